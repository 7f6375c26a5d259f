#include "suite.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <corotet/detail/core/thread_pool.hpp>
#include <exception>
#include <mutex>
#include <utility>

#include "../failure.hpp"
#include "../progress.hpp"

namespace corotet::program::stress {
namespace {

std::vector<Case> choose_cases(const std::vector<std::string>& wanted) {
  std::vector<Case> cases = all_cases();
  if (wanted.empty()) return cases;
  const auto is = [](const Case& c, const std::string& name) {
    return c.name == name || c.name.substr(0, c.name.find('-')) == name || c.name.starts_with(name + "-");
  };
  for (const std::string& name : wanted)
    if (std::none_of(cases.begin(), cases.end(), [&](const Case& c) { return is(c, name); }))
      throw Failure(fmt::format("there is no case \"{}\"; --list names them", name));
  std::erase_if(cases, [&](const Case& c) {
    return std::none_of(wanted.begin(), wanted.end(), [&](const std::string& name) { return is(c, name); });
  });
  return cases;
}

std::vector<Run> plan(const std::vector<Case>& cases, const SuiteOptions& options) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const std::vector<SolverChoice> solvers = solver_choices(cases[i].solvers);
    const std::vector<Ratio>& ratios = cases[i].ratios;
    for (const int order : {1, 2})
      for (const ScalarKind scalar : {ScalarKind::single_precision, ScalarKind::double_precision})
        for (const Stepping stepping : {Stepping::euler, Stepping::newton, Stepping::bdf2})
          for (const SolverChoice& solver : solvers)
            for (const Ratio& ratio : ratios) {
              const bool centre_solver = solver.name == solvers.front().name,
                         centre_ratio = ratio.name == ratios.front().name;
              if (options.breadth == Coverage::star && !centre_solver && !centre_ratio) continue;
              if (options.breadth == Coverage::quick && !(centre_solver && centre_ratio)) continue;
              if (options.breadth == Coverage::quick && scalar == ScalarKind::double_precision) continue;
              const Configuration c{order, scalar, stepping, solver, ratio, options.tangent};
              if (std::all_of(options.only.begin(), options.only.end(),
                              [&](const std::string& word) { return c.has_word(word); }))
                runs.push_back({i, c, {}, 0});
            }
  }
  return runs;
}

void carry_out(Run& run, const Case& hard, const Effort& effort) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  try {
    run.verdict = hard.run(run.configuration, effort);
  } catch (const std::exception& error) {
    run.verdict.expect(false, error.what());
  }
  run.seconds = std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  add_start_cases(cases);
  add_held_cases(cases);
  add_free_cases(cases);
  add_material_cases(cases);
  add_scale_cases(cases);
  add_input_cases(cases);
  add_endurance_cases(cases);
  return cases;
}

Outcome run_suite(const SuiteOptions& options) {
  Outcome outcome{choose_cases(options.cases), {}};
  outcome.runs = plan(outcome.cases, options);
  if (outcome.runs.empty()) throw Failure("no configuration of these cases has all the words of --only");
  Effort effort;  // of --full
  if (options.breadth == Coverage::star) effort.long_steps = 2000;
  if (options.breadth == Coverage::quick) effort = {.seeds = 10, .long_steps = 300};
  Progress progress(static_cast<int>(outcome.runs.size()));
  std::mutex mutex;
  int done = 0;
  ThreadPool pool(options.threads);
  pool(static_cast<Index>(outcome.runs.size()), [&](Index i) {
    Run& run = outcome.runs[at(i)];
    carry_out(run, outcome.cases[run.of_case], effort);
    const std::lock_guard lock(mutex);
    progress.show(++done);
  });
  return outcome;
}

}  // namespace corotet::program::stress
