// The rigid motions of parts of a body: what the coarse levels of a preconditioner are made of.
#pragma once

#include <array>
#include <cmath>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/buffer.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/types.hpp>

namespace corotet::inline v0_1 {

/// Six numbers a part: translation and rotation, or force and torque.
template <std::floating_point Scalar>
using SixVector = Matrix<Scalar, 6, 1>;
template <std::floating_point Scalar>
[[nodiscard]] SixVector<Scalar> six_vector(const Vec3<Scalar>& first, const Vec3<Scalar>& second) {
  SixVector<Scalar> y;
  y.set_block(0, 0, first);
  y.set_block(3, 0, second);
  return y;
}

/// Where each part of a body is, and how it has turned since rest.
template <std::floating_point Scalar>
struct RigidFrames {
  Field<Scalar> rest_center, center;  ///< mean position of the members, m
  detail::Buffer<Mat3<Scalar>> rotation;
  /// 1 / size, 1/m, which makes rotations as large as translations; 0 for a part that cannot be said to turn, because
  /// what is free of it lies on a line.
  detail::Buffer<Scalar> inverse_size;

  COROTET_COLD explicit RigidFrames(Index parts = 0)
      : rest_center(at(parts), Vec3<Scalar>::Zero()),
        center(rest_center),
        rotation(at(parts), Mat3<Scalar>::Identity()),
        inverse_size(at(parts), Scalar(0)) {}

  [[nodiscard]] Index parts() const { return size_of(center); }

  /// Force and torque about the centre, in the part's own turned axes and units.
  [[nodiscard]] SixVector<Scalar> to_part(Index part, const Vec3<Scalar>& force, const Vec3<Scalar>& torque) const {
    return six_vector<Scalar>(rotation[at(part)].transpose() * force,
                              inverse_size[at(part)] * (rotation[at(part)].transpose() * torque));
  }
  /// The other way for motions: translation and rotation in the axes of the world.
  [[nodiscard]] Vec3<Scalar> translation(Index part, const SixVector<Scalar>& y) const {
    return rotation[at(part)] * y.template head<3>();
  }
  [[nodiscard]] Vec3<Scalar> turn(Index part, const SixVector<Scalar>& y) const {
    return inverse_size[at(part)] * (rotation[at(part)] * y.template tail<3>());
  }

  /// `inverse_size` from the rest offsets of free points: their number and their second moment S = sum X X^T, m^2.
  COROTET_COLD void set_size(Index part, Index free_points, const Mat3<double>& second_moment) {
    // On a line S has one eigenvalue, and |S| is its trace; otherwise |S| <= (1 - e) trace, e the share of the others.
    const double trace = second_moment.trace();
    const bool turns = free_points >= 3 && second_moment.norm() < 0.999 * trace;
    inverse_size[at(part)] = turns ? static_cast<Scalar>(1 / std::sqrt(trace / free_points)) : Scalar(0);
  }
};

/// Visits the blocks of P^T A P in the rows of one part, P the rigid motions of parts in the axes of the world: calls
/// `add(part of the column, 6x6 block)` for each block of A whose row is one of `vertices`. `part_of(v)`: -1 for a
/// vertex that does not move. `offset(v)`: from the centre of its part, m, as it is now.
template <std::floating_point Scalar, class Vertices, class PartOf, class Offset, class Add>
void rigid_row(const BlockMatrix<Scalar>& matrix, const Vertices& vertices, PartOf&& part_of, Offset&& offset,
               Add&& add) {
  const BlockPattern& p = matrix.pattern();
  const auto cross = [&](Index v) {
    const Vec3<double> d = offset(v).template cast<double>();
    Mat3<double> m;
    m.set_col(0, {0, d.z(), -d.y()});
    m.set_col(1, {-d.z(), 0, d.x()});
    m.set_col(2, {d.y(), -d.x(), 0});
    return m;
  };
  for (const Index i : vertices) {
    if (part_of(i) < 0) continue;
    const Mat3<double> across = cross(i);  // P_i^T = [I; [d_i]x], P_j = [I, -[d_j]x]
    for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k) {
      const Index j = p.column[at(k)], other = part_of(j);
      if (other < 0) continue;
      Matrix<double, 6, 6> block;
      const Mat3<double> left = matrix.block(k).template cast<double>(), right = -(left * cross(j));
      block.set_block(0, 0, left);
      block.set_block(0, 3, right);
      block.set_block(3, 0, across * left);
      block.set_block(3, 3, across * right);
      add(other, block);
    }
  }
}

/// Turns a block between two parts from the axes of the world into those of the parts, and scales it.
template <std::floating_point Scalar>
[[nodiscard]] COROTET_COLD Matrix<double, 6, 6> in_part_axes(const RigidFrames<Scalar>& frames, Index row, Index column,
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

/// Motions that a part does not have (all its vertices pinned, or no rotation) must not make the matrix singular: they
/// stand alone, and so does rounding that is left of them.
inline void stabilise(Matrix<double, 6, 6>& diagonal_block) {
  const double largest = diagonal_block.diagonal().maxCoeff();
  for (int r = 0; r < 6; ++r) {
    double& entry = diagonal_block(r, r);
    entry = entry > 0 ? entry * (1 + 1e-10) : (largest > 0 ? largest : 1.0);
  }
}

}  // namespace corotet::inline v0_1
