// Badly shaped elements, and materials that hardly change their volume.
#include <fmt/core.h>

#include <cmath>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/quality.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <utility>

#include "../failure.hpp"
#include "case.hpp"
#include "test_body.hpp"

namespace corotet::program::stress {
namespace {

/// Where the new corner of an element on the triangle 0 a b goes, in units of its legs a and b and its normal.
struct Shape {
  const char* name;
  const char* words;
  ElementDefect defect;
  Vec3<double> apex;
};

constexpr double thin = 5e-3;  // dihedral angles below 1 degree

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> all{
      {"needle", "10 times longer than wide", ElementDefect::needle, {1.0 / 3, 1.0 / 3, 10}},
      {"sliver", "four corners in a square, 1/200 thick", ElementDefect::sliver, {1, 1, thin}},
      {"wedge", "two corners 1/200 of an edge apart", ElementDefect::wedge, {0, 0, thin}},
      {"cap", "a corner 1/200 above the opposite face", ElementDefect::cap, {1.0 / 3, 1.0 / 3, thin}}};
  return all;
}

/// A block of 2 x 1 x 1 cells of 0.5 m with one more element on its face x = 1 m, the last of the mesh.
MeshData with_bad_element(const Shape& shape, int order) {
  MeshData mesh = require(make_block({.size = {1, 0.5, 0.5}, .cells = {2, 1, 1}}));
  for (std::size_t first = 0; first < mesh.connectivity.size(); first += 4) {
    Index face[3], found = 0, opposite = -1;
    for (std::size_t k = 0; k < 4; ++k) {
      const Index v = mesh.connectivity[first + k];
      if (mesh.positions[at(v)].x() > 1 - 1e-9 && found < 3)
        face[found++] = v;
      else
        opposite = v;
    }
    if (found < 3 || opposite < 0) continue;
    const auto x = [&](int k) { return mesh.positions[at(face[k])]; };
    for (Index& corner : face) {  // the one with the right angle comes first
      std::swap(face[0], corner);
      if (std::abs((x(1) - x(0)).dot(x(2) - x(0))) < 1e-9) break;
    }
    const Vec3<double> a = x(1) - x(0), b = x(2) - x(0);
    const Vec3<double> out = Vec3<double>::UnitX() * a.norm();
    mesh.positions.emplace_back(x(0) + shape.apex.x() * a + shape.apex.y() * b + shape.apex.z() * out);
    const bool right_handed = a.cross(b).dot(out) > 0;
    mesh.connectivity.insert(mesh.connectivity.end(), {face[0], face[right_handed ? 1 : 2], face[right_handed ? 2 : 1],
                                                       mesh.vertex_count() - 1});
    break;
  }
  return order == 2 ? raise_order(std::move(mesh)) : mesh;
}

CaseResult hang_with_bad_element(const Configuration& configuration, const Shape& shape) {
  Scene scene = configuration.scene();
  scene.gravity = {0, 0, -9.81};
  scene.material.young = 1e7;  // the needle is 5 m long and heavy
  TestBody trial(scene, with_bad_element(shape, configuration.order));
  CaseResult verdict;
  const auto worst = worst_elements(require(measure_quality(trial.mesh())), 1);
  verdict.expect(worst.front().element == trial.mesh().element_count() - 1 && worst.front().defect == shape.defect,
                 "the check of the mesh does not name the element");
  trial.pin(at_left_end);
  trial.run(300);
  trial.report_to(verdict);
  verdict.at_most("rms displacement, m", trial.rms_to_rest(), 6);
  verdict.note("most iterations", trial.counts().max_iterations);
  verdict.note("steps short of the tolerance", trial.counts().unconverged);
  return verdict;
}

/// The drop of the bar's tip at rest under a small load, and what its volume then is, for one of Poisson's ratios.
struct Sag {
  double drop, volume_error;
};
Sag sag(const Configuration& configuration, double poisson, CaseResult& verdict) {
  Scene scene = configuration.scene();
  scene.dt = 0.1;
  scene.damping.mass = 20;  // ends the swing of the second order formula
  scene.material.poisson = poisson;
  scene.gravity = {0, 0, -0.1};
  TestBody trial(scene, bar(configuration.order));
  trial.pin(at_left_end);
  const double volume = trial.volume();
  trial.run(200);
  trial.report_to(verdict);
  const Index tip = nearest_position(trial.mesh().positions, Vec3<double>(1, 0, 0));
  return {-trial.body().displacement(tip).z(), trial.volume() / volume - 1};
}

CaseResult nearly_incompressible(const Configuration& configuration) {
  CaseResult verdict;
  const Sag soft = sag(configuration, 0.3, verdict);
  const bool right_element = configuration.ratio.volumetric_strain == VolumetricStrain::averaged;
  for (const double poisson : {0.45, 0.49, 0.499, 0.4999}) {
    const Sag stiff = sag(configuration, poisson, verdict);
    const std::string what = fmt::format("nu {}: drop as a share of that at .3", poisson);
    if (right_element)
      verdict.at_least(what, stiff.drop / soft.drop, 0.85);
    else
      verdict.note(what, stiff.drop / soft.drop);
    if (poisson > 0.499) verdict.note("change of volume", stiff.volume_error);
  }
  verdict.note("steps short of the tolerance", verdict.steps.unconverged);
  return verdict;
}

}  // namespace

void add_material_cases(std::vector<Case>& cases) {
  for (const Shape& shape : shapes())
    cases.push_back(
        {shape.name, fmt::format("block of 10 good elements and one bad one ({}) hangs from one end", shape.words),
         "5 s finite, within the 6 m that it is long with a needle; `check` names the element; iterations reported",
         Solvers::all, ratios(Ratios::all),
         [&shape](const Configuration& c, const Effort&) { return hang_with_bad_element(c, shape); }});
  cases.push_back({"incompressible",
                   "bar sags at nu = .45, .49, .499, .4999",
                   "finite; change of volume reported; mean dilatation: at least 0.85 of the drop at nu = .3",
                   Solvers::all,
                   {{"element", 0.3, VolumetricStrain::pointwise}, {"mean", 0.3, VolumetricStrain::averaged}},
                   [](const Configuration& c, const Effort&) { return nearly_incompressible(c); }});
}

}  // namespace corotet::program::stress
