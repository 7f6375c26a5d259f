// The linear solvers: right answers, honest reports.
#include <corotet/assembly/assemble.hpp>
#include <corotet/rotation/polar.hpp>
#include <corotet/solve/auto_solver.hpp>
#include <corotet/solve/block_cholesky.hpp>
#include <corotet/solve/block_jacobi.hpp>
#include <corotet/solve/pcg.hpp>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <memory>

#include "support/bodies.hpp"

namespace corotet {
namespace {

/// M + h^2 K' of a deformed beam, with a few vertices isolated as pins are.
template <class Scalar, class Element>
BlockMatrix<Scalar> step_matrix(std::array<Index, 3> cells) {
  const auto mesh = testing::distorted_block<Scalar, Element>({.size = {1, 0.3, 0.3}, .cells = cells}, 0.2, 1);
  const Material material{.young = 5e5, .poisson = 0.3, .density = 1000};
  const Elasticity<Scalar, Element> law(mesh, material);
  const auto pattern = std::make_shared<const BlockPattern>(BlockPattern::of(mesh.elements(), mesh.vertex_count()));
  ElasticEvaluation<Scalar, Element> state(law);
  SerialExecutor serial;
  law.evaluate(testing::random_field<Scalar>(mesh.vertex_count(), 0.01, 2), state, serial);
  BlockMatrix<Scalar> a(pattern);
  const Scalar h = Scalar(1) / 60;
  assemble(law, state, Mass<Scalar>(mesh, material, MassModel::lumped, *pattern), Scalar(1), h * h, a, serial);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.position(v).x() == 0) a.isolate(v);
  return a;
}

template <class Scalar>
Eigen::MatrixXd dense(const BlockMatrix<Scalar>& a) {
  const BlockPattern& p = a.pattern();
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(3 * a.rows(), 3 * a.rows());
  for (Index i = 0; i < a.rows(); ++i)
    for (Index s = p.row_start[at(i)]; s < p.row_start[at(i) + 1]; ++s)
      d.block<3, 3>(3 * i, 3 * p.column[at(s)]) = a.block(s).template cast<double>();
  return d;
}

template <class T>
class Solvers : public ::testing::Test {};
TYPED_TEST_SUITE(Solvers, testing::AllCases);

TYPED_TEST(Solvers, AgreeWithADenseFactorisation) {
  using Scalar = typename TypeParam::Scalar;
  const auto a = step_matrix<Scalar, typename TypeParam::Element>({4, 2, 2});
  const Field<Scalar> b = testing::random_field<Scalar>(a.rows(), 1, 3);
  const Eigen::VectorXd exact = dense(a).llt().solve(flat(b).template cast<double>());
  SerialExecutor serial;
  for (const SolverMethod method : {SolverMethod::pcg, SolverMethod::cholesky, SolverMethod::automatic})
    for (const PreconditionerKind kind : {PreconditionerKind::jacobi, PreconditionerKind::block_jacobi}) {
      const double tolerance = sizeof(Scalar) == 4 ? 1e-5 : 1e-12;
      AutoSolver<Scalar> solver({.method = method, .preconditioner = kind, .tolerance = tolerance});
      solver.analyze(a.pattern());
      Field<Scalar> x(b.size());
      const SolveReport report = solver.solve(a, b, x, serial);
      EXPECT_EQ(report.status, SolveStatus::converged);
      EXPECT_LE(report.residual, tolerance);
      EXPECT_LT((flat(x).template cast<double>() - exact).norm(), 200 * tolerance * exact.norm());
      EXPECT_TRUE(method == SolverMethod::automatic || solver.method() == method);
    }
}

TYPED_TEST(Solvers, ReportTheResidualThatIsThere) {
  using Scalar = typename TypeParam::Scalar;
  const auto a = step_matrix<Scalar, typename TypeParam::Element>({6, 2, 2});
  const Field<Scalar> b = testing::random_field<Scalar>(a.rows(), 1, 4);
  SerialExecutor serial;
  AutoSolver<Scalar> solver({.method = SolverMethod::pcg, .tolerance = 1e-3});
  solver.analyze(a.pattern());
  Field<Scalar> x(b.size()), r(b.size());
  const SolveReport report = solver.solve(a, b, x, serial);
  a.apply(x, r, serial);
  flat(r) = flat(b) - flat(r);
  double rz = 0, bz = 0;
  for (Index i = 0; i < a.rows(); ++i) {
    const Mat3<Scalar> inverse = a.diagonal(i).inverse();
    rz += double(r[at(i)].dot(inverse * r[at(i)]));
    bz += double(b[at(i)].dot(inverse * b[at(i)]));
  }
  EXPECT_LE(report.residual, 1e-3);
  EXPECT_NEAR(std::sqrt(rz / bz), report.residual, 0.05 * report.residual);
}

TYPED_TEST(Solvers, ReachingTheIterationLimitIsReported) {
  using Scalar = typename TypeParam::Scalar;
  const auto a = step_matrix<Scalar, typename TypeParam::Element>({4, 2, 2});
  const Field<Scalar> b = testing::random_field<Scalar>(a.rows(), 1, 3);
  SerialExecutor serial;
  AutoSolver<Scalar> solver({.method = SolverMethod::pcg, .tolerance = 1e-6, .max_iterations = 3});
  solver.analyze(a.pattern());
  Field<Scalar> x(b.size());
  const SolveReport report = solver.solve(a, b, x, serial);
  EXPECT_EQ(report.status, SolveStatus::iteration_limit);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_GT(report.residual, 1e-6);
}

TYPED_TEST(Solvers, AMatrixThatIsNotPositiveDefiniteIsReported) {
  using Scalar = typename TypeParam::Scalar;
  auto a = step_matrix<Scalar, typename TypeParam::Element>({2, 1, 1});
  const Field<Scalar> b = testing::random_field<Scalar>(a.rows(), 1, 3);
  SerialExecutor serial;
  for (const Scalar diagonal : {Scalar(-1), std::numeric_limits<Scalar>::quiet_NaN()}) {
    a.block(a.pattern().diagonal.back()) = diagonal * Mat3<Scalar>::Identity();
    for (const SolverMethod method : {SolverMethod::pcg, SolverMethod::cholesky}) {
      AutoSolver<Scalar> solver({.method = method});
      solver.analyze(a.pattern());
      Field<Scalar> x(b.size());
      EXPECT_EQ(solver.solve(a, b, x, serial).status, SolveStatus::breakdown);
    }
  }
}

TYPED_TEST(Solvers, ZeroRightSideNeedsNoIteration) {
  using Scalar = typename TypeParam::Scalar;
  const auto a = step_matrix<Scalar, typename TypeParam::Element>({2, 1, 1});
  const Field<Scalar> b(at(a.rows()), Vec3<Scalar>::Zero());
  SerialExecutor serial;
  for (const SolverMethod method : {SolverMethod::pcg, SolverMethod::cholesky}) {
    AutoSolver<Scalar> solver({.method = method});
    solver.analyze(a.pattern());
    Field<Scalar> x = testing::random_field<Scalar>(a.rows(), 1, 5);
    const SolveReport report = solver.solve(a, b, x, serial);
    EXPECT_EQ(report.status, SolveStatus::converged);
    EXPECT_EQ(report.iterations, 0);
    EXPECT_EQ(flat(x).norm(), 0);
  }
}

/// The fill-reducing order works: the factor of a beam, which is a band, stays near its band, far below a dense factor;
/// and one symbolic analysis serves matrix after matrix.
TEST(BlockCholesky, KeepsTheFactorSparseAndRefactorizes) {
  auto a = step_matrix<double, Tet4>({24, 2, 2});
  BlockCholesky<double> cholesky;
  cholesky.analyze(a.pattern());
  cholesky.allocate();
  const double n = a.rows();
  EXPECT_LT(static_cast<double>(cholesky.factor_blocks()), 0.15 * n * n / 2);
  const Field<double> b = testing::random_field<double>(a.rows(), 1, 6);
  Field<double> x(b.size());
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(cholesky.factorize(a));
    cholesky.solve(b, x);
    EXPECT_LT((dense(a) * flat(x) - flat(b)).norm(), 1e-10 * flat(b).norm());
    for (Index i = 0; i < a.rows(); ++i) a.block(a.pattern().diagonal[at(i)]) *= 1.5;
  }
}

}  // namespace
}  // namespace corotet
