#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "report_files.hpp"
#include "svg_plot.hpp"

namespace corotet::program {
namespace {

using Points = std::vector<std::pair<double, double>>;

bool has_own_step(const StudyReport& report, const ReportRow& row) {
  return row.configuration.scene.dt == report.frame_s && row.configuration.scene.integrator == report.integrator;
}

const char* element_name(int order) { return order == 1 ? "Tet4" : "Tet10"; }

NamedPlot error_against_time(const StudyReport& report) {
  LogLogPlot plot{
      fmt::format("{}: error against time", report.name),
      report.at_rest ? "ms a step, one thread" : fmt::format("ms for {:.3g} s of motion, one thread", report.frame_s),
      "total error (displacement)",
      {}};
  Points frontier;
  for (const int order : {1, 2}) {
    PlotSeries grid{fmt::format("{}, meshes x dt", element_name(order)), {}, false},
        varied{fmt::format("{}, other settings", element_name(order)), {}, false};
    for (const ReportRow& row : report.rows) {
      if (!row.run.ok() || row.configuration.order != order) continue;
      (row.role == "grid" ? grid : varied).points.emplace_back(row.frame_ms, row.errors.total.displacement);
      if (row.frontier) frontier.emplace_back(row.frame_ms, row.errors.total.displacement);
    }
    for (const PlotSeries& series : {grid, varied})
      if (!series.points.empty()) plot.series.push_back(series);
  }
  std::sort(frontier.begin(), frontier.end());
  plot.series.push_back({"Pareto frontier", frontier, true, false});
  return {report.name + "_error_time.svg", plot.svg()};
}

NamedPlot error_against_size(const StudyReport& report) {
  LogLogPlot plot{fmt::format("{}: error of the mesh", report.name),
                  "h, cube root of the mean element volume, m",
                  "error of space alone",
                  {}};
  for (const int order : {1, 2}) {
    std::map<double, Errors> errors;
    for (const ReportRow& row : report.rows)
      if (row.role == "grid" && row.run.ok() && row.configuration.order == order && has_own_step(report, row))
        errors[report.level_sizes[at(row.configuration.level)]] = row.errors.space;
    PlotSeries displacement{fmt::format("{}, displacement", element_name(order)), {}},
        energy{fmt::format("{}, energy", element_name(order)), {}};
    for (const auto& [size, error] : errors) {
      displacement.points.emplace_back(size, error.displacement);
      energy.points.emplace_back(size, error.energy);
    }
    plot.series.push_back(displacement);
    plot.series.push_back(energy);
  }
  return {report.name + "_error_h.svg", plot.svg()};
}

NamedPlot error_against_step(const StudyReport& report) {
  LogLogPlot plot{
      fmt::format("{}: error of the time step", report.name), "dt, s", "error of time alone, finest mesh", {}};
  std::map<std::string, std::map<double, Errors>> errors;  // by integrator
  for (const ReportRow& row : report.rows) {
    if (!row.run.ok() || (row.role != "grid" && row.role != "integrator")) continue;
    std::string integrator;
    for (const Setting& setting : settings())
      if (std::string(setting.name) == "integrator") integrator = setting.value(row.configuration);
    errors[integrator][row.configuration.scene.dt] = row.errors.time;
  }
  for (const auto& [integrator, by_step] : errors) {
    PlotSeries displacement{integrator + ", displacement", {}}, energy{integrator + ", energy", {}};
    for (const auto& [dt, error] : by_step) {
      displacement.points.emplace_back(dt, error.displacement);
      energy.points.emplace_back(dt, error.energy);
    }
    plot.series.push_back(displacement);
    plot.series.push_back(energy);
  }
  return {report.name + "_error_dt.svg", plot.svg()};
}

NamedPlot budget(const StudyReport& report) {
  StackedBars bars{
      fmt::format("{}: what the error is made of", report.name), "relative error (displacement)", budget_parts(), {}};
  for (const ErrorBudget& b : report.budgets) {
    StackedBars::Bar bar{b.label, {}, b.total.displacement};
    for (const BudgetPart& part : b.parts) bar.parts.push_back(part.errors.displacement);
    bars.bars.push_back(bar);
  }
  return {report.name + "_budget.svg", bars.svg()};
}

}  // namespace

std::vector<NamedPlot> make_plots(const StudyReport& report) {
  std::vector<NamedPlot> plots{error_against_time(report), error_against_size(report)};
  if (!report.at_rest) plots.push_back(error_against_step(report));
  plots.push_back(budget(report));
  return plots;
}

NamedPlot make_cost_plot(const std::vector<StudyReport>& reports) {
  LogLogPlot plot{"Cost against size", "vertices", "ms a step, one thread", {}};
  std::map<std::string, std::map<double, double>> cost;
  for (const StudyReport& report : reports)
    for (const ReportRow& row : report.rows) {
      const bool compared = (row.role == "grid" && !report.at_rest) || row.role == "preconditioner";
      if (!row.run.ok() || !compared || !has_own_step(report, row) || row.run.facts.vertices == 0) continue;
      const std::string name = row.role == "grid"
                                   ? fmt::format("{} {}", report.name, element_name(row.configuration.order))
                                   : fmt::format("{} {}, {}", report.name, element_name(row.configuration.order),
                                                 row.run.facts.preconditioner);
      cost[name][row.run.facts.vertices] = row.run.step_ms;
    }
  for (const auto& [name, points] : cost)
    if (points.size() > 1) plot.series.push_back({name, {points.begin(), points.end()}});
  return {"cost.svg", plot.svg()};
}

}  // namespace corotet::program
