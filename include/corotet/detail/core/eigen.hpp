// Fields and small matrices as Eigen's, for programs that compute with Eigen.
#pragma once

#include <corotet/detail/core/macros_off.hpp>

#include <Eigen/Core>

#include <corotet/detail/core/macros_on.hpp>

#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1 {

/// All degrees of freedom of a body: vertex-major, x y z of vertex 0, then of vertex 1, ...
template <std::floating_point Scalar>
using VecX = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

/// A field as one column of numbers, 3n x 1, vertex-major x y z. A view: valid as long as the field is not resized.
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Map<VecX<Scalar>> flat(Field<Scalar>& field) {
  return {field.empty() ? nullptr : field.front().data(), static_cast<Eigen::Index>(3 * field.size())};
}
/// The same, read-only.
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Map<const VecX<Scalar>> flat(const Field<Scalar>& field) {
  return {field.empty() ? nullptr : field.front().data(), static_cast<Eigen::Index>(3 * field.size())};
}

/// A small matrix as Eigen's, where Eigen wants an expression of its own: `Eigen::AngleAxisd(as_eigen(rotation))`,
/// `dense.block<3, 3>(i, j) = as_eigen(m)`. (To and from Eigen's matrices of the same size it converts by itself.) A
/// view: valid as long as the matrix, one that is returned by value until the end of the expression.
template <std::floating_point Scalar, int R, int C>
[[nodiscard]] Eigen::Map<Eigen::Matrix<Scalar, R, C>> as_eigen(Matrix<Scalar, R, C>& m) {
  return Eigen::Map<Eigen::Matrix<Scalar, R, C>>(m.data());
}
/// An Eigen matrix that refers to the numbers of `m`.
template <std::floating_point Scalar, int R, int C>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<Scalar, R, C>> as_eigen(const Matrix<Scalar, R, C>& m) {
  return Eigen::Map<const Eigen::Matrix<Scalar, R, C>>(m.data());
}
/// The same for numbers that lie in a larger array.
template <std::floating_point Scalar, int R, int C>
[[nodiscard]] Eigen::Map<Eigen::Matrix<Scalar, R, C>> as_eigen(const detail::MatrixView<Scalar, R, C>& m) {
  return Eigen::Map<Eigen::Matrix<Scalar, R, C>>(&m(0, 0));
}

}  // namespace corotet::inline v0_1
