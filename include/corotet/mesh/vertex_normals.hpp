// Normals of a triangle surface: of its faces and, weighted by angle, of its vertices.
#pragma once

#include <cmath>
#include <corotet/core/elementary.hpp>
#include <corotet/core/types.hpp>
#include <corotet/mesh/surface_mesh.hpp>
#include <vector>

namespace corotet::inline v0_1 {

/// Unit normal of a triangle (counter-clockwise seen from its tip); zero where the triangle has no area.
[[nodiscard]] inline Vec3<double> triangle_normal(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  const Vec3<double> n = (b - a).cross(c - a);
  const double length = n.stableNorm();  // its square would leave the range from triangles of 1e77 m on
  return length > 0 ? n / length : Vec3<double>::Zero();
}

/// One unit normal a vertex: face normals weighted by the angle of the face at the vertex, which depends on the shape
/// alone and not on how it is cut into triangles (Thürmer & Wüthrich 1998). Zero for a vertex in no triangle with area.
/// Indices must be in range.
[[nodiscard]] inline std::vector<Vec3<double>> vertex_normals(const SurfaceMesh& surface) {
  std::vector<Vec3<double>> normals(surface.positions.size(), Vec3<double>::Zero());
  for (const std::array<Index, 3>& t : surface.triangles) {
    const Vec3<double> n =
        triangle_normal(surface.positions[at(t[0])], surface.positions[at(t[1])], surface.positions[at(t[2])]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3<double>& x = surface.positions[at(t[i])];
      const Vec3<double> e = surface.positions[at(t[(i + 1) % 3])] - x, f = surface.positions[at(t[(i + 2) % 3])] - x;
      normals[at(t[i])] += detail::arc_tangent(e.cross(f).stableNorm(), e.dot(f)) * n;
    }
  }
  for (Vec3<double>& n : normals) {
    const double length = n.norm();
    n = length > 0 ? n / length : Vec3<double>::Zero();
  }
  return normals;
}

}  // namespace corotet::inline v0_1
