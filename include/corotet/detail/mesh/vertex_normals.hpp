// Normals of a triangle surface: of its faces and, weighted by angle, of its vertices.
#pragma once

#include <array>
#include <cmath>
#include <corotet/detail/core/elementary.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/coinciding.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <vector>

namespace corotet::inline v0_1 {

namespace detail {

/// Unit normal of a triangle (counter-clockwise seen from its tip); zero where the triangle has no area.
[[nodiscard]] inline Vec3<double> triangle_normal(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  const Vec3<double> n = (b - a).cross(c - a);
  const double length = n.stableNorm();  // its square would leave the range from triangles of 1e77 m on
  return length > 0 ? n / length : Vec3<double>::Zero();
}

/// A sum of unit vectors times weights, and the sum of the weights.
struct WeightedNormal {
  Vec3<double> sum = Vec3<double>::Zero();
  double weight = 0;

  void add(const WeightedNormal& other) {
    sum += other.sum;
    weight += other.weight;
  }
  /// Unit length; zero where nothing but rounding is left of the sum.
  [[nodiscard]] Vec3<double> direction() const {
    constexpr double rounding = 1e-6;  // of coordinates in float
    const double length = sum.norm();
    return length > rounding * weight ? sum / length : Vec3<double>::Zero();
  }
};

/// One a vertex: the normals of its triangles, weighted by their angles at the vertex, rad.
inline std::vector<WeightedNormal> angle_weighted_normals(const SurfaceMesh& surface) {
  std::vector<WeightedNormal> normals(surface.positions.size());
  for (const std::array<Index, 3>& t : surface.triangles) {
    const Vec3<double> n =
        triangle_normal(surface.positions[at(t[0])], surface.positions[at(t[1])], surface.positions[at(t[2])]);
    if (n.isZero()) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3<double>& x = surface.positions[at(t[i])];
      const Vec3<double> e = surface.positions[at(t[(i + 1) % 3])] - x, f = surface.positions[at(t[(i + 2) % 3])] - x;
      const double angle = arc_tangent(e.cross(f).stableNorm(), e.dot(f));
      normals[at(t[i])].add({angle * n, angle});
    }
  }
  return normals;
}

}  // namespace detail

/// One unit normal a vertex: face normals weighted by the angle of the face at the vertex, which depends on the shape
/// alone and not on how it is cut into triangles (Thürmer & Wüthrich 1998). Zero for a vertex in no triangle with area.
/// Each vertex has the normal of its own triangles: where vertices are divided along an edge, the edge is sharp.
/// Indices must be in range.
[[nodiscard]] inline std::vector<Vec3<double>> vertex_normals(const SurfaceMesh& surface) {
  std::vector<Vec3<double>> normals;
  normals.reserve(surface.positions.size());
  for (const detail::WeightedNormal& n : detail::angle_weighted_normals(surface)) {
    const double length = n.sum.norm();
    normals.push_back(length > 0 ? n.sum / length : Vec3<double>::Zero());
  }
  return normals;
}

/// The same with one normal for all vertices at exactly the same place, those of the triangles of all of them: a
/// surface that is divided there for its texture coordinates, or into single triangles, is shaded as if it were not.
/// Where these normals cancel, as they do on a sheet that has triangles on both sides, the copies of each side share
/// one. Zero for a vertex in no triangle with area, and for one that belongs to both sides of a sheet.
/// Positions must be finite, and indices in range.
[[nodiscard]] inline std::vector<Vec3<double>> seamless_normals(const SurfaceMesh& surface) {
  const std::vector<detail::WeightedNormal> own = detail::angle_weighted_normals(surface);
  const std::vector<Index> first = detail::first_coinciding(surface.positions);
  struct Place {
    detail::WeightedNormal all, front, back;
    Vec3<double> direction = Vec3<double>::Zero();  // of the first copy that has one: it faces the front
  };
  std::vector<Place> places(own.size());  // at the first vertex of each
  const auto is_in_front = [&](const Place& place, std::size_t v) { return place.direction.dot(own[v].sum) > 0; };
  for (std::size_t v = 0; v < own.size(); ++v) {
    Place& place = places[at(first[v])];
    if (place.direction.isZero()) place.direction = own[v].direction();
    place.all.add(own[v]);
    (is_in_front(place, v) ? place.front : place.back).add(own[v]);
  }
  std::vector<Vec3<double>> normals;
  normals.reserve(own.size());
  for (std::size_t v = 0; v < own.size(); ++v) {
    const Place& place = places[at(first[v])];
    const Vec3<double> all = place.all.direction(),
                       side = (is_in_front(place, v) ? place.front : place.back).direction();
    if (!all.isZero())
      normals.push_back(all);
    else
      normals.push_back(side.dot(own[v].sum) > 0 ? side : own[v].direction());
  }
  return normals;
}

}  // namespace corotet::inline v0_1
