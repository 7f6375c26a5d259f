// All runs of the hard cases, and what became of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "case.hpp"
#include "case_result.hpp"
#include "configuration.hpp"

namespace corotet::program::stress {

/// How many configurations are tried.
enum class Coverage {
  quick,  ///< float, auto and one of Poisson's ratios, with less effort
  star,   ///< all solvers for one ratio, all ratios for `auto`
  full    ///< all solvers for all ratios
};

struct SuiteOptions {
  std::vector<std::string> cases;  ///< names, or their part before a '-'; none: all
  std::vector<std::string> only;   ///< words that a configuration must have
  std::optional<Tangent> tangent;  ///< instead of each stepping's own
  Coverage breadth = Coverage::star;
  int threads = 1;
};

struct Run {
  std::size_t of_case;  ///< in the list of cases
  Configuration configuration;
  CaseResult verdict;
  double seconds = 0;
};

struct Outcome {
  std::vector<Case> cases;  ///< those that were asked for
  std::vector<Run> runs;
};

/// Throws a Failure for a case or a word that there is not.
[[nodiscard]] Outcome run_suite(const SuiteOptions& options);

}  // namespace corotet::program::stress
