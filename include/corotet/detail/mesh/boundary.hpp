// The outer surface of a tetrahedral mesh: the faces that belong to one element only.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/mesh/check_connectivity.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// The boundary as triangles over the *volume mesh's* vertices, in the order of the elements.
struct BoundarySurface {
  /// Counter-clockwise seen from outside. One a face of a 4-node mesh; four a face of a 10-node mesh: its three corners
  /// and its middle.
  std::vector<std::array<Index, 3>> triangles;

  /// The element behind each triangle.
  std::vector<Index> elements;
};

/// A surface with vertices of its own, and where they come from.
struct CompactSurface {
  SurfaceMesh surface;                 ///< with the vertices that its triangles name alone
  std::vector<Index> volume_vertices;  ///< the volume mesh's vertex for each surface vertex, ascending
};

namespace detail {

/// A face by its sorted corners, so that both elements that own it give the same key.
struct FaceUse {
  std::array<Index, 3> corners;
  Index element;
  std::int8_t face;
  std::int8_t turn;  // +1: `corners` run counter-clockwise seen from outside the element, -1: clockwise, 0: unknown

  /// In the order of the corners, then of elements and faces.
  [[nodiscard]] bool precedes(const FaceUse& other) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (corners[i] != other.corners[i]) return corners[i] < other.corners[i];
    return element != other.element ? element < other.element : face < other.face;
  }
};

/// Puts faces with the same corners side by side: O(n log n).
COROTET_COLD inline void sort_faces(std::vector<FaceUse>& uses) {
  std::sort(uses.begin(), uses.end(), [](const FaceUse& p, const FaceUse& q) { return p.precedes(q); });
}

inline FaceUse face_use(const Index* nodes, int orientation, Index element, int face) {
  const std::array<std::size_t, 3>& local = tet_faces[at(face)];
  std::array<Index, 3> c{nodes[local[0]], nodes[local[1]], nodes[local[2]]};
  int turn = orientation;
  const auto order = [&](std::size_t i, std::size_t j) {
    if (c[i] <= c[j]) return;
    std::swap(c[i], c[j]);
    turn = -turn;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return {c, element, static_cast<std::int8_t>(face), static_cast<std::int8_t>(turn)};
}

inline Error face_error(const FaceUse& use, const std::string& reason) {
  const auto& [a, b, c] = use.corners;
  return Error{ErrorCode::invalid_argument, "element " + std::to_string(use.element),
               "its face (" + std::to_string(a) + ", " + std::to_string(b) + ", " + std::to_string(c) + ") " + reason};
}

/// The node between two corners of a Tet10.
inline std::size_t middle_node(std::size_t a, std::size_t b) {
  const auto joins = [&](const ElementEdge& edge) {
    return (edge.a == a && edge.b == b) || (edge.a == b && edge.b == a);
  };
  std::size_t k = 0;
  while (!joins(tet_edges[k])) ++k;
  return 4 + k;
}

inline void add_face(BoundarySurface& surface, const Index* nodes, int nodes_per_element, Index element, int face,
                     bool reversed) {
  std::array<std::size_t, 3> c = tet_faces[at(face)];
  if (reversed) std::swap(c[1], c[2]);
  const auto add = [&](std::size_t i, std::size_t j, std::size_t k) {
    surface.triangles.push_back({nodes[i], nodes[j], nodes[k]});
    surface.elements.push_back(element);
  };
  if (nodes_per_element == 4) return add(c[0], c[1], c[2]);
  const std::size_t m01 = middle_node(c[0], c[1]), m12 = middle_node(c[1], c[2]), m20 = middle_node(c[2], c[0]);
  add(c[0], m01, m20);
  add(m01, c[1], m12);
  add(m20, m12, c[2]);
  add(m01, m12, m20);
}

/// Sorts all faces by their corners, so that equal ones meet: O(n log n). `nodes(e)` points at an element's nodes;
/// `orientation(e)` is the sign of its volume, 0 where rounding hides it.
template <std::invocable<Index> Nodes, std::invocable<Index> Orientation>
Result<BoundarySurface> extract_boundary(Index element_count, int nodes_per_element, const Nodes& nodes,
                                         const Orientation& orientation) {
  std::vector<FaceUse> uses;
  uses.reserve(at(element_count) * 4);
  for (Index e = 0; e < element_count; ++e)
    for (int f = 0; f < 4; ++f) uses.push_back(face_use(nodes(e), orientation(e), e, f));
  sort_faces(uses);

  std::vector<std::uint8_t> is_outer(uses.size(), 0);  // face f of element e: at 4 e + f
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].corners == uses[begin].corners) ++end;
    const FaceUse& first = uses[begin];
    if (end - begin > 2)
      return face_error(first, "belongs to " + std::to_string(end - begin) +
                                   " elements; at most two can meet at a face without overlapping");
    if (end - begin == 2 && first.turn * uses[begin + 1].turn > 0)
      return face_error(first, "also belongs to element " + std::to_string(uses[begin + 1].element) +
                                   ", which lies on the same side of it: they overlap");
    if (end - begin == 1) is_outer[4 * at(first.element) + at(first.face)] = 1;
  }

  BoundarySurface surface;
  for (Index e = 0; e < element_count; ++e)
    for (int f = 0; f < 4; ++f)
      if (is_outer[4 * at(e) + at(f)] != 0) add_face(surface, nodes(e), nodes_per_element, e, f, orientation(e) < 0);
  return surface;
}

/// The sign of an element's volume; 0 where rounding of the positions could have turned it.
inline int volume_sign(const std::vector<Vec3<double>>& x, const Index* nodes) {
  double size = 0, largest = 0;
  for (int a = 0; a < 4; ++a) {
    size = (std::max)(size, (x[at(nodes[a])] - x[at(nodes[0])]).norm());
    largest = (std::max)(largest, x[at(nodes[a])].cwiseAbs().maxCoeff());
  }
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * size * size * (std::max)(size, largest);
  const double determinant = 6 * corner_volume(x, nodes);
  return determinant > rounding ? 1 : determinant < -rounding ? -1 : 0;
}

}  // namespace detail

/// The boundary of an unchecked mesh. Elements of either winding are understood; a flat one is taken as it is wound.
/// Errors: invalid_argument (nodes_per_element; a face of more than two elements, or of two that overlap: the first
/// such element is named) and index_out_of_range.
[[nodiscard]] inline Result<BoundarySurface> extract_boundary(const MeshData& mesh) {
  if (Result<void> status = detail::check_connectivity(mesh); !status) return status.error();
  const auto nodes = [&](Index e) { return mesh.connectivity.data() + std::ptrdiff_t{e} * mesh.nodes_per_element; };
  return detail::extract_boundary(mesh.element_count(), mesh.nodes_per_element, nodes,
                                  [&](Index e) { return detail::volume_sign(mesh.positions, nodes(e)); });
}

/// The boundary of a checked mesh. Errors: invalid_argument where elements overlap at a face, as above.
template <std::floating_point Scalar, TetrahedralElement Element>
[[nodiscard]] Result<BoundarySurface> extract_boundary(const TetMesh<Scalar, Element>& mesh) {
  return detail::extract_boundary(
      mesh.element_count(), Element::nodes, [&](Index e) { return mesh.element(e).data(); }, [](Index) { return 1; });
}

/// The boundary with its own vertices, numbered in the order of the volume's. `positions` holds one position (m) for
/// each vertex of the volume mesh, at rest or deformed. The surface has no normals.
template <std::floating_point Scalar>
[[nodiscard]] CompactSurface compact_surface(const BoundarySurface& boundary,
                                             const std::vector<Vec3<Scalar>>& positions) {
  constexpr Index unused = -1;
  std::vector<Index> surface_vertex(positions.size(), unused);
  for (const auto& triangle : boundary.triangles) {
    for (const Index v : triangle) {
      COROTET_ASSERT(v >= 0 && at(v) < positions.size(), "give one position for each vertex of the volume mesh");
      surface_vertex[at(v)] = 0;
    }
  }
  CompactSurface compact;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (surface_vertex[v] == unused) continue;
    surface_vertex[v] = size_of(compact.volume_vertices);
    compact.volume_vertices.push_back(static_cast<Index>(v));
    compact.surface.positions.push_back(positions[v].template cast<double>());
  }
  compact.surface.triangles.reserve(boundary.triangles.size());
  for (const auto& [a, b, c] : boundary.triangles)
    compact.surface.triangles.push_back({surface_vertex[at(a)], surface_vertex[at(b)], surface_vertex[at(c)]});
  return compact;
}

}  // namespace corotet::inline v0_1
