// What the error of one configuration is made of.
#pragma once

#include <string>
#include <vector>

#include "references.hpp"

namespace corotet::program {

struct BudgetPart {
  std::string name;
  Errors errors;
};

struct ErrorBudget {
  std::string label;
  Configuration configuration;
  std::vector<BudgetPart> parts;  ///< their vectors add up to the total; their norms add up to no less
  Errors total;
};

/// Names of the parts, in the order in which they are taken away.
[[nodiscard]] const std::vector<std::string>& budget_parts();

/// Replaces one setting after the other by the tight one, and measures what each changes: precision by double, the
/// solver's tolerance by 1e-10, the rotation by a polar one at each quadrature point, the mesh by the finest, the one
/// linear solve of a step by Newton's method, the time step by the extrapolation to none.
[[nodiscard]] ErrorBudget measure_budget(References& references, const Configuration& configuration, std::string label);

}  // namespace corotet::program
