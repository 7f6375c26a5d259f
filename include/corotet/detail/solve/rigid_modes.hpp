// The rigid motions of aggregates: the unknowns of the coarse levels of a preconditioner.
#pragma once

#include <array>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1::detail {

/// Six numbers an aggregate: translation and rotation, or force and torque.
template <std::floating_point Scalar>
using SixVector = Matrix<Scalar, 6, 1>;
template <std::floating_point Scalar>
[[nodiscard]] SixVector<Scalar> six_vector(const Vec3<Scalar>& first, const Vec3<Scalar>& second) {
  SixVector<Scalar> y;
  y.set_block(0, 0, first);
  y.set_block(3, 0, second);
  return y;
}

/// The position of each aggregate, and its rotation since the rest configuration.
template <std::floating_point Scalar>
struct RigidFrames {
  Buffer<Vec3<Scalar>> center;  ///< mean position of the members, m
  Buffer<Mat3<Scalar>> rotation;
  /// 1 / size, 1/m, which makes rotations as large as translations; 0 for an aggregate without a rotation, because its
  /// free points lie on a line.
  Buffer<Scalar> inverse_size;

  COROTET_COLD explicit RigidFrames(Index count = 0)
      : center(at(count)), rotation(at(count), Mat3<Scalar>::Identity()), inverse_size(at(count)) {}

  [[nodiscard]] Index count() const { return size_of(center); }
  [[nodiscard]] std::size_t bytes() const { return bytes_of(center) + bytes_of(rotation) + bytes_of(inverse_size); }

  /// Force and torque about the centre, in the aggregate's own turned axes and units.
  [[nodiscard]] SixVector<Scalar> to_own_axes(Index aggregate, const Vec3<Scalar>& force,
                                              const Vec3<Scalar>& torque) const {
    return six_vector<Scalar>(rotation[at(aggregate)].transpose() * force,
                              inverse_size[at(aggregate)] * (rotation[at(aggregate)].transpose() * torque));
  }
  /// The other way for motions: translation and rotation in the axes of the world.
  [[nodiscard]] Vec3<Scalar> translation(Index aggregate, const SixVector<Scalar>& y) const {
    return rotation[at(aggregate)] * y.template head<3>();
  }
  [[nodiscard]] Vec3<Scalar> turn(Index aggregate, const SixVector<Scalar>& y) const {
    return inverse_size[at(aggregate)] * (rotation[at(aggregate)] * y.template tail<3>());
  }

  /// `inverse_size` from the rest offsets of free points: their number and their second moment S = sum X X^T, m^2.
  COROTET_COLD void set_size(Index aggregate, Index free_points, const Mat3<double>& second_moment) {
    // On a line S has one eigenvalue, and |S| is its trace; otherwise |S| <= (1 - e) trace, e the share of the others.
    const double trace = second_moment.trace();
    const bool turns = free_points >= 3 && second_moment.norm() < 0.999 * trace;
    inverse_size[at(aggregate)] = turns ? static_cast<Scalar>(1 / detail::square_root(trace / free_points)) : Scalar(0);
  }
};

/// Turns a block between two aggregates from the axes of the world into their own, and scales it.
template <std::floating_point Scalar>
[[nodiscard]] COROTET_COLD Matrix<double, 6, 6> in_own_axes(const RigidFrames<Scalar>& frames, Index row, Index column,
                                                            const Matrix<double, 6, 6>& world) {
  const Mat3<double> left = frames.rotation[at(row)].template cast<double>().transpose();
  const Mat3<double> right = frames.rotation[at(column)].template cast<double>();
  const std::array<double, 2> row_scale{1, double(frames.inverse_size[at(row)])};
  const std::array<double, 2> column_scale{1, double(frames.inverse_size[at(column)])};
  Matrix<double, 6, 6> turned;
  for (int r = 0; r < 2; ++r)
    for (int c = 0; c < 2; ++c)
      turned.set_block(3 * r, 3 * c,
                       left * world.block<3, 3>(3 * r, 3 * c) * right * (row_scale[at(r)] * column_scale[at(c)]));
  return turned;
}

/// Motions that an aggregate does not have (all its vertices pinned, or no rotation) must not make the matrix singular:
/// they stand alone, and so does rounding that is left of them. Adds `shift` times the diagonal.
inline void stabilise(Matrix<double, 6, 6>& diagonal_block, double shift = 0) {
  const double largest = diagonal_block.diagonal().maxCoeff();
  for (int r = 0; r < 6; ++r) {
    double& entry = diagonal_block(r, r);
    entry = entry > 0 ? entry * (1 + 1e-10 + shift) : (largest > 0 ? largest : 1.0);
  }
}

}  // namespace corotet::inline v0_1::detail
