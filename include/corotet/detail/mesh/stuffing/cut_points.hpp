// Where the surface crosses the lattice's edges, and the lattice vertices that are warped onto it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/stuffing/lattice.hpp>
#include <cstdint>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// A vertex is warped to a cut point nearer than this fraction of the edge (Labelle & Shewchuk 2007). Chosen by search
/// over random signs and extreme cut points: the worst dihedral angles that any function then gets are 10.75 and
/// 164.70 degrees. (The pair 0.25, 0.412 lets a plane make one of 10.2, and other functions one of 9.3.)
inline constexpr double warp_long = 0.285, warp_short = 0.398;

/// The lattice after cutting and warping.
struct CutLattice {
  struct Cut {
    std::pair<Index, Index> ends;  // lattice vertices, ascending
    double along;                  // from the first end, as a fraction of the edge, in (0, 1)
    bool alive;                    // until one of its ends is warped
  };
  std::vector<std::int8_t> sign;                       // of the function at each lattice vertex; 0 on the surface
  std::vector<Cut> cuts;                               // ascending by ends
  std::vector<std::pair<Index, Vec3<double>>> warped;  // lattice vertices and where they went, m; ascending

  [[nodiscard]] Index find_cut(Index a, Index b) const {
    const std::pair<Index, Index> ends = std::minmax(a, b);
    return static_cast<Index>(
        std::lower_bound(cuts.begin(), cuts.end(), ends, [](const Cut& cut, const auto& e) { return cut.ends < e; }) -
        cuts.begin());
  }
};

/// The zero of `f` between `a` (value `fa`) and `b` (value `fb` of the other sign), as a fraction of the way, strictly
/// between: regula falsi with the Illinois rule, so that the point lies on a curved level set too.
template <class Function>
double crossing(const Function& f, const Vec3<double>& a, const Vec3<double>& b, double fa, double fb) {
  constexpr int max_steps = 20;
  constexpr double close = 1e-6;  // of the edge
  double low = 0, high = 1, t = 0.5;
  int moved = 0;  // the end that moved last: -1 low, +1 high
  for (int step = 0; step < max_steps; ++step) {
    const double before = t;
    t = low + (high - low) * (fa / (fa - fb));
    if (!(t > low && t < high)) t = (low + high) / 2;
    if (step > 0 && std::fabs(t - before) < close) break;
    const double ft = f(Vec3<double>(a + t * (b - a)));
    if (is_zero(ft) || !std::isfinite(ft)) break;
    const int side = (ft < 0) == (fa < 0) ? -1 : 1;
    (side < 0 ? low : high) = t;
    (side < 0 ? fa : fb) = ft;
    if (side == moved) (side < 0 ? fb : fa) /= 2;
    moved = side;
  }
  return std::clamp(t, 1e-9, 1 - 1e-9);
}

/// Cuts every edge whose ends have opposite signs, then visits the vertices in order: one that is nearer to a cut point
/// than the limit moves to the nearest such point, gets the sign 0, and the cuts on its edges are dropped.
template <class Function>
CutLattice cut_and_warp(const BccLattice& lattice, const Function& f, const std::vector<double>& values) {
  CutLattice out;
  out.sign.resize(values.size());
  for (std::size_t v = 0; v < values.size(); ++v)
    out.sign[v] = static_cast<std::int8_t>(values[v] < 0 ? -1 : values[v] > 0 ? 1 : 0);
  lattice.for_each_edge([&](Index p, Index q) {
    if (out.sign[at(p)] * out.sign[at(q)] >= 0) return;
    const auto [a, b] = std::minmax(p, q);
    out.cuts.push_back(
        {{a, b}, crossing(f, lattice.position(a), lattice.position(b), values[at(a)], values[at(b)]), true});
  });
  std::sort(out.cuts.begin(), out.cuts.end(), [](const auto& p, const auto& q) { return p.ends < q.ends; });

  std::vector<std::pair<Index, Index>> uses;  // vertex, cut on one of its edges
  uses.reserve(2 * out.cuts.size());
  for (Index c = 0; c < size_of(out.cuts); ++c) {
    uses.emplace_back(out.cuts[at(c)].ends.first, c);
    uses.emplace_back(out.cuts[at(c)].ends.second, c);
  }
  std::sort(uses.begin(), uses.end());
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    const Index v = uses[begin].first;
    constexpr Index none = -1;
    Index nearest = none;
    double least = 0;
    for (; end < uses.size() && uses[end].first == v; ++end) {
      const CutLattice::Cut& cut = out.cuts[at(uses[end].second)];
      const bool is_long = lattice.is_long(cut.ends.first, cut.ends.second);
      const double fraction = cut.ends.first == v ? cut.along : 1 - cut.along;
      const double length = fraction * (is_long ? 1 : square_root(0.75));  // in cubes
      if (!cut.alive || fraction >= (is_long ? warp_long : warp_short)) continue;
      if (nearest != none && length >= least) continue;
      nearest = uses[end].second;
      least = length;
    }
    if (nearest == none) continue;
    const CutLattice::Cut& cut = out.cuts[at(nearest)];
    const Vec3<double> a = lattice.position(cut.ends.first), b = lattice.position(cut.ends.second);
    out.warped.emplace_back(v, a + cut.along * (b - a));
    out.sign[at(v)] = 0;
    for (std::size_t i = begin; i < end; ++i) out.cuts[at(uses[i].second)].alive = false;
  }
  return out;
}

}  // namespace corotet::inline v0_1::detail
