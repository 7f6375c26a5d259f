#include "configuration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>

namespace corotet::program::stress {

std::string Configuration::column() const {
  constexpr std::string_view steppings[] = {"euler", "newton", "bdf2"};
  return fmt::format("tet{} {} {}", order == 1 ? 4 : 10, in_double() ? "double" : "float",
                     steppings[static_cast<int>(stepping)]);
}

std::string Configuration::name() const { return fmt::format("{} {} {}", column(), solver.name, ratio.name); }

bool Configuration::has_word(std::string_view word) const {
  std::istringstream words(name());
  for (std::string each; words >> each;)
    if (each == word) return true;
  return false;
}

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
  if (which == Solvers::all)
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

}  // namespace corotet::program::stress
