// The linear system of a step, with what a solver may make use of besides its matrix.
#pragma once

#include <concepts>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstdint>
#include <span>

namespace corotet::inline v0_1 {

/// A symmetric, positive semi-definite matrix that is known by its products: what couples vertices that no element
/// does.
template <std::floating_point Scalar>
class MatrixFreeTerm {
 public:
  /// Adds the product with x to y. Allocates nothing.
  virtual void add(const PaddedField<Scalar>& x, PaddedField<Scalar>& y) const = 0;

 protected:
  MatrixFreeTerm() = default;
  MatrixFreeTerm(const MatrixFreeTerm&) = default;
  MatrixFreeTerm& operator=(const MatrixFreeTerm&) = default;
  ~MatrixFreeTerm() = default;
};

/// (matrix + coupling) * x = right_side.
template <std::floating_point Scalar>
struct StepSystem {
  const BlockMatrix<Scalar>& matrix;  ///< symmetric, positive definite
  const Field<Scalar>& right_side;    ///< kg m/s, one a row
  /// Of the state in which the matrix was assembled, m: with the rest positions given to `analyze`, how far each part
  /// of the body has turned.
  const Field<Scalar>& displacement;
  /// Vertices whose equations stand alone, with zero on the right side.
  std::span<const Index> pinned;
  /// > 0. Another number means that the matrix changed for other reasons than the displacement: a far longer or shorter
  /// step, other damping, other materials, other pins. See LagKey.
  std::uint64_t lag_key = 0;
  /// To be added to the matrix, unless null: the sum is positive definite. Preconditioners may
  /// ignore it; a solver that cannot add it returns SolveStatus::invalid_options.
  const MatrixFreeTerm<Scalar>* coupling = nullptr;
  /// >= 1: the solution may be so many times less accurate than the solver's tolerance.
  double looseness = 1;
};

}  // namespace corotet::inline v0_1
