// What an update computes: the motion of each carrying element, then position and normal of each vertex.
#pragma once

#include <array>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/embed/bind.hpp>
#include <corotet/detail/embed/body_point.hpp>
#include <corotet/detail/embed/element_map.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <limits>

namespace corotet::inline v0_1::detail {

/// cof(M) = det(M) M^-T: turns area vectors as M turns lengths; defined for every M.
template <std::floating_point Scalar>
Mat3<Scalar> cofactor(const Mat3<Scalar>& m) {
  Mat3<Scalar> c;
  c.set_col(0, m.col(1).cross(m.col(2)));
  c.set_col(1, m.col(2).cross(m.col(0)));
  c.set_col(2, m.col(0).cross(m.col(1)));
  return c;
}

/// A surface vertex, as small as it can be: updates are bound by the memory they read.
template <std::floating_point Scalar, int edge_nodes>
struct BoundVertex {
  Index slot;  ///< of the element that carries it
  /// Tet4: xi + step, all that a linear field needs. Tet10: xi, then xi / 2 + step (see `ElementMotion`).
  std::array<Vec3<Scalar>, std::size_t{edge_nodes + 1}> where;
  /// J^T N with the rest Jacobian J = dX/dxi: the normal in natural coordinates, unit length. cof(dx/dxi) takes it to
  /// the deformed normal, as cof(F) N = cof(dx/dxi) J^T N / det J.
  Vec3<Scalar> normal;

  /// Rest normal `n` (unit length, or zero) at `point`, which is carried by the element in slot `carrier`.
  template <TetrahedralElement Element>
  BoundVertex(const TetMesh<Scalar, Element>& mesh, const BoundPoint& point, Index carrier, const Vec3<double>& n)
      : slot(carrier) {
    if constexpr (edge_nodes == 0) {
      where[0] = (point.xi + point.step).template cast<Scalar>();
    } else {
      where[0] = point.xi.cast<Scalar>();
      where[1] = (point.xi / 2 + point.step).template cast<Scalar>();
    }
    const NodePositions<Element> x = node_positions(mesh, point.element);
    const auto map = ElementField<double, edge_nodes>::from_nodes([&](int a) { return x[at(a)]; });
    normal = (map.gradient(point.xi).transpose() * n).stableNormalized().template cast<Scalar>();
  }

  [[nodiscard]] bool is_finite() const { return where.front().allFinite() && where.back().allFinite(); }

  /// N_a(xi) + dN_a/dxi . step
  template <TetrahedralElement Element>
  [[nodiscard]] std::array<double, Element::nodes> weights() const {
    const Vec3<double> xi = where[0].template cast<double>();
    if constexpr (edge_nodes == 0)
      return extended_weights<Element>(xi, Vec3<double>::Zero());
    else
      return extended_weights<Element>(xi, where[1].template cast<double>() - xi / 2);
  }
};

/// An element that carries vertices: its nodes, its rest shape (m) and the size of that.
template <std::floating_point Scalar, TetrahedralElement Element>
struct CarrierElement {
  std::array<Index, Element::nodes> nodes;
  ElementField<Scalar, Element::edge_nodes> rest;
  Scalar size;

  CarrierElement(const TetMesh<Scalar, Element>& mesh, Index e)
      : nodes(mesh.element(e)),
        rest(ElementField<Scalar, Element::edge_nodes>::from_nodes([&](int a) { return mesh.position(nodes[at(a)]); })),
        size(rest.slope.cwiseAbs().maxCoeff()) {}
};

/// A 3-vector in the first three of four lanes, the fourth 0: one SIMD register in float. For what is kept once an
/// element; vertices stay packed.
template <std::floating_point Scalar>
using Wide = Matrix<Scalar, 4, 1>;

/// a x b.
template <std::floating_point Scalar>
[[nodiscard]] COROTET_ALWAYS_INLINE Wide<Scalar> cross(const Wide<Scalar>& a, const Wide<Scalar>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0};
}

template <std::floating_point Scalar>
Wide<Scalar> widen(const Vec3<Scalar>& v) {
  return {v[0], v[1], v[2], 0};
}

/// A matrix by its columns.
template <std::floating_point Scalar>
using WideColumns = std::array<Wide<Scalar>, 3>;

template <std::floating_point Scalar>
WideColumns<Scalar> widen_columns(const Mat3<Scalar>& m) {
  return {widen<Scalar>(m.col(0)), widen<Scalar>(m.col(1)), widen<Scalar>(m.col(2))};
}

template <std::floating_point Scalar>
Wide<Scalar> multiply(const WideColumns<Scalar>& m, const Vec3<Scalar>& v) {
  return m[0] * v[0] + m[1] * v[1] + m[2] * v[2];
}

/// What |cof(J) m|^2 must exceed to be more than rounding, given |J|^2: each entry of the cofactor is a difference of
/// products of that size.
template <std::floating_point Scalar>
Scalar rounding_of_normal(Scalar squared_jacobian) {
  const Scalar size = 8 * std::numeric_limits<Scalar>::epsilon() * squared_jacobian;
  return size * size;
}

/// `cof_m` / |cof_m|; where that is lost in rounding or overflow, the rest normal at `xi` of m = `vertex.normal`.
template <std::floating_point Scalar, TetrahedralElement Element>
Wide<Scalar> unit_normal(const Wide<Scalar>& cof_m, Scalar min_squared, const Vec3<Scalar>& m, const Vec3<Scalar>& xi,
                         const CarrierElement<Scalar, Element>& carrier) {
  const Scalar squared = cof_m.squaredNorm();
  if (squared > min_squared && squared <= (std::numeric_limits<Scalar>::max)()) [[likely]]
    return cof_m * (Scalar(1) / square_root(squared));
  const Mat3<Scalar> rest = carrier.rest.gradient(xi) / carrier.size;
  return widen<Scalar>((cofactor(rest) * m).stableNormalized());
}

/// The motion of one element in the current frame: the polynomial of its current positions, x = X + u (relative to the
/// mesh's origin). Slopes are divided by the element's rest size, so that squares of areas stay far from the ends of
/// float's range for bodies of any size.
template <std::floating_point Scalar, TetrahedralElement Element>
struct ElementMotion;

/// Tet4: everything about the normal but the product with it is done once an element.
template <std::floating_point Scalar, TetrahedralElement Element>
  requires(Element::edge_nodes == 0)
struct ElementMotion<Scalar, Element> {
  Wide<Scalar> at_zero;
  WideColumns<Scalar> slope;  // not divided: nothing but positions needs it
  WideColumns<Scalar> cof;
  Scalar min_squared;

  template <bool with_normals>
  void set(const CarrierElement<Scalar, Element>& carrier, const Vec3<Scalar>* u) {
    const auto displacement =
        ElementField<Scalar, 0>::from_nodes([&](int a) -> const Vec3<Scalar>& { return u[carrier.nodes[at(a)]]; });
    const Mat3<Scalar> jacobian = carrier.rest.slope + displacement.slope;
    at_zero = widen<Scalar>(carrier.rest.at_zero + displacement.at_zero);
    slope = widen_columns<Scalar>(jacobian);
    if constexpr (with_normals) {
      const Mat3<Scalar> scaled = jacobian / carrier.size;
      cof = widen_columns<Scalar>(cofactor(scaled));
      min_squared = rounding_of_normal(scaled.squaredNorm());
    }
  }

  template <bool with_normals>
  void evaluate(const BoundVertex<Scalar, 0>& vertex, const CarrierElement<Scalar, Element>& carrier, Wide<Scalar>& x,
                Wide<Scalar>& n) const {
    x = at_zero + multiply(slope, vertex.where[0]);
    if constexpr (with_normals)
      n = unit_normal(multiply(cof, vertex.normal), min_squared, vertex.normal, vertex.where[0], carrier);
  }
};

/// Tet10: the Jacobian differs from vertex to vertex. Position and normal share it.
template <std::floating_point Scalar, TetrahedralElement Element>
  requires(Element::edge_nodes == 1)
struct ElementMotion<Scalar, Element> {
  Wide<Scalar> at_zero;
  WideColumns<Scalar> slope, curvature, twist;  // see ElementField
  Scalar size;

  template <bool /*with_normals*/>
  void set(const CarrierElement<Scalar, Element>& carrier, const Vec3<Scalar>* u) {
    const auto displacement =
        ElementField<Scalar, 1>::from_nodes([&](int a) -> const Vec3<Scalar>& { return u[carrier.nodes[at(a)]]; });
    size = carrier.size;
    at_zero = widen<Scalar>(carrier.rest.at_zero + displacement.at_zero);
    slope = widen_columns<Scalar>((carrier.rest.slope + displacement.slope) / size);
    curvature = widen_columns<Scalar>((carrier.rest.curvature + displacement.curvature) / size);
    twist = widen_columns<Scalar>((carrier.rest.twist + displacement.twist) / size);
  }

  /// x(xi) + G(xi) step, where x(xi) = x(0) + (G(0) + G(xi)) xi / 2.
  template <bool with_normals>
  void evaluate(const BoundVertex<Scalar, 1>& vertex, const CarrierElement<Scalar, Element>& carrier, Wide<Scalar>& x,
                Wide<Scalar>& n) const {
    const Vec3<Scalar>&xi = vertex.where[0], &m = vertex.normal;
    const WideColumns<Scalar> g{slope[0] + curvature[0] * xi[0] + twist[2] * xi[1] + twist[1] * xi[2],
                                slope[1] + twist[2] * xi[0] + curvature[1] * xi[1] + twist[0] * xi[2],
                                slope[2] + twist[1] * xi[0] + twist[0] * xi[1] + curvature[2] * xi[2]};
    x = at_zero + size * (multiply<Scalar>(slope, xi / 2) + multiply(g, vertex.where[1]));
    if constexpr (with_normals) {
      const Wide<Scalar> cof_m = cross(g[1], g[2]) * m[0] + cross(g[2], g[0]) * m[1] + cross(g[0], g[1]) * m[2];
      const Scalar squares = g[0].squaredNorm() + g[1].squaredNorm() + g[2].squaredNorm();
      n = unit_normal(cof_m, rounding_of_normal(squares), m, xi, carrier);
    }
  }
};

}  // namespace corotet::inline v0_1::detail
