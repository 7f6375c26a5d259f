// A surface that moves with the volume around it: bound once, written every frame.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/instances.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/shared.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/embed/bind.hpp>
#include <corotet/detail/embed/body_point.hpp>
#include <corotet/detail/embed/deform.hpp>
#include <corotet/detail/embed/vertex_buffer.hpp>
#include <corotet/detail/mesh/check_connectivity.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// A detailed surface that moves with a body, written into a vertex buffer: positions and normals.
///
/// Use it for what is drawn, so that the mesh may be coarse. The boundary of the mesh itself is extract_boundary;
/// single points are PointLocator.
/// @snippet files.cpp surface
/// Each vertex is bound to a point of the mesh, which is not needed after that. Laws: an affine motion x = A X + b of
/// the mesh moves every vertex by the same map and turns normals by cof(A), vertices outside the mesh included; results
/// are the same bits on any executor; an update allocates nothing.
///
/// Positions are written relative to the mesh's origin() (an engine puts that into its model matrix), so they keep
/// float precision wherever the body is.
///
/// The binding is constant and shared: a copy is another scratch on the same binding. One copy for each body of a mesh
/// lets threads update all bodies at once. A surface that is const serves several threads with a Scratch each.
template <std::floating_point Scalar, TetrahedralElement Element = Tet4>
class EmbeddedSurface {
  using Motion = detail::ElementMotion<Scalar, Element>;

 public:
  using Mesh = TetMesh<Scalar, Element>;  ///< of the body

  /// The motions of the carrying elements: written by each update before it reads them.
  class Scratch {
   public:
    /// Bytes.
    [[nodiscard]] std::size_t memory() const { return detail::bytes_of(motions_); }

   private:
    friend class EmbeddedSurface;
    explicit Scratch(std::size_t carriers) : motions_(carriers) {}

    detail::Scratch<Motion> motions_;
  };

  /// Binds vertices with the given rest positions (m, in the coordinates given to TetMesh::create) and rest normals
  /// (one a vertex, any length; or none). A vertex outside the mesh goes to the nearest element, is counted, and
  /// follows the linear extension of the motion at the nearest point. Errors: non_finite_value (names the vertex; also
  /// one farther from the mesh's origin than 1e100 m, in float 1e30 m), invalid_argument (number of normals),
  /// unsupported (too many).
  [[nodiscard]] static Result<EmbeddedSurface> bind(const Mesh& mesh, std::span<const Vec3<double>> rest_positions,
                                                    std::span<const Vec3<double>> rest_normals = {},
                                                    ExecutorRef executor = {});

  /// The same for a triangle surface. Where it has no normals, its vertices get those of `seamless_normals`: vertices
  /// at exactly the same place have one. For sharp edges, give normals; `vertex_normals` keeps divided edges sharp.
  /// Further errors: index_out_of_range (names the triangle).
  [[nodiscard]] static Result<EmbeddedSurface> bind(const Mesh& mesh, const SurfaceMesh& surface,
                                                    ExecutorRef executor = {});

  /// For const updates of this surface and its copies.
  [[nodiscard]] Scratch make_scratch() const { return Scratch(binding_->elements.size()); }

  /// Writes positions and normals that belong to the displacements `u` (m, one a mesh vertex, relative to its rest
  /// position) into `out`. A normal that the motion makes undefined (the body crushed to a line or a point there) is
  /// written as the rest normal. `out` must have one vertex for each bound vertex; normals need bound normals.
  void update(std::span<const Vec3<Scalar>> u, const VertexBuffer& out, ExecutorRef executor = {}) {
    update(u, out, scratch_, executor);
  }
  /// The same, with scratch of the caller's: one surface may then serve several threads at once.
  void update(std::span<const Vec3<Scalar>> u, const VertexBuffer& out, Scratch& scratch,
              ExecutorRef executor = {}) const;

  /// Positions alone, m, relative to the mesh's origin: one a bound vertex.
  void positions(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out) { positions(u, out, scratch_); }
  /// The same, with scratch of the caller's.
  void positions(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out, Scratch& scratch,
                 ExecutorRef executor = {}) const;

  /// Unit normals alone.
  void normals(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out) { normals(u, out, scratch_); }
  /// The same, with scratch of the caller's.
  void normals(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out, Scratch& scratch,
               ExecutorRef executor = {}) const;

  /// Number of vertices of the surface.
  [[nodiscard]] Index vertex_count() const { return size_of(binding_->vertices); }
  /// Whether it computes normals.
  [[nodiscard]] bool has_normals() const { return binding_->has_normals; }

  /// The scratch is owned, the binding shared.
  [[nodiscard]] MemoryUse memory() const { return {scratch_.memory(), binding_->bytes()}; }
  /// Whether both are copies of one.
  [[nodiscard]] bool shares_binding(const EmbeddedSurface& other) const { return &*binding_ == &*other.binding_; }

  /// The mesh vertices that carry bound vertex `v`.
  [[nodiscard]] const std::array<Index, Element::nodes>& carriers(Index v) const {
    return binding_->elements[at(binding_->vertices[at(v)].slot)].nodes;
  }
  /// Their weights w_a, which sum to 1: the vertex moves by sum_a w_a u_a. For passing forces on the surface to the
  /// mesh.
  [[nodiscard]] std::array<double, Element::nodes> weights(Index v) const {
    return binding_->vertices[at(v)].template weights<Element>();
  }

  /// Both: for forces and velocities at the vertex, see point_on_body.hpp.
  [[nodiscard]] BodyPoint<Element> body_point(Index v) const { return {carriers(v), weights(v)}; }

  /// Bound vertices outside the mesh by more than its rounding: how many, which, and the farthest of them, m.
  [[nodiscard]] Index outside_count() const { return size_of(binding_->outside_vertices); }
  /// The vertices that outside_count() counts.
  [[nodiscard]] const std::vector<Index>& outside_vertices() const { return binding_->outside_vertices; }
  /// The largest distance of one of these from the mesh, m; 0 if there is none.
  [[nodiscard]] double max_distance() const { return binding_->max_distance; }

  /// How many rest normals had no direction and were replaced by +z.
  [[nodiscard]] Index replaced_normals() const { return binding_->replaced_normals; }

  /// What binding cost: boxes looked at, over all vertices. Grows as vertices times log(elements).
  [[nodiscard]] std::int64_t boxes_visited() const { return binding_->boxes_visited; }

 private:
  using Carrier = detail::CarrierElement<Scalar, Element>;
  using Vertex = detail::BoundVertex<Scalar, Element::edge_nodes>;

  static constexpr Index unused = -1;
  static constexpr Index element_grain = 256, vertex_grain = 1024;

  struct Binding {
    std::vector<Vertex> vertices;
    std::vector<Carrier> elements;  // those that carry a vertex, in the order in which vertices name them
    std::vector<Index> outside_vertices;
    double max_distance = 0;
    std::int64_t boxes_visited = 0;
    Index mesh_vertices = 0;
    Index replaced_normals = 0;
    bool has_normals = false;

    [[nodiscard]] std::size_t bytes() const {
      return sizeof(Binding) + detail::bytes_of(vertices) + detail::bytes_of(elements) +
             detail::bytes_of(outside_vertices);
    }
  };

  explicit EmbeddedSurface(detail::Shared<Binding> binding)
      : binding_(std::move(binding)), scratch_(binding_->elements.size()) {}

  static constexpr auto nothing = [](Index, const detail::Wide<Scalar>&) {};

  /// Sets the motion of each carrier, then hands each vertex's position and normal to the writers.
  template <bool with_normals, class WritePosition, class WriteNormal>
  void deform(std::span<const Vec3<Scalar>> u, Scratch& scratch, ExecutorRef executor,
              const WritePosition& write_position, const WriteNormal& write_normal) const {
    const Binding& binding = *binding_;
    COROTET_ASSERT(size_of(u) == binding.mesh_vertices, "displacements need one entry per mesh vertex");
    COROTET_ASSERT(!with_normals || binding.has_normals, "normals were not given when binding");
    COROTET_ASSERT(scratch.motions_.size() == binding.elements.size(), "the scratch belongs to another surface");
    for_ranges(executor, size_of(binding.elements), element_grain, [&](Index begin, Index end) {
      for (Index e = begin; e < end; ++e)
        scratch.motions_[at(e)].template set<with_normals>(binding.elements[at(e)], u.data());
    });
    for_ranges(executor, vertex_count(), vertex_grain, [&](Index begin, Index end) {
      // Copies here: what is written as bytes might change anything that lies elsewhere.
      const Carrier* const elements = binding.elements.data();
      const Vertex* const vertices = binding.vertices.data();
      const Motion* const motions = scratch.motions_.data();
      const WritePosition position = write_position;
      const WriteNormal normal = write_normal;
      for (Index v = begin; v < end; ++v) {
        const Vertex& vertex = vertices[v];
        detail::Wide<Scalar> x, n;
        motions[vertex.slot].template evaluate<with_normals>(vertex, elements[vertex.slot], x, n);
        position(v, x);
        if constexpr (with_normals) normal(v, n);
      }
    });
  }

  /// By the attributes that `out` has.
  template <class WritePosition, class WriteNormal>
  void deform_into(std::span<const Vec3<Scalar>> u, const VertexBuffer& out, Scratch& scratch, ExecutorRef executor,
                   const WritePosition& position, const WriteNormal& normal) const {
    const bool with_positions = out.position_offset != VertexBuffer::none;
    const bool with_normals = out.normal_offset != VertexBuffer::none;
    if (with_positions && with_normals)
      deform<true>(u, scratch, executor, position, normal);
    else if (with_positions)
      deform<false>(u, scratch, executor, position, nothing);
    else if (with_normals)
      deform<true>(u, scratch, executor, nothing, normal);
  }

  detail::Shared<Binding> binding_;
  Scratch scratch_;
};

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <std::floating_point Scalar, TetrahedralElement Element>
Result<EmbeddedSurface<Scalar, Element>> EmbeddedSurface<Scalar, Element>::bind(
    const Mesh& mesh, std::span<const Vec3<double>> rest_positions, std::span<const Vec3<double>> rest_normals,
    ExecutorRef executor) {
  if (Result<void> status = detail::check_surface(mesh, rest_positions, rest_normals); !status) return status.error();
  const Index count = size_of(rest_positions);
  const detail::BoxTree tree = detail::element_tree(mesh);
  const double rounding = detail::position_rounding<Scalar>(tree.bounds());
  std::vector<detail::BoundPoint> points(at(count));
  for_ranges(executor, count, Index{64}, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v)
      points[at(v)] = detail::bind_point(mesh, tree, rounding, rest_positions[at(v)] - mesh.origin());
  });

  Binding binding;
  binding.has_normals = !rest_normals.empty();
  binding.mesh_vertices = mesh.vertex_count();
  const auto normals = detail::unit_normals(rest_normals, binding.replaced_normals);
  std::vector<Index> slot_of(at(mesh.element_count()), unused);
  binding.vertices.reserve(at(count));
  for (Index v = 0; v < count; ++v) {
    const detail::BoundPoint& point = points[at(v)];
    Index& slot = slot_of[at(point.element)];
    if (slot == unused) {
      slot = size_of(binding.elements);
      binding.elements.emplace_back(mesh, point.element);
    }
    const Vec3<double> normal = binding.has_normals ? normals[at(v)] : Vec3<double>(Vec3<double>::Zero());
    if (!binding.vertices.emplace_back(mesh, point, slot, normal).is_finite())
      return Error{ErrorCode::non_finite_value, "surface vertex " + std::to_string(v),
                   "it is too far from so small an element for this precision"};
    binding.boxes_visited += point.visited;
    if (point.distance > 0) {
      binding.outside_vertices.push_back(v);
      binding.max_distance = (std::max)(binding.max_distance, point.distance);
    }
  }
  binding.elements.shrink_to_fit();
  binding.outside_vertices.shrink_to_fit();
  return EmbeddedSurface(detail::Shared<Binding>::make(std::move(binding)));
}

template <std::floating_point Scalar, TetrahedralElement Element>
Result<EmbeddedSurface<Scalar, Element>> EmbeddedSurface<Scalar, Element>::bind(const Mesh& mesh,
                                                                                const SurfaceMesh& surface,
                                                                                ExecutorRef executor) {
  if (Result<void> status = detail::check_triangles(surface); !status) return status.error();
  if (!surface.normals.empty() || surface.triangles.empty())
    return bind(mesh, surface.positions, surface.normals, executor);
  if (Result<void> status = detail::check_surface(mesh, surface.positions, {}); !status) return status.error();
  return bind(mesh, surface.positions, seamless_normals(surface), executor);
}

template <std::floating_point Scalar, TetrahedralElement Element>
void EmbeddedSurface<Scalar, Element>::update(std::span<const Vec3<Scalar>> u, const VertexBuffer& out,
                                              Scratch& scratch, ExecutorRef executor) const {
  COROTET_ASSERT(out.data != nullptr && out.count == vertex_count(), "the buffer needs one vertex per bound vertex");
  COROTET_ASSERT(out.fits(out.position_offset) && out.fits(out.normal_offset), "an attribute exceeds the stride");
  COROTET_ASSERT(out.conversion.is_valid(), "a conversion needs three different axes and a scale > 0");
  using Wide = detail::Wide<Scalar>;
  const auto start_of = [&out](std::size_t offset) { return out.data + (offset == VertexBuffer::none ? 0 : offset); };
  std::byte *const first_position = start_of(out.position_offset), *const first_normal = start_of(out.normal_offset);
  const std::size_t stride = out.stride;
  const Wide translation = detail::widen<Scalar>(out.translation.template cast<Scalar>());
  if (out.conversion.is_identity())
    return deform_into(
        u, out, scratch, executor,
        [=](Index v, const Wide& x) { detail::store<Scalar>(first_position + at(v) * stride, x + translation); },
        [=](Index v, const Wide& n) { detail::store<Scalar>(first_normal + at(v) * stride, n); });
  // One product of each sum is not zero: converted numbers are rounded once.
  const Mat3<double> matrix = out.conversion.matrix();
  const auto map = detail::widen_columns<Scalar>(matrix.template cast<Scalar>());
  const auto turn = detail::widen_columns<Scalar>((matrix / out.conversion.scale).template cast<Scalar>());
  deform_into(
      u, out, scratch, executor,
      [=](Index v, const Wide& x) {
        const Vec3<Scalar> moved = (x + translation).template head<3>();
        detail::store<Scalar>(first_position + at(v) * stride, detail::multiply<Scalar>(map, moved));
      },
      [=](Index v, const Wide& n) {
        detail::store<Scalar>(first_normal + at(v) * stride, detail::multiply<Scalar>(turn, n.template head<3>()));
      });
}

template <std::floating_point Scalar, TetrahedralElement Element>
void EmbeddedSurface<Scalar, Element>::positions(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out,
                                                 Scratch& scratch, ExecutorRef executor) const {
  COROTET_ASSERT(size_of(out) == vertex_count(), "out needs one entry per bound vertex");
  const auto write = [&](Index v, const detail::Wide<Scalar>& x) { out[at(v)] = x.template head<3>(); };
  deform<false>(u, scratch, executor, write, nothing);
}

template <std::floating_point Scalar, TetrahedralElement Element>
void EmbeddedSurface<Scalar, Element>::normals(std::span<const Vec3<Scalar>> u, std::span<Vec3<Scalar>> out,
                                               Scratch& scratch, ExecutorRef executor) const {
  COROTET_ASSERT(size_of(out) == vertex_count(), "out needs one entry per bound vertex");
  const auto write = [&](Index v, const detail::Wide<Scalar>& n) { out[at(v)] = n.template head<3>(); };
  deform<true>(u, scratch, executor, nothing, write);
}

COROTET_INSTANCES_OF_ELEMENT(EmbeddedSurface)

}  // namespace corotet::inline v0_1
