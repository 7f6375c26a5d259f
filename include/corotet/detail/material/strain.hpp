// Strain of a batch of elements, seen from their rotations.
#pragma once

#include <array>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1::detail {

/// sym(R^T F) - I: xx yy zz yz zx xy.
template <std::floating_point Scalar>
struct StrainLanes : std::array<Lanes<Scalar>, 6> {
  [[nodiscard]] Lanes<Scalar> squared_norm() const {
    const StrainLanes& e = *this;
    return e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + Lanes<Scalar>(2) * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]);
  }
  [[nodiscard]] Lanes<Scalar> trace() const { return (*this)[0] + (*this)[1] + (*this)[2]; }
};

/// As sym(R^T (F - R)), so that small strains keep their digits.
template <std::floating_point Scalar>
[[nodiscard]] StrainLanes<Scalar> corotational_strain(const Mat3Lanes<Scalar>& f, const Mat3Lanes<Scalar>& r) {
  Mat3Lanes<Scalar> d;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) d(i, j) = f(i, j) - r(i, j);
  const auto product = [&](int i, int j) -> Lanes<Scalar> {
    return r(0, i) * d(0, j) + r(1, i) * d(1, j) + r(2, i) * d(2, j);
  };
  StrainLanes<Scalar> e;
  for (int i = 0; i < 3; ++i) e[at(i)] = product(i, i);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    e[at(3 + i)] = Lanes<Scalar>(Scalar(0.5)) * (product(j, k) + product(k, j));
  }
  return e;
}

/// R^T F - I, of which corotational_strain is the symmetric part.
template <std::floating_point Scalar>
void rotated_gradient(const Mat3Lanes<Scalar>& f, const Mat3Lanes<Scalar>& r, Mat3Lanes<Scalar>& h) {
  Mat3Lanes<Scalar> d;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) d(i, j) = f(i, j) - r(i, j);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) h(i, j) = r(0, i) * d(0, j) + r(1, i) * d(1, j) + r(2, i) * d(2, j);
}

}  // namespace corotet::inline v0_1::detail
