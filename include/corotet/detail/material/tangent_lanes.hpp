// The derivative of a stress by the deformation gradient, one in each lane.
#pragma once

#include <array>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>

namespace corotet::inline v0_1 {

/// The symmetric fourth-order tensor dP/dF of a quadrature point, Pa, as 3x3 blocks over columns: entry (i, k) of block
/// (j, l) is dP_ij / dF_kl. Kept are the blocks with j <= l; block (l, j) is the transpose of block (j, l).
template <std::floating_point Scalar>
class TangentLanes {
 public:
  using L = Lanes<Scalar>;  ///< one number of each element

  TangentLanes() {
    for (Mat3Lanes<Scalar>& block : block_)
      for (auto& row : block.entry) row.fill(L(0));
  }

  /// Block (j, l), j <= l.
  [[nodiscard]] Mat3Lanes<Scalar>& block(std::size_t j, std::size_t l) { return block_[number(j, l)]; }
  /// The same, read-only.
  [[nodiscard]] const Mat3Lanes<Scalar>& block(std::size_t j, std::size_t l) const { return block_[number(j, l)]; }

  /// dP_ij / dF_kl of any two columns j and l.
  [[nodiscard]] const L& entry(std::size_t i, std::size_t j, std::size_t k, std::size_t l) const {
    return j <= l ? block(j, l).entry[i][k] : block(l, j).entry[k][i];
  }

  /// Adds factor dF: factor times the identity.
  void add_identity(const L& factor) {
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t i = 0; i < 3; ++i) block(j, j).entry[i][i] += factor;
  }

  /// Adds factor A (A : dF).
  void add_outer(const L& factor, const Mat3Lanes<Scalar>& a) {
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t i = 0; i < 3; ++i) {
        const L scaled = factor * a.entry[i][j];
        for (std::size_t l = j; l < 3; ++l)
          for (std::size_t k = 0; k < 3; ++k) block(j, l).entry[i][k] += scaled * a.entry[k][l];
      }
  }

  /// Adds factor d(cof F)[dF], the second derivative of det F.
  void add_cofactor_derivative(const L& factor, const Mat3Lanes<Scalar>& f) {
    // Columns of cof F are products f_1 x f_2, f_2 x f_0, f_0 x f_1 of the columns of F.
    add_cross(block(0, 1), -factor, f, 2);
    add_cross(block(0, 2), factor, f, 1);
    add_cross(block(1, 2), -factor, f, 0);
  }

 private:
  [[nodiscard]] static constexpr std::size_t number(std::size_t j, std::size_t l) { return j == 0 ? l : j + l + 1; }

  /// block += factor [f_c]x.
  static void add_cross(Mat3Lanes<Scalar>& block, const L& factor, const Mat3Lanes<Scalar>& f, std::size_t c) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      const L scaled = factor * f.entry[i][c];
      block.entry[k][j] += scaled;
      block.entry[j][k] -= scaled;
    }
  }

  std::array<Mat3Lanes<Scalar>, 6> block_;
};

}  // namespace corotet::inline v0_1
