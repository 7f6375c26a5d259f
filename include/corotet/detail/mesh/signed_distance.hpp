// The signed distance to a closed triangle surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/span_of.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/box.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <corotet/detail/mesh/check_connectivity.hpp>
#include <corotet/detail/mesh/closest_point.hpp>
#include <corotet/detail/mesh/coinciding.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/mesh/vertex_normals.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Which surfaces SignedDistance takes.
struct SignedDistanceOptions {
  bool merges_coinciding = false;  ///< vertices at exactly the same place are one, and triangles that vanish are none
  bool refuses_flat = false;       ///< triangles without area are an error
};

/// Distance to a closed surface, m, negative inside. The sign is that of the angle-weighted pseudonormal of the nearest
/// vertex, edge or face (Bærentzen & Aanæs 2005): it comes with the distance from a single search and is exact on edges
/// and corners, where counting the crossings of a ray needs special cases.
class SignedDistance {
 public:
  /// The distance of a point, m, and its gradient: a unit vector, outwards.
  struct Nearest {
    double distance;
    Vec3<double> normal;
  };

  /// Errors: empty_mesh, index_out_of_range, non_finite_value (also beyond 1e100 m); invalid_argument where an edge is
  /// not shared by exactly two triangles with opposite directions (an open surface, or vertices that coincide but are
  /// not merged), or where the surface encloses no volume; degenerate_element, if options ask for it.
  [[nodiscard]] COROTET_COLD static Result<SignedDistance> create(const SurfaceMesh& surface,
                                                                  const SignedDistanceOptions& options = {}) {
    if (surface.triangles.empty()) return Error{ErrorCode::empty_mesh, "surface", "it has no triangles"};
    if (Result<void> status = check_positions(span_of(surface.positions), "surface vertex"); !status)
      return status.error();
    if (Result<void> status = check_triangles(surface); !status) return status.error();
    SignedDistance out;
    out.surface_.positions = surface.positions;
    const std::vector<Index> number = out.take_triangles(surface, options.merges_coinciding);
    if (number.empty()) return Error{ErrorCode::invalid_argument, "surface", "it encloses no volume"};
    std::vector<Box> boxes;
    double volume = 0;
    const Vec3<double> centre = out.corner(0, 0);
    for (Index t = 0; t < size_of(out.surface_.triangles); ++t) {
      const Vec3<double>&x = out.corner(t, 0), &y = out.corner(t, 1), &z = out.corner(t, 2);
      if (options.refuses_flat && is_flat(x, y, z))
        return Error{ErrorCode::degenerate_element, "triangle " + std::to_string(number[at(t)]),
                     "it has no area, so that its inside is unknown"};
      out.face_normals_.push_back(triangle_normal(x, y, z));
      volume += (x - centre).dot((y - centre).cross(z - centre)) / 6;
      Box& box = boxes.emplace_back();
      for (const Vec3<double>& p : {x, y, z}) box.add(p);
    }
    if (Result<void> status = out.add_edges(number); !status) return status.error();
    if (is_zero(volume)) return Error{ErrorCode::invalid_argument, "surface", "it encloses no volume"};
    out.turn_ = volume < 0 ? -1 : 1;
    out.vertex_normals_ = vertex_normals(out.surface_);
    out.tree_ = BoxTree(boxes);
    const Box bounds = out.bounds();
    out.on_surface_ = direction_rounding * bounds.low.cwiseAbs().cwiseMax(bounds.high.cwiseAbs()).maxCoeff();
    return out;
  }

  /// `p`: finite, of magnitude 1e120 at most.
  [[nodiscard]] double operator()(const Vec3<double>& p) const {
    const Found found = find(p);
    return found.sign * found.distance;
  }
  /// The same with the normal, which on the surface is that of the face, edge or vertex there.
  [[nodiscard]] Nearest nearest(const Vec3<double>& p) const {
    const Found found = find(p);
    const double distance = found.sign * found.distance;
    const Vec3<double>& face = face_normals_[at(found.triangle)];
    if (found.pseudonormal == &face) return {distance, turn_ * face};
    if (found.distance > on_surface_) return {distance, (p - found.point) / distance};
    const double length = found.pseudonormal->norm();
    return {distance, length > 0 ? turn_ / length * *found.pseudonormal : turn_ * face};
  }

  [[nodiscard]] Box bounds() const { return tree_.bounds(); }
  /// Whether the triangles were wound the wrong way round, clockwise seen from outside.
  [[nodiscard]] bool turned() const { return turn_ < 0; }
  /// Positions and triangles, as they were wound.
  [[nodiscard]] const SurfaceMesh& surface() const { return surface_; }

 private:
  static constexpr double direction_rounding = 1e-10;  // of the largest coordinate: nearer points have no direction

  /// The nearest point, on that triangle.
  struct Found {
    Index triangle;
    Vec3<double> point;                // m
    const Vec3<double>* pseudonormal;  // of any length
    double distance;                   // m, >= 0
    int sign;
  };

  SignedDistance() = default;

  [[nodiscard]] const Vec3<double>& corner(Index t, std::size_t i) const {
    return surface_.positions[at(surface_.triangles[at(t)][i])];
  }

  [[nodiscard]] Found find(const Vec3<double>& p) const {
    COROTET_ASSERT(p.cwiseAbs().maxCoeff() <= 1e120, "the squared distance would overflow");
    SimplexPoint<3> nearest;
    nearest.squared_distance = std::numeric_limits<double>::infinity();
    const NearestPrimitive found = tree_.nearest(p, [&](Index t) {
      const SimplexPoint<3> q = closest_on_triangle(corner(t, 0), corner(t, 1), corner(t, 2), p);
      if (q.squared_distance < nearest.squared_distance) nearest = q;
      return q.squared_distance;
    });
    const Vec3<double>& normal = pseudonormal(found.primitive, nearest);
    return {found.primitive, nearest.point, &normal, square_root(found.squared_distance),
            turn_ * (p - nearest.point).dot(normal) < 0 ? -1 : 1};
  }

  /// Whether rounding hides the direction of a triangle's normal.
  static bool is_flat(const Vec3<double>& x, const Vec3<double>& y, const Vec3<double>& z) {
    constexpr double negligible = 1e-12;  // of the square of the longest edge
    const double longest = (std::max)({(y - x).stableNorm(), (z - y).stableNorm(), (x - z).stableNorm()});
    return !(longest > 0) || !(((y - x) / longest).cross((z - x) / longest).norm() > negligible);
  }

  /// Returns the numbers of those taken.
  std::vector<Index> take_triangles(const SurfaceMesh& surface, bool merges_coinciding) {
    std::vector<Index> first, number;
    if (merges_coinciding) first = first_coinciding(surface.positions);
    for (Index t = 0; t < size_of(surface.triangles); ++t) {
      std::array<Index, 3> corners = surface.triangles[at(t)];
      if (merges_coinciding) {
        for (Index& v : corners) v = first[at(v)];
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      }
      surface_.triangles.push_back(corners);
      number.push_back(t);
    }
    return number;
  }

  /// Of the face, edge or vertex on which `q` lies; any length.
  [[nodiscard]] const Vec3<double>& pseudonormal(Index t, const SimplexPoint<3>& q) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      if (is_zero(q.barycentric[j]) && is_zero(q.barycentric[k]))
        return vertex_normals_[at(surface_.triangles[at(t)][i])];
    }
    for (std::size_t i = 0; i < 3; ++i)
      if (is_zero(q.barycentric[(i + 2) % 3])) return edge_normals_[at(triangle_edges_[at(t)][i])];
    return face_normals_[at(t)];
  }

  /// Pairs up the two sides of each edge and sums their normals. Edge i of a triangle runs from its corner i to the
  /// next. `number`: of triangles, for errors.
  Result<void> add_edges(const std::vector<Index>& number) {
    struct Side {
      std::pair<Index, Index> ends;
      Index triangle;
      std::size_t edge;
      bool ascending;
    };
    const auto name = [&](Index t) { return "triangle " + std::to_string(number[at(t)]); };
    std::vector<Side> sides;
    for (Index t = 0; t < size_of(number); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const Index a = surface_.triangles[at(t)][i], b = surface_.triangles[at(t)][(i + 1) % 3];
        if (a == b)
          return Error{ErrorCode::invalid_argument, name(t), "it names vertex " + std::to_string(a) + " twice"};
        sides.push_back({std::minmax(a, b), t, i, a < b});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& p, const Side& q) {
      return p.ends != q.ends ? p.ends < q.ends : p.triangle < q.triangle;
    });
    triangle_edges_.resize(number.size());
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
      while (end < sides.size() && sides[end].ends == sides[begin].ends) ++end;
      const Side& side = sides[begin];
      const auto edge = [&] {
        return "its edge " + std::to_string(side.ends.first) + "-" + std::to_string(side.ends.second);
      };
      if (end - begin != 2)
        return Error{ErrorCode::invalid_argument, name(side.triangle),
                     edge() + " belongs to " + std::to_string(end - begin) +
                         " triangles; a closed surface has two at each edge (are coinciding vertices merged?)"};
      const Side& other = sides[begin + 1];
      if (side.ascending == other.ascending)
        return Error{
            ErrorCode::invalid_argument, name(side.triangle),
            edge() + " has the same direction in " + name(other.triangle) + ": they are wound in opposite ways"};
      for (const Side& s : {side, other}) triangle_edges_[at(s.triangle)][s.edge] = size_of(edge_normals_);
      edge_normals_.push_back(face_normals_[at(side.triangle)] + face_normals_[at(other.triangle)]);
    }
    return {};
  }

  SurfaceMesh surface_;
  std::vector<std::array<Index, 3>> triangle_edges_;
  std::vector<Vec3<double>> face_normals_, edge_normals_, vertex_normals_;
  BoxTree tree_;
  double on_surface_ = 0;  // m
  int turn_ = 1;
};

}  // namespace corotet::inline v0_1::detail
