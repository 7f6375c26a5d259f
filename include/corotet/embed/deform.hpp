// What an update computes: the motion of each carrying element, then position and normal of each vertex.
#pragma once

#include <array>
#include <cmath>
#include <corotet/core/types.hpp>
#include <corotet/embed/bind.hpp>
#include <corotet/embed/element_map.hpp>
#include <corotet/mesh/tet_mesh.hpp>
#include <limits>

namespace corotet::detail {

/// cof(M) = det(M) M^-T: turns area vectors as M turns lengths; defined for every M.
template <std::floating_point Scalar>
Mat3<Scalar> cofactor(const Mat3<Scalar>& m) {
  Mat3<Scalar> c;
  c.col(0) = m.col(1).cross(m.col(2));
  c.col(1) = m.col(2).cross(m.col(0));
  c.col(2) = m.col(0).cross(m.col(1));
  return c;
}

/// A surface vertex, as small as it can be: updates are bound by the memory they read.
template <std::floating_point Scalar, int order>
struct BoundVertex {
  Index slot;         ///< of the element that carries it
  Vec3<Scalar> rest;  ///< P, m, relative to the mesh's origin
  /// Tet4: xi + step, all that a linear field needs. Tet10: xi, then xi / 2 + step (see `ElementMotion::position`).
  std::array<Vec3<Scalar>, order> where;
  /// J^T N with the rest Jacobian J = dX/dxi: the normal in natural coordinates, unit length. cof(dx/dxi) takes it to
  /// the deformed normal, as cof(F) N = cof(dx/dxi) J^T N / det J.
  Vec3<Scalar> normal;

  /// `p`, m, and unit normal `n` (or zero) at rest, relative to the mesh's origin; bound at `point`, carried by
  /// `carrier`.
  template <ReferenceElement Element>
  BoundVertex(const TetMesh<Scalar, Element>& mesh, const BoundPoint& point, Index carrier, const Vec3<double>& p,
              const Vec3<double>& n)
      : slot(carrier), rest(p.cast<Scalar>()) {
    if constexpr (order == 1) {
      where[0] = (point.xi + point.step).template cast<Scalar>();
    } else {
      where[0] = point.xi.cast<Scalar>();
      where[1] = (point.xi / 2 + point.step).template cast<Scalar>();
    }
    const NodePositions<Element> x = node_positions(mesh, point.element);
    const auto map = ElementField<double, order>::from_nodes([&](int a) { return x[at(a)]; });
    normal = (map.gradient(point.xi).transpose() * n).stableNormalized().template cast<Scalar>();
  }

  /// N_a(xi) + dN_a/dxi . step
  template <ReferenceElement Element>
  [[nodiscard]] std::array<double, Element::nodes> weights() const {
    const Vec3<double> first = where[0].template cast<double>();
    const NaturalCoordinates xi{first[0], first[1], first[2]};
    std::array<double, Element::nodes> w = Element::shape(xi);
    if constexpr (order == 2) {
      const Vec3<double> step = where[1].template cast<double>() - first / 2;
      const auto gradient = Element::gradient(xi);
      for (std::size_t a = 0; a < w.size(); ++a)
        for (int i = 0; i < 3; ++i) w[a] += gradient[a][at(i)] * step[i];
    }
    return w;
  }
};

/// An element that carries vertices: its nodes and its rest shape.
template <std::floating_point Scalar, ReferenceElement Element>
struct CarrierElement {
  std::array<Index, Element::nodes> nodes;
  ElementField<Scalar, Element::order> rest;

  CarrierElement(const TetMesh<Scalar, Element>& mesh, Index e)
      : nodes(mesh.element(e)),
        rest(ElementField<Scalar, Element::order>::from_nodes([&](int a) { return mesh.position(nodes[at(a)]); })) {}
};

/// The normal cof(J) m / |.|, or zero where it is lost in rounding or overflow.
template <std::floating_point Scalar>
Vec3<Scalar> turned_normal(const Vec3<Scalar>& cof_m, Scalar least_squared) {
  const Scalar squared = cof_m.squaredNorm();
  if (squared > least_squared && squared <= std::numeric_limits<Scalar>::max())
    return cof_m * (Scalar(1) / std::sqrt(squared));
  return Vec3<Scalar>::Zero();
}

/// What cof(J) m must exceed, squared, to be more than rounding: each entry of the cofactor is a difference of products
/// of the size of |J|^2.
template <std::floating_point Scalar>
Scalar rounding_of_normal(const Mat3<Scalar>& jacobian) {
  const Scalar size = 8 * std::numeric_limits<Scalar>::epsilon() * jacobian.squaredNorm();
  return size * size;
}

/// The motion of one element in the current frame. The inverse of the element's size makes Jacobians free of units, so
/// that squares of areas stay far from the ends of float's range for bodies of any size.
template <std::floating_point Scalar, ReferenceElement Element>
struct ElementMotion;

/// Tet4: everything about the normal but the product with it is done once an element.
template <std::floating_point Scalar, ReferenceElement Element>
  requires(Element::order == 1)
struct ElementMotion<Scalar, Element> {
  ElementField<Scalar, 1> displacement;
  Mat3<Scalar> cof;
  Scalar least_squared;

  template <bool with_normals>
  void set(const CarrierElement<Scalar, Element>& carrier, const Vec3<Scalar>* u) {
    displacement = ElementField<Scalar, 1>::from_nodes([&](int a) { return u[carrier.nodes[at(a)]]; });
    if constexpr (with_normals) {
      const Scalar inverse_size = 1 / carrier.rest.slope.cwiseAbs().maxCoeff();
      const Mat3<Scalar> jacobian = (carrier.rest.slope + displacement.slope) * inverse_size;
      cof = cofactor(jacobian);
      least_squared = rounding_of_normal(jacobian);
    }
  }

  [[nodiscard]] Vec3<Scalar> position(const BoundVertex<Scalar, 1>& vertex) const {
    return vertex.rest + displacement.value(vertex.where[0]);
  }

  [[nodiscard]] Vec3<Scalar> normal(const BoundVertex<Scalar, 1>& vertex,
                                    const CarrierElement<Scalar, Element>& carrier) const {
    const Vec3<Scalar> n = turned_normal<Scalar>(cof * vertex.normal, least_squared);
    if (!n.isZero(0)) return n;
    return (cofactor(carrier.rest.slope) * vertex.normal).stableNormalized();
  }
};

/// Tet10: gradients differ from vertex to vertex.
template <std::floating_point Scalar, ReferenceElement Element>
  requires(Element::order == 2)
struct ElementMotion<Scalar, Element> {
  ElementField<Scalar, 2> displacement;
  Scalar inverse_size;

  template <bool with_normals>
  void set(const CarrierElement<Scalar, Element>& carrier, const Vec3<Scalar>* u) {
    displacement = ElementField<Scalar, 2>::from_nodes([&](int a) { return u[carrier.nodes[at(a)]]; });
    inverse_size = 1 / carrier.rest.slope.cwiseAbs().maxCoeff();
  }

  /// P + u(xi) + G(xi) step, where u(xi) = u(0) + (G(0) + G(xi)) xi / 2.
  [[nodiscard]] Vec3<Scalar> position(const BoundVertex<Scalar, 2>& vertex) const {
    return vertex.rest + (displacement.at_zero + displacement.slope * (vertex.where[0] / 2) +
                          displacement.gradient(vertex.where[0]) * vertex.where[1]);
  }

  [[nodiscard]] Vec3<Scalar> normal(const BoundVertex<Scalar, 2>& vertex,
                                    const CarrierElement<Scalar, Element>& carrier) const {
    const Mat3<Scalar> rest = carrier.rest.gradient(vertex.where[0]);
    const Mat3<Scalar> jacobian = (rest + displacement.gradient(vertex.where[0])) * inverse_size;
    const Vec3<Scalar> n = turned_normal<Scalar>(cofactor(jacobian) * vertex.normal, rounding_of_normal(jacobian));
    if (!n.isZero(0)) return n;
    return (cofactor(rest) * vertex.normal).stableNormalized();
  }
};

}  // namespace corotet::detail
