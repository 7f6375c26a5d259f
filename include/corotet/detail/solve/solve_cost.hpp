// What a solve will cost, before it is tried: how a solver chooses.
#pragma once

#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1::detail {

/// The time of one solve of a step, in products of its matrix with a vector. Counts what is read and computed, with
/// weights that were measured (docs/benchmarks/speed.md has the figures, `corotet bench` prints the prediction beside
/// the time). A ratio of times on one machine: it holds roughly on others, which a clock would not.
class SolveCost {
 public:
  SolveCost() = default;
  /// The body: blocks in its matrix, vertices.
  SolveCost(Index matrix_blocks, Index vertices) : blocks_(double(matrix_blocks)), vertices_(double(vertices)) {}

  /// Iterations of conjugate gradients where nothing is known yet: 4 to 8 for a soft body that moves steadily, 13 to 20
  /// for a stiff one; with a factor of the whole body, one or two.
  static constexpr double usual_rigid_iterations = 8, usual_warped_iterations = 1.3;

  /// With rigid aggregates whose coarse factor has as many 6x6 blocks.
  [[nodiscard]] double rigid_aggregates(double factor_blocks, double iterations = usual_rigid_iterations) const {
    const double application = 3.0 * vertices_ + 8.0 * factor_blocks, update = 25 * vertices_;
    return solve(iterations, application, update);
  }

  /// With the whole body's factor of as many 3x3 blocks, turned with its vertices.
  [[nodiscard]] double warped_cholesky(double factor_blocks, double iterations = usual_warped_iterations) const {
    const double application = 1.7 * factor_blocks + 8 * vertices_, update = 0.8 * blocks_ + 60 * vertices_;
    return solve(iterations, application, update);
  }

 private:
  /// The initial guess costs 1.4 products, the residual that is measured at the end one. Applications are those of the
  /// iterations, and one before and one after.
  [[nodiscard]] double solve(double iterations, double application, double update) const {
    const double vectors = 1.5 * vertices_;
    return 2.4 + iterations * (1 + vectors / blocks_) + ((iterations + 2) * application + update) / blocks_;
  }

  double blocks_ = 0, vertices_ = 0;
};

}  // namespace corotet::inline v0_1::detail
