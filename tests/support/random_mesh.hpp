// Meshes that no one would draw: the Delaunay tetrahedra of random points, slivers included.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <map>
#include <utility>
#include <vector>

#include "support/random.hpp"

namespace corotet::testing {

/// Point by point (Bowyer 1981, Watson 1981): the elements whose circumsphere holds the new point make room for new
/// ones between it and their outer faces. Quadratic, and sure only for points in general position.
class Delaunay {
 public:
  using Tet = std::array<Index, 4>;

  explicit Delaunay(std::vector<Vec3<double>> points) : points_(std::move(points)) {
    const Index first = size_of(points_);
    const double far = 1e3;  // the points lie in the unit cube
    for (const Vec3<double>& corner :
         {Vec3<double>(-1, -1, -1), Vec3<double>(3, -1, -1), Vec3<double>(-1, 3, -1), Vec3<double>(-1, -1, 3)})
      points_.emplace_back(far * corner);
    tets_ = {{first, first + 1, first + 2, first + 3}};
    for (Index p = 0; p < first; ++p) insert(p);
    std::erase_if(tets_, [&](const Tet& t) { return *std::max_element(t.begin(), t.end()) >= first; });
    points_.resize(at(first));
  }

  [[nodiscard]] const std::vector<Vec3<double>>& points() const { return points_; }
  [[nodiscard]] const std::vector<Tet>& tets() const { return tets_; }

 private:
  /// > 0 if the tetrahedron is wound as the library's are.
  [[nodiscard]] double volume6(const Tet& t) const {
    const auto& o = points_[at(t[0])];
    return (points_[at(t[1])] - o).cross(points_[at(t[2])] - o).dot(points_[at(t[3])] - o);
  }

  [[nodiscard]] bool holds(const Tet& t, const Vec3<double>& x) const {
    Mat3<double> edges;
    Vec3<double> half;
    for (int i = 0; i < 3; ++i) {
      const Vec3<double> edge = points_[at(t[at(i) + 1])] - points_[at(t[0])];
      edges.set_row(i, edge.transpose());
      half[i] = edge.squaredNorm() / 2;
    }
    const Vec3<double> centre = edges.inverse() * half;
    return (x - points_[at(t[0])] - centre).squaredNorm() < centre.squaredNorm();
  }

  void insert(Index p) {
    std::map<std::array<Index, 3>, std::pair<int, std::array<Index, 3>>> faces;  // by sorted corners
    std::erase_if(tets_, [&](const Tet& t) {
      if (!holds(t, points_[at(p)])) return false;
      for (const auto& [a, b, c] : {std::array{0U, 2U, 1U}, std::array{0U, 1U, 3U}, std::array{1U, 2U, 3U},
                                    std::array{2U, 0U, 3U}}) {  // wound outwards
        const std::array<Index, 3> face{t[a], t[b], t[c]};
        std::array<Index, 3> key = face;
        std::sort(key.begin(), key.end());
        auto& [count, outer] = faces[key];
        ++count;
        outer = face;
      }
      return true;
    });
    for (const auto& [key, entry] : faces)
      if (entry.first == 1) {
        const auto& [a, b, c] = entry.second;
        const Tet t{a, c, b, p};
        if (volume6(t) > 0) tets_.push_back(t);
      }
  }

  std::vector<Vec3<double>> points_;
  std::vector<Tet> tets_;
};

/// `size` m across in each direction. Elements too flat to have a rest shape in float are left out.
inline MeshData random_mesh(Random& random, Index points, const Vec3<double>& size, int order) {
  std::vector<Vec3<double>> inside;
  for (Index p = 0; p < points; ++p) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    inside.emplace_back(x, y, z);
  }
  const Delaunay delaunay(std::move(inside));
  MeshData mesh;
  for (const Vec3<double>& x : delaunay.points()) mesh.positions.emplace_back(x.cwiseProduct(size));
  for (const Delaunay::Tet& t : delaunay.tets()) {
    const auto edge = [&](std::size_t a) { return mesh.positions[at(t[a])] - mesh.positions[at(t[0])]; };
    const double longest = std::max({edge(1).norm(), edge(2).norm(), edge(3).norm()});
    if (edge(1).cross(edge(2)).dot(edge(3)) > 1e-5 * longest * longest * longest)
      mesh.connectivity.insert(mesh.connectivity.end(), t.begin(), t.end());
  }
  mesh = remove_unreferenced(std::move(mesh));
  return order == 2 ? raise_order(std::move(mesh)) : mesh;
}

}  // namespace corotet::testing
