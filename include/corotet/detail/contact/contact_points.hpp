// The points of a body by which it touches.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/embed/body_point.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstddef>
#include <vector>

namespace corotet::inline v0_1 {

/// Points that move with a body, each carried by some of its vertices: those of the boundary, or of an EmbeddedSurface.
///
/// Take the vertices of the boundary for a mesh that is as fine as its surface, and an embedded surface for a coarse
/// mesh under a detailed one. Where obstacles have edges or are small, points must lie closer than these are wide.
/// @snippet contact.cpp contact
class ContactPoints {
 public:
  ContactPoints() = default;

  /// The vertices of the boundary, ascending. Errors: those of extract_boundary.
  template <std::floating_point Scalar, TetrahedralElement Element>
  [[nodiscard]] COROTET_COLD static Result<ContactPoints> boundary(const TetMesh<Scalar, Element>& mesh) {
    const auto surface = extract_boundary(mesh);
    if (!surface) return surface.error();
    std::vector<bool> outside(at(mesh.vertex_count()), false);
    for (const auto& triangle : surface->triangles)
      for (const Index v : triangle) outside[at(v)] = true;
    ContactPoints points;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (outside[at(v)]) points.add(v, mesh.position(v).template cast<double>());
    return points;
  }

  /// The vertices of a surface that is bound to the body's mesh.
  template <std::floating_point Scalar, TetrahedralElement Element>
  COROTET_COLD ContactPoints(const EmbeddedSurface<Scalar, Element>& surface, const TetMesh<Scalar, Element>& mesh) {
    for (Index v = 0; v < surface.vertex_count(); ++v) add(surface.body_point(v), mesh);
  }

  /// Adds one point of the mesh, such as a PointLocator finds.
  template <std::floating_point Scalar, TetrahedralElement Element>
  COROTET_COLD void add(const BodyPoint<Element>& point, const TetMesh<Scalar, Element>& mesh) {
    for (std::size_t a = 0; a < point.vertices.size(); ++a)
      if (std::fabs(point.weights[a]) > negligible) {
        vertex_.push_back(point.vertices[a]);
        weight_.push_back(point.weights[a]);
      }
    double sum = 0;
    for (const double w : point.weights) sum += std::fabs(w);
    amplification_ = (std::max)(amplification_, sum);
    end_.push_back(size_of(vertex_));
    box_.add(point.interpolate([&](Index v) { return mesh.position(v); }));
    vertices_ = (std::max)(vertices_, mesh.vertex_count());
  }

  /// Number of points.
  [[nodiscard]] Index size() const { return size_of(end_); }
  /// One more than the largest vertex that carries a point.
  [[nodiscard]] Index vertex_count() const { return vertices_; }
  /// The longest edge of the box around all points at rest, m.
  [[nodiscard]] double extent() const { return size() == 0 ? 0 : (box_.high - box_.low).maxCoeff(); }

  /// The largest sum of a point's weights, without their signs: how many times farther than any vertex a point moves.
  [[nodiscard]] double amplification() const { return amplification_; }

  /// Vertices that carry point p: entries first(p) ... last(p) - 1 of the two functions below.
  [[nodiscard]] Index first(Index p) const { return p == 0 ? 0 : end_[at(p - 1)]; }
  /// Behind the last entry of a point.
  [[nodiscard]] Index last(Index p) const { return end_[at(p)]; }
  /// The vertex of an entry.
  [[nodiscard]] Index vertex(Index entry) const { return vertex_[at(entry)]; }
  /// Its share in the point's motion. Shares of a point sum to 1.
  [[nodiscard]] double weight(Index entry) const { return weight_[at(entry)]; }

  /// The value of a field of vectors at point p, `field(vertex)`, summed in double.
  template <std::invocable<Index> FieldValue>
  [[nodiscard]] Vec3<double> interpolate(Index p, const FieldValue& field) const {
    Vec3<double> sum = Vec3<double>::Zero();
    for (Index e = first(p); e < last(p); ++e) sum += weight(e) * field(vertex(e)).template cast<double>();
    return sum;
  }

 private:
  static constexpr double negligible = 1e-12;  // weight

  void add(Index vertex, const Vec3<double>& position) {
    vertex_.push_back(vertex);
    weight_.push_back(1);
    end_.push_back(size_of(vertex_));
    box_.add(position);
    vertices_ = (std::max)(vertices_, vertex + 1);
  }

  std::vector<Index> vertex_, end_;
  std::vector<double> weight_;
  Box box_;
  Index vertices_ = 0;
  double amplification_ = 1;
};

}  // namespace corotet::inline v0_1
