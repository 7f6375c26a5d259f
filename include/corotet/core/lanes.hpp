// Batches: the same quantity of several elements side by side, so that one instruction serves all of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <corotet/core/types.hpp>

namespace corotet {

/// Elements in a batch: 16 in float, 8 in double (64 bytes). The same on every machine, whatever its vector width, so
/// that layout and results do not depend on compiler flags.
template <std::floating_point Scalar>
inline constexpr int lane_count = sizeof(Scalar) <= 4 ? 16 : 8;

/// One scalar of each element in a batch. Eigen maps it to whatever vector instructions the compiler is allowed to use.
template <std::floating_point Scalar>
using Lanes = Eigen::Array<Scalar, lane_count<Scalar>, 1>;

/// A 3-vector of each element in a batch: [component], lane.
template <std::floating_point Scalar>
using Vec3Lanes = std::array<Lanes<Scalar>, 3>;

/// A 3x3 matrix of each element in a batch: (row, column), lane.
template <std::floating_point Scalar>
struct Mat3Lanes {
  std::array<std::array<Lanes<Scalar>, 3>, 3> entry;

  [[nodiscard]] Lanes<Scalar>& operator()(int row, int column) { return entry[at(row)][at(column)]; }
  [[nodiscard]] const Lanes<Scalar>& operator()(int row, int column) const { return entry[at(row)][at(column)]; }

  /// The matrix in one lane.
  [[nodiscard]] Mat3<Scalar> lane(int l) const {
    Mat3<Scalar> m;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) m(r, c) = (*this)(r, c)[l];
    return m;
  }

  void set_lane(int l, const Mat3<Scalar>& m) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) (*this)(r, c)[l] = m(r, c);
  }
};

}  // namespace corotet
