// What a case found, against what it asks.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "../step_counts.hpp"

namespace corotet::program::stress {

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
  StepCounts steps;
  double recovered = -1;  ///< random starts: the fraction that came back to the rest shape
};

}  // namespace corotet::program::stress
