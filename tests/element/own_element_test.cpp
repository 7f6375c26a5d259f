// An element that is not the library's: a hexahedron carries meshes, bodies and steps; what needs a tetrahedron refuses
// it.
#include <corotet/detail/assembly/elasticity.hpp>
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/material/stable_neo_hookean.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/element_lines.hpp>
#include <corotet/detail/mesh/element_quality.hpp>
#include <corotet/detail/mesh/io/vtu_values.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "support/bodies.hpp"
#include "support/derivatives.hpp"
#include "support/elastic_rig.hpp"
#include "support/matrices.hpp"
#include "support/solver_choice.hpp"

namespace corotet {
namespace {

using testing::must;
using testing::Rig;
using testing::rubber;

/// Gauss's eight points of the unit cube.
constexpr std::array<QuadraturePoint, 8> gauss_points = [] {
  std::array<QuadraturePoint, 8> points{};
  constexpr double low = 0.21132486540518711775, high = 0.78867513459481288225;
  for (std::size_t q = 0; q < 8; ++q)
    points[q] = {{(q & 1U) == 0 ? low : high, (q & 2U) == 0 ? low : high, (q & 4U) == 0 ? low : high}, 0.125};
  return points;
}();

/// The trilinear hexahedron: node a lies at the corner of the unit cube whose coordinates are the bits of a.
struct Hex8 {
  static constexpr int nodes = 8;
  static constexpr auto stiffness_points = gauss_points;
  static constexpr auto mass_points = gauss_points;
  static constexpr std::array<std::size_t, nodes> mirrored{1, 0, 3, 2, 5, 4, 7, 6};

  static constexpr std::array<double, nodes> shape(const NaturalCoordinates& xi) {
    std::array<double, nodes> n{};
    for (std::size_t a = 0; a < n.size(); ++a) n[a] = factor(xi, a, 0) * factor(xi, a, 1) * factor(xi, a, 2);
    return n;
  }
  static constexpr std::array<NaturalCoordinates, nodes> gradient(const NaturalCoordinates& xi) {
    std::array<NaturalCoordinates, nodes> g{};
    for (std::size_t a = 0; a < g.size(); ++a)
      for (std::size_t i = 0; i < 3; ++i)
        g[a][i] = (is_high(a, i) ? 1 : -1) * factor(xi, a, (i + 1) % 3) * factor(xi, a, (i + 2) % 3);
    return g;
  }

 private:
  static constexpr bool is_high(std::size_t a, std::size_t i) { return (a >> i & 1U) != 0; }
  static constexpr double factor(const NaturalCoordinates& xi, std::size_t a, std::size_t i) {
    return is_high(a, i) ? xi[i] : 1 - xi[i];
  }
};

/// As an element of before these traits: it says its degree, and nothing of its nodes.
struct Tet20 {
  static constexpr int nodes = 20;
  [[maybe_unused]] static constexpr int order = 3;
  static constexpr auto stiffness_points = quadrature::degree5;
  static constexpr auto mass_points = quadrature::degree5;
  static std::array<double, nodes> shape(const NaturalCoordinates& xi);
  static std::array<NaturalCoordinates, nodes> gradient(const NaturalCoordinates& xi);
};
/// And as one that says that there are two nodes on each edge.
struct CubicTet20 : Tet20 {
  static constexpr int edge_nodes = 2;
  static constexpr std::array<std::size_t, nodes> mirrored{};
};

// What a generic element is good for, by what it says of itself.
static_assert(ReferenceElement<Hex8> && !TetrahedralElement<Hex8>);
static_assert(!ReferenceElement<Tet20>, "without `mirrored` no mesh can be made of it");
static_assert(ReferenceElement<CubicTet20> && !TetrahedralElement<CubicTet20>);
static_assert(TetrahedralElement<Tet4> && TetrahedralElement<Tet10>);
static_assert(LinearTetrahedron<Tet4> && !LinearTetrahedron<Tet10> && !LinearTetrahedron<Hex8>);
static_assert(has_constant_gradients<Tet4> && !has_constant_gradients<Tet10> && !has_constant_gradients<Hex8>);
static_assert(has_unit_gradients<Tet4> && !has_unit_gradients<Tet10> && !has_unit_gradients<Hex8>);

// What knows tetrahedra alone does not compile with it: these would be wrong, not just poor.
template <class Element>
concept HasBoundary = requires(const TetMesh<double, Element>& mesh) { extract_boundary(mesh); };
template <class Element>
concept HasLines = requires(const TetMesh<double, Element>& mesh) { element_lines(mesh); };
template <class Element>
concept IsWritten = requires(const TetMesh<double, Element>& mesh) { vtu_cells(mesh); };
template <class Element>
concept IsMeasured = requires(std::array<Vec3<double>, Element::nodes> x) { measure_element<Element>(x); };
template <class Element>
concept CarriesSurfaces = requires { typename EmbeddedSurface<double, Element>; };
template <class Element>
concept HasPatches = requires(const TetMesh<double, Element>& mesh) { detail::dilatation_patches(mesh); };
template <class Element>
concept KnownTopology =
    HasBoundary<Element> && HasLines<Element> && IsWritten<Element> && IsMeasured<Element> && CarriesSurfaces<Element>;
static_assert(KnownTopology<Tet4> && KnownTopology<Tet10> && HasPatches<Tet4>);
static_assert(!HasBoundary<Hex8> && !HasLines<Hex8> && !IsWritten<Hex8> && !IsMeasured<Hex8> &&
              !CarriesSurfaces<Hex8> && !HasPatches<Hex8> && !HasPatches<Tet10>);

/// A block of cells, inner vertices moved by up to `amount` of a cell, every other element wound the wrong way round.
MeshData hexahedra(const Vec3<double>& size, const std::array<Index, 3>& cells, double amount) {
  MeshData data;
  data.nodes_per_element = Hex8::nodes;
  testing::Random random(1);
  const auto vertex = [&](Index i, Index j, Index k) { return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i; };
  for (Index k = 0; k <= cells[2]; ++k)
    for (Index j = 0; j <= cells[1]; ++j)
      for (Index i = 0; i <= cells[0]; ++i) {
        const std::array<Index, 3> place{i, j, k};
        Vec3<double> x;
        for (int c = 0; c < 3; ++c) {
          const double cell = size[c] / cells[at(c)];
          x[c] = cell * place[at(c)];
          if (place[at(c)] > 0 && place[at(c)] < cells[at(c)]) x[c] += random.uniform(-amount, amount) * cell;
        }
        data.positions.push_back(x);
      }
  for (Index k = 0; k < cells[2]; ++k)
    for (Index j = 0; j < cells[1]; ++j)
      for (Index i = 0; i < cells[0]; ++i)
        for (std::size_t a = 0; a < 8; ++a) {
          const std::size_t node = (i + j + k) % 2 == 0 ? a : Hex8::mirrored[a];
          data.connectivity.push_back(vertex(i + Index(node & 1U), j + Index(node >> 1U & 1U), k + Index(node >> 2U)));
        }
  return data;
}

TetMesh<double, Hex8> hex_mesh(const Vec3<double>& size, const std::array<Index, 3>& cells, double amount) {
  return must(TetMesh<double, Hex8>::create(hexahedra(size, cells, amount)));
}

TEST(OwnElement, MakesMeshesWhichTurnItRoundWhereItMustBe) {
  const auto mesh = hex_mesh({1, 1, 1}, {2, 2, 2}, 0.2);
  EXPECT_EQ(mesh.flipped_elements(), 4);
  MeshData flat = hexahedra({1, 1, 1}, {2, 2, 2}, 0);
  for (auto& x : flat.positions) x.z() = 0;
  const auto refused = TetMesh<double, Hex8>::create(flat);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::degenerate_element);
}

/// Uniaxial tension of distorted elements, exact for each model at any strain: the patch test.
TEST(OwnElement, PassesThePatchTest) {
  const auto mesh = hex_mesh({2, 1, 0.5}, {3, 2, 2}, 0.2);
  const double s = 1.3, side = 1 - rubber.poisson * (s - 1);
  const auto u = testing::displacement_of(
      mesh, [&](const Vec3<double>& x) { return x.cwiseProduct(Vec3<double>(s, side, side)); });
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
    Rig<double, Hex8> rig(mesh, rubber, volumetric_strain);
    const Field<double> force = rig.force(u);
    double pull = 0, inside = 0, sideways = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      const double x = mesh.position(v).x();
      if (x > 2 - 1e-9) pull -= force[at(v)].x();
      if (x > 1e-9 && x < 2 - 1e-9) inside = std::max(inside, std::abs(force[at(v)].x()));
      sideways = std::max({sideways, std::abs(force[at(v)].y()), std::abs(force[at(v)].z())});
    }
    const double expected = rubber.young * (s - 1) * 0.5;
    EXPECT_NEAR(pull, expected, 1e-10 * expected);
    EXPECT_LT(inside, 1e-10 * expected);
    EXPECT_LT(sideways, 1e-10 * expected);
    EXPECT_NEAR(rig.law.energy(u), 0.5 * rubber.young * (s - 1) * (s - 1), 1e-10 * expected);
  }
}

template <class Law>
void expect_derivatives(VolumetricStrain volumetric_strain) {
  const auto mesh = hex_mesh({1, 0.7, 0.5}, {2, 1, 1}, 0.2);
  Rig<double, Hex8, Law> rig(mesh, rubber, volumetric_strain, Tangent::consistent);
  const Mat3<double> affine = testing::Random(2).rotation() * testing::diagonal({1.2, 0.9, 1.1});
  Field<double> u = testing::displacement_of(mesh, [&](const Vec3<double>& x) { return affine * x; });
  flat(u) += flat(testing::random_field<double>(mesh.vertex_count(), 0.03, 3));
  testing::expect_derivatives(rig, u, 1e-6);
}

TEST(OwnElement, HasForcesAndTangentsThatAreDerivatives) {
  expect_derivatives<Polar>(VolumetricStrain::pointwise);
  expect_derivatives<Polar>(VolumetricStrain::averaged);
  expect_derivatives<StableNeoHookean>(VolumetricStrain::pointwise);
}

/// A thick beam of hexahedra falls as one of 10-node tetrahedra does.
TEST(OwnElement, Steps) {
  constexpr Material soft{.young = 2e5, .poisson = 0.3, .density = 1000};
  const auto fall = []<class Element>(SoftBody<double, Element> body) {
    body.pin_where([](const Vec3<double>& x) { return x.x() < 1e-9; });
    body.set_gravity({0, 0, -9.81});
    ImplicitEuler euler(body, testing::solver({.tolerance = 1e-6}));
    for (int step = 0; step < 15; ++step) EXPECT_TRUE(euler.step(body, 1.0 / 60).ok());
    return body.displacements()[at(body.mesh().nearest_vertex({1, 0.25, 0.25}))].z();
  };
  const double hex = fall(must(SoftBody<double, Hex8>::create(hex_mesh({1, 0.5, 0.5}, {8, 4, 4}, 0), soft)));
  const double tet = fall(must(SoftBody<double, Tet10>::create(
      testing::block<double, Tet10>({.size = {1, 0.5, 0.5}, .cells = {4, 2, 2}}), soft)));
  EXPECT_NEAR(hex, tet, 0.03 * std::abs(tet));
  EXPECT_LT(tet, -0.05) << "the case must tell";
}

}  // namespace
}  // namespace corotet
