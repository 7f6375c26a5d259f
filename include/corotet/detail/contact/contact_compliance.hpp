// How much a point of a body gives way by the diagonal of a step's matrix.
#pragma once

#include <algorithm>
#include <concepts>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/assembly/mass.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1::detail {

/// The compliance of a point of contact, 1/kg: summed over the vertices that carry it.
struct ContactCompliance {
  double along = 0, across = 0;  ///< the normal, and in the plane of the contact
  bool is_held = true;           ///< pins let no vertex move along the normal

  /// Adds a vertex, row `row` of the matrix, with a weight, squared. `normal`: in the frame of the matrix.
  template <std::floating_point Scalar>
  void add(const BlockMatrix<Scalar>& matrix, const Mass<Scalar>& mass, Index row, double weight2,
           const Vec3<double>& normal) {
    const BlockPattern& pattern = matrix.pattern();
    const Mat3<double> inverse = matrix.diagonal(row).template cast<double>().inverse();
    const double here = normal.dot(inverse * normal);
    // The mass alone has this one. A consistent tangent that is indefinite may have a larger one, or none.
    const double most = 1 / static_cast<double>(mass.factor(pattern, row, pattern.diagonal[at(row)]));
    const auto bounded = [most](double compliance) { return compliance > 0 ? (std::min)(compliance, most) : most; };
    along += weight2 * bounded(here);
    across += weight2 * bounded((inverse.trace() - here) / 2);
    for (int i = 0; i < 3; ++i) is_held = is_held && (is_zero(normal[i]) || is_pinned(matrix, row, i));
  }

 private:
  /// Whether an equation of a vertex stands apart from those of all others, as those of pinned components do.
  template <std::floating_point Scalar>
  [[nodiscard]] static bool is_pinned(const BlockMatrix<Scalar>& matrix, Index row, int component) {
    const BlockPattern& pattern = matrix.pattern();
    for (Index k = pattern.row_start[at(row)]; k < pattern.row_start[at(row) + 1]; ++k)
      if (pattern.column[at(k)] != row)
        for (int j = 0; j < 3; ++j)
          if (!is_zero(matrix.block(k)(component, j))) return false;
    return true;
  }
};

}  // namespace corotet::inline v0_1::detail
