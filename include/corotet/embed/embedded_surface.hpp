// A surface that moves with the volume around it: bound once, written every frame.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/core/assert.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/instances.hpp>
#include <corotet/core/result.hpp>
#include <corotet/core/types.hpp>
#include <corotet/embed/bind.hpp>
#include <corotet/embed/deform.hpp>
#include <corotet/embed/vertex_buffer.hpp>
#include <corotet/mesh/check_connectivity.hpp>
#include <corotet/mesh/surface_mesh.hpp>
#include <corotet/mesh/tet_mesh.hpp>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace corotet::inline v0_1 {

/// Surface vertices, each bound to a point of a tetrahedral mesh. The mesh is not needed after binding.
/// Laws: an affine motion x = A X + b of the mesh moves every vertex by the same map and turns normals by cof(A),
/// vertices outside the mesh included; results are the same bits on any executor; an update allocates nothing.
///
/// Positions are written relative to the mesh's origin() (an engine puts that into its model matrix), so they keep
/// float precision wherever the body is.
template <std::floating_point Scalar, TetrahedralElement Element = Tet4>
class EmbeddedSurface {
 public:
  using Mesh = TetMesh<Scalar, Element>;

  /// Binds vertices with the given rest positions (m, in the coordinates given to TetMesh::create) and rest normals
  /// (one a vertex, any length; or none). A vertex outside the mesh goes to the nearest element, is counted, and
  /// follows the linear extension of the motion at the nearest point. Errors: non_finite_value (names the vertex; also
  /// one farther from the mesh's origin than 1e100 m, in float 1e30 m), invalid_argument (number of normals),
  /// unsupported (too many).
  [[nodiscard]] static Result<EmbeddedSurface> bind(const Mesh& mesh, std::span<const Vec3<double>> rest_positions,
                                                    std::span<const Vec3<double>> rest_normals = {},
                                                    ExecutorRef executor = {});

  /// The same for a triangle surface. Where it has no normals, its vertices get the angle-weighted normals of its
  /// triangles. Further errors: index_out_of_range (names the triangle).
  [[nodiscard]] static Result<EmbeddedSurface> bind(const Mesh& mesh, const SurfaceMesh& surface,
                                                    ExecutorRef executor = {});

  /// Writes positions and normals that belong to the displacements `u` (m, one a mesh vertex, relative to its rest
  /// position) into `out`. A normal that the motion makes undefined (the body crushed to a line or a point there) is
  /// written as the rest normal. `out` must have one vertex for each bound vertex; normals need bound normals.
  void update(std::span<const Vec3<Scalar>> u, const VertexBuffer& out, ExecutorRef executor = {});

  /// Positions alone, m, relative to the mesh's origin: one a bound vertex.
  void positions(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out);

  /// Unit normals alone.
  void normals(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out);

  [[nodiscard]] Index vertex_count() const { return size_of(vertices_); }
  [[nodiscard]] bool has_normals() const { return has_normals_; }

  /// The mesh vertices that carry bound vertex `v`.
  [[nodiscard]] const std::array<Index, Element::nodes>& carriers(Index v) const {
    return elements_[at(vertices_[at(v)].slot)].nodes;
  }
  /// Their weights w_a, which sum to 1: the vertex moves by sum_a w_a u_a. For passing forces on the surface to the
  /// mesh.
  [[nodiscard]] std::array<double, Element::nodes> weights(Index v) const {
    return vertices_[at(v)].template weights<Element>();
  }

  /// Bound vertices outside the mesh by more than its rounding: how many, which, and the farthest of them, m.
  [[nodiscard]] Index outside_count() const { return size_of(outside_vertices_); }
  [[nodiscard]] const std::vector<Index>& outside_vertices() const { return outside_vertices_; }
  [[nodiscard]] double largest_distance() const { return largest_distance_; }

  /// How many rest normals had no direction and were replaced by +z.
  [[nodiscard]] Index replaced_normals() const { return replaced_normals_; }

  /// What binding cost: boxes looked at, over all vertices. Grows as vertices times log(elements).
  [[nodiscard]] std::int64_t boxes_visited() const { return boxes_visited_; }

 private:
  static constexpr Index unused = -1;
  static constexpr Index element_grain = 256, vertex_grain = 1024;

  EmbeddedSurface() = default;

  static constexpr auto nothing = [](Index, const detail::Wide<Scalar>&) {};

  /// Sets the motion of each carrier, then hands each vertex's position and normal to the writers.
  template <bool with_normals, class WritePosition, class WriteNormal>
  void deform(std::span<const Vec3<Scalar>> u, ExecutorRef executor, const WritePosition& write_position,
              const WriteNormal& write_normal) {
    COROTET_ASSERT(size_of(u) == mesh_vertices_, "displacements need one entry per mesh vertex");
    COROTET_ASSERT(!with_normals || has_normals_, "normals were not given when binding");
    for_ranges(executor, size_of(elements_), element_grain, [&](Index begin, Index end) {
      for (Index e = begin; e < end; ++e) motions_[at(e)].template set<with_normals>(elements_[at(e)], u.data());
    });
    for_ranges(executor, vertex_count(), vertex_grain, [&](Index begin, Index end) {
      for (Index v = begin; v < end; ++v) {
        const Vertex& vertex = vertices_[at(v)];
        detail::Wide<Scalar> x, n;
        motions_[at(vertex.slot)].template evaluate<with_normals>(vertex, elements_[at(vertex.slot)], x, n);
        write_position(v, x);
        if constexpr (with_normals) write_normal(v, n);
      }
    });
  }

  using Carrier = detail::CarrierElement<Scalar, Element>;
  using Vertex = detail::BoundVertex<Scalar, Element::edge_nodes>;
  using Motion = detail::ElementMotion<Scalar, Element>;

  std::vector<Vertex> vertices_;
  std::vector<Carrier> elements_;  // those that carry a vertex, in the order in which vertices name them
  std::vector<Motion> motions_;    // one a carrier, filled anew by each update
  std::vector<Index> outside_vertices_;
  double largest_distance_ = 0;
  std::int64_t boxes_visited_ = 0;
  Index mesh_vertices_ = 0;
  Index replaced_normals_ = 0;
  bool has_normals_ = false;
};

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <std::floating_point Scalar, TetrahedralElement Element>
Result<EmbeddedSurface<Scalar, Element>> EmbeddedSurface<Scalar, Element>::bind(
    const Mesh& mesh, std::span<const Vec3<double>> rest_positions, std::span<const Vec3<double>> rest_normals,
    ExecutorRef executor) {
  if (Result<void> status = detail::check_surface(mesh, rest_positions, rest_normals); !status) return status.error();
  const Index count = size_of(rest_positions);
  const BoxTree tree = detail::element_tree(mesh);
  const double rounding = detail::position_rounding<Scalar>(tree.bounds());
  std::vector<detail::BoundPoint> points(at(count));
  for_ranges(executor, count, Index{64}, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v)
      points[at(v)] = detail::bind_point(mesh, tree, rounding, rest_positions[at(v)] - mesh.origin());
  });

  EmbeddedSurface surface;
  surface.has_normals_ = !rest_normals.empty();
  surface.mesh_vertices_ = mesh.vertex_count();
  const auto normals = detail::unit_normals(rest_normals, surface.replaced_normals_);
  std::vector<Index> slot_of(at(mesh.element_count()), unused);
  surface.vertices_.reserve(at(count));
  for (Index v = 0; v < count; ++v) {
    const detail::BoundPoint& point = points[at(v)];
    Index& slot = slot_of[at(point.element)];
    if (slot == unused) {
      slot = size_of(surface.elements_);
      surface.elements_.emplace_back(mesh, point.element);
    }
    const Vec3<double> normal = surface.has_normals_ ? normals[at(v)] : Vec3<double>(Vec3<double>::Zero());
    if (!surface.vertices_.emplace_back(mesh, point, slot, normal).is_finite())
      return Error{ErrorCode::non_finite_value, "surface vertex " + std::to_string(v),
                   "it is too far from so small an element for this precision"};
    surface.boxes_visited_ += point.visited;
    if (point.distance > 0) {
      surface.outside_vertices_.push_back(v);
      surface.largest_distance_ = (std::max)(surface.largest_distance_, point.distance);
    }
  }
  surface.motions_.resize(surface.elements_.size());
  return surface;
}

template <std::floating_point Scalar, TetrahedralElement Element>
Result<EmbeddedSurface<Scalar, Element>> EmbeddedSurface<Scalar, Element>::bind(const Mesh& mesh,
                                                                                const SurfaceMesh& surface,
                                                                                ExecutorRef executor) {
  if (Result<void> status = detail::check_triangles(surface); !status) return status.error();
  if (!surface.normals.empty() || surface.triangles.empty())
    return bind(mesh, surface.positions, surface.normals, executor);
  if (Result<void> status = detail::check_surface(mesh, surface.positions, {}); !status) return status.error();
  return bind(mesh, surface.positions, vertex_normals(surface), executor);
}

template <std::floating_point Scalar, TetrahedralElement Element>
void EmbeddedSurface<Scalar, Element>::update(std::span<const Vec3<Scalar>> u, const VertexBuffer& out,
                                              ExecutorRef executor) {
  COROTET_ASSERT(out.data != nullptr && out.count == vertex_count(), "the buffer needs one vertex per bound vertex");
  COROTET_ASSERT(out.fits(out.position_offset) && out.fits(out.normal_offset), "an attribute exceeds the stride");
  const detail::Wide<Scalar> translation = detail::widen<Scalar>(out.translation.template cast<Scalar>());
  const auto position = [&](Index v, const detail::Wide<Scalar>& x) {
    detail::store<Scalar>(out.data + at(v) * out.stride + out.position_offset, x + translation);
  };
  const auto normal = [&](Index v, const detail::Wide<Scalar>& n) {
    detail::store<Scalar>(out.data + at(v) * out.stride + out.normal_offset, n);
  };
  const bool with_positions = out.position_offset != VertexBuffer::none;
  const bool with_normals = out.normal_offset != VertexBuffer::none;
  if (with_positions && with_normals)
    deform<true>(u, executor, position, normal);
  else if (with_positions)
    deform<false>(u, executor, position, nothing);
  else if (with_normals)
    deform<true>(u, executor, nothing, normal);
}

template <std::floating_point Scalar, TetrahedralElement Element>
void EmbeddedSurface<Scalar, Element>::positions(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out) {
  COROTET_ASSERT(size_of(out) == vertex_count(), "out needs one entry per bound vertex");
  const auto write = [&](Index v, const detail::Wide<Scalar>& x) { out[at(v)] = x.template head<3>(); };
  deform<false>(u, {}, write, nothing);
}

template <std::floating_point Scalar, TetrahedralElement Element>
void EmbeddedSurface<Scalar, Element>::normals(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out) {
  COROTET_ASSERT(size_of(out) == vertex_count(), "out needs one entry per bound vertex");
  const auto write = [&](Index v, const detail::Wide<Scalar>& n) { out[at(v)] = n.template head<3>(); };
  deform<true>(u, {}, nothing, write);
}

COROTET_INSTANCES_OF_ELEMENT(EmbeddedSurface)

}  // namespace corotet::inline v0_1
