// All runs of the hard cases, and what became of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "case.hpp"
#include "case_result.hpp"
#include "configuration.hpp"

namespace corotet::program::stress {

/// Which configurations of each case are tried.
enum class Coverage {
  quick,  ///< float, `auto` and one of Poisson's ratios, with less effort
  pairs,  ///< each two values of any two factors: others for each case
  full    ///< all
};

struct SuiteOptions {
  std::vector<std::string> cases;  ///< names, or their part before a '-'; none: all
  std::vector<std::string> only;   ///< words of a factor's values: no other values of it
  std::optional<Tangent> tangent;  ///< instead of each stepping's own
  Coverage coverage = Coverage::pairs;
  int threads = 1;
};

struct Run {
  std::size_t of_case;  ///< in the list of cases
  Configuration configuration;
  CaseResult verdict = {};
  double seconds = 0;
};

struct Outcome {
  std::vector<Case> cases;  ///< those that were asked for
  std::vector<Run> runs;
};

/// What configurations of these cases are made of.
[[nodiscard]] Factors all_factors(const std::vector<Case>& cases);

/// Throws a Failure for a case or a word that there is not.
[[nodiscard]] Outcome run_suite(const SuiteOptions& options);

}  // namespace corotet::program::stress
