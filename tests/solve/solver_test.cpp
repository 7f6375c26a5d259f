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
BlockMatrix<Scalar> step_matrix(std::array<Index, 3> cells, double young = 5e5) {
  const auto mesh = testing::distorted_block<Scalar, Element>({.size = {1, 0.3, 0.3}, .cells = cells}, 0.2, 1);
  const Material material{.young = young, .poisson = 0.3, .density = 1000};
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

/// Recomputed in double, whatever was asked for: a stiff body and a tolerance beyond float's reach included. The report
/// says converged only where that is true, and something else where it is not.
TYPED_TEST(Solvers, ReportTheResidualThatIsThere) {
  using Scalar = typename TypeParam::Scalar;
  for (const double young : {5e5, 5e8})
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      const auto a = step_matrix<Scalar, typename TypeParam::Element>({6, 2, 2}, young);
      const Field<Scalar> b = testing::random_field<Scalar>(a.rows(), 1, 4);
      SerialExecutor serial;
      AutoSolver<Scalar> solver({.method = SolverMethod::pcg, .tolerance = tolerance, .max_iterations = 20000});
      solver.analyze(a.pattern());
      Field<Scalar> x(b.size());
      const SolveReport report = solver.solve(a, b, x, serial);
      const Eigen::VectorXd right = flat(b).template cast<double>();
      const Eigen::VectorXd r = right - dense(a) * flat(x).template cast<double>();
      double rz = 0, bz = 0;
      for (Index i = 0; i < a.rows(); ++i) {
        const Mat3<double> inverse = a.diagonal(i).template cast<double>().inverse();
        rz += r.segment<3>(3 * i).dot(inverse * r.segment<3>(3 * i));
        bz += right.segment<3>(3 * i).dot(inverse * right.segment<3>(3 * i));
      }
      const double there = std::sqrt(rz / bz);
      if (report.status == SolveStatus::converged)
        EXPECT_LE(there, 1.5 * tolerance) << "E " << young;
      else
        EXPECT_EQ(report.status, SolveStatus::stagnated);
      EXPECT_NEAR(there, report.residual, 0.5 * report.residual + 1e-15)
          << "E " << young << ", tolerance " << tolerance;
      EXPECT_TRUE(sizeof(Scalar) == 4 || report.status == SolveStatus::converged);
    }
}

TYPED_TEST(Solvers, RefuseOptionsOutOfRange) {
  using Scalar = typename TypeParam::Scalar;
  const auto a = step_matrix<Scalar, typename TypeParam::Element>({2, 1, 1});
  const Field<Scalar> b = testing::random_field<Scalar>(a.rows(), 1, 3);
  SerialExecutor serial;
  for (const SolverMethod method : {SolverMethod::pcg, SolverMethod::cholesky})
    for (const double tolerance : {0.0, 1.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
      AutoSolver<Scalar> solver({.method = method, .tolerance = tolerance});
      solver.analyze(a.pattern());
      Field<Scalar> x(b.size());
      EXPECT_EQ(solver.solve(a, b, x, serial).status, SolveStatus::invalid_options);
    }
}

/// Blocks whose determinant leaves the range of float are still inverted.
TEST(BlockJacobi, InvertsBlocksOfAnyMagnitude) {
  const auto mesh = testing::block<float, Tet4>({});
  BlockMatrix<float> a(std::make_shared<const BlockPattern>(BlockPattern::of(mesh.elements(), mesh.vertex_count())));
  Mat3<float> block;
  block << 4, 1, 0, 1, 3, 1, 0, 1, 2;
  SerialExecutor serial;
  for (const float magnitude : {1e-30f, 1e-15f, 1.0f, 1e15f, 1e30f}) {
    for (Index i = 0; i < a.rows(); ++i) a.block(a.pattern().diagonal[at(i)]) = magnitude * block;
    BlockJacobi<float> preconditioner(a.pattern());
    preconditioner.update(a, serial);
    const Field<float> r(at(a.rows()), Vec3<float>(1, 2, 3));
    Field<float> z(r.size());
    preconditioner.apply(r, z, serial);
    EXPECT_LT((magnitude * (block * z[0]) - r[0]).norm(), 1e-5f) << magnitude;
  }
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
