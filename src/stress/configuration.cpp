#include "configuration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

namespace corotet::program::stress {

namespace {

std::string word_of(int order) { return order == 1 ? "tet4" : "tet10"; }
std::string word_of(ScalarKind scalar) { return scalar == ScalarKind::double_precision ? "double" : "float"; }
std::string word_of(Stepping stepping) {
  constexpr std::array words{"euler", "newton", "bdf2"};
  return words[static_cast<std::size_t>(stepping)];
}
std::string word_of(const SolverChoice& solver) { return std::string(solver.name); }
std::string word_of(const Ratio& ratio) { return std::string(ratio.name); }

/// Calls visit(f, values of factor f) for each.
template <class OfFactors, class Visit>
void for_each_factor(OfFactors& factors, Visit&& visit) {
  visit(0U, factors.orders);
  visit(1U, factors.scalars);
  visit(2U, factors.steppings);
  visit(3U, factors.solvers);
  visit(4U, factors.ratios);
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

std::string Configuration::column() const {
  return fmt::format("{} {} {}", word_of(order), word_of(scalar), word_of(stepping));
}

std::string Configuration::name() const { return fmt::format("{} {} {}", column(), solver.name, ratio.name); }

Scene Configuration::scene() const {
  Scene scene;
  scene.order = order;
  scene.scalar = scalar;
  scene.material = {5e5, ratio.poisson, 1000};
  scene.volumetric_strain = ratio.volumetric_strain;
  scene.gravity.setZero();
  scene.solver.method = solver.method;
  scene.solver.preconditioner = solver.preconditioner;
  if (stepping == Stepping::bdf2) scene.integrator = IntegratorKind::bdf2;
  if (stepping == Stepping::newton) {
    scene.newton.iterations = 20;
    scene.newton.tangent = Tangent::consistent;
  }
  if (tangent) scene.newton.tangent = *tangent;
  return scene;
}

Scene Configuration::settling_scene() const {
  Scene settling = scene();
  if (stepping == Stepping::bdf2) settling.damping.mass = 10;
  return settling;
}

std::vector<SolverChoice> solver_choices(Solvers which) {
  using enum PreconditionerKind;
  std::vector<SolverChoice> choices{{"auto", SolverMethod::automatic, automatic},
                                    {"cholesky", SolverMethod::cholesky, automatic}};
  if (which == Solvers::iterative) choices.pop_back();
  if (which != Solvers::two)
    for (const PreconditionerKind kind : {jacobi, block_jacobi, rigid_aggregates, warped_cholesky})
      choices.push_back({name_of(kind), SolverMethod::pcg, kind});
  return choices;
}

std::vector<Ratio> ratios(Ratios which) {
  std::vector<Ratio> all{{"nu=.3", 0.3, VolumetricStrain::pointwise},
                         {"nu=.499", 0.499, VolumetricStrain::pointwise},
                         {"nu=.499mean", 0.499, VolumetricStrain::averaged}};
  if (which == Ratios::all) {
    all.push_back({"nu=0", 0, VolumetricStrain::pointwise});
    all.push_back({"nu=.45", 0.45, VolumetricStrain::pointwise});
  }
  return all;
}

FactorWords Factors::words() const {
  FactorWords words;
  for_each_factor(*this, [&](std::size_t f, const auto& values) {
    for (const auto& value : values) words[f].push_back(word_of(value));
  });
  return words;
}

std::array<std::size_t, 5> Factors::levels() const {
  std::array<std::size_t, 5> levels{};
  for_each_factor(*this, [&](std::size_t f, const auto& values) { levels[f] = values.size(); });
  return levels;
}

Configuration Factors::configuration(const Choice& choice) const {
  return {.order = orders[choice[0]],
          .scalar = scalars[choice[1]],
          .stepping = steppings[choice[2]],
          .solver = solvers[choice[3]],
          .ratio = ratios[choice[4]],
          .tangent = {}};
}

void Factors::keep(const FactorWords& wanted) {
  for_each_factor(*this, [&](std::size_t f, auto& values) {
    if (!wanted[f].empty())
      std::erase_if(values, [&](const auto& value) { return !contains(wanted[f], word_of(value)); });
  });
}

}  // namespace corotet::program::stress
