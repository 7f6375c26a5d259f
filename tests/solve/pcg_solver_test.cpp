// A preconditioner of a reader's own: one class, and it serves a step.
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/solve/block_jacobi.hpp>
#include <corotet/detail/solve/pcg_solver.hpp>
#include <corotet/detail/solve/rigid_aggregates.hpp>
#include <corotet/detail/solve/warped_cholesky.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "solve/step_matrices.hpp"

namespace corotet::pcg_solver_test {
namespace {

/// Symmetric block Gauss-Seidel, z = (D + U)^-1 D (D + L)^-1 r with A = L + D + U (Saad 2003, section 10.2).
template <std::floating_point Scalar>
class GaussSeidel {
 public:
  using scalar_type = Scalar;
  static constexpr int estimator_delay = 8;

  void analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& /*rest*/) {
    inverse_.resize(at(pattern->rows()));
  }

  void update(const StepSystem<Scalar>& system, ExecutorRef /*executor*/) {
    matrix_ = &system.matrix;  // which outlives the solve
    for (Index i = 0; i < matrix_->rows(); ++i) inverse_[at(i)] = matrix_->diagonal(i).inverse();
  }

  double apply(const PaddedField<Scalar>& r, PaddedField<Scalar>& z, ExecutorRef /*executor*/) {
    const BlockPattern& p = matrix_->pattern();
    const auto others = [&](Index i, Index begin, Index end) {  // sum of A_ij z_j
      Vec3<Scalar> sum = Vec3<Scalar>::Zero();
      for (Index k = begin; k < end; ++k)
        if (k != p.diagonal[at(i)]) sum += matrix_->block(k) * z[at(p.column[at(k)])].vector();
      return sum;
    };
    double product = 0;
    for (Index i = 0; i < p.rows(); ++i)
      z[at(i)].set(inverse_[at(i)] * (r[at(i)].vector() - others(i, p.row_start[at(i)], p.diagonal[at(i)])));
    for (Index i = p.rows() - 1; i >= 0; --i) {
      const Vec3<Scalar> after = inverse_[at(i)] * others(i, p.diagonal[at(i)], p.row_start[at(i) + 1]);
      z[at(i)].set(z[at(i)].vector() - after);
      product += static_cast<double>(r[at(i)].vector().dot(z[at(i)].vector()));
    }
    return product;
  }

 private:
  const BlockMatrix<Scalar>* matrix_ = nullptr;
  std::vector<Mat3<Scalar>> inverse_;
};

static_assert(Preconditioner<GaussSeidel<float>, float> && Preconditioner<GaussSeidel<double>, double>);
static_assert(LinearSolver<PcgSolver<GaussSeidel<float>>, float>);
static_assert(LinearSolver<PcgSolver<WarpedCholesky<double>>, double>);

template <class T>
class PcgSolvers : public ::testing::Test {};
using Cases = ::testing::Types<testing::Case<float, Tet4>, testing::Case<double, Tet10>>;
TYPED_TEST_SUITE(PcgSolvers, Cases);

/// Whatever the preconditioner, a solve ends at the same solution; a better one takes fewer iterations.
TYPED_TEST(PcgSolvers, AgreeOnASystem) {
  using Scalar = typename TypeParam::Scalar;
  const testing::BeamSystem<Scalar, typename TypeParam::Element> beam({8, 2, 2}, 5e6);
  const double tolerance = sizeof(Scalar) == 4 ? 1e-5 : 1e-11;
  const auto solve = [&](auto solver, Field<Scalar>& x) {
    solver.analyze(beam.matrix.shared_pattern(), beam.rest());
    x.resize(beam.right_side.size());
    const SolveReport report = solver.solve(beam.system(), x, {});
    EXPECT_EQ(report.status, SolveStatus::converged);
    return report.iterations;
  };
  const PcgOptions options{.tolerance = tolerance};
  Field<Scalar> jacobi, gauss_seidel, rigid, warped;
  const int most = solve(PcgSolver<BlockJacobi<Scalar>>(options), jacobi);
  EXPECT_LT(solve(PcgSolver<GaussSeidel<Scalar>>(options), gauss_seidel), most);
  EXPECT_LT(solve(PcgSolver<RigidAggregates<Scalar>>(options), rigid), most);
  EXPECT_LT(solve(PcgSolver<WarpedCholesky<Scalar>>(options), warped), most);
  for (const Field<Scalar>* other : {&gauss_seidel, &rigid, &warped})
    EXPECT_LT((flat(*other) - flat(jacobi)).norm(), 100 * Scalar(tolerance) * flat(jacobi).norm());
}

/// Steps with it are those with the default solver, to the tolerance.
TYPED_TEST(PcgSolvers, AnotherPreconditionerServesAStep) {
  using Scalar = typename TypeParam::Scalar;
  using Body = SoftBody<Scalar, typename TypeParam::Element>;
  auto body = testing::must(
      Body::create(testing::block<Scalar, typename TypeParam::Element>({.size = {1, 0.2, 0.2}, .cells = {6, 2, 2}}),
                   Material{.young = 5e5}));
  body.pin_where([](const Vec3<Scalar>& x) { return x.x() < Scalar(1e-3); });
  body.set_gravity({0, 0, Scalar(-9.81)});
  auto other = body;
  const double tolerance = sizeof(Scalar) == 4 ? 1e-5 : 1e-11;
  ImplicitEuler<Body, PcgSolver<GaussSeidel<Scalar>>> own(body, PcgOptions{.tolerance = tolerance});
  ImplicitEuler builtin(other, SolverOptions{.tolerance = tolerance});
  int iterations = 0;
  for (int step = 0; step < 20; ++step) {
    const StepReport report = own.step(body, Scalar(1.0 / 60));
    ASSERT_TRUE(report.ok());
    iterations += report.iterations;
    ASSERT_TRUE(builtin.step(other, Scalar(1.0 / 60)).ok());
  }
  EXPECT_GT(iterations, 20);
  EXPECT_LT((flat(body.displacements()) - flat(other.displacements())).norm(), 100 * tolerance);
  EXPECT_GT(flat(body.displacements()).norm(), 0.1);
}

}  // namespace
}  // namespace corotet::pcg_solver_test
