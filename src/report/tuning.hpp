// Looks for the cheapest settings that are accurate enough, or the most accurate that are cheap enough.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "references.hpp"
#include "report_data.hpp"
#include "study.hpp"

namespace corotet::program {

/// One of the two is asked for.
struct TuningGoal {
  std::optional<double> error;      ///< of displacements in the norm of the mass, relative
  std::optional<double> budget_ms;  ///< for as much motion as one step of the scene, on one thread
};

/// Settings with what they are expected to cost and reach: parts measured one by one and added up.
struct Candidate {
  Configuration configuration;
  double space = 0, time = 0, arithmetic = 0;  ///< relative errors
  double frame_ms = 0;
  bool measured = false;  ///< then error and frame_ms are those of a run of these very settings
  double error = 0;       ///< until measured: the sum of the parts, on the safe side
};

struct Tuning {
  Candidate predicted, measured;
  Candidate as_it_was;  ///< the scene itself, measured
  int tried = 0;        ///< candidates that were run to see whether they keep their promise
};

/// Writes the settings down as a scene, and runs what was written.
using Confirm = std::function<RunResult(const Configuration&)>;

/// What `confirm` returns is what `measured` is measured on. Throws a Failure that names the best that was found if no
/// candidate reaches the goal. `observer` as for `conduct`.
[[nodiscard]] Tuning tune(const Study& study, const TuningGoal& goal, ThreadPool& threads, TimeBudget& budget,
                          const Confirm& confirm, const std::function<void(const std::string&, double)>& observer);

}  // namespace corotet::program
