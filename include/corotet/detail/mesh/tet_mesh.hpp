// A checked tetrahedral mesh: what every other part of the library may rely on.
#pragma once

#include <array>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/instances.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/message.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/element/tet10.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/validate.hpp>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// A mesh of tetrahedra: rest positions and elements, checked once by `create`.
///
/// A body is made of one. MeshData is the same without the guarantees: what readers and generators return. Tet10
/// reaches an error with far fewer elements than Tet4.
/// @snippet bodies.cpp mesh
/// Invariants, established by `create` and kept for life: every index is in range; no
/// element names a vertex twice; every vertex belongs to an element; every element has a positive Jacobian at each
/// quadrature point; every number is finite. Elements of a reader's own are carried as well: see ReferenceElement.
template <std::floating_point Scalar, ReferenceElement Element = Tet4>
class TetMesh {
 public:
  using scalar_type = Scalar;  ///< float or double
  /// Tet4, Tet10 or one of your own
  using element_type = Element;
  using Nodes = std::array<Index, Element::nodes>;  ///< of an element

  /// Checks `data` and takes it. Elements with the opposite winding are turned round and counted in
  /// `flipped_elements()`. `origin` (m) is subtracted from all positions before they are rounded to Scalar: give the
  /// centre of a mesh that lies far from 0 to keep float precision; everything else then works in coordinates relative
  /// to it.
  /// Errors: empty_mesh, invalid_argument (wrong nodes_per_element: see raise_order and lower_order; array lengths),
  /// index_out_of_range, duplicate_node, unreferenced_vertex (see remove_unreferenced), non_finite_value,
  /// degenerate_element, unsupported (too large for 32-bit indices); each names the element or vertex.
  [[nodiscard]] COROTET_COLD static Result<TetMesh> create(const MeshData& data,
                                                           const Vec3<double>& origin = Vec3<double>::Zero());

  /// Number of vertices.
  [[nodiscard]] Index vertex_count() const { return size_of(positions_); }
  /// Number of elements.
  [[nodiscard]] Index element_count() const { return size_of(elements_); }

  /// Rest positions relative to `origin()`, m.
  [[nodiscard]] const std::vector<Vec3<Scalar>>& positions() const { return positions_; }
  /// Rest position of a vertex, m.
  [[nodiscard]] const Vec3<Scalar>& position(Index vertex) const { return positions_[at(vertex)]; }

  /// The rest position of node `a` of an element, for sums in double.
  [[nodiscard]] Vec3<double> node_position(Index element, std::size_t a) const {
    return position(elements_[at(element)][a]).template cast<double>();
  }
  /// Those of all its nodes.
  [[nodiscard]] std::array<Vec3<double>, std::size_t{Element::nodes}> node_positions(Index element) const {
    std::array<Vec3<double>, std::size_t{Element::nodes}> x;
    for (std::size_t a = 0; a < x.size(); ++a) x[a] = node_position(element, a);
    return x;
  }

  /// The vertex whose rest position is nearest to `x` (m, relative to `origin()`), the first of equals. Looks at each.
  [[nodiscard]] Index nearest_vertex(const Vec3<Scalar>& x) const { return nearest_position(positions_, x); }

  /// Vertices of all elements, in the order of the element type's nodes.
  [[nodiscard]] const std::vector<Nodes>& elements() const { return elements_; }
  /// Vertices of an element.
  [[nodiscard]] const Nodes& element(Index e) const { return elements_[at(e)]; }

  /// One tag an element, or empty.
  [[nodiscard]] const std::vector<int>& regions() const { return regions_; }

  /// What was subtracted from the positions given to `create`, m.
  [[nodiscard]] const Vec3<double>& origin() const { return origin_; }

  /// How many elements `create` turned round.
  [[nodiscard]] Index flipped_elements() const { return flipped_elements_; }

  /// The mesh as unchecked data in double, in the coordinates given to `create`: for writers and converters.
  [[nodiscard]] COROTET_COLD MeshData data() const;

  /// Bytes on the heap.
  [[nodiscard]] std::size_t bytes() const {
    return detail::bytes_of(positions_) + detail::bytes_of(elements_) + detail::bytes_of(regions_);
  }

  /// The mesh of some elements alone, each named once, with the same positions and origin. `vertices` (out): of this
  /// mesh, ascending, one for each of the new mesh's.
  [[nodiscard]] COROTET_COLD TetMesh part(const std::vector<Index>& elements, std::vector<Index>& vertices) const;

 private:
  TetMesh() = default;

  std::vector<Vec3<Scalar>> positions_;
  std::vector<Nodes> elements_;
  std::vector<int> regions_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  Index flipped_elements_ = 0;
};

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <std::floating_point Scalar, ReferenceElement Element>
Result<TetMesh<Scalar, Element>> TetMesh<Scalar, Element>::create(const MeshData& data, const Vec3<double>& origin) {
  if (Result<void> status = detail::check_arrays(data, Element::nodes); !status) return status.error();

  TetMesh mesh;
  mesh.origin_ = origin;
  mesh.positions_ = Field<Scalar>(data.positions.size());
  for (std::size_t v = 0; v < data.positions.size(); ++v) {
    mesh.positions_[v] = (data.positions[v] - origin).template cast<Scalar>();
    if (!mesh.positions_[v].allFinite())
      return detail::error(ErrorCode::non_finite_value, {"vertex ", v},
                           {"its position is not a finite number in this precision"});
  }

  mesh.elements_ = std::vector<Nodes>(data.connectivity.size() / Element::nodes);
  for (Index e = 0; e < mesh.element_count(); ++e) {
    Nodes& nodes = mesh.elements_[at(e)];
    std::copy_n(data.connectivity.begin() + std::ptrdiff_t{e} * Element::nodes, Element::nodes, nodes.begin());
    if (detail::signed_volume<Element>(mesh.node_positions(e)) < 0) {  // of what is kept, not of `data`
      detail::turn_round<Element>(nodes);
      ++mesh.flipped_elements_;
    }
    const auto epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
    if (Result<void> status = detail::check_volume<Element>(mesh.node_positions(e), e, epsilon); !status)
      return status.error();
  }
  mesh.regions_ = data.regions;
  return mesh;
}

template <std::floating_point Scalar, ReferenceElement Element>
MeshData TetMesh<Scalar, Element>::data() const {
  MeshData out;
  out.nodes_per_element = Element::nodes;
  out.positions.reserve(positions_.size());
  for (const Vec3<Scalar>& x : positions_) out.positions.push_back(x.template cast<double>() + origin_);
  out.connectivity.reserve(elements_.size() * Element::nodes);
  for (const Nodes& nodes : elements_) out.connectivity.insert(out.connectivity.end(), nodes.begin(), nodes.end());
  out.regions = regions_;
  return out;
}

template <std::floating_point Scalar, ReferenceElement Element>
TetMesh<Scalar, Element> TetMesh<Scalar, Element>::part(const std::vector<Index>& elements,
                                                        std::vector<Index>& vertices) const {
  std::vector<Index> place(positions_.size(), -1);
  for (const Index e : elements)
    for (const Index v : elements_[at(e)]) place[at(v)] = 0;
  TetMesh mesh;
  mesh.origin_ = origin_;
  vertices.clear();
  for (Index v = 0; v < vertex_count(); ++v)
    if (place[at(v)] == 0) {
      place[at(v)] = size_of(vertices);
      vertices.push_back(v);
    }
  mesh.positions_ = Field<Scalar>(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) mesh.positions_[i] = positions_[at(vertices[i])];
  mesh.elements_ = std::vector<Nodes>(elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i) {
    for (std::size_t a = 0; a < Element::nodes; ++a) mesh.elements_[i][a] = place[at(elements_[at(elements[i])][a])];
    if (!regions_.empty()) mesh.regions_.push_back(regions_[at(elements[i])]);
  }
  return mesh;
}

COROTET_INSTANCES_OF_ELEMENT(TetMesh)

}  // namespace corotet::inline v0_1
