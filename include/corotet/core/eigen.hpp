// Fields as Eigen's vectors, for programs that compute with Eigen.
#pragma once

#include <corotet/core/macros_off.hpp>

#include <Eigen/Core>

#include <corotet/core/macros_on.hpp>

#include <corotet/core/types.hpp>

namespace corotet {

/// All degrees of freedom of a body: vertex-major, x y z of vertex 0, then of vertex 1, ...
template <std::floating_point Scalar>
using VecX = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

/// A field as one column of numbers, 3n x 1, vertex-major x y z. A view: valid as long as the field is not resized.
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Map<VecX<Scalar>> flat(Field<Scalar>& field) {
  return {field.empty() ? nullptr : field.front().data(), static_cast<Eigen::Index>(3 * field.size())};
}
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Map<const VecX<Scalar>> flat(const Field<Scalar>& field) {
  return {field.empty() ? nullptr : field.front().data(), static_cast<Eigen::Index>(3 * field.size())};
}

}  // namespace corotet
