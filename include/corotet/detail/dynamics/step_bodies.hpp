// Many small bodies at once.
#pragma once

#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <span>

namespace corotet::inline v0_1 {

/// Steps `bodies[i]` by `integrators[i]`, which was made for it or for a copy of it, by `h` seconds; `reports[i]` tells
/// how that ended. The three have the same length. Bodies are handed to the executor a few at a time and each is
/// stepped by one thread: a body too small to be worth splitting is stepped with no synchronisation inside, and what
/// its integrator reads and writes stays in one core's cache from phase to phase. Same bits on any executor.
///
/// Bodies that touch each other are coupled by the caller, between steps, through external forces.
template <class Integrator, class Body>
void step_bodies(std::span<Integrator> integrators, std::span<Body> bodies, typename Body::scalar_type h,
                 std::span<StepReport> reports, ExecutorRef executor) {
  COROTET_ASSERT(integrators.size() == bodies.size() && reports.size() == bodies.size(),
                 "one integrator and one report a body");
  constexpr Index bodies_a_task = 2;  // some tens of microseconds, as other tasks
  for_ranges(executor, size_of(bodies), bodies_a_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) reports[at(i)] = integrators[at(i)].step(bodies[at(i)], h);
  });
}

}  // namespace corotet::inline v0_1
