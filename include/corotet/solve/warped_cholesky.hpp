// Factor the body once, then turn the factor with it: the preconditioner for small bodies, stiff ones most of all.
#pragma once

#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/block_cholesky.hpp>
#include <corotet/solve/block_factor.hpp>
#include <corotet/solve/range_sum.hpp>
#include <corotet/solve/renewal.hpp>
#include <corotet/solve/rotation_of_points.hpp>
#include <corotet/solve/solver.hpp>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace corotet {

/// z = Q A0^-1 Q^T r, where Q turns each vertex as its neighbours have turned, and A0 = Q^T A Q at the time of the
/// factorisation. Each element's warped stiffness is R K_e R^T, so that Q A0 Q^T is close to A as long as neighbours
/// turn alike (Courtecuisse, Allard, Duriez & Cotin 2010, "Asynchronous preconditioners for efficient solving of
/// non-linear deformations", turn a factor so). Factors again when Renewal says so.
template <std::floating_point Scalar>
class WarpedCholesky {
 public:
  static constexpr int error_delay = 0;

  WarpedCholesky() = default;

  /// Ordering and pattern of the factor; `allocate` must follow before use.
  void analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& rest) {
    pattern_ = pattern;
    rest_ = rest;
    cholesky_.analyze(*pattern);
  }
  [[nodiscard]] bool fits() const { return cholesky_.fits(); }
  [[nodiscard]] std::size_t factor_blocks() const { return cholesky_.factor_blocks(); }
  [[nodiscard]] double factor_flops() const { return cholesky_.factor_flops(); }

  void allocate() {
    cholesky_.allocate();
    unturned_ = BlockMatrix<double>(pattern_);
    factor_.assign(cholesky_.factor());
    rotation_.assign(rest_.size(), Mat3<Scalar>::Identity());
    turned_back_.assign(rest_.size(), Vec3<Scalar>::Zero());
    sum_ = RangeSum(size_of(rest_));
  }

  template <Executor E>
  void update(const StepSystem<Scalar>& system, E& executor) {
    turn(system.displacement, executor);
    if (!renewal_.due(system.era)) return;
    const BlockPattern& p = *pattern_;
    for_ranges(executor, p.rows(), RangeSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k)
          unturned_.block(k) = (rotation_[at(i)].transpose() * system.matrix.block(k) * rotation_[at(p.column[at(k)])])
                                   .template cast<double>();
    });
    if (cholesky_.factorize(unturned_)) {
      factor_.assign(cholesky_.factor());
      usable_ = true;
    } else {
      renewal_.failed();  // and the last factor that could be made serves on
    }
  }

  template <Executor E>
  double apply(const PaddedField<Scalar>& r, PaddedField<Scalar>& z, E& executor) {
    if (!usable_) return std::numeric_limits<double>::quiet_NaN();
    renewal_.count();
    for_ranges(executor, size_of(r), RangeSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        turned_back_[at(i)].noalias() = rotation_[at(i)].transpose() * r[at(i)].vector();
    });
    Scalar* const numbers = turned_back_.front().data();
    factor_.solve(numbers, numbers);
    return sum_(executor, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) z[at(i)].set((rotation_[at(i)] * turned_back_[at(i)]).eval());
      return range_dot(r, z, begin, end);
    });
  }

 private:
  /// The rotation of each vertex: that of the edges to its neighbours.
  template <Executor E>
  void turn(const Field<Scalar>& displacement, E& executor) {
    const BlockPattern& p = *pattern_;
    for_ranges(executor, p.rows(), RangeSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        Mat3<Scalar> moment = Mat3<Scalar>::Zero();
        for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k) {
          const Index j = p.column[at(k)];
          const Vec3<Scalar> edge = rest_[at(j)] - rest_[at(i)];
          moment += (edge + (displacement[at(j)] - displacement[at(i)])) * edge.transpose();
        }
        rotation_[at(i)] = moment;
      }
    });
    rotations_of_moments(rotation_, executor);
  }

  std::shared_ptr<const BlockPattern> pattern_;
  Field<Scalar> rest_, turned_back_;
  std::vector<Mat3<Scalar>> rotation_;
  BlockCholesky<double> cholesky_;
  BlockMatrix<double> unturned_;
  BlockFactor<Scalar, 3> factor_;
  Renewal renewal_;
  RangeSum sum_;
  bool usable_ = false;
};

static_assert(Preconditioner<WarpedCholesky<float>, float>);

}  // namespace corotet
