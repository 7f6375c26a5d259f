#include "matrix.hpp"

#include <algorithm>
#include <set>

namespace corotet::program {

Configuration base_of(const Study& study, int reference_level) {
  const bool only_one = study.meshes.count() == 1;
  const int level = only_one ? 0 : std::min(study.base_level, reference_level - 1);
  if (level < 0) return {study.scene, 0, 1};
  return {study.scene, level, 2};
}

std::vector<Planned> plan(const Study& study, const Configuration& base) {
  std::vector<Planned> rows;
  std::set<std::string> known;
  const auto add = [&](const Configuration& c, const char* role) {
    if (known.insert(key_of(c)).second) rows.push_back({c, role});
  };

  std::vector<Configuration> meshes;
  meshes.reserve(study.tet10_levels.size() + study.tet4_levels.size());
  for (const int level : study.tet10_levels) meshes.push_back({study.scene, level, 2});
  for (const int level : study.tet4_levels) meshes.push_back({study.scene, level, 1});
  const auto work = [&](const Configuration& c) {  // a 10-node element costs some ten 4-node ones
    return study.meshes[c.level].linear.element_count() * (c.order == 2 ? 10 : 1);
  };
  std::stable_sort(meshes.begin(), meshes.end(),
                   [&](const Configuration& a, const Configuration& b) { return work(a) < work(b); });
  for (Configuration c : meshes)
    for (const IntegratorKind integrator : study.integrators)
      for (const double dt : study.dts) {
        c.scene.integrator = integrator;
        c.scene.dt = dt;
        add(c, "grid");
      }

  const auto vary = [&](const char* role, auto&& change) {
    Configuration c = base;
    change(c.scene);
    add(c, role);
  };
  for (const auto rotation : {RotationKind::identity, RotationKind::gram_schmidt, RotationKind::polar})
    vary("rotation", [&](Scene& s) { s.rotation = rotation; });
  vary("rotation_site", [](Scene& s) { s.rotation_site = RotationSite::element; });
  vary("mass", [](Scene& s) { s.mass = s.mass == MassModel::lumped ? MassModel::consistent : MassModel::lumped; });
  vary("scalar", [](Scene& s) {
    s.scalar = s.scalar == ScalarKind::double_precision ? ScalarKind::single_precision : ScalarKind::double_precision;
  });
  vary("dilatation", [](Scene& s) {
    s.volumetric_strain =
        s.volumetric_strain == VolumetricStrain::averaged ? VolumetricStrain::pointwise : VolumetricStrain::averaged;
  });
  const bool has_energy = base.scene.rotation == RotationKind::polar && base.scene.rotation_site == RotationSite::point;
  for (const int iterations : {2, 20})
    vary("newton", [&](Scene& s) {
      s.newton.iterations = iterations;
      if (has_energy) s.newton.tangent = Tangent::consistent;
    });
  for (const auto tangent : {Tangent::warped, Tangent::stabilized, Tangent::consistent})
    if (has_energy || tangent != Tangent::consistent) vary("tangent", [&](Scene& s) { s.newton.tangent = tangent; });
  for (const double tolerance : {1e-1, 1e-2, 1e-4, 1e-5})
    vary("tolerance", [&](Scene& s) { s.solver.tolerance = tolerance; });
  vary("solver", [](Scene& s) { s.solver.method = SolverMethod::cholesky; });
  for (Configuration c : meshes) {
    if (!study.sizes && (c.level != base.level || c.order != base.order)) continue;
    for (const auto kind : {PreconditionerKind::block_jacobi, PreconditionerKind::rigid_aggregates,
                            PreconditionerKind::warped_cholesky}) {
      c.scene.solver.method = SolverMethod::pcg;
      c.scene.solver.preconditioner = kind;
      add(c, "preconditioner");
    }
  }
  return rows;
}

}  // namespace corotet::program
