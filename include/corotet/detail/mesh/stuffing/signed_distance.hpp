// The signed distance to a closed triangle surface.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <corotet/detail/mesh/check_connectivity.hpp>
#include <corotet/detail/mesh/closest_point.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/mesh/vertex_normals.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Distance to a closed surface, m, negative inside. The sign is that of the angle-weighted pseudonormal of the nearest
/// vertex, edge or face (Bærentzen & Aanæs 2005): it comes with the distance from a single search and is exact on edges
/// and corners, where counting the crossings of a ray needs special cases.
class SignedDistance {
 public:
  /// Errors: empty_mesh, index_out_of_range, non_finite_value (also beyond 1e100 m); invalid_argument where an edge is
  /// not shared by exactly two triangles with opposite directions (an open surface, or vertices that coincide but are
  /// not merged), or where the surface encloses no volume.
  [[nodiscard]] static Result<SignedDistance> create(const SurfaceMesh& surface) {
    if (surface.triangles.empty()) return Error{ErrorCode::empty_mesh, "surface", "it has no triangles"};
    if (Result<void> status = check_positions(surface.positions, "surface vertex"); !status) return status.error();
    if (Result<void> status = check_triangles(surface); !status) return status.error();
    SignedDistance out;
    out.positions_ = surface.positions;
    out.triangles_ = surface.triangles;
    std::vector<Box> boxes;
    double volume = 0;
    const Vec3<double> centre = surface.positions[at(surface.triangles[0][0])];
    for (const auto& [a, b, c] : surface.triangles) {
      const Vec3<double>&x = surface.positions[at(a)], &y = surface.positions[at(b)], &z = surface.positions[at(c)];
      out.face_normals_.push_back(triangle_normal(x, y, z));
      volume += (x - centre).dot((y - centre).cross(z - centre)) / 6;
      Box& box = boxes.emplace_back();
      for (const Vec3<double>& p : {x, y, z}) box.add(p);
    }
    if (Result<void> status = out.add_edges(); !status) return status.error();
    if (is_zero(volume)) return Error{ErrorCode::invalid_argument, "surface", "it encloses no volume"};
    out.turn_ = volume < 0 ? -1 : 1;
    out.vertex_normals_ = vertex_normals(surface);
    out.tree_ = BoxTree(boxes);
    return out;
  }

  /// `p`: finite, of magnitude 1e120 at most.
  [[nodiscard]] double operator()(const Vec3<double>& p) const {
    COROTET_ASSERT(p.cwiseAbs().maxCoeff() <= 1e120, "the squared distance would overflow");
    SimplexPoint<3> nearest;
    const auto corner = [&](Index t, std::size_t i) -> const Vec3<double>& {
      return positions_[at(triangles_[at(t)][i])];
    };
    const NearestPrimitive found = tree_.nearest(p, [&](Index t) {
      const SimplexPoint<3> q = closest_on_triangle(corner(t, 0), corner(t, 1), corner(t, 2), p);
      if (q.squared_distance < nearest_or_infinite(nearest)) nearest = q;
      return q.squared_distance;
    });
    const double distance = detail::square_root(found.squared_distance);
    return turn_ * (p - nearest.point).dot(pseudonormal(found.primitive, nearest)) < 0 ? -distance : distance;
  }

  [[nodiscard]] Box bounds() const { return tree_.bounds(); }
  /// Whether the triangles were wound the wrong way round, clockwise seen from outside.
  [[nodiscard]] bool turned() const { return turn_ < 0; }

 private:
  SignedDistance() = default;

  static double nearest_or_infinite(const SimplexPoint<3>& q) {
    const bool unset = is_zero(q.barycentric[0] + q.barycentric[1] + q.barycentric[2]);
    return unset ? std::numeric_limits<double>::infinity() : q.squared_distance;
  }

  /// Of the face, edge or vertex on which `q` lies; any length.
  [[nodiscard]] const Vec3<double>& pseudonormal(Index t, const SimplexPoint<3>& q) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      if (is_zero(q.barycentric[j]) && is_zero(q.barycentric[k])) return vertex_normals_[at(triangles_[at(t)][i])];
    }
    for (std::size_t i = 0; i < 3; ++i)
      if (is_zero(q.barycentric[(i + 2) % 3])) return edge_normals_[at(triangle_edges_[at(t)][i])];
    return face_normals_[at(t)];
  }

  /// Pairs up the two sides of each edge and sums their normals. Edge i of a triangle runs from its corner i to the
  /// next.
  Result<void> add_edges() {
    struct Side {
      std::pair<Index, Index> ends;
      Index triangle;
      std::size_t edge;
      bool ascending;
    };
    std::vector<Side> sides;
    for (Index t = 0; t < size_of(triangles_); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const Index a = triangles_[at(t)][i], b = triangles_[at(t)][(i + 1) % 3];
        if (a == b)
          return Error{ErrorCode::invalid_argument, "triangle " + std::to_string(t),
                       "it names vertex " + std::to_string(a) + " twice"};
        sides.push_back({std::minmax(a, b), t, i, a < b});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& p, const Side& q) {
      return p.ends != q.ends ? p.ends < q.ends : p.triangle < q.triangle;
    });
    triangle_edges_.resize(triangles_.size());
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
      while (end < sides.size() && sides[end].ends == sides[begin].ends) ++end;
      const Side& side = sides[begin];
      const std::string edge = "edge " + std::to_string(side.ends.first) + "-" + std::to_string(side.ends.second);
      if (end - begin != 2)
        return Error{ErrorCode::invalid_argument, edge,
                     "it belongs to " + std::to_string(end - begin) +
                         " triangles; a closed surface has two at each edge (are coinciding vertices merged?)"};
      const Side& other = sides[begin + 1];
      if (side.ascending == other.ascending)
        return Error{ErrorCode::invalid_argument, edge, "its two triangles are wound in opposite ways"};
      for (const Side& s : {side, other}) triangle_edges_[at(s.triangle)][s.edge] = size_of(edge_normals_);
      edge_normals_.push_back(face_normals_[at(side.triangle)] + face_normals_[at(other.triangle)]);
    }
    return {};
  }

  std::vector<Vec3<double>> positions_;
  std::vector<std::array<Index, 3>> triangles_;
  std::vector<std::array<Index, 3>> triangle_edges_;
  std::vector<Vec3<double>> face_normals_, edge_normals_, vertex_normals_;
  BoxTree tree_;
  int turn_ = 1;
};

}  // namespace corotet::inline v0_1::detail
