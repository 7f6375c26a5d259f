// What a case found, against what it asks.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

namespace corotet::program::stress {

/// What the steps of a run reported, all together.
struct StepStatistics {
  int steps = 0;
  int unconverged = 0;         ///< steps whose linear solver stopped before its tolerance, and said so
  int capped = 0;              ///< of these, by its limit of iterations
  int newton_unconverged = 0;  ///< the same of Newton's method
  int max_iterations = 0;      ///< of the linear solver in a step
  std::string error;           ///< of the first step that was refused

  void add(const StepStatistics& other) {
    steps += other.steps;
    unconverged += other.unconverged;
    capped += other.capped;
    newton_unconverged += other.newton_unconverged;
    max_iterations = std::max(max_iterations, other.max_iterations);
    if (error.empty()) error = other.error;
  }
};

/// A number that was measured, with the limit that it must keep if there is one.
struct Finding {
  std::string text;  ///< "rms to rest 2.1e-5 <= 1e-3"
  bool passed = true;
};

class CaseResult {
 public:
  /// Conditions; a value that is not a number fails.
  void at_most(const std::string& what, double value, double limit) {
    findings.push_back({fmt::format("{} {:.2g} (<= {:g})", what, value, limit), value <= limit});
  }
  void at_least(const std::string& what, double value, double limit) {
    findings.push_back({fmt::format("{} {:.4g} (>= {:g})", what, value, limit), value >= limit});
  }
  void expect(bool condition, const std::string& what) {
    if (!condition) findings.push_back({what, false});
  }

  /// Reported, not judged.
  void note(const std::string& what, double value) { findings.push_back({fmt::format("{} {:.4g}", what, value)}); }

  [[nodiscard]] bool passed() const {
    return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return f.passed; });
  }

  /// All that was found, failures first.
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const bool passed : {false, true})
      for (const Finding& finding : findings)
        if (finding.passed == passed) text += (text.empty() ? "" : "; ") + finding.text;
    return text;
  }

  std::vector<Finding> findings;
  StepStatistics ledger;
  double recovered = -1;  ///< random starts: the fraction that came back to the rest shape
};

}  // namespace corotet::program::stress
