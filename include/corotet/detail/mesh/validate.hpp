// The checks behind TetMesh::create, each with an error that names the culprit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/message.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/jacobian.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Lengths, index range, repeated nodes, vertices without an element.
COROTET_COLD inline Result<void> check_arrays(const MeshData& data, int nodes_per_element) {
  if (data.positions.empty()) return error(ErrorCode::empty_mesh, "mesh", "it has no vertices");
  if (data.connectivity.empty()) return error(ErrorCode::empty_mesh, "mesh", "it has no elements");
  // A body counts 3 degrees of freedom a vertex and nodes^2 contributions an element by Index.
  constexpr std::size_t most = std::size_t{(std::numeric_limits<Index>::max)()};
  if (data.positions.size() > most / 3 || data.connectivity.size() > most / at((std::max)(nodes_per_element, 1)))
    return error(ErrorCode::unsupported, "mesh", "it is too large for 32-bit indices");
  if (data.nodes_per_element != nodes_per_element)
    return error(ErrorCode::invalid_argument, {"mesh"},
                 {"its elements have ", data.nodes_per_element, " nodes, this mesh type has ", nodes_per_element,
                  " (raise_order and lower_order convert)"});
  if (data.connectivity.size() % at(nodes_per_element) != 0)
    return error(ErrorCode::invalid_argument, {"mesh"},
                 {"connectivity has ", data.connectivity.size(), " entries, not a multiple of ", nodes_per_element});
  if (!data.regions.empty() && size_of(data.regions) != data.element_count())
    return error(ErrorCode::invalid_argument, "mesh", "regions must hold one tag an element, or be empty");

  Buffer<bool> referenced(data.positions.size());
  for (Index e = 0; e < data.element_count(); ++e) {
    const Index* nodes = data.connectivity.data() + std::ptrdiff_t{e} * nodes_per_element;
    for (int a = 0; a < nodes_per_element; ++a) {
      const Index v = nodes[a];
      if (v < 0 || v >= data.vertex_count())
        return error(ErrorCode::index_out_of_range, {"element ", e},
                     {"it names vertex ", v, ", but the mesh has vertices 0 to ", data.vertex_count() - 1});
      int b = 0;
      while (nodes[b] != v) ++b;
      if (b != a) return error(ErrorCode::duplicate_node, {"element ", e}, {"it names vertex ", v, " twice"});
      referenced[at(v)] = true;
    }
  }
  for (std::size_t v = 0; v < referenced.size(); ++v)
    if (!referenced[v])
      return error(ErrorCode::unreferenced_vertex, {"vertex ", v},
                   {"it belongs to no element, so it would have no mass (remove_unreferenced drops such vertices)"});
  return {};
}

/// Signed volume of the tetrahedron of the corners, m^3.
inline double corner_volume(const std::vector<Vec3<double>>& x, const Index* nodes) {
  const Vec3<double>& o = x[at(nodes[0])];
  return (x[at(nodes[1])] - o).cross(x[at(nodes[2])] - o).dot(x[at(nodes[3])] - o) / 6;
}

/// Signed volume of an element whose nodes lie at `x`, m^3; of a tetrahedron, that of its corners.
template <ReferenceElement Element>
double signed_volume(const std::array<Vec3<double>, std::size_t{Element::nodes}>& x) {
  if constexpr (TetrahedralElement<Element>) {
    return (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]) / 6;
  } else {
    double volume = 0;
    for (std::size_t q = 0; q < Element::stiffness_points.size(); ++q)
      volume += Element::stiffness_points[q].weight * jacobian(natural_gradients<Element>[q], x).determinant();
    return volume;
  }
}

/// Reverses the winding.
template <ReferenceElement Element>
void turn_round(std::array<Index, Element::nodes>& nodes) {
  const std::array<Index, Element::nodes> before = nodes;
  for (std::size_t a = 0; a < nodes.size(); ++a) nodes[a] = before[Element::mirrored[a]];
}

/// Positive Jacobian at one quadrature point of element `e`, whose nodes lie at `x`. Rounding moves each node by
/// `epsilon` times its distance from the origin, `largest` at most, and with it the determinant.
template <ReferenceElement Element>
COROTET_COLD Result<void> check_jacobian(const std::array<Vec3<double>, std::size_t{Element::nodes}>& x,
                                         const QuadraturePoint& point, Index e, double epsilon, double largest) {
  const Mat3<double> to_space = jacobian(Element::gradient(point.xi), x);
  const double det = to_space.determinant();
  const double size = (std::max)({to_space.col(0).norm(), to_space.col(1).norm(), to_space.col(2).norm()});
  const double rounding = 4 * epsilon * size * size * (std::max)(size, largest);
  if (det > rounding && std::isfinite(det)) return {};
  if (!has_constant_gradients<Element> && signed_volume<Element>(x) * 6 > rounding)
    return error(ErrorCode::degenerate_element, {"element ", e},
                 {"its edges are curved so far that it folds over itself"});
  return error(ErrorCode::degenerate_element, {"element ", e}, {"its volume is zero to rounding (", det / 6, " m^3)"});
}

/// Positive Jacobian at each quadrature point of element `e`, whose nodes lie at `x`, measured against rounding in
/// positions of precision `epsilon`.
template <ReferenceElement Element>
COROTET_COLD Result<void> check_volume(const std::array<Vec3<double>, std::size_t{Element::nodes}>& x, Index e,
                                       double epsilon) {
  double largest = 0;
  for (const Vec3<double>& node : x) largest = (std::max)(largest, node.cwiseAbs().maxCoeff());
  for (const QuadraturePoint& point : Element::stiffness_points)
    if (Result<void> status = check_jacobian<Element>(x, point, e, epsilon, largest); !status) return status;
  if constexpr (!has_constant_gradients<Element>)
    for (const QuadraturePoint& point : Element::mass_points)
      if (Result<void> status = check_jacobian<Element>(x, point, e, epsilon, largest); !status) return status;
  return {};
}

}  // namespace corotet::inline v0_1::detail
