// Factor the body once, then turn the factor with it: the preconditioner for small bodies, stiff ones most of all.
#pragma once

#include <array>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/shared.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/block_cholesky.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/refactorization_policy.hpp>
#include <corotet/detail/solve/rotation_of_points.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <corotet/detail/solve/symbolic_factor.hpp>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// z = Q A0^-1 Q^T r, where Q turns each vertex as its neighbours have turned, and A0 = Q^T A Q at the time of the
/// factorisation. Each element's warped stiffness is R K_e R^T, so that Q A0 Q^T is close to A as long as neighbours
/// turn alike (Courtecuisse, Allard, Duriez & Cotin 2010, "Asynchronous preconditioners for efficient solving of
/// non-linear deformations", turn a factor so). RefactorizationPolicy says when the factor is made again.
template <std::floating_point Scalar>
class WarpedCholesky {
 public:
  using scalar_type = Scalar;                ///< of the matrix
  static constexpr int estimator_delay = 0;  ///< its error estimate needs no delay

  /// If the factor is too large for 32-bit indices, `apply` returns not-a-number.
  COROTET_COLD void analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& rest) {
    analyze(pattern, rest, detail::Shared<detail::SymbolicFactor>::make(*pattern));
  }
  /// The same with a symbolic factor of the pattern that is there.
  COROTET_COLD void analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& rest,
                            detail::Shared<detail::SymbolicFactor> symbolic) {
    *this = {};
    pattern_ = pattern;
    PaddedField<Scalar> padded(rest.size());
    for (std::size_t v = 0; v < rest.size(); ++v) padded[v].set(rest[v]);
    rest_ = detail::Shared<PaddedField<Scalar>>::make(std::move(padded));
    cholesky_.analyze(std::move(symbolic), compact);
    rotation_ = detail::Scratch<Mat3<Scalar>>(rest.size());
    sum_ = DeterministicSum(size_of(rest));
  }

  /// See Preconditioner.
  COROTET_COLD void update(const StepSystem<Scalar>& system, ExecutorRef executor) {
    if (!cholesky_.is_ready()) return;
    turn(system.displacement, executor);
    if (!policy_.should_refactor(system.lag_key)) return;
    for (const double shift : RefactorizationPolicy::shifts)
      if (factorize(system.matrix, shift, executor)) return;
    policy_.failed();
  }

  /// See Preconditioner.
  double apply(const PaddedField<Scalar>& r, PaddedField<Scalar>& z, ExecutorRef executor) {
    if (!cholesky_.has_factor()) return std::numeric_limits<double>::quiet_NaN();
    policy_.count();
    const std::vector<Index>& place = cholesky_.symbolic().place;
    for_ranges(executor, size_of(r), DeterministicSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const Columns column = columns(rotation_[at(i)]);
        product(transposed(column[0], column[1], column[2]), r[at(i)]).store(cholesky_.segment(place[at(i)]));
      }
    });
    cholesky_.solve_segments();
    return sum_(executor, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        z[at(i)].set(product(columns(rotation_[at(i)]), cholesky_.segment(place[at(i)])).first_three());
      return detail::range_dot(r, z, begin, end);
    });
  }

  /// Bytes of its own, and those that copies share.
  [[nodiscard]] MemoryUse memory() const {
    MemoryUse use = cholesky_.memory() + sum_.memory();
    use.owned += detail::bytes_of(rotation_);
    if (rest_) use.shared += detail::bytes_of(*rest_);
    return use;
  }

  /// For snapshots.
  COROTET_COLD void visit_state(detail::StateArchive& archive) {
    cholesky_.visit_state(archive);
    policy_.visit_state(archive);
  }

 private:
  using Q = detail::Vec4<Scalar>;
  using Columns = std::array<Q, 3>;
  static constexpr bool compact = BlockCholesky<Scalar>::can_be_compact;
  static_assert(BlockCholesky<Scalar>::width == 4);

  /// Of a matrix, each with a number without meaning behind it.
  [[nodiscard]] COROTET_ALWAYS_INLINE static Columns columns(const Mat3<Scalar>& m) {
    return {Q::load(m.data()), Q::load(m.data() + 3), Q::template load_part<3>(m.data() + 6)};
  }
  template <class Vector>
  [[nodiscard]] COROTET_ALWAYS_INLINE static Q product(const Columns& column, const Vector& v) {
    return column[0] * Q(v[0]) + column[1] * Q(v[1]) + column[2] * Q(v[2]);
  }

  /// The factor of the matrix, turned back, with `shift` times its diagonal more.
  COROTET_COLD bool factorize(const BlockMatrix<Scalar>& matrix, double shift, [[maybe_unused]] ExecutorRef executor) {
    const BlockPattern& p = *pattern_;
    const auto turned_back = [&](Index i, Index slot) {
      const Mat3<Scalar> back = rotation_[at(i)].transpose();
      auto block = (back * matrix.block(slot) * rotation_[at(p.column[at(slot)])]).template cast<double>();
      if (slot == p.diagonal[at(i)])
        for (int c = 0; c < 3; ++c) block(c, c) *= 1 + shift;
      return block;
    };
    if constexpr (!compact) {
      cholesky_.begin();
      for_ranges(executor, p.rows(), DeterministicSum::grain, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i)
          for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k)
            if (cholesky_.takes(k)) cholesky_.entry(k) = turned_back(i, k);
      });
      return cholesky_.factorize();
    } else {
      return cholesky_.factorize(p, turned_back);
    }
  }

  /// The rotation of each vertex: that of the edges to its neighbours.
  void turn(const Field<Scalar>& displacement, ExecutorRef executor) {
    const BlockPattern& p = *pattern_;
    const PaddedField<Scalar>& rest_positions = *rest_;
    const auto place = [&](Index i) { return Q::load(cholesky_.segment(i)); };  // free outside a solve
    for_ranges(executor, p.rows(), DeterministicSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        PaddedVector<Scalar> moved;
        moved.set(rest_positions[at(i)].vector() + displacement[at(i)]);
        moved.vec4().store(cholesky_.segment(i));
      }
    });
    for_ranges(executor, p.rows(), DeterministicSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const Q rest = rest_positions[at(i)].vec4(), here = place(i);
        Columns moment{Q(Scalar(0)), Q(Scalar(0)), Q(Scalar(0))};
        for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k) {
          const Index j = p.column[at(k)];
          const Q now = place(j) - here;
          PaddedVector<Scalar> edge;
          edge.set(rest_positions[at(j)].vec4() - rest);
          COROTET_UNROLL
          for (std::size_t c = 0; c < 3; ++c) moment[c] += now * Q(edge[c]);
        }
        for (std::size_t c = 0; c < 3; ++c) moment[c].template store_part<3>(rotation_[at(i)].data() + 3 * c);
      }
    });
    rotations_of_moments(rotation_, executor);
  }

  std::shared_ptr<const BlockPattern> pattern_;
  detail::Shared<PaddedField<Scalar>> rest_;  // m
  detail::Scratch<Mat3<Scalar>> rotation_;    // of each vertex, as `update` found it
  BlockCholesky<Scalar> cholesky_;
  RefactorizationPolicy policy_;
  DeterministicSum sum_;
};

}  // namespace corotet::inline v0_1
