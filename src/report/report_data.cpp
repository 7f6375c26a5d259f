#include "report_data.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace corotet::program {
namespace {

struct ErrorAt {
  double size;  // h or dt
  Errors errors;
  std::array<Index, 3> cells{};  // of a grid; 0: any
};

/// A mesh that is finer along one axis only has no order.
bool is_refined_evenly(const ErrorAt& coarse, const ErrorAt& fine) {
  if (!(coarse.size > 1.2 * fine.size)) return false;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (coarse.cells[axis] * fine.cells[0] != fine.cells[axis] * coarse.cells[0]) return false;
  return true;
}

/// Between each and the nearest coarser one; fine ones last.
void add_orders(const std::string& what, std::vector<ErrorAt> points, std::vector<MeasuredOrder>& orders) {
  std::sort(points.begin(), points.end(), [](const ErrorAt& a, const ErrorAt& b) { return a.size > b.size; });
  for (std::size_t i = 1; i < points.size(); ++i) {
    const ErrorAt& fine = points[i];
    const auto found = std::find_if(points.rend() - static_cast<std::ptrdiff_t>(i), points.rend(),
                                    [&](const ErrorAt& p) { return is_refined_evenly(p, fine); });
    if (found == points.rend()) continue;
    const ErrorAt& coarse = *found;
    const auto order = [&](double Errors::*measure) {
      const double a = coarse.errors.*measure, b = fine.errors.*measure;
      return a > 0 && b > 0 ? std::log(a / b) / std::log(coarse.size / fine.size)
                            : std::numeric_limits<double>::quiet_NaN();
    };
    orders.push_back({fmt::format("{} {:.3g} → {:.3g}", what, coarse.size, fine.size), order(&Errors::displacement),
                      order(&Errors::energy), order(&Errors::probe)});
  }
}

/// Of the grid, with the scene's own integrator and time step.
bool differs_in_mesh_only(const StudyReport& report, const ReportRow& row) {
  return row.role == "grid" && row.run.ok() && row.configuration.scene.integrator == report.integrator &&
         std::abs(row.configuration.scene.dt / report.frame_s - 1) < 1e-9;
}

}  // namespace

void mark_frontier(std::vector<ReportRow>& rows) {
  std::vector<ReportRow*> sound;
  for (ReportRow& row : rows) {
    row.frontier = false;
    if (row.run.ok() && std::isfinite(row.errors.total.displacement) && row.frame_ms > 0) sound.push_back(&row);
  }
  std::sort(sound.begin(), sound.end(), [](const ReportRow* a, const ReportRow* b) {
    return a->frame_ms != b->frame_ms ? a->frame_ms < b->frame_ms
                                      : a->errors.total.displacement < b->errors.total.displacement;
  });
  double least = std::numeric_limits<double>::infinity();
  for (ReportRow* row : sound) {
    if (row->errors.total.displacement >= least) continue;
    least = row->errors.total.displacement;
    row->frontier = true;
  }
}

std::vector<MeasuredOrder> measure_orders(const StudyReport& report) {
  std::vector<MeasuredOrder> orders;
  for (const int order : {1, 2}) {
    std::vector<ErrorAt> points;
    for (const ReportRow& row : report.rows) {
      if (row.configuration.order != order || !differs_in_mesh_only(report, row)) continue;
      if (row.errors.space.displacement >= report.reference_error)  // the reference is a mesh, too
        points.push_back({report.level_sizes[at(row.configuration.level)], row.errors.space,
                          report.level_cells[at(row.configuration.level)]});
    }
    add_orders(order == 1 ? "Tet4, h/m" : "Tet10, h/m", points, orders);
  }
  if (report.at_rest) return orders;
  for (const IntegratorKind integrator : {IntegratorKind::implicit_euler, IntegratorKind::bdf2}) {
    std::vector<ErrorAt> points;
    for (const ReportRow& row : report.rows) {  // the error of time is measured on the finest mesh: rows repeat it
      const double dt = row.configuration.scene.dt;
      const bool known = std::any_of(points.begin(), points.end(), [&](const ErrorAt& p) { return p.size == dt; });
      if (row.role == "grid" && row.run.ok() && row.configuration.scene.integrator == integrator && !known)
        points.push_back({dt, row.errors.time, {}});
    }
    add_orders(integrator == IntegratorKind::bdf2 ? "BDF2, dt/s" : "backward Euler, dt/s", points, orders);
  }
  return orders;
}

std::string mesh_name(const StudyReport& report, const Configuration& configuration) {
  return fmt::format("{} {}", configuration.order == 1 ? "Tet4" : "Tet10", report.level_names[at(configuration.level)]);
}

}  // namespace corotet::program
