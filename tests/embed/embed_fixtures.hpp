// Meshes, surface points and motions for the tests of embedded surfaces.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <limits>
#include <random>
#include <vector>

namespace corotet {

/// A kind of mesh: precision, element, and whether its edges are curved.
template <std::floating_point S, ReferenceElement E, bool is_curved>
struct Kind {
  using Scalar = S;
  using Element = E;
  using Mesh = TetMesh<S, E>;
  using Surface = EmbeddedSurface<S, E>;
  static constexpr bool curved = is_curved;
};
using AllKinds = testing::Types<Kind<float, Tet4, false>, Kind<double, Tet4, false>, Kind<float, Tet10, false>,
                                Kind<double, Tet10, false>, Kind<float, Tet10, true>, Kind<double, Tet10, true>>;

using StraightTet10Kinds = testing::Types<Kind<float, Tet10, false>, Kind<double, Tet10, false>>;
using DoubleKinds = testing::Types<Kind<double, Tet4, false>, Kind<double, Tet10, false>, Kind<double, Tet10, true>>;

using Points = std::vector<Vec3<double>>;

template <class K>
class EmbedFixture : public testing::Test {
 protected:
  // Short names here, so that tests can use the long ones.
  using S = typename K::Scalar;
  using E = typename K::Element;
  using M = typename K::Mesh;
  static constexpr double epsilon = std::numeric_limits<S>::epsilon();

  static inline const Vec3<double> corner{-0.4, 0.1, 0.2}, size{1.0, 0.6, 0.5};

  /// Bends straight lines: the map under which curved meshes are images of the block.
  static Vec3<double> bend(const Vec3<double>& x) {
    return x + 0.15 * Vec3<double>(std::sin(3 * x[1]), std::cos(4 * x[2]), std::sin(3 * x[0] + x[1]));
  }

  /// The block, 4 x 3 x 2 cells, its nodes moved by `bend` if the kind is curved.
  static MeshData block_data() {
    BlockOptions options;
    options.corner = corner;
    options.size = size;
    options.cells = {4, 3, 2};
    options.order = E::order;
    MeshData data = make_block(options).value();
    if (K::curved)
      for (Vec3<double>& x : data.positions) x = bend(x);
    return data;
  }
  static M block() { return M::create(block_data()).value(); }

  Vec3<double> random_vector(double most) {
    std::uniform_real_distribution<double> coordinate(-most, most);
    return {coordinate(random_), coordinate(random_), coordinate(random_)};
  }

  /// Natural coordinates uniform in the reference tetrahedron.
  Vec3<double> random_natural() {
    for (;;) {
      const Vec3<double> xi = random_vector(0.5) + Vec3<double>::Constant(0.5);
      if (xi.sum() < 1) return xi;
    }
  }

  /// sum_a N_a(xi) value_a over an element, written out with the shape functions.
  template <class NodeValue>
  static Vec3<double> interpolate(const M& mesh, Index e, const Vec3<double>& xi, NodeValue&& value) {
    const auto n = E::shape({xi[0], xi[1], xi[2]});
    Vec3<double> out = Vec3<double>::Zero();
    for (std::size_t a = 0; a < n.size(); ++a) out += n[a] * value(mesh.element(e)[a]);
    return out;
  }
  static Vec3<double> interpolate_position(const M& mesh, Index e, const Vec3<double>& xi) {
    return interpolate(mesh, e, xi, [&](Index v) { return Vec3<double>(mesh.position(v).template cast<double>()); });
  }

  /// Points in random elements.
  Points inside(const M& mesh, Index count) {
    Points points;
    for (Index i = 0; i < count; ++i)
      points.push_back(
          interpolate_position(mesh, static_cast<Index>(random_() % at(mesh.element_count())), random_natural()));
    return points;
  }

  /// Points anywhere in the neighbourhood, most of them outside.
  Points around(Index count) {
    Points points;
    for (Index i = 0; i < count; ++i) points.push_back(corner + size / 2 + random_vector(1));
    return points;
  }

  Points directions(Index count) {
    Points normals;
    for (Index i = 0; i < count; ++i) normals.push_back(random_vector(1).normalized());
    return normals;
  }

  /// Displacements of the mesh's vertices under x -> motion(x), in the mesh's precision.
  template <class Motion>
  static Field<S> displacements(const M& mesh, Motion&& motion) {
    Field<S> u;
    for (const Vec3<S>& x : mesh.positions()) {
      const Vec3<double> rest = x.template cast<double>();
      u.push_back((motion(rest) - rest).template cast<S>());
    }
    return u;
  }
  static double largest(const Field<S>& u) {
    double most = 0;
    for (const Vec3<S>& v : u) most = std::max(most, double{v.norm()});
    return most;
  }

  /// How far rounding may move vertex v: of its own position, and of displacements times weights.
  static double rounding(const typename K::Surface& surface, Index v, const Vec3<double>& rest, const Field<S>& u) {
    double weights = 0;
    for (const double w : surface.weights(v)) weights += std::abs(w);
    return 8 * epsilon * (rest.norm() + weights * largest(u));
  }

  static Field<S> positions(typename K::Surface& surface, const Field<S>& u) {
    Field<S> out(at(surface.vertex_count()));
    surface.positions(u, out);
    return out;
  }
  static Field<S> normals(typename K::Surface& surface, const Field<S>& u) {
    Field<S> out(at(surface.vertex_count()));
    surface.normals(u, out);
    return out;
  }

  std::mt19937 random_{11};
};

/// The types of the kind under test, in a typed test.
#define USE_KIND                                                \
  using Fixture [[maybe_unused]] = TestFixture;                 \
  using Scalar [[maybe_unused]] = typename TypeParam::Scalar;   \
  using Element [[maybe_unused]] = typename TypeParam::Element; \
  using Mesh [[maybe_unused]] = typename TypeParam::Mesh;       \
  using Surface [[maybe_unused]] = typename TypeParam::Surface

}  // namespace corotet
