// The point of a segment, a triangle or a tetrahedron that is nearest to a given point.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>

namespace corotet::inline v0_1::detail {

/// A point of a simplex with N corners: barycentric coordinates in [0, 1] that sum to 1, exactly 0 for a corner that
/// plays no part (so that a face, an edge and a corner can be told apart).
template <std::size_t N>
struct SimplexPoint {
  std::array<double, N> barycentric{};
  Vec3<double> point = Vec3<double>::Zero();  ///< m
  double squared_distance = 0;                ///< m^2
};

/// On the segment a b; coinciding ends are fine.
[[nodiscard]] inline SimplexPoint<2> closest_on_segment(const Vec3<double>& a, const Vec3<double>& b,
                                                        const Vec3<double>& p) {
  const Vec3<double> ab = b - a;
  const double length2 = ab.squaredNorm(), along = ab.dot(p - a);
  SimplexPoint<2> out;
  if (!(along > 0) || !(length2 > 0)) {
    out = {{1, 0}, a, 0};
  } else if (along >= length2) {
    out = {{0, 1}, b, 0};
  } else {
    const double t = along / length2;
    out = {{1 - t, t}, a + t * ab, 0};
  }
  out.squared_distance = (p - out.point).squaredNorm();
  return out;
}

/// On the triangle a b c; a triangle without area is treated as its edges.
[[nodiscard]] inline SimplexPoint<3> closest_on_triangle(const Vec3<double>& a, const Vec3<double>& b,
                                                         const Vec3<double>& c, const Vec3<double>& p) {
  const std::array<Vec3<double>, 3> x{a, b, c};
  const Vec3<double> n = (b - a).cross(c - a);
  const double n2 = n.squaredNorm();
  if (n2 > 0) {
    std::array<double, 3> l;  // signed areas of the parts opposite each corner, seen along the normal
    for (std::size_t i = 0; i < 3; ++i) l[i] = (x[(i + 2) % 3] - x[(i + 1) % 3]).cross(p - x[(i + 1) % 3]).dot(n) / n2;
    if (l[0] > 0 && l[1] > 0 && l[2] > 0) {
      const Vec3<double> q = l[0] * a + l[1] * b + l[2] * c;
      // Measured along the normal: less rounding than from q.
      const double height = n.dot(p - a);
      return {l, q, height * height / n2};
    }
  }
  SimplexPoint<3> best;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const SimplexPoint<2> edge = closest_on_segment(x[i], x[j], p);
    if (i > 0 && edge.squared_distance >= best.squared_distance) continue;
    best = {{}, edge.point, edge.squared_distance};
    best.barycentric[i] = edge.barycentric[0];
    best.barycentric[j] = edge.barycentric[1];
  }
  return best;
}

/// In or on the tetrahedron; the distance of a point inside is 0. Any winding; one without volume is treated as its
/// faces.
[[nodiscard]] inline SimplexPoint<4> closest_on_tetrahedron(const std::array<Vec3<double>, 4>& x,
                                                            const Vec3<double>& p) {
  Mat3<double> edges;
  for (int j = 0; j < 3; ++j) edges.set_col(j, x[at(j + 1)] - x[0]);
  const Vec3<double> r = p - x[0];
  const double volume = edges.determinant();
  if (!is_zero(volume)) {
    const Vec3<double> l =
        Vec3<double>(r.dot(edges.col(1).cross(edges.col(2))), r.dot(edges.col(2).cross(edges.col(0))),
                     r.dot(edges.col(0).cross(edges.col(1)))) /
        volume;
    const double l0 = 1 - l.sum();
    if (l0 >= 0 && l.minCoeff() >= 0) return {{l0, l[0], l[1], l[2]}, p, 0};
  }
  SimplexPoint<4> best;
  for (std::size_t f = 0; f < 4; ++f) {
    const std::array<std::size_t, 3>& face = tet_faces[f];
    const SimplexPoint<3> q = closest_on_triangle(x[face[0]], x[face[1]], x[face[2]], p);
    if (f > 0 && q.squared_distance >= best.squared_distance) continue;
    best = {{}, q.point, q.squared_distance};
    for (std::size_t i = 0; i < 3; ++i) best.barycentric[face[i]] = q.barycentric[i];
  }
  return best;
}

}  // namespace corotet::inline v0_1::detail
