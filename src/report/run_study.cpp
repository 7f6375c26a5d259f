#include "run_study.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "../failure.hpp"
#include "matrix.hpp"

namespace corotet::program {
namespace {

/// One product of the mesh's matrix with a vector, us; 0 if no body can be made of it. Each mesh is timed once.
class SpmvBaseline {
 public:
  double of(const Study& study, const Configuration& c) {
    const auto [place, is_new] = us_.try_emplace({c.level, c.order}, 0.0);
    if (!is_new) return place->second;
    try {
      place->second = make_simulation(c.scene, study.meshes.mesh(c.level, c.order))->measure_spmv_us();
    } catch (const Failure&) {
      place->second = 0;  // the run says what is wrong
    }
    return place->second;
  }

 private:
  std::map<std::pair<int, int>, double> us_;
};

/// A run for its time and its errors.
ReportRow measure(const Study& study, const Planned& planned, References& references, TimeBudget& budget,
                  SpmvBaseline& baseline) {
  const Configuration& c = planned.configuration;
  ReportRow row{planned.role, c, {}, {}, {}, 0, 0, false};
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  row.errors = {{none, none, none}, {none, none, none}, {none, none, none}, {none, none, none}};
  row.closed_form_errors.assign(study.closed_forms.size(), none);
  if (const double seconds = references.estimate(c); seconds > budget.left()) {
    row.run.status = fmt::format("left out: it and its references would take about {:.0f} s", seconds);
    return row;
  }
  ThreadPool serial(1);
  const auto start = std::chrono::steady_clock::now();
  row.run = run(study, c, serial);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (row.run.steps > 0)
    budget.learn(TimeBudget::kind(c.order, false), study.meshes[c.level].linear.element_count(), row.run.steps,
                 seconds);
  row.spmv_us = baseline.of(study, c);
  row.frame_ms = row.run.step_ms * study.scene.dt / c.scene.dt;
  if (row.run.ok()) {
    row.errors = references.parts(c, row.run);
    for (std::size_t k = 0; k < study.closed_forms.size(); ++k)
      row.closed_form_errors[k] = std::abs(study.closed_forms[k].measure(row.run) / study.closed_forms[k].value - 1);
  }
  row.run.track.clear();
  row.run.probes.clear();
  return row;
}

}  // namespace

StudyReport run_study(const Study& study, ThreadPool& threads, TimeBudget& budget, const StudyObserver& observer) {
  observer(study.name + ": reference", 0);
  constexpr double share_of_finest = 0.5;
  References references(study, study.reference_level, threads, budget, share_of_finest);
  StudyReport report;
  report.name = study.name;
  report.title = study.title;
  report.notes = study.meshes.notes;
  report.frame_s = study.scene.dt;
  report.at_rest = study.at_rest;
  report.integrator = study.scene.integrator;
  for (const MeshLevel& level : study.meshes.levels) {
    report.level_sizes.push_back(level.size);
    report.level_names.push_back(level.name);
    report.level_cells.push_back(level.cells);
  }
  const RunResult& exact = references.exact();
  report.reference = fmt::format("Tet10 {}, double, solved to 1e-10{}", study.meshes[references.level()].name,
                                 study.at_rest ? "" : ", BDF2 with Newton's method extrapolated to dt = 0");
  report.reference_error = references.own_error();
  if (references.level() < study.reference_level)
    report.notes += fmt::format("{}mesh {} would have been a better reference but takes longer than --minutes allows",
                                report.notes.empty() ? "" : "; ", study.meshes[study.reference_level].name);
  for (const ClosedForm& form : study.closed_forms) {
    report.closed_form_names.push_back(form.what);
    report.checks.push_back({form.what, form.source, form.value, form.measure(exact)});
  }

  const Configuration base = base_of(study, references.level());
  const std::vector<Planned> planned = plan(study, base);
  const auto count = static_cast<double>(planned.size());
  SpmvBaseline baseline;
  for (std::size_t i = 0; i < planned.size(); ++i) {
    const Configuration& c = planned[i].configuration;
    const bool is_reference = c.order == 2 && c.level >= references.level();
    observer(fmt::format("{}: {}, dt {:.3g}", study.name, mesh_name(report, c), c.scene.dt), double(i) / count);
    if (is_reference && study.meshes.count() > 1) continue;  // it cannot be measured against itself
    report.rows.push_back(measure(study, planned[i], references, budget, baseline));
  }
  mark_frontier(report.rows);
  report.orders = measure_orders(report);

  // Of the rows that a reader compares: each element on its meshes, at the scene's time step, and the base at others.
  observer(study.name + ": error budgets", 1);
  constexpr std::size_t max_budgets = 16;
  for (const ReportRow& row : report.rows) {
    const Configuration& c = row.configuration;
    const bool own_step = c.scene.dt == study.scene.dt && c.scene.integrator == study.scene.integrator;
    const bool at_base = c.level == base.level && c.order == base.order;
    const bool told = (row.role == "grid" && (own_step || at_base)) || row.role == "rotation" || row.role == "newton" ||
                      row.role == "dilatation" ||
                      (row.role == "tolerance" && c.scene.solver.tolerance > study.scene.solver.tolerance);
    if (!told || !row.run.ok() || report.budgets.size() >= max_budgets || references.estimate(c) > budget.left())
      continue;
    std::string label = mesh_name(report, c);
    if (c.scene.integrator != study.scene.integrator) label += fmt::format(", {}", name_of(c.scene.integrator));
    if (c.scene.dt != study.scene.dt) label += fmt::format(", dt {:.3g} s", c.scene.dt);
    if (row.role != "grid") {
      for (const Setting& setting : settings())
        if (setting.name == row.role) label += ", " + std::string(setting.name) + " " + setting.value(c);
    }
    report.budgets.push_back(measure_budget(references, c, std::move(label)));
  }
  return report;
}

}  // namespace corotet::program
