// Where conjugate gradients start: motion changes little from step to step, so the last solutions nearly hold the next.
#pragma once

#include <array>
#include <corotet/core/executor.hpp>
#include <corotet/core/register.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/range_sum.hpp>
#include <corotet/solve/step_system.hpp>
#include <cstddef>
#include <utility>

namespace corotet {

/// Keeps the last solutions, and starts from that combination of them which is nearest to the new solution in the
/// energy norm (Fischer 1998, "Projection techniques for iterative solution of Ax = b with successive right-hand
/// sides", method 1): whatever they are worth, it is no farther away than zero is. Costs one pass over the matrix.
template <std::floating_point Scalar>
class FirstGuess {
 public:
  static constexpr std::size_t depth = 2;

  FirstGuess() = default;
  explicit FirstGuess(Index vertices) : sums_(vertices) {
    for (std::size_t k = 0; k < depth; ++k) product_[k] = last_[k] = PaddedField<Scalar>(at(vertices));
  }

  /// Sets x to the guess and r to right_side - A x; returns the guess's energy x . A x.
  template <Executor E>
  double start(const StepSystem<Scalar>& system, PaddedField<Scalar>& x, PaddedField<Scalar>& r, E& executor) {
    for (PaddedField<Scalar>& last : last_)
      for (const Index v : system.pinned) last[at(v)] = {};
    const auto sums = sums_(executor, [&](Index begin, Index end) {
      multiply(system.matrix, begin, end);
      for (Index i = begin; i < end; ++i) r[at(i)].set(system.right_side[at(i)]);
      return Sums{range_dot(last_[0], product_[0], begin, end), range_dot(last_[0], product_[1], begin, end),
                  range_dot(last_[1], product_[1], begin, end), range_dot(last_[0], r, begin, end),
                  range_dot(last_[1], r, begin, end)};
    });
    const Combination c = nearest(sums);
    for_ranges(executor, size_of(x), RangeSum::grain, [&](Index begin, Index end) {
      const auto of = [&](auto& field) { return range_of(field, begin, end); };
      const auto first = static_cast<Scalar>(c.factor[0]), second = static_cast<Scalar>(c.factor[1]);
      of(x) = first * of(last_[0]) + second * of(last_[1]);
      of(r) -= first * of(product_[0]) + second * of(product_[1]);
    });
    return c.energy;
  }

  /// Keeps a solution; the oldest is forgotten.
  void remember(const PaddedField<Scalar>& x) {
    std::swap(last_[0], last_[1]);
    last_[0] = x;
  }

 private:
  /// x0.Ax0, x0.Ax1, x1.Ax1, x0.b, x1.b
  using Sums = typename RangeSums<5>::Sums;

  struct Combination {
    std::array<double, depth> factor{};
    double energy = 0;
  };

  /// Solves the projected equation by elimination; what the older solution adds to the newer one is left out where
  /// rounding hides it.
  [[nodiscard]] static Combination nearest(const Sums& s) {
    const auto [a00, a01, a11, b0, b1] = s;
    Combination c;
    if (!(a00 > 0)) return c;
    const double share = a01 / a00, rest = a11 - share * a01;
    if (rest > 1e-8 * a11) c.factor[1] = (b1 - share * b0) / rest;
    c.factor[0] = b0 / a00 - share * c.factor[1];
    c.energy = c.factor[0] * b0 + c.factor[1] * b1;
    return c;
  }

  /// Rows [begin, end) of both products, for one read of the matrix.
  void multiply(const BlockMatrix<Scalar>& matrix, Index begin, Index end) {
    using Q = Quad<Scalar>;
    const BlockPattern& p = matrix.pattern();
    for (Index i = begin; i < end; ++i) {
      std::array<Q, 3> u{Q(Scalar(0)), Q(Scalar(0)), Q(Scalar(0))}, v = u;
      for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k) {
        const Scalar* a = matrix.values(k);
        const Index j = p.column[at(k)];
        for (std::size_t c = 0; c < 3; ++c) {
          const Q column = Q::load(a + 3 * c);
          u[c] += column * Q(last_[0][at(j)][c]);
          v[c] += column * Q(last_[1][at(j)][c]);
        }
      }
      product_[0][at(i)].set((u[0] + u[1] + u[2]).first_three());
      product_[1][at(i)].set((v[0] + v[1] + v[2]).first_three());
    }
  }

  std::array<PaddedField<Scalar>, depth> last_, product_;
  RangeSums<5> sums_;
};

}  // namespace corotet
