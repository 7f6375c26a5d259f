// Names for the few types that everything shares. Quantities are in SI units; no axis is "up".
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products
#include <Eigen/LU>        // 3x3 determinant and inverse
#include <cmath>
#include <concepts>
#include <cstdint>
#include <vector>

namespace corotet {

/// Index of a vertex, an element or a block. Signed, so that differences are safe.
using Index = std::int32_t;

template <std::floating_point Scalar>
using Vec3 = Eigen::Matrix<Scalar, 3, 1>;

template <std::floating_point Scalar>
using Mat3 = Eigen::Matrix<Scalar, 3, 3>;

/// All degrees of freedom of a body: vertex-major, x y z of vertex 0, then of vertex 1, ...
template <std::floating_point Scalar>
using VecX = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

/// One vector a vertex: positions, displacements, velocities, forces.
template <std::floating_point Scalar>
using Field = std::vector<Vec3<Scalar>>;

/// A field as one column of numbers, 3n x 1, vertex-major x y z. A view: valid as long as the field is not resized.
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Map<VecX<Scalar>> flat(Field<Scalar>& field) {
  return {field.empty() ? nullptr : field.front().data(), static_cast<Eigen::Index>(3 * field.size())};
}
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Map<const VecX<Scalar>> flat(const Field<Scalar>& field) {
  return {field.empty() ? nullptr : field.front().data(), static_cast<Eigen::Index>(3 * field.size())};
}

/// Whether none is infinite or not a number. For what a caller gave: Eigen's allFinite subtracts, and so raises the
/// floating-point exception that a caller may have made a trap of.
template <std::floating_point Scalar>
[[nodiscard]] bool all_finite(const Vec3<Scalar>& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/// An array's length as an Index. Every array in the library is bounded by the mesh, whose creation checks the range.
template <class Container>
[[nodiscard]] constexpr Index size_of(const Container& container) {
  return static_cast<Index>(container.size());
}

/// An Index as an array subscript.
[[nodiscard]] constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace corotet
