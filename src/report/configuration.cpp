#include "configuration.hpp"

#include <fmt/core.h>

namespace corotet::program {
namespace {

std::string name_of(SolverMethod method) {
  if (method == SolverMethod::automatic) return "auto";
  return method == SolverMethod::pcg ? "pcg" : "cholesky";
}

std::string name_of(RotationKind rotation) {
  if (rotation == RotationKind::identity) return "identity";
  return rotation == RotationKind::polar ? "polar" : "gram_schmidt";
}

}  // namespace

const std::vector<Setting>& settings() {
  using C = Configuration;
  static const std::vector<Setting> list{
      {"order", [](const C& c) { return fmt::format("{}", c.order); }},
      {"scalar",
       [](const C& c) -> std::string { return c.scene.scalar == ScalarKind::single_precision ? "float" : "double"; }},
      {"rotation", [](const C& c) { return name_of(c.scene.rotation); }},
      {"rotation_site",
       [](const C& c) -> std::string { return c.scene.rotation_site == RotationSite::point ? "point" : "element"; }},
      {"mass", [](const C& c) -> std::string { return c.scene.mass == MassModel::lumped ? "lumped" : "consistent"; }},
      {"dilatation",
       [](const C& c) -> std::string {
         return c.scene.volumetric_strain == VolumetricStrain::averaged ? "mean" : "per_element";
       }},
      {"integrator", [](const C& c) -> std::string { return name_of(c.scene.integrator); }},
      {"newton", [](const C& c) { return fmt::format("{}", c.scene.newton.iterations); }},
      {"newton_tolerance", [](const C& c) { return fmt::format("{:.3g}", c.scene.newton.tolerance); }},
      {"tangent", [](const C& c) { return std::string(corotet::name_of(c.scene.newton.tangent)); }},
      {"dt", [](const C& c) { return fmt::format("{:.6g}", c.scene.dt); }},
      {"solver", [](const C& c) { return name_of(c.scene.solver.method); }},
      {"preconditioner", [](const C& c) { return std::string(corotet::name_of(c.scene.solver.preconditioner)); }},
      {"tolerance", [](const C& c) { return fmt::format("{:.3g}", c.scene.solver.tolerance); }},
      {"max_iterations", [](const C& c) { return fmt::format("{}", c.scene.solver.max_iterations); }}};
  return list;
}

std::string key_of(const Configuration& configuration) {
  std::string key = fmt::format("{}", configuration.level);
  for (const Setting& setting : settings()) key += "," + setting.value(configuration);
  return key;
}

Configuration tightened(Configuration configuration) {
  Scene& scene = configuration.scene;
  scene.scalar = ScalarKind::double_precision;
  scene.rotation = RotationKind::polar;
  scene.rotation_site = RotationSite::point;
  scene.solver = {};
  scene.solver.tolerance = 1e-10;
  return configuration;
}

Configuration converged(Configuration configuration) {
  StepOptions& newton = configuration.scene.newton;
  newton.iterations = 50;
  newton.tolerance = 1e-8;
  newton.tangent = Tangent::consistent;
  return configuration;
}

}  // namespace corotet::program
