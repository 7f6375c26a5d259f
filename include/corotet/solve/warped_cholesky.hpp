// Factor the body once, then turn the factor with it: the preconditioner for small bodies, stiff ones most of all.
#pragma once

#include <array>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/buffer.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/register.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/block_cholesky.hpp>
#include <corotet/solve/block_factor.hpp>
#include <corotet/solve/range_sum.hpp>
#include <corotet/solve/renewal.hpp>
#include <corotet/solve/rotation_of_points.hpp>
#include <corotet/solve/solver.hpp>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

namespace corotet::inline v0_1 {

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
  COROTET_COLD void analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& rest) {
    pattern_ = pattern;
    rest_ = PaddedField<Scalar>(rest.size());
    for (std::size_t v = 0; v < rest.size(); ++v) rest_[v].set(rest[v]);
    cholesky_.analyze(*pattern);
  }
  [[nodiscard]] bool fits() const { return cholesky_.fits(); }
  [[nodiscard]] std::size_t factor_blocks() const { return cholesky_.factor_blocks(); }
  [[nodiscard]] double factor_flops() const { return cholesky_.factor_flops(); }

  COROTET_COLD void allocate() {
    cholesky_.allocate();
    unturned_ = BlockMatrix<double>(pattern_);
    factor_.assign(cholesky_.factor());
    place_ = rest_;
    rotation_.assign(rest_.size(), Mat3<Scalar>::Identity());
    turned_back_.assign(rest_.size(), Vec3<Scalar>::Zero());
    sum_ = RangeSum(size_of(rest_));
  }

  void update(const StepSystem<Scalar>& system, ExecutorRef executor) {
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

  double apply(const PaddedField<Scalar>& r, PaddedField<Scalar>& z, ExecutorRef executor) {
    if (!usable_) return std::numeric_limits<double>::quiet_NaN();
    renewal_.count();
    for_ranges(executor, size_of(r), RangeSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const Columns column = columns(rotation_[at(i)]);
        product(transposed(column[0], column[1], column[2]), r[at(i)])
            .template store_part<3>(turned_back_[at(i)].data());
      }
    });
    Scalar* const numbers = turned_back_.front().data();
    factor_.solve(numbers, numbers);
    return sum_(executor, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        z[at(i)].set(product(columns(rotation_[at(i)]), turned_back_[at(i)]).first_three());
      return range_dot(r, z, begin, end);
    });
  }

 private:
  using Q = Quad<Scalar>;
  using Columns = std::array<Q, 3>;

  /// Of a matrix, each with a number without meaning behind it.
  [[nodiscard]] COROTET_ALWAYS_INLINE static Columns columns(const Mat3<Scalar>& m) {
    return {Q::load(m.data()), Q::load(m.data() + 3), Q::template load_part<3>(m.data() + 6)};
  }
  template <class Vector>
  [[nodiscard]] COROTET_ALWAYS_INLINE static Q product(const Columns& column, const Vector& v) {
    return column[0] * Q(v[0]) + column[1] * Q(v[1]) + column[2] * Q(v[2]);
  }

  /// The rotation of each vertex: that of the edges to its neighbours.
  void turn(const Field<Scalar>& displacement, ExecutorRef executor) {
    const BlockPattern& p = *pattern_;
    for_ranges(executor, p.rows(), RangeSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) place_[at(i)].set(rest_[at(i)].vector() + displacement[at(i)]);
    });
    for_ranges(executor, p.rows(), RangeSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const Q rest = rest_[at(i)].quad(), place = place_[at(i)].quad();
        Columns moment{Q(Scalar(0)), Q(Scalar(0)), Q(Scalar(0))};
        for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k) {
          const Index j = p.column[at(k)];
          const Q now = place_[at(j)].quad() - place;
          PaddedVector<Scalar> edge;
          edge.set(rest_[at(j)].quad() - rest);
          COROTET_UNROLL
          for (std::size_t c = 0; c < 3; ++c) moment[c] += now * Q(edge[c]);
        }
        for (std::size_t c = 0; c < 3; ++c) moment[c].template store_part<3>(rotation_[at(i)].data() + 3 * c);
      }
    });
    rotations_of_moments(rotation_, executor);
  }

  std::shared_ptr<const BlockPattern> pattern_;
  PaddedField<Scalar> rest_, place_;  // m
  Field<Scalar> turned_back_;
  detail::Buffer<Mat3<Scalar>> rotation_;
  BlockCholesky<double> cholesky_;
  BlockMatrix<double> unturned_;
  BlockFactor<Scalar, 3> factor_;
  Renewal renewal_;
  RangeSum sum_;
  bool usable_ = false;
};

}  // namespace corotet::inline v0_1
