// What two sources of one program that are compiled with different flags must agree on.
#pragma once

#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace corotet::one_program {

template <class... T>
std::vector<std::pair<std::size_t, std::size_t>> sizes() {
  return {{sizeof(T), alignof(T)}...};
}

/// Sizes and alignments of what holds data, as this source sees them.
inline std::vector<std::pair<std::size_t, std::size_t>> layout() {
  return sizes<Vec3<float>, Mat3<double>, Matrix<double, 4, 4>, Matrix<float, 6, 6>, Lanes<float>, Lanes<double>,
               LaneMask<float>, LaneMask<double>, PaddedVector<float>, PaddedVector<double>, TetMesh<float, Tet10>,
               SoftBody<float, Tet4>, SoftBody<double, Tet10>, detail::ElementBatch<float, Tet4>,
               detail::ElementBatch<double, Tet10>, AutoSolver<float>, AutoSolver<double>,
               ImplicitEuler<SoftBody<float, Tet4>>, Bdf2<SoftBody<double, Tet10>>, EmbeddedSurface<float, Tet4>,
               EmbeddedSurface<double, Tet10>, detail::ElementMotion<float, Tet4>, detail::ElementMotion<double, Tet4>,
               detail::ElementMotion<float, Tet10>, detail::ElementMotion<double, Tet10>, StepReport, Material>();
}

/// A body, its integrator and its skin, made by one source and used by another.
template <class Element>
struct Bundle {
  using Body = SoftBody<double, Element>;
  Body body;
  ImplicitEuler<Body> euler;
  EmbeddedSurface<double, Element> skin;
};

template <class Element>
std::unique_ptr<Bundle<Element>> make_bundle() {
  const auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {5, 1, 1}, .order = Element::order});
  auto mesh = TetMesh<double, Element>::create(*block);
  auto body = SoftBody<double, Element>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  body->pin_where([](const Vec3<double>& x) { return x.x() == 0; });
  body->set_gravity({0, 0, -9.81});
  ImplicitEuler<SoftBody<double, Element>> euler(*body);
  auto skin = EmbeddedSurface<double, Element>::bind(*mesh, block->positions);
  return std::make_unique<Bundle<Element>>(Bundle<Element>{std::move(*body), std::move(euler), std::move(*skin)});
}

/// Steps, and returns how far the skin, whose vertices are those of the mesh, is from the body, m.
template <class Element>
double step_and_compare(Bundle<Element>& bundle) {
  for (int k = 0; k < 5; ++k)
    if (!bundle.euler.step(bundle.body, 1.0 / 60).ok()) return 1e9;
  Field<double> positions(at(bundle.skin.vertex_count()));
  bundle.skin.positions(bundle.body.displacements(), positions);
  double worst = 0;
  for (Index v = 0; v < size_of(positions); ++v)
    worst = (std::max)(worst, (positions[at(v)] - bundle.body.position(v)).norm());
  return worst;
}

// What the source with other flags defines.
std::vector<std::pair<std::size_t, std::size_t>> layout_elsewhere();
std::unique_ptr<Bundle<Tet4>> linear_elsewhere();
std::unique_ptr<Bundle<Tet10>> quadratic_elsewhere();
double step_elsewhere(Bundle<Tet4>& bundle);
double step_elsewhere(Bundle<Tet10>& bundle);

}  // namespace corotet::one_program
