// The beam that the examples measure: held at x = 0, under its own weight, with a converged answer to compare with.
#pragma once

#include <algorithm>
#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/static_solve.hpp>
#include <cstdio>
#include <utility>

namespace beam {

inline constexpr double length = 1, thickness = 0.1;        // m, square section
inline constexpr double density = 1000, gravity = 9.81;     // kg/m^3, m/s^2
inline constexpr double area = thickness * thickness;       // m^2
inline constexpr double inertia = area * area / 12;         // second moment of area, m^4
inline constexpr double weight = density * gravity * area;  // a metre, N/m

/// How soft the beam is: q = weight * length^3 / (E I), dimensionless. 1 sags visibly, 8 hangs down.
inline corotet::Material material(double q, double poisson) {
  return {.young = weight * length * length * length / (q * inertia), .poisson = poisson, .density = density};
}

/// Tip deflection of a Timoshenko cantilever under its own weight, m: bending plus shear. Small deflections only.
inline double timoshenko_tip(const corotet::Material& m) {
  const double shear_modulus = m.young / (2 * (1 + m.poisson));
  const double shear_factor = 10 * (1 + m.poisson) / (12 + 11 * m.poisson);  // Cowper 1966, square section
  return weight * length * length * length * length / (8 * m.young * inertia) +
         weight * length * length / (2 * shear_factor * shear_modulus * area);
}

/// The centre of the free end of the 3D solid at q = 8, poisson = 0.3, converged in space: an independent computation
/// (quadratic elements, refined until nothing changed by more than 5e-4 m).
inline constexpr double reference_shortening = 0.27661, reference_drop = 0.64665;  // m

template <class Scalar, class Element>
corotet::Result<corotet::TetMesh<Scalar, Element>> mesh(std::array<corotet::Index, 3> cells,
                                                        corotet::BlockSplit split = {}) {
  const auto block = corotet::make_block({.corner = {0, -thickness / 2, -thickness / 2},
                                          .size = {length, thickness, thickness},
                                          .cells = cells,
                                          .split = split,
                                          .order = Element::order});
  if (!block) return block.error();
  return corotet::TetMesh<Scalar, Element>::create(*block);
}

/// Holds the end at x = 0 and lets gravity pull along -z. Returns the vertex at the centre of the free end.
template <class Body>
corotet::Index hang(Body& body) {
  using Scalar = typename Body::scalar_type;
  body.pin_where([](const auto& x) { return x.x() < 1e-6; });
  body.set_gravity({0, 0, Scalar(-gravity)});
  return body.mesh().nearest_vertex({Scalar(length), 0, 0});
}

/// Lets a mesh of the beam sag, stiff enough for the formula of small deflections, and prints how it compares.
template <class Element>
bool sag(corotet::MeshData data) {
  using namespace corotet;
  const Material m = material(0.1, 0.3);
  const auto mesh = TetMesh<double, Element>::create(std::move(data));
  if (!mesh) return std::fprintf(stderr, "%s\n", mesh.error().message().c_str()), false;
  auto body = SoftBody<double, Element>::create(*mesh, m);
  if (!body) return std::fprintf(stderr, "%s\n", body.error().message().c_str()), false;
  const Index tip = hang(*body);
  if (!solve_static(*body).converged) return std::fprintf(stderr, "the beam does not come to rest\n"), false;
  const double drop = -body->displacements()[at(tip)].z(), expected = timoshenko_tip(m);
  std::printf("order %d: %5d vertices, %5d elements, the tip drops by %.5f m, Timoshenko %.5f m, ratio %.4f\n",
              Element::order, mesh->vertex_count(), mesh->element_count(), drop, expected, drop / expected);
  return true;
}

}  // namespace beam
