// Doing a study: its runs, their errors, and what follows from them.
#pragma once

#include <functional>
#include <string>

#include "report_data.hpp"
#include "study.hpp"
#include "time_budget.hpp"

namespace corotet::program {

/// Told what is done next and which part of the study is done (0 ... 1).
using StudyObserver = std::function<void(const std::string& what, double part)>;

/// Rows are timed on one thread; the references use `threads`. Runs for which `allowance` does not suffice are rows
/// that say so. Throws a Failure if there is nothing to measure errors against.
[[nodiscard]] StudyReport run_study(const Study& study, ThreadPool& threads, TimeBudget& budget,
                                    const StudyObserver& observer);

}  // namespace corotet::program
