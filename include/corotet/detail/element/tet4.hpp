// The 4-node tetrahedron: linear shape functions, one deformation gradient an element.
#pragma once

#include <array>
#include <corotet/detail/element/reference_element.hpp>
#include <cstddef>

namespace corotet::inline v0_1 {

/// Cheapest element. Stiff in bending and locks as Poisson's ratio nears 1/2: see docs/benchmarks/elements.md for how
/// much.
struct Tet4 {
  static constexpr int nodes = 4;                                        ///< the corners
  static constexpr int order = 1;                                        ///< degree of the shape functions
  static constexpr int edge_nodes = 0;                                   ///< nodes on an edge besides its corners
  static constexpr std::array<std::size_t, nodes> mirrored{0, 2, 1, 3};  ///< corners 1 and 2 exchanged
  static constexpr auto stiffness_points = quadrature::degree1;          ///< for the stiffness
  static constexpr auto mass_points = quadrature::degree2;               ///< for the mass

  /// Shape functions at natural coordinates `xi`, one a node.
  static constexpr std::array<double, nodes> shape(const NaturalCoordinates& xi) {
    return {1 - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]};
  }

  /// Their gradients with respect to `xi`, one a node; constant.
  static constexpr std::array<NaturalCoordinates, nodes> gradient(const NaturalCoordinates& /*xi*/) {
    return {{{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  }
};

static_assert(LinearTetrahedron<Tet4>);

}  // namespace corotet::inline v0_1
