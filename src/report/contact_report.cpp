#include "contact_report.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <corotet/detail/core/version.hpp>

#include "svg_plot.hpp"

namespace corotet::program {
namespace {

std::string dt_text(double dt) { return fmt::format("1/{:.4g}", 1 / dt); }

std::string error_text(double error) {
  return error < 1e-3 ? fmt::format("{:.0e}", error) : fmt::format("{:.2g} %", 100 * error);
}

std::string table(const ContactCaseReport& report) {
  const std::vector<ContactRow>& rows = report.rows;
  const auto complete =
      std::find_if(rows.begin(), rows.end(), [](const ContactRow& row) { return !row.quantities.empty(); });
  std::string text = "| | E, Pa | mesh | integrator | h, s |", line = "| --- | --- | --- | --- | --- |";
  if (complete != rows.end())
    for (const ContactQuantity& q : complete->quantities) {
      text += fmt::format(" {} | error |", q.name);
      line += " --- | --- |";
    }
  text += " ms a step | ms a frame | iterations | passes | most | touching |\n" + line +
          " --- | --- | --- | --- | --- | --- |\n";
  for (const ContactRow& row : rows) {
    const ContactSetting& s = row.setting;
    text += fmt::format("| {} | {:.0e} | {} | {} | {} |", row.frontier ? "•" : "", s.young, row.mesh,
                        name_of(s.integrator), dt_text(s.dt));
    if (row.status != "ok") {
      text += fmt::format(" {} |\n", row.status);
      continue;
    }
    for (const ContactQuantity& q : row.quantities)
      text += fmt::format(" {:.5g} | {} |", q.measured, error_text(q.error()));
    text += fmt::format(" {:.3g} | {:.3g} | {:.1f} | {:.2f} | {} | {} |\n", row.step_ms, row.frame_ms, row.iterations,
                        row.passes, row.max_passes, row.most_touching);
  }
  return text;
}

}  // namespace

std::string plot_name(const ContactCaseReport& report) { return report.of.name + "_error_time.svg"; }

std::string plot_contact(const ContactCaseReport& report) {
  LogLogPlot plot;
  plot.title = report.of.title;
  plot.x_label = "ms for 1/60 s of motion, one thread";
  for (const ContactRow& row : report.rows) {
    if (row.status != "ok") continue;
    const ContactQuantity& first = row.quantities.front();
    plot.y_label = "error of the " + first.name.substr(0, first.name.find(','));
    const std::string name = fmt::format("{}, {}, E {:.0e}", row.setting.order == 1 ? "Tet4" : "Tet10",
                                         name_of(row.setting.integrator), row.setting.young);
    if (plot.series.empty() || plot.series.back().name != name) {
      const auto known = std::find_if(plot.series.begin(), plot.series.end(),
                                      [&](const PlotSeries& series) { return series.name == name; });
      if (known == plot.series.end()) plot.series.push_back({.name = name, .points = {}, .line = false});
    }
    std::find_if(plot.series.begin(), plot.series.end(), [&](const PlotSeries& series) {
      return series.name == name;
    })->points.emplace_back(row.frame_ms, first.error());
  }
  return plot.series.empty() ? "" : plot.svg();
}

std::string format_contact_markdown(const std::vector<ContactCaseReport>& reports, const std::string& command) {
  std::string text = fmt::format(
      "# Contact: speed against error\n\nPrinted by `{}`, corotet {}.{}.{}. Every row with every column: "
      "contact.csv.\n\n",
      command, COROTET_VERSION_MAJOR, COROTET_VERSION_MINOR, COROTET_VERSION_PATCH);
  text +=
      "All in float, with one solve a step and the solver's own choice, on one thread. *Error* is relative, against "
      "the "
      "closed form; the meshes\nand the integrator have their own errors in it. *ms a step* is the mean over all steps "
      "of "
      "the run, *ms a frame* the same for 1/60 s of\nmotion. *Passes*: linear solves a step, mean and most. •: no "
      "other "
      "row of this stiffness has less error of the first quantity for less time.\n";
  for (const ContactCaseReport& report : reports) {
    text += fmt::format("\n## {}: {}\n\n{}: {}", report.of.name, report.of.title, "Known", report.of.known_from);
    for (const double young : report.of.youngs)
      for (const ContactRow& row : report.rows)
        if (row.setting.young == young && row.status == "ok") {
          std::string values;
          for (const ContactQuantity& q : row.quantities)
            values += fmt::format("{}{} {:.6g}", values.empty() ? "" : "; ", q.name, q.known);
          text += fmt::format(". E {:.0e}: {}", young, values);
          break;
        }
    text += fmt::format(".\n\n{}", table(report));
    if (!plot_contact(report).empty()) text += fmt::format("\n![{0}]({0})\n", plot_name(report));
  }
  return text;
}

std::string format_contact_csv(const std::vector<ContactCaseReport>& reports) {
  std::string text =
      "case,quantity,known,measured,error,status,young,element,mesh,elements,vertices,integrator,dt,steps,step_ms,"
      "frame_ms,iterations,passes,max_passes,most_touching,unsettled,frontier\n";
  const auto quoted = [](std::string cell) {
    std::replace(cell.begin(), cell.end(), '"', '\'');
    return fmt::format("\"{}\"", cell);
  };
  for (const ContactCaseReport& report : reports)
    for (const ContactRow& row : report.rows) {
      const ContactSetting& s = row.setting;
      const std::string run =
          fmt::format("{},{:g},{},{},{},{},{},{:.6g},{},{:.4g},{:.4g},{:.3f},{:.3f},{},{},{},{}\n", quoted(row.status),
                      s.young, s.order == 1 ? "tet4" : "tet10", row.mesh, row.elements, row.vertices,
                      name_of(s.integrator), s.dt, row.steps, row.step_ms, row.frame_ms, row.iterations, row.passes,
                      row.max_passes, row.most_touching, row.unsettled, row.frontier ? 1 : 0);
      for (const ContactQuantity& q : row.quantities)
        text += fmt::format("{},{},{:.9g},{:.9g},{:.4g},{}", report.of.name, quoted(q.name), q.known, q.measured,
                            q.error(), run);
      if (row.quantities.empty()) text += fmt::format("{},,,,,{}", report.of.name, run);
    }
  return text;
}

}  // namespace corotet::program
