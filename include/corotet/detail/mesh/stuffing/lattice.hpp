// The body-centred cubic lattice: the background grid of isosurface stuffing.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <cstdint>

namespace corotet::inline v0_1::detail {

/// Corners and centres of a grid of cubes. Coordinates are counted in half cubes: all even at a corner, all odd at a
/// centre. Its tetrahedra are all alike, with dihedral angles of 60 and 90 degrees: two opposite long edges (a cube's
/// side, between corners or between centres) and four short ones (sqrt(3)/2 of that, corner to centre).
class BccLattice {
 public:
  using Coordinates = std::array<Index, 3>;

  /// Covers `box` with cubes of side `size` (m) and a margin of `margin` cubes all round. See `vertex_count_of` for the
  /// range.
  BccLattice(const Box& box, double size, Index margin) : size_(size) {
    for (int i = 0; i < 3; ++i) {
      cells_[at(i)] = static_cast<Index>((std::max)(1.0, std::ceil((box.high[i] - box.low[i]) / size))) + 2 * margin;
      low_[i] = (box.low[i] + box.high[i] - size * cells_[at(i)]) / 2;
    }
    corners_ = (cells_[0] + 1) * (cells_[1] + 1) * (cells_[2] + 1);
  }

  /// Cubes that a lattice would have, before anything is built; may exceed any integer.
  static double cell_count_of(const Box& box, double size, Index margin) {
    double count = 1;
    for (int i = 0; i < 3; ++i) count *= (std::max)(1.0, std::ceil((box.high[i] - box.low[i]) / size)) + 2.0 * margin;
    return count;
  }

  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] const Coordinates& cells() const { return cells_; }
  [[nodiscard]] Index vertex_count() const { return corners_ + cells_[0] * cells_[1] * cells_[2]; }
  [[nodiscard]] bool is_corner(Index v) const { return v < corners_; }
  [[nodiscard]] bool is_long(Index a, Index b) const { return is_corner(a) == is_corner(b); }

  [[nodiscard]] Index corner(Index i, Index j, Index k) const {
    return i + (cells_[0] + 1) * (j + (cells_[1] + 1) * k);
  }
  [[nodiscard]] Index centre(Index i, Index j, Index k) const { return corners_ + i + cells_[0] * (j + cells_[1] * k); }
  /// In half cubes.
  [[nodiscard]] Coordinates coordinates(Index v) const {
    const Index odd = is_corner(v) ? 0 : 1;
    const Index nx = cells_[0] + 1 - odd, ny = cells_[1] + 1 - odd, n = is_corner(v) ? v : v - corners_;
    return {2 * (n % nx) + odd, 2 * (n / nx % ny) + odd, 2 * (n / nx / ny) + odd};
  }
  /// m
  [[nodiscard]] Vec3<double> position(Index v) const {
    const Coordinates c = coordinates(v);
    return low_ + size_ / 2 * Vec3<double>(c[0], c[1], c[2]);
  }
  /// Whether the vertex belongs to the outermost layer, whose tetrahedra are incomplete.
  [[nodiscard]] bool on_rim(Index v) const {
    const Coordinates c = coordinates(v);
    for (std::size_t i = 0; i < 3; ++i)
      if (c[i] <= 1 || c[i] >= 2 * cells_[i] - 1) return true;
    return false;
  }

  /// Calls `visit(a, b)` once for each edge.
  template <class Visit>
  void for_each_edge(Visit&& visit) const {
    const auto [nx, ny, nz] = cells_;
    for (Index k = 0; k <= nz; ++k)
      for (Index j = 0; j <= ny; ++j)
        for (Index i = 0; i <= nx; ++i) {
          if (i < nx) visit(corner(i, j, k), corner(i + 1, j, k));
          if (j < ny) visit(corner(i, j, k), corner(i, j + 1, k));
          if (k < nz) visit(corner(i, j, k), corner(i, j, k + 1));
          if (i == nx || j == ny || k == nz) continue;
          const Index c = centre(i, j, k);
          if (i + 1 < nx) visit(c, centre(i + 1, j, k));
          if (j + 1 < ny) visit(c, centre(i, j + 1, k));
          if (k + 1 < nz) visit(c, centre(i, j, k + 1));
          for (Index bits = 0; bits < 8; ++bits) visit(c, corner(i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2)));
        }
  }

  /// Calls `visit(tetrahedron)` once for each: around each side of a cube lie the centres of four cubes, and each
  /// neighbouring two of them make a tetrahedron with the side.
  template <class Visit>
  void for_each_tetrahedron(Visit&& visit) const {
    constexpr std::array<std::array<Index, 2>, 4> ring{{{-1, -1}, {0, -1}, {0, 0}, {-1, 0}}};
    const auto [nx, ny, nz] = cells_;
    for (Index k = 0; k <= nz; ++k)
      for (Index j = 0; j <= ny; ++j)
        for (Index i = 0; i <= nx; ++i)
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t s = (axis + 1) % 3, t = (axis + 2) % 3;
            const Coordinates low{i, j, k};
            if (low[axis] == cells_[axis] || low[s] == 0 || low[s] == cells_[s] || low[t] == 0 || low[t] == cells_[t])
              continue;
            Coordinates high = low;
            ++high[axis];
            std::array<Index, 4> around;
            for (std::size_t r = 0; r < 4; ++r) {
              Coordinates c = low;
              c[s] += ring[r][0];
              c[t] += ring[r][1];
              around[r] = centre(c[0], c[1], c[2]);
            }
            for (std::size_t r = 0; r < 4; ++r)
              visit(std::array<Index, 4>{corner(i, j, k), corner(high[0], high[1], high[2]), around[r],
                                         around[(r + 1) % 4]});
          }
  }

 private:
  double size_;
  Vec3<double> low_;
  Coordinates cells_{};
  Index corners_ = 0;
};

}  // namespace corotet::inline v0_1::detail
