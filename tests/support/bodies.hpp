// Meshes and bodies that several tests start from.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstdlib>
#include <utility>

#include "stress/energy_watch.hpp"
#include "support/random.hpp"

namespace corotet::testing {

/// A scalar and an element, for typed tests.
template <class S, class E>
struct Case {
  using Scalar = S;
  using Element = E;
};
using AllCases = ::testing::Types<Case<float, Tet4>, Case<double, Tet4>, Case<float, Tet10>, Case<double, Tet10>>;

/// Takes the value, or fails the test with the error's text and ends the program: later code could not run.
template <class T>
T must(Result<T> result) {
  if (!result) {
    ADD_FAILURE() << result.error().message();
    std::abort();
  }
  return std::move(result).value();
}

inline void must(const Result<void>& status) { ASSERT_TRUE(status.ok()) << status.error().message(); }

template <class Scalar, class Element>
TetMesh<Scalar, Element> block(BlockOptions options) {
  options.order = Element::order;
  return must(TetMesh<Scalar, Element>::create(must(make_block(options))));
}

/// Moves every vertex inside the box by up to `amount` of the cell size, corners first and mid-edge vertices after
/// them, so that elements are distorted but straight-sided.
template <class Scalar, class Element>
TetMesh<Scalar, Element> distorted_block(BlockOptions options, double amount, unsigned seed) {
  options.order = 1;
  MeshData data = must(make_block(options));
  Random random(seed);
  const Vec3<double> cell(options.size.x() / options.cells[0], options.size.y() / options.cells[1],
                          options.size.z() / options.cells[2]);
  for (Vec3<double>& x : data.positions)
    for (int i = 0; i < 3; ++i) {
      const double from_low = x[i] - options.corner[i], tolerance = 1e-9 * options.size[i];
      const double shift = random.uniform(-amount, amount) * cell[i];
      if (from_low > tolerance && from_low < options.size[i] - tolerance) x[i] += shift;
    }
  if (Element::order == 2) data = raise_order(std::move(data));
  return must(TetMesh<Scalar, Element>::create(std::move(data)));
}

/// A block held at x = 0 that bends under its own weight along -z.
template <class Scalar, class Element>
SoftBody<Scalar, Element> cantilever(const BlockOptions& block_options, const Material& material, double gravity,
                                     const BodyOptions& options = {}) {
  auto body = must(SoftBody<Scalar, Element>::create(block<Scalar, Element>(block_options), material, options));
  body.pin_where([](const Vec3<Scalar>& x) { return x.x() == 0; });
  body.set_gravity({0, 0, static_cast<Scalar>(-gravity)});
  return body;
}

/// The displacement that takes each rest position X to `map(X)`.
template <class Mesh, class Map>
auto displacement_of(const Mesh& mesh, Map&& map) {
  using Scalar = typename Mesh::scalar_type;
  Field<Scalar> u;
  for (const auto& x : mesh.positions())
    u.push_back((map(x.template cast<double>()) - x.template cast<double>()).template cast<Scalar>());
  return u;
}

template <class Scalar>
Field<Scalar> random_field(Index vertices, double size, unsigned seed) {
  Random random(seed);
  Field<Scalar> field;
  for (Index v = 0; v < vertices; ++v) field.push_back(random.vector(size).cast<Scalar>());
  return field;
}

/// Velocities of a rigid rotation about the origin, omega in rad/s.
template <class Mesh>
auto spin_of(const Mesh& mesh, const Vec3<double>& omega) {
  using Scalar = typename Mesh::scalar_type;
  Field<Scalar> v;
  for (const auto& x : mesh.positions()) v.push_back(omega.cross(x.template cast<double>()).template cast<Scalar>());
  return v;
}

/// J.
template <class Body>
double kinetic_energy(const Body& body) {
  double sum = 0;
  for (Index v = 0; v < body.vertex_count(); ++v)
    sum += double(body.velocities()[at(v)].dot(body.mass().row_product(*body.pattern(), v, body.velocities()))) / 2;
  return sum;
}

/// Kinetic, elastic and that of gravity, J.
template <class Body>
double energy(const Body& body) {
  double sum = body.law().energy(body.displacements()) + kinetic_energy(body);
  for (Index v = 0; v < body.vertex_count(); ++v)
    sum -= double(body.mass().row_sum(v)) * double(body.displacements()[at(v)].dot(body.gravity()));
  return sum;
}

using program::stress::EnergyWatch;

/// kg m/s.
template <class Body>
Vec3<double> linear_momentum(const Body& body) {
  Vec3<double> sum = Vec3<double>::Zero();
  for (Index v = 0; v < body.vertex_count(); ++v)
    sum += body.mass().row_product(*body.pattern(), v, body.velocities()).template cast<double>();
  return sum;
}

/// The largest displacement from rest, m: for tests that two ways lead to the same state, which they do as well where
/// nothing moves.
template <class Body>
double max_displacement(const Body& body) {
  double largest = 0;
  for (const auto& u : body.displacements()) largest = std::max(largest, double(u.norm()));
  return largest;
}

/// m/s.
template <class Body>
double max_speed(const Body& body) {
  double largest = 0;
  for (const auto& v : body.velocities()) largest = std::max(largest, double(v.norm()));
  return largest;
}

/// About the centre of mass, kg m^2/s.
template <class Body>
Vec3<double> angular_momentum(const Body& body) {
  const auto position = [&](Index v) { return body.position(v).template cast<double>(); };
  Vec3<double> centre = Vec3<double>::Zero(), sum = Vec3<double>::Zero();
  for (Index v = 0; v < body.vertex_count(); ++v)
    centre += double(body.mass().row_sum(v)) * position(v) / body.mass().total();
  for (Index v = 0; v < body.vertex_count(); ++v)
    sum += (position(v) - centre)
               .cross(body.mass().row_product(*body.pattern(), v, body.velocities()).template cast<double>());
  return sum;
}

}  // namespace corotet::testing
