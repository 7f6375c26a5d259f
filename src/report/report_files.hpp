// report.csv, report.md and the plots.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report_data.hpp"

namespace corotet::program {

/// One line a row, all studies: docs/benchmarks/report.md describes the columns.
[[nodiscard]] std::string format_csv(const std::vector<StudyReport>& reports);

/// The page that shows the plots and says what they say. `command`: what printed it.
[[nodiscard]] std::string format_markdown(const std::vector<StudyReport>& reports, const std::string& command);

/// Names and contents of the plots of a study, as the page refers to them.
struct NamedPlot {
  std::string file, svg;
};
[[nodiscard]] std::vector<NamedPlot> make_plots(const StudyReport& report);

/// Cost against size, of all studies.
[[nodiscard]] NamedPlot make_cost_plot(const std::vector<StudyReport>& reports);

}  // namespace corotet::program
