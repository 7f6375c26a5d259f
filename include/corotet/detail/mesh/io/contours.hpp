// Closed lines at which a sampled height has a given value, as polygons.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Numbers on a grid of points one unit apart, row by row.
struct Grid {
  Index columns = 0, rows = 0;
  std::vector<float> values{};

  Grid(Index width, Index height, float value) : columns(width), rows(height), values(at(width) * at(height), value) {}
  [[nodiscard]] std::size_t place(Index column, Index row) const { return at(row) * at(columns) + at(column); }
  [[nodiscard]] float operator()(Index column, Index row) const { return values[place(column, row)]; }
  [[nodiscard]] float& operator()(Index column, Index row) { return values[place(column, row)]; }
};

struct GridPoint {
  double x, y;
};

/// The outlines of where `grid` is at least `level`, by marching squares (Maple 2003): holes run the other way round.
/// The outermost points of the grid must be below the level.
inline std::vector<std::vector<GridPoint>> contours_of(const Grid& grid, float level) {
  // Edge 2n goes from point n to the right, edge 2n + 1 down. `next` leads from each crossed edge to the next.
  std::vector<Index> next(2 * grid.values.size(), -1);
  for (Index row = 0; row + 1 < grid.rows; ++row)
    for (Index column = 0; column + 1 < grid.columns; ++column) {
      const Index n = static_cast<Index>(grid.place(column, row)), below = n + grid.columns;
      const std::array<Index, 4> edges{2 * n, 2 * (n + 1) + 1, 2 * below, 2 * n + 1};
      const std::array<float, 4> corners{grid.values[at(n)], grid.values[at(n + 1)], grid.values[at(below + 1)],
                                         grid.values[at(below)]};
      std::array<bool, 4> inside{};
      int leaves = 0;
      for (std::size_t i = 0; i < 4; ++i) inside[i] = corners[i] >= level;
      for (std::size_t i = 0; i < 4; ++i) leaves += inside[i] && !inside[(i + 1) % 4];
      // Where two opposite corners are inside, their mean decides whether they are joined.
      const bool joined = leaves == 2 && corners[0] + corners[1] + corners[2] + corners[3] >= 4 * level;
      for (std::size_t i = 0; i < 4; ++i) {
        if (!inside[i] || inside[(i + 1) % 4]) continue;
        std::size_t back = i;
        for (std::size_t k = 1; k < 4; ++k) {
          const std::size_t j = (i + (leaves == 2 && !joined ? 4 - k : k)) % 4;
          if (inside[j] || !inside[(j + 1) % 4]) continue;
          back = j;
          break;
        }
        next[at(edges[i])] = edges[back];
      }
    }

  std::vector<std::vector<GridPoint>> loops;
  for (std::size_t start = 0; start < next.size(); ++start) {
    if (next[start] < 0) continue;
    std::vector<GridPoint> loop;
    for (Index edge = static_cast<Index>(start); next[at(edge)] >= 0;) {
      const Index a = edge / 2, b = edge % 2 == 0 ? a + 1 : a + grid.columns;
      const auto va = static_cast<double>(grid.values[at(a)]), vb = static_cast<double>(grid.values[at(b)]);
      const double share = (static_cast<double>(level) - va) / (vb - va);
      const Index column = a % grid.columns, row = a / grid.columns;
      const double x = column, y = row;
      loop.push_back(edge % 2 == 0 ? GridPoint{x + share, y} : GridPoint{x, y + share});
      edge = std::exchange(next[at(edge)], -1);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

/// A closed line with as few of its points as keep it within `tolerance` of the others (Douglas & Peucker 1973).
inline std::vector<GridPoint> simplified(const std::vector<GridPoint>& loop, double tolerance) {
  if (loop.size() < 4) return loop;
  const auto distance = [&](std::size_t i, std::size_t a, std::size_t b) {
    const GridPoint &p = loop[i], &q = loop[a], &r = loop[b];
    const double dx = r.x - q.x, dy = r.y - q.y, square = dx * dx + dy * dy;
    const double t = square > 0 ? std::clamp(((p.x - q.x) * dx + (p.y - q.y) * dy) / square, 0.0, 1.0) : 0;
    return std::hypot(p.x - q.x - t * dx, p.y - q.y - t * dy);
  };
  std::vector<bool> keep(loop.size(), false);
  std::size_t farthest = 0;
  for (std::size_t i = 1; i < loop.size(); ++i)
    if (distance(i, 0, 0) > distance(farthest, 0, 0)) farthest = i;
  keep[0] = keep[farthest] = true;
  std::vector<std::array<std::size_t, 2>> spans{{0, farthest}, {farthest, loop.size()}};
  while (!spans.empty()) {
    const auto [begin, end] = spans.back();
    spans.pop_back();
    std::size_t worst = begin;
    double most = tolerance;
    for (std::size_t i = begin + 1; i < end; ++i)
      if (const double d = distance(i, begin, end % loop.size()); d > most) {
        most = d;
        worst = i;
      }
    if (worst == begin) continue;
    keep[worst] = true;
    spans.push_back({begin, worst});
    spans.push_back({worst, end});
  }
  std::vector<GridPoint> result;
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (keep[i]) result.push_back(loop[i]);
  return result;
}

/// The area within a closed line.
inline double area_of(const std::vector<GridPoint>& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const GridPoint &p = loop[i], &q = loop[(i + 1) % loop.size()];
    sum += p.x * q.y - q.x * p.y;
  }
  return std::fabs(sum) / 2;
}

}  // namespace corotet::inline v0_1::detail
