// The surface of a body by which it touches other bodies, and itself.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/contact/contact_points.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/index_list.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// Points that move with a body, and triangles between them: its boundary, or an EmbeddedSurface.
///
/// The same as ContactPoints, for contact with other bodies: there the triangles are what points touch.
class ContactSurface {
 public:
  /// The boundary of a mesh; a face of a 10-node mesh is four triangles. Errors: those of extract_boundary.
  template <std::floating_point Scalar, TetrahedralElement Element>
  [[nodiscard]] COROTET_COLD static Result<ContactSurface> boundary(const TetMesh<Scalar, Element>& mesh) {
    auto points = ContactPoints::boundary(mesh);
    if (!points) return points.error();
    const auto surface = extract_boundary(mesh);
    std::vector<Index> point_of(at(mesh.vertex_count()), 0);
    for (Index p = 0; p < points->size(); ++p) point_of[at(points->vertex(points->first(p)))] = p;
    std::vector<std::array<Index, 3>> triangles = surface->triangles;
    for (std::array<Index, 3>& triangle : triangles)
      for (Index& v : triangle) v = point_of[at(v)];
    return ContactSurface(std::move(*points), std::move(triangles));
  }

  /// A closed surface that is bound to the body's mesh: that of `surface`, from which `embedded` was made.
  template <std::floating_point Scalar, TetrahedralElement Element>
  COROTET_COLD ContactSurface(const EmbeddedSurface<Scalar, Element>& embedded, const SurfaceMesh& surface,
                              const TetMesh<Scalar, Element>& mesh)
      : ContactSurface(ContactPoints(embedded, mesh), surface.triangles) {
    COROTET_ASSERT(embedded.vertex_count() == size_of(surface.positions), "the surface is another one than is bound");
  }

  [[nodiscard]] const ContactPoints& points() const { return points_; }  ///< its corners
  /// Three points each, counter-clockwise seen from outside.
  [[nodiscard]] const std::vector<std::array<Index, 3>>& triangles() const { return triangles_; }
  /// Triangles with a corner at a point.
  [[nodiscard]] std::span<const Index> triangles_at(Index point) const {
    return {around_.data() + start_[at(point)], at(start_[at(point) + 1] - start_[at(point)])};
  }

 private:
  COROTET_COLD ContactSurface(ContactPoints points, std::vector<std::array<Index, 3>> triangles)
      : points_(std::move(points)), triangles_(std::move(triangles)) {
    std::vector<Index> corner;
    for (const auto& triangle : triangles_) corner.insert(corner.end(), triangle.begin(), triangle.end());
    detail::find_places(corner.data(), corner.size(), at(points_.size()), start_, around_);
    for (Index& place : around_) place /= 3;
  }

  ContactPoints points_;
  std::vector<std::array<Index, 3>> triangles_;
  std::vector<Index> start_, around_;  // triangles, by points
};

}  // namespace corotet::inline v0_1
