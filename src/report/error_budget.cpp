#include "error_budget.hpp"

#include <utility>

namespace corotet::program {

const std::vector<std::string>& budget_parts() {
  static const std::vector<std::string> names{"precision", "tolerance", "rotation", "space", "one solve", "time"};
  return names;
}

ErrorBudget measure_budget(References& references, const Configuration& configuration, std::string label) {
  const Configuration tight = tightened(configuration);
  std::vector<const RunResult*> chain{&references.of(configuration)};
  Configuration c = configuration;
  c.scene.scalar = tight.scene.scalar;
  chain.push_back(&references.of(c));
  c.scene.solver = tight.scene.solver;
  chain.push_back(&references.of(c));
  chain.push_back(&references.of(tight));
  chain.push_back(&references.of(references.on_finest_mesh(configuration)));
  // A configuration that has Newton's method is told by its number how far it goes.
  chain.push_back(&references.of(converged(references.on_finest_mesh(configuration))));
  chain.push_back(&references.exact());

  ErrorBudget budget{std::move(label), configuration, {}, references.norms().between(*chain.front(), *chain.back())};
  for (std::size_t k = 0; k < budget_parts().size(); ++k)
    budget.parts.push_back({budget_parts()[k], references.norms().between(*chain[k], *chain[k + 1])});
  return budget;
}

}  // namespace corotet::program
