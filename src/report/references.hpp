// The runs that others are measured against. Each is made once.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <map>
#include <optional>
#include <string>

#include "error_norms.hpp"
#include "study.hpp"
#include "time_budget.hpp"

namespace corotet::program {

/// Errors of a run r on mesh m with time step h, by cause. With T(m, h) the tightened run (configuration.hpp) and * for
/// "as fine as can be had", the parts add up, as vectors, to the total:
///   r - T(*, *) = [r - T(m, h)] + [T(m, h) - T(*, h)] + [T(*, h) - T(*, *)].
struct ErrorParts {
  Errors total, space, time;
  Errors arithmetic;  ///< tolerance, rotation and precision together
};

class References {
 public:
  /// Uses at most `share` of what is left of the allowance for the finest runs: else it takes a coarser mesh for them.
  References(const Study& study, int level, ThreadPool& pool, TimeBudget& budget, double share);

  /// Of 10-node elements.
  [[nodiscard]] int level() const { return level_; }

  /// Any configuration, without regard to its time.
  const RunResult& of(const Configuration& configuration);

  [[nodiscard]] Configuration on_finest_mesh(Configuration configuration) const;

  /// T(*, *): on the finest mesh by BDF2 with Newton's method, extrapolated from the study's shortest time step and
  /// half of it (Richardson: the error of BDF2 is proportional to the square of the step). Throws a Failure if it
  /// fails.
  const RunResult& exact();

  /// Error of the finest mesh itself, at the scene's time step: what the next coarser one is off by, over 3 (as if the
  /// error went with the square of h; it goes faster where the solution is smooth). Not a number if there is none.
  [[nodiscard]] double own_error();

  [[nodiscard]] ErrorParts parts(const Configuration& configuration, const RunResult& result);
  [[nodiscard]] const ErrorNorms& norms();

  /// What a run and the references that only it needs would take, s.
  [[nodiscard]] double estimate(const Configuration& configuration) const;

 private:
  [[nodiscard]] double shortest_dt() const;
  [[nodiscard]] double elements(const Configuration& configuration) const;
  [[nodiscard]] double steps(const Configuration& configuration) const;
  [[nodiscard]] Configuration tight(const Configuration& configuration) const;

  const Study& study_;
  ThreadPool& pool_;
  TimeBudget& allowance_;
  int level_;
  std::map<std::string, RunResult> runs_;
  std::optional<RunResult> exact_;
  std::optional<ErrorNorms> norms_;
};

}  // namespace corotet::program
