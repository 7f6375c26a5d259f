// Plots as SVG text: what the report needs, no more.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace corotet::program {

struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< > 0; others are left out
  bool line = true;                               ///< joined in the given order
  bool marks = true;
};

/// Both axes logarithmic.
struct LogLogPlot {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;

  [[nodiscard]] std::string svg() const;
};

/// Horizontal bars, each of parts one after the other, and a mark at its total.
struct StackedBars {
  struct Bar {
    std::string name;
    std::vector<double> parts;  ///< >= 0, as many as `part_names`
    double total = 0;
  };
  std::string title, x_label;
  std::vector<std::string> part_names;
  std::vector<Bar> bars;

  [[nodiscard]] std::string svg() const;
};

}  // namespace corotet::program
