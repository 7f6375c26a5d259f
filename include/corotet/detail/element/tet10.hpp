// The 10-node tetrahedron: quadratic shape functions on corners and edge midpoints.
#pragma once

#include <array>
#include <corotet/detail/element/reference_element.hpp>
#include <cstddef>

namespace corotet::inline v0_1 {

/// Node order: four corners, then the midpoints of `tet_edges` (the order of VTK; readers translate the others).
/// Bends without locking; many times fewer elements than Tet4 for the same error: see docs/benchmarks/elements.md.
struct Tet10 {
  static constexpr int nodes = 10;      ///< 4 corners, 6 midpoints of edges
  static constexpr int order = 2;       ///< degree of the shape functions
  static constexpr int edge_nodes = 1;  ///< nodes on an edge besides its corners
  /// Corners 1 and 2 exchanged.
  static constexpr std::array<std::size_t, nodes> mirrored{0, 2, 1, 3, 6, 5, 4, 7, 9, 8};
  static constexpr auto stiffness_points = quadrature::degree2;  ///< for the stiffness
  static constexpr auto mass_points = quadrature::degree5;       ///< for the mass

  /// Shape functions at natural coordinates `xi`: L(2L-1) at a corner, 4 La Lb on an edge (L = barycentric
  /// coordinates).
  static constexpr std::array<double, nodes> shape(const NaturalCoordinates& xi) {
    const std::array<double, 4> l = barycentric(xi);
    std::array<double, nodes> n{};
    for (std::size_t c = 0; c < 4; ++c) n[c] = l[c] * (2 * l[c] - 1);
    for (std::size_t e = 0; e < 6; ++e) n[4 + e] = 4 * l[tet_edges[e].a] * l[tet_edges[e].b];
    return n;
  }

  /// Their gradients with respect to `xi`, one a node; linear in `xi`.
  static constexpr std::array<NaturalCoordinates, nodes> gradient(const NaturalCoordinates& xi) {
    const std::array<double, 4> l = barycentric(xi);
    constexpr std::array<NaturalCoordinates, 4> dl{{{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    std::array<NaturalCoordinates, nodes> g{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t c = 0; c < 4; ++c) g[c][i] = (4 * l[c] - 1) * dl[c][i];
      for (std::size_t e = 0; e < 6; ++e) {
        const auto [a, b] = tet_edges[e];
        g[4 + e][i] = 4 * (l[a] * dl[b][i] + l[b] * dl[a][i]);
      }
    }
    return g;
  }

 private:
  static constexpr std::array<double, 4> barycentric(const NaturalCoordinates& xi) {
    return {1 - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]};
  }
};

static_assert(TetrahedralElement<Tet10>);

}  // namespace corotet::inline v0_1
