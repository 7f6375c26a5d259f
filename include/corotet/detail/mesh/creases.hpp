// Vertices divided along sharp edges, so that a surface can be shaded smoothly between them.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/vertex_normals.hpp>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// A surface with one normal a vertex: a vertex on a sharp edge is there once for each smooth part of the surface.
struct CreasedSurface {
  std::vector<Index> source;                    ///< the vertex of the original surface
  std::vector<std::array<Index, 3>> triangles;  ///< over `source`, in the original order
};

/// Cosine of the angle between the normals of two triangles from which on their common edge is sharp: 60 degrees.
inline constexpr double crease_cosine = 0.5;

/// Divides the vertices. An edge is smooth where exactly two triangles meet in it at less than the crease angle.
/// Indices must be in range, and 3 x the number of triangles must be an Index.
inline CreasedSurface split_at_creases(const Field<double>& positions,
                                       const std::vector<std::array<Index, 3>>& triangles) {
  struct EdgeUse {
    Index low, high, low_corner, high_corner;  // a corner is 3 x triangle + place
  };
  std::vector<EdgeUse> uses;
  Field<double> normals;
  uses.reserve(3 * triangles.size());
  normals.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::array<Index, 3>& v = triangles[t];
    normals.push_back(triangle_normal(positions[at(v[0])], positions[at(v[1])], positions[at(v[2])]));
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      EdgeUse use{v[i], v[j], static_cast<Index>(3 * t + i), static_cast<Index>(3 * t + j)};
      if (use.low > use.high) use = {use.high, use.low, use.high_corner, use.low_corner};
      uses.push_back(use);
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.low_corner) < std::tie(b.low, b.high, b.low_corner);
  });

  // Corners that belong to one vertex of the result, as a forest whose roots stand for them.
  std::vector<Index> parent(3 * triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index corner) {
    while (parent[at(corner)] != corner) {
      parent[at(corner)] = parent[at(parent[at(corner)])];
      corner = parent[at(corner)];
    }
    return corner;
  };
  const auto unite = [&](Index a, Index b) {
    const std::pair<Index, Index> ends = std::minmax({root(a), root(b)});
    parent[at(ends.second)] = ends.first;
  };
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].low == uses[begin].low && uses[end].high == uses[begin].high) ++end;
    if (end - begin != 2) continue;
    const EdgeUse &a = uses[begin], &b = uses[begin + 1];
    const Vec3<double>& n = normals[at(a.low_corner / 3)];
    const Vec3<double>& m = normals[at(b.low_corner / 3)];
    const bool have_area = n.squaredNorm() > 0 && m.squaredNorm() > 0;
    if (have_area && n.dot(m) < crease_cosine) continue;
    unite(a.low_corner, b.low_corner);
    unite(a.high_corner, b.high_corner);
  }

  CreasedSurface result;
  result.triangles.resize(triangles.size());
  std::vector<Index> number(parent.size(), -1);
  for (std::size_t c = 0; c < parent.size(); ++c) {
    Index& own = number[at(root(static_cast<Index>(c)))];
    if (own < 0) {
      own = size_of(result.source);
      result.source.push_back(triangles[c / 3][c % 3]);
    }
    result.triangles[c / 3][c % 3] = own;
  }
  return result;
}

}  // namespace corotet::inline v0_1::detail
