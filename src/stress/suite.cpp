#include "suite.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <corotet/detail/core/thread_pool.hpp>
#include <cstdint>
#include <exception>
#include <mutex>
#include <utility>

#include "../failure.hpp"
#include "../progress.hpp"
#include "pairwise.hpp"

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

/// The words of --only by factor.
FactorWords sort_words(const std::vector<std::string>& only) {
  const FactorWords known = all_factors(all_cases()).words();
  FactorWords wanted;
  for (const std::string& word : only) {
    const auto factor = std::find_if(known.begin(), known.end(), [&](const std::vector<std::string>& words) {
      return std::find(words.begin(), words.end(), word) != words.end();
    });
    if (factor == known.end()) throw Failure(fmt::format("--only: no configuration has the word \"{}\"", word));
    wanted[static_cast<std::size_t>(factor - known.begin())].push_back(word);
  }
  return wanted;
}

/// FNV-1a: a case keeps its configurations when others come or go.
std::uint32_t hash_of(const std::string& name) {
  std::uint32_t hash = 2166136261U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return hash;
}

std::vector<Run> plan(const std::vector<Case>& cases, const SuiteOptions& options) {
  const FactorWords wanted = sort_words(options.only);
  std::vector<Run> runs;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Factors factors = cases[i].factors();
    if (options.coverage == Coverage::quick) {
      factors.scalars.resize(1);
      factors.solvers.resize(1);
      factors.ratios.resize(1);
    }
    factors.keep(wanted);
    const auto levels = factors.levels();
    for (const Choice& choice :
         options.coverage == Coverage::pairs ? pairwise(levels, hash_of(cases[i].name)) : full_product(levels)) {
      Configuration configuration = factors.configuration(choice);
      configuration.tangent = options.tangent;
      runs.push_back({.of_case = i, .configuration = configuration});
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
  add_contact_cases(cases);
  return cases;
}

Factors all_factors(const std::vector<Case>& cases) {
  Factors factors{.solvers = solver_choices(Solvers::all), .ratios = {}};
  for (const Case& each : cases)
    for (const Ratio& ratio : each.ratios)
      if (std::none_of(factors.ratios.begin(), factors.ratios.end(),
                       [&](const Ratio& known) { return known.name == ratio.name; }))
        factors.ratios.push_back(ratio);
  return factors;
}

Outcome run_suite(const SuiteOptions& options) {
  Outcome outcome{choose_cases(options.cases), {}};
  outcome.runs = plan(outcome.cases, options);
  if (outcome.runs.empty()) throw Failure("no configuration of these cases has all the words of --only");
  Effort effort;
  if (options.coverage == Coverage::quick) effort = {.seeds = 10, .long_steps = 300};
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
