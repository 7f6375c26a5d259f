// Names for the few types that everything shares. Quantities are in SI units; no axis is "up".
#pragma once

#include <cmath>
#include <concepts>
#include <corotet/detail/core/matrix.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace corotet::inline v0_1 {

/// Index of a vertex, an element or a block. Signed, so that differences are safe.
using Index = std::int32_t;

/// Three numbers, as a column: a position, velocity or force.
template <std::floating_point Scalar>
using Vec3 = Matrix<Scalar, 3, 1>;

/// A 3x3 matrix.
template <std::floating_point Scalar>
using Mat3 = Matrix<Scalar, 3, 3>;

/// One vector a vertex: positions, displacements, velocities, forces.
template <std::floating_point Scalar>
using Field = std::vector<Vec3<Scalar>>;

/// An array's length as an Index. Every array in the library is bounded by the mesh, whose creation checks the range.
template <class Container>
[[nodiscard]] constexpr Index size_of(const Container& container) {
  return static_cast<Index>(container.size());
}

/// An Index as an array subscript.
[[nodiscard]] constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace corotet::inline v0_1
