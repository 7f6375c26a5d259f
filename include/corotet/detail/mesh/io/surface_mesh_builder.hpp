// What all surface readers do with what they have read: polygons to triangles, checks, notes.
#pragma once

#include <array>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/coinciding.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

class SurfaceMeshBuilder {
 public:
  SurfaceMesh mesh;

  void note(std::string text) { mesh.notes.push_back(std::move(text)); }

  /// Adds a vertex. `in` is told if there are too many.
  template <class Input>
  void add_vertex(Input& in, const Vec3<double>& position) {
    if (mesh.positions.size() >= most)
      return in.fail("has more vertices than 32-bit indices can number", ErrorCode::unsupported);
    mesh.positions.push_back(position + Vec3<double>::Zero());  // -0 becomes 0: the same point
  }

  /// Adds a polygon as a fan around its first corner. `in` is told if there are too many or too few corners.
  template <class Input>
  void add_polygon(Input& in, std::span<const Index> corners) {
    if (corners.size() < 3) return in.fail("a face has " + std::to_string(corners.size()) + " corners, not 3 or more");
    if (mesh.triangles.size() + corners.size() > most)
      return in.fail("has more triangles than 32-bit indices can number", ErrorCode::unsupported);
    if (corners.size() > 3) ++split_polygons_;
    for (std::size_t i = 2; i < corners.size(); ++i) {
      const std::array<Index, 3> triangle{corners[0], corners[i - 1], corners[i]};
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
        ++dropped_triangles_;
      else
        mesh.triangles.push_back(triangle);
    }
  }

  /// Makes one vertex of those at exactly the same place: formats that repeat them in each triangle. O(n log n).
  void merge_equal_vertices() {
    Field<double>& x = mesh.positions;
    const std::vector<Index> first = first_coinciding(x);
    std::vector<Index> renumbered(x.size());
    Index kept = 0;
    for (std::size_t v = 0; v < x.size(); ++v) {
      if (at(first[v]) == v) {
        x[at(kept)] = x[v];
        renumbered[v] = kept++;
      } else {
        renumbered[v] = renumbered[at(first[v])];
      }
    }
    if (at(kept) < x.size()) note("merged " + std::to_string(x.size()) + " vertices into " + std::to_string(kept));
    x.resize(at(kept));
    const auto triangles = std::exchange(mesh.triangles, {});
    mesh.triangles.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles) {
      const std::array<Index, 3> t{renumbered[at(a)], renumbered[at(b)], renumbered[at(c)]};
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
        ++dropped_triangles_;
      else
        mesh.triangles.push_back(t);
    }
  }

  /// The surface, once indices are known to be in range. Errors: empty_mesh.
  [[nodiscard]] Result<SurfaceMesh> finish(std::string_view name) {
    if (split_polygons_ > 0)
      note("split " + std::to_string(split_polygons_) + " polygons into triangles, as fans from their first corners");
    if (dropped_triangles_ > 0)
      note("dropped " + std::to_string(dropped_triangles_) + " triangles that name a vertex twice");
    use_normals();
    if (mesh.positions.empty()) return Error{ErrorCode::empty_mesh, std::string(name), "it has no vertices"};
    if (mesh.triangles.empty()) return Error{ErrorCode::empty_mesh, std::string(name), "it has no triangles"};
    return std::move(mesh);
  }

 private:
  static constexpr std::size_t most = (std::numeric_limits<Index>::max)();

  /// Normals are kept if there is one of some length for each vertex.
  void use_normals() {
    if (mesh.normals.empty()) return;
    bool usable = mesh.normals.size() == mesh.positions.size();
    for (Vec3<double>& normal : mesh.normals) {
      const double length = normal.stableNorm();
      usable = usable && length > 0 && length <= (std::numeric_limits<double>::max)();
      if (usable) normal /= length;
    }
    if (usable) return;
    note("ignored normals: not every vertex has one");
    mesh.normals.clear();
  }

  std::size_t split_polygons_ = 0;
  std::size_t dropped_triangles_ = 0;
};

/// The vertex that a file names, counted from 0. `in` is told if it does not exist.
template <class Input>
Index surface_vertex(Input& in, std::int64_t index, std::size_t vertex_count) {
  if (!in.ok()) return 0;
  if (index >= 0 && static_cast<std::uint64_t>(index) < vertex_count) return static_cast<Index>(index);
  in.fail("a face names vertex " + std::to_string(index) + ", but there are " + std::to_string(vertex_count),
          ErrorCode::index_out_of_range);
  return 0;
}

}  // namespace corotet::inline v0_1::detail
