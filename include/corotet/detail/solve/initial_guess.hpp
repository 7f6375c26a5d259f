// Where conjugate gradients start: the span of the last solutions nearly holds the next, as motion changes little.
#pragma once

#include <array>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/step_system.hpp>
#include <cstddef>
#include <utility>

namespace corotet::inline v0_1::detail {

/// Keeps the last solutions, and starts from that combination of them which is nearest to the new solution in the
/// energy norm (Fischer 1998, "Projection techniques for iterative solution of Ax = b with successive right-hand
/// sides", method 1): whatever they are worth, it is no farther away than zero is. Costs one pass over the matrix.
template <std::floating_point Scalar>
class InitialGuess {
 public:
  static constexpr std::size_t depth = 2;

  InitialGuess() = default;
  COROTET_COLD explicit InitialGuess(Index vertices) : sums_(vertices) {
    for (PaddedField<Scalar>& last : last_) last = PaddedField<Scalar>(at(vertices));
  }

  /// Fields of the caller for the products of the matrix with the last solutions.
  using Products = std::array<PaddedField<Scalar>*, depth>;

  /// Sets x to the guess and r to right_side - A x; returns the guess's energy x . A x.
  double start(const StepSystem<Scalar>& system, PaddedField<Scalar>& x, PaddedField<Scalar>& r,
               const Products& product, ExecutorRef executor) {
    for (PaddedField<Scalar>& last : last_)
      for (const Index v : system.pinned) last[at(v)] = {};
    const bool couples = system.coupling != nullptr;
    if (couples) multiply_coupled(system, product);
    const Sums sums = sums_(executor, [&](Index begin, Index end) {
      if (!couples) multiply(system.matrix, product, begin, end);
      for (Index i = begin; i < end; ++i) r[at(i)].set(system.right_side[at(i)]);
      Sums part;
      std::size_t n = 0;
      for (std::size_t k = 0; k < depth; ++k) {
        for (std::size_t l = 0; l <= k; ++l) part[n++] = range_dot(last_[k], *product[l], begin, end);
        part[n++] = range_dot(last_[k], r, begin, end);
      }
      return part;
    });
    const Combination c = nearest(sums);
    for_ranges(executor, size_of(x), DeterministicSum::grain, [&](Index begin, Index end) {
      static_assert(depth == 2);
      const auto a = static_cast<Scalar>(c.factor[0]), b = static_cast<Scalar>(c.factor[1]);
      map_range(
          begin, end, x, [=](auto p, auto q) { return a * p + b * q; }, last_[0], last_[1]);
      map_range(
          begin, end, r, [=](auto s, auto p, auto q) { return s - a * p - b * q; }, r, *product[0], *product[1]);
    });
    return c.energy;
  }

  /// Keeps a solution, and gives the oldest for it, which is forgotten: nothing is copied.
  void remember(PaddedField<Scalar>& x) {
    for (std::size_t k = depth - 1; k > 0; --k) std::swap(last_[k], last_[k - 1]);
    std::swap(last_[0], x);
  }

  [[nodiscard]] MemoryUse memory() const { return MemoryUse{depth * bytes_of(last_[0]), 0} + sums_.memory(); }

  void visit_state(StateArchive& archive) { archive(last_); }

 private:
  /// For each k: x_k . A x_l for l <= k, then x_k . b
  static constexpr std::size_t sum_count = depth * (depth + 1) / 2 + depth;
  using Sums = typename DeterministicReduction<sum_count>::Sums;

  struct Combination {
    std::array<double, depth> factor{};
    double energy = 0;
  };

  /// Solves the projected equation by Cholesky's method; what an older solution adds to the newer ones is left out
  /// where rounding hides it.
  [[nodiscard]] COROTET_COLD static Combination nearest(const Sums& s) {
    std::array<std::array<double, depth>, depth> l{};
    std::array<double, depth> y{};
    std::array<bool, depth> used{};
    std::size_t n = 0;
    Combination c;
    for (std::size_t k = 0; k < depth; ++k) {
      const double* row = &s[n];
      const double own = row[k], right = row[k + 1];
      n += k + 2;
      double rest = own;
      y[k] = right;
      for (std::size_t j = 0; j < k; ++j) {
        if (!used[j]) continue;
        double sum = row[j];
        for (std::size_t i = 0; i < j; ++i) sum -= l[k][i] * l[j][i];
        l[k][j] = sum / l[j][j];
        rest -= l[k][j] * l[k][j];
        y[k] -= l[k][j] * y[j];
      }
      used[k] = own > 0 && rest > 1e-8 * own;
      if (!used[k]) {
        l[k] = {};
        y[k] = 0;
        continue;
      }
      l[k][k] = detail::square_root(rest);
      y[k] /= l[k][k];
      c.energy += y[k] * y[k];
    }
    for (std::size_t k = depth; k-- > 0;) {
      if (!used[k]) continue;
      double sum = y[k];
      for (std::size_t i = k + 1; i < depth; ++i) sum -= l[i][k] * c.factor[i];
      c.factor[k] = sum / l[k][k];
    }
    return c;
  }

  COROTET_COLD void multiply_coupled(const StepSystem<Scalar>& system, const Products& product) const {
    multiply(system.matrix, product, 0, size_of(last_[0]));
    for (std::size_t k = 0; k < depth; ++k) system.coupling->add(last_[k], *product[k]);
  }

  /// Rows [begin, end) of all products, for one read of the matrix.
  void multiply(const BlockMatrix<Scalar>& matrix, const Products& product, Index begin, Index end) const {
    using Q = Vec4<Scalar>;
    const BlockPattern& p = matrix.pattern();
    for (Index i = begin; i < end; ++i) {
      std::array<Q, 3 * depth> sum;
      sum.fill(Q(Scalar(0)));
      for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k) {
        const Scalar* a = matrix.values(k);
        const Index j = p.column[at(k)];
        COROTET_UNROLL
        for (std::size_t c = 0; c < 3; ++c) {
          const Q column = Q::load(a + 3 * c);
          COROTET_UNROLL
          for (std::size_t v = 0; v < depth; ++v) sum[3 * v + c] += column * Q(last_[v][at(j)][c]);
        }
      }
      for (std::size_t v = 0; v < depth; ++v)
        (*product[v])[at(i)].set((sum[3 * v] + sum[3 * v + 1] + sum[3 * v + 2]).first_three());
    }
  }

  std::array<PaddedField<Scalar>, depth> last_;
  DeterministicReduction<sum_count> sums_;
};

}  // namespace corotet::inline v0_1::detail
