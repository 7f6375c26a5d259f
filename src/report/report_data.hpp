// All that a report found out, before it is written down.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "error_budget.hpp"
#include "references.hpp"
#include "study.hpp"

namespace corotet::program {

struct ReportRow {
  std::string role;  ///< matrix.hpp
  Configuration configuration;
  RunResult run;                           ///< without its track
  ErrorParts errors;                       ///< not a number where the run is not ok
  std::vector<double> closed_form_errors;  ///< relative, one for each of the study's closed forms
  double spmv_us = 0;                      ///< of the mesh
  double frame_ms = 0;                     ///< for as much motion as one step of the scene: step_ms times steps in it
  bool frontier = false;                   ///< no other row has a smaller total error for less time
};

/// A measured order of convergence.
struct MeasuredOrder {
  std::string what;  ///< "Tet4, h 0.05 -> 0.025"
  double displacement = 0, energy = 0, probe = 0;
};

/// A number of the reference run beside the one that is known.
struct ClosedFormCheck {
  std::string what, source;
  double expected = 0, reference = 0;
};

struct StudyReport {
  std::string name, title, notes;
  std::string reference;       ///< what the errors are against
  double reference_error = 0;  ///< of the reference's own mesh, estimated from the next coarser one (displacement)
  double frame_s = 0;          ///< the scene's time step
  IntegratorKind integrator = IntegratorKind::implicit_euler;  ///< the scene's
  bool at_rest = false;
  std::vector<std::string> closed_form_names;
  std::vector<ReportRow> rows;
  std::vector<MeasuredOrder> orders;
  std::vector<ClosedFormCheck> checks;
  std::vector<ErrorBudget> budgets;
  std::vector<double> level_sizes;  ///< h of each mesh level, m
  std::vector<std::string> level_names;
  std::vector<std::array<Index, 3>> level_cells;  ///< of grids
};

/// Marks the rows on the frontier of total error (displacement) against time.
void mark_frontier(std::vector<ReportRow>& rows);

/// From the grid: of the mesh (each order of element, at the scene's time step, space alone) and of the time step
/// (on the finest mesh, time alone).
[[nodiscard]] std::vector<MeasuredOrder> measure_orders(const StudyReport& report);

/// "Tet10 10x1x1".
[[nodiscard]] std::string mesh_name(const StudyReport& report, const Configuration& configuration);

}  // namespace corotet::program
