// The isoparametric map of one element as a polynomial, and its inverse: where in an element does a point lie?
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <corotet/detail/mesh/closest_point.hpp>

namespace corotet::inline v0_1::detail {

/// A vector field over an element, given by its node values, as a polynomial in the natural coordinates:
/// f(xi) = f(0) + (G(0) + G(xi)) xi / 2 with the gradient G(xi) = df/dxi, which is linear in xi (constant for Tet4).
/// All coefficients are differences of node values, so a common translation costs no precision.
template <std::floating_point Scalar, int edge_nodes>
struct ElementField;

template <std::floating_point Scalar>
struct ElementField<Scalar, 0> {
  Vec3<Scalar> at_zero;  ///< f(0)
  Mat3<Scalar> slope;    ///< G

  /// `node(a)` is the value at node a.
  template <class NodeValue>
  static ElementField from_nodes(NodeValue&& node) {
    ElementField f;
    f.at_zero = node(0);
    for (int j = 0; j < 3; ++j) f.slope.set_col(j, node(j + 1) - f.at_zero);
    return f;
  }

  [[nodiscard]] const Mat3<Scalar>& gradient(const Vec3<Scalar>& /*xi*/) const { return slope; }
  [[nodiscard]] Vec3<Scalar> value(const Vec3<Scalar>& xi) const { return at_zero + slope * xi; }
};

template <std::floating_point Scalar>
struct ElementField<Scalar, 1> {
  Vec3<Scalar> at_zero;    ///< f(0)
  Mat3<Scalar> slope;      ///< G(0)
  Mat3<Scalar> curvature;  ///< d2f/dxi_j dxi_j in column j
  Mat3<Scalar> twist;      ///< the mixed derivatives: d2f/dxi_k dxi_l in column j, where {j, k, l} = {0, 1, 2}

  template <class NodeValue>
  static ElementField from_nodes(NodeValue&& node) {
    ElementField f;
    f.at_zero = node(0);
    constexpr std::array<int, 3> to_corner{4, 6, 7};  // edges 0-1, 0-2, 0-3
    constexpr std::array<int, 3> opposite{9, 8, 5};   // edges 2-3, 1-3, 1-2
    Mat3<Scalar> edge;
    for (int j = 0; j < 3; ++j) {
      const Vec3<Scalar> corner = node(j + 1) - f.at_zero;
      edge.set_col(j, node(to_corner[at(j)]) - f.at_zero);
      f.slope.set_col(j, 4 * edge.col(j) - corner);
      f.curvature.set_col(j, 4 * (corner - 2 * edge.col(j)));
    }
    for (int j = 0; j < 3; ++j)
      f.twist.set_col(j, 4 * ((node(opposite[at(j)]) - f.at_zero) - edge.col((j + 1) % 3) - edge.col((j + 2) % 3)));
    return f;
  }

  [[nodiscard]] Mat3<Scalar> gradient(const Vec3<Scalar>& xi) const {
    Mat3<Scalar> g;
    g.set_col(0, slope.col(0) + curvature.col(0) * xi[0] + twist.col(2) * xi[1] + twist.col(1) * xi[2]);
    g.set_col(1, slope.col(1) + twist.col(2) * xi[0] + curvature.col(1) * xi[1] + twist.col(0) * xi[2]);
    g.set_col(2, slope.col(2) + twist.col(1) * xi[0] + twist.col(0) * xi[1] + curvature.col(2) * xi[2]);
    return g;
  }
  [[nodiscard]] Vec3<Scalar> value(const Vec3<Scalar>& xi) const { return at_zero + (slope + gradient(xi)) * xi / 2; }
};

/// Node positions of one element in double, m.
template <TetrahedralElement Element>
using NodePositions = std::array<Vec3<double>, Element::nodes>;

/// Contains the whole element, curved or not: the hull of its Bézier points (2 m - (a + b)/2 on an edge).
template <TetrahedralElement Element>
Box element_box(const NodePositions<Element>& x) {
  Box box;
  for (std::size_t c = 0; c < 4; ++c) box.add(x[c]);
  if constexpr (Element::edge_nodes == 1)
    for (std::size_t e = 0; e < 6; ++e) box.add(2 * x[4 + e] - (x[tet_edges[e].a] + x[tet_edges[e].b]) / 2);
  return box;
}

/// The farthest that a mid-edge node lies from the middle of its edge, m; 0 for Tet4.
template <TetrahedralElement Element>
double bow(const NodePositions<Element>& x) {
  double most = 0;
  if constexpr (Element::edge_nodes == 1)
    for (std::size_t e = 0; e < 6; ++e)
      most = (std::max)(most, (x[4 + e] - (x[tet_edges[e].a] + x[tet_edges[e].b]) / 2).norm());
  return most;
}

/// A point of an element and how far it is from the point that was asked for.
struct ElementPoint {
  Vec3<double> xi = Vec3<double>::Constant(0.25);
  double squared_distance = 0;  ///< m^2
};

/// Natural coordinates, 0 where barycentric coordinates are 0.
inline Vec3<double> natural(const SimplexPoint<4>& q) { return {q.barycentric[1], q.barycentric[2], q.barycentric[3]}; }

/// Walks from `start` to a nearest point of a curved element: each step takes the nearest point of the linearised
/// element, a tetrahedron, and is halved until the distance shrinks (Gauss-Newton; Newton's method for a point inside).
template <TetrahedralElement Element>
ElementPoint refine_closest(const ElementField<double, Element::edge_nodes>& map, const Vec3<double>& p,
                            const Vec3<double>& start, double tolerance) {
  constexpr int max_steps = 50, max_halvings = 30;
  constexpr double min_gain = 1e-9;  // of the squared distance
  ElementPoint now{start, (map.value(start) - p).squaredNorm()};
  for (int step = 0; step < max_steps && now.squared_distance > tolerance * tolerance; ++step) {
    const Vec3<double> x = map.value(now.xi);
    const Mat3<double> g = map.gradient(now.xi);
    const Vec3<double> corner = x - g * now.xi;
    const Vec3<double> target =
        natural(closest_on_tetrahedron({corner, corner + g.col(0), corner + g.col(1), corner + g.col(2)}, p));
    const double before = now.squared_distance;
    double t = 1;
    for (int halving = 0; halving < max_halvings; ++halving, t /= 2) {
      const Vec3<double> xi = now.xi + t * (target - now.xi);
      const double d2 = (map.value(xi) - p).squaredNorm();
      if (d2 < before) {
        now = {xi, d2};
        break;
      }
    }
    if (!(now.squared_distance < before * (1 - min_gain))) break;
  }
  return now;
}

/// The point of the element nearest to `p`: closed form where the sides are straight to `tolerance` (m), iterated where
/// they are curved; with `thorough` from several starts unless the first one ends at `p` itself.
template <TetrahedralElement Element>
ElementPoint closest_on_element(const NodePositions<Element>& x, const Vec3<double>& p, double tolerance,
                                bool thorough) {
  const SimplexPoint<4> straight = closest_on_tetrahedron({x[0], x[1], x[2], x[3]}, p);
  ElementPoint best{natural(straight), straight.squared_distance};
  if constexpr (Element::edge_nodes == 1) {
    if (bow<Element>(x) <= tolerance) return best;
    const auto map = ElementField<double, Element::edge_nodes>::from_nodes([&](int a) { return x[at(a)]; });
    best = refine_closest<Element>(map, p, best.xi, tolerance);
    for (const QuadraturePoint& q : Element::stiffness_points) {
      if (!thorough || best.squared_distance <= tolerance * tolerance) break;
      const ElementPoint other = refine_closest<Element>(map, p, Vec3<double>(q.xi[0], q.xi[1], q.xi[2]), tolerance);
      if (other.squared_distance < best.squared_distance) best = other;
    }
  }
  return best;
}

}  // namespace corotet::inline v0_1::detail
