// Binding: for each surface vertex the element that carries it and where in that element it lies.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/number_text.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/embed/element_map.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <corotet/detail/mesh/check_connectivity.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <corotet/detail/mesh/vertex_normals.hpp>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Where a point is bound. A field f of the mesh is taken at the point as f(xi) + (df/dxi)(xi) step, xi in the element:
/// `step` is 0 to rounding for a point inside, and leads outside along the linear extension of the field at the nearest
/// point. So affine fields are exact everywhere, and quadratic shape functions are never evaluated outside.
struct BoundPoint {
  Index element = 0;
  Vec3<double> xi;
  Vec3<double> step;
  double distance = 0;       ///< from the element, m; 0 inside to the rounding of the mesh
  std::int64_t visited = 0;  ///< boxes looked at
};

/// Node positions of an element in double.
template <std::floating_point Scalar, TetrahedralElement Element>
NodePositions<Element> node_positions(const TetMesh<Scalar, Element>& mesh, Index e) {
  return mesh.node_positions(e);
}

template <std::floating_point Scalar, TetrahedralElement Element>
BoxTree element_tree(const TetMesh<Scalar, Element>& mesh) {
  std::vector<Box> boxes(at(mesh.element_count()));
  for (Index e = 0; e < mesh.element_count(); ++e) boxes[at(e)] = element_box<Element>(node_positions(mesh, e));
  return BoxTree(boxes);
}

/// Rounding of positions in the mesh's precision, m.
template <std::floating_point Scalar>
double position_rounding(const Box& bounds) {
  return 4 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) *
         (std::max)(bounds.low.cwiseAbs().maxCoeff(), bounds.high.cwiseAbs().maxCoeff());
}

/// A curved element may fold at its rim, where no quadrature point looks: there the linear extension starts from the
/// nearest point at which the mesh guarantees a positive Jacobian.
template <TetrahedralElement Element>
Vec3<double> usable_start(const ElementField<double, Element::edge_nodes>& map, const Vec3<double>& xi) {
  if constexpr (Element::edge_nodes == 0) {
    return xi;
  } else {
    constexpr double least = 1e-3;  // of the smallest Jacobian at the quadrature points
    double smallest = std::numeric_limits<double>::infinity(), nearest2 = smallest;
    Vec3<double> nearest = xi;
    for (const QuadraturePoint& q : Element::stiffness_points) {
      const Vec3<double> point(q.xi[0], q.xi[1], q.xi[2]);
      smallest = (std::min)(smallest, map.gradient(point).determinant());
      if (const double d2 = (point - xi).squaredNorm(); d2 < nearest2) {
        nearest2 = d2;
        nearest = point;
      }
    }
    return map.gradient(xi).determinant() > least * smallest ? xi : nearest;
  }
}

/// The point of a mesh nearest to `p`: its element, where in that, and how far. `positions_of(e)` are the node
/// positions of element e, m; `step` stays unset.
template <TetrahedralElement Element, std::invocable<Index> PositionsOf>
BoundPoint nearest_point(const BoxTree& tree, double rounding, const Vec3<double>& p, const PositionsOf& positions_of) {
  BoundPoint bound;
  const auto search = [&](bool thorough) {
    double best = std::numeric_limits<double>::infinity();
    const NearestPrimitive found = tree.nearest(p, [&](Index e) {
      const ElementPoint q = closest_on_element<Element>(positions_of(e), p, rounding, thorough);
      // Nothing is nearer than "inside": the search ends there.
      const double d2 = q.squared_distance <= rounding * rounding ? 0 : q.squared_distance;
      if (d2 < best) {
        best = d2;
        bound.xi = q.xi;
      }
      return d2;
    });
    bound.element = found.primitive;
    bound.visited += found.visited;
    bound.distance = square_root(found.squared_distance);
  };
  search(false);
  // One start for each element finds nearly every point that is inside; only the others are worth several.
  if (Element::edge_nodes > 0 && bound.distance > 0) search(true);
  return bound;
}

/// Binds `p` (relative to the mesh's origin).
template <std::floating_point Scalar, TetrahedralElement Element>
BoundPoint bind_point(const TetMesh<Scalar, Element>& mesh, const BoxTree& tree, double rounding,
                      const Vec3<double>& p) {
  BoundPoint bound = nearest_point<Element>(tree, rounding, p, [&](Index e) { return node_positions(mesh, e); });
  const NodePositions<Element> x = node_positions(mesh, bound.element);
  const auto map = ElementField<double, Element::edge_nodes>::from_nodes([&](int a) { return x[at(a)]; });
  bound.xi = usable_start<Element>(map, bound.xi);
  bound.step = map.gradient(bound.xi).inverse() * (p - map.value(bound.xi));
  return bound;
}

/// Normals to bind: unit length, +z in place of a zero normal (counted in `replaced`).
inline std::vector<Vec3<double>> unit_normals(std::span<const Vec3<double>> normals, Index& replaced) {
  std::vector<Vec3<double>> out;
  out.reserve(normals.size());
  for (const Vec3<double>& n : normals) {
    const double length = n.stableNorm();
    out.push_back(length > 0 ? n / length : Vec3<double>(0, 0, 1));
    if (!(length > 0)) ++replaced;
  }
  return out;
}

/// Lengths, and the first vertex that is not finite or too far from the mesh's origin.
template <std::floating_point Scalar, TetrahedralElement Element>
Result<void> check_surface(const TetMesh<Scalar, Element>& mesh, std::span<const Vec3<double>> positions,
                           std::span<const Vec3<double>> normals) {
  if (positions.size() > std::size_t{(std::numeric_limits<Index>::max)()} / 3)
    return Error{ErrorCode::unsupported, "surface", "it is too large for 32-bit indices"};
  if (!normals.empty() && normals.size() != positions.size())
    return Error{
        ErrorCode::invalid_argument, "surface",
        "it has " + std::to_string(positions.size()) + " vertices but " + std::to_string(normals.size()) + " normals"};
  if (Result<void> status = check_positions(positions, "surface vertex"); !status) return status;
  // In float, natural coordinates and moved positions need room below the end of the range.
  constexpr double largest = std::numeric_limits<Scalar>::max_exponent10 > 100 ? max_coordinate : 1e30;
  for (std::size_t v = 0; v < positions.size(); ++v)
    if ((positions[v] - mesh.origin()).cwiseAbs().maxCoeff() > largest)
      return Error{ErrorCode::non_finite_value, "surface vertex " + std::to_string(v),
                   "it is farther than " + number_text(largest) + " m from the mesh's origin"};
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (!normals[v].allFinite())
      return Error{ErrorCode::non_finite_value, "surface vertex " + std::to_string(v), "its normal is not finite"};
  return {};
}

}  // namespace corotet::inline v0_1::detail
