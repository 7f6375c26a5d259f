// What is refused before anything is computed.
#pragma once

#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_options.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <cstddef>

namespace corotet::inline v0_1::detail {

/// The report of a step that is not made: the body is as it was. `vertex`: the culprit, if there is one.
[[nodiscard]] inline StepReport refused(StepReport report, StepError why, Index vertex = -1) {
  report.error = why;
  report.vertex = vertex;
  report.converged = false;
  return report;
}

/// Names what the caller gave that keeps a step of `h` seconds from being tried: h, options, or a force, gravity or pin
/// that is not finite. Accepted if nothing does.
template <class Body>
[[nodiscard]] COROTET_COLD StepReport check_step(const Body& body, typename Body::scalar_type h,
                                                 const StepOptions& options) {
  if (!std::isfinite(h) || h <= 0) return refused({}, StepError::time_step);
  if (options.iterations < 1 || !is_tolerance(options.tolerance)) return refused({}, StepError::newton_options);
  if (!body.gravity().allFinite()) return refused({}, StepError::gravity);
  const auto force = body.external_forces();
  for (std::size_t v = 0; v < force.size(); ++v)
    if (!force[v].allFinite()) return refused({}, StepError::external_force, static_cast<Index>(v));
  for (std::size_t p = 0; p < body.pins().targets().size(); ++p)
    if (!body.pins().targets()[p].allFinite()) return refused({}, StepError::pin_target, body.pins().vertices()[p]);
  return {};
}

}  // namespace corotet::inline v0_1::detail
