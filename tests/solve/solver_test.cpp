// The linear solvers: right answers, honest reports.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <corotet/detail/solve/auto_solver.hpp>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "solve/step_matrices.hpp"
#include "support/floating_point_traps.hpp"

namespace corotet::solver_test {
namespace {

using testing::BeamSystem;
using testing::dense;

static_assert(LinearSolver<AutoSolver<float>, float> && LinearSolver<AutoSolver<double>, double>);

constexpr std::array all_preconditioners{PreconditionerKind::automatic, PreconditionerKind::jacobi,
                                         PreconditionerKind::block_jacobi, PreconditionerKind::rigid_aggregates,
                                         PreconditionerKind::warped_cholesky};

/// Solves once with a new solver.
template <class Scalar, class Element>
SolveReport solve(const BeamSystem<Scalar, Element>& beam, const SolverOptions& options, Field<Scalar>& x) {
  AutoSolver<Scalar> solver(options);
  solver.analyze(beam.matrix.shared_pattern(), beam.rest());
  x.resize(beam.right_side.size());
  SerialExecutor serial;
  return solver.solve(beam.system(), x, serial);
}

template <class T>
class Solvers : public ::testing::Test {};
TYPED_TEST_SUITE(Solvers, testing::AllCases);

/// And with each other: whatever the preconditioner, the answer is the same to the tolerance.
TYPED_TEST(Solvers, AgreeWithADenseFactorisation) {
  using Scalar = typename TypeParam::Scalar;
  const Mat3<double> turned = rotation_by(2 * Vec3<double>(1, 2, 3).normalized());
  const BeamSystem<Scalar, typename TypeParam::Element> beam({4, 2, 2}, 5e5, turned);
  const Eigen::VectorXd exact = dense(beam.matrix).llt().solve(flat(beam.right_side).template cast<double>());
  const double tolerance = sizeof(Scalar) == 4 ? 1e-5 : 1e-12;
  for (const SolverMethod method : {SolverMethod::pcg, SolverMethod::cholesky, SolverMethod::automatic})
    for (const PreconditionerKind kind : all_preconditioners) {
      Field<Scalar> x;
      const SolveReport report = solve(beam, {.method = method, .preconditioner = kind, .tolerance = tolerance}, x);
      EXPECT_EQ(report.status, SolveStatus::converged);
      EXPECT_LE(report.residual, tolerance);
      EXPECT_LT((flat(x).template cast<double>() - exact).norm(), 100 * tolerance * exact.norm());
    }
}

/// `auto` changes to a factor of the whole body where solves take so many iterations that it is cheaper, stays with it
/// until the system changes for other reasons than motion, and never does so for a soft body.
TEST(SolverChoice, FollowsTheIterationsThatSolvesTake) {
  for (const double young : {5e4, 5e9}) {
    BeamSystem<double, Tet4> beam({8, 2, 2}, young);
    AutoSolver<double> solver({.tolerance = 1e-3});
    solver.analyze(beam.matrix.shared_pattern(), beam.rest());
    EXPECT_EQ(solver.preconditioner(), PreconditionerKind::rigid_aggregates);
    const double predicted = solver.predicted_products();
    EXPECT_GT(predicted, 3) << "no solve is cheaper than the products it needs";
    Field<double> x(beam.right_side.size());
    SerialExecutor serial;
    const auto solve_some = [&] {
      for (int i = 0; i < 20; ++i) {
        beam.right_side = testing::random_field<double>(beam.mesh.vertex_count(), 1, unsigned(i));
        for (const Index v : beam.pinned) beam.right_side[at(v)].setZero();
        EXPECT_EQ(solver.solve(beam.system(), x, serial).status, SolveStatus::converged);
      }
    };
    solve_some();
    const bool stiff = young > 1e6;
    EXPECT_EQ(solver.preconditioner(),
              stiff ? PreconditionerKind::warped_cholesky : PreconditionerKind::rigid_aggregates);
    EXPECT_NE(solver.predicted_products(), predicted) << "from the iterations seen";
    ++beam.lag_key;
    EXPECT_EQ(solver.solve(beam.system(), x, serial).status, SolveStatus::converged);
    EXPECT_EQ(solver.preconditioner(), PreconditionerKind::rigid_aggregates);
  }
}

/// The error in the energy norm, computed in double: for a stiff body and a tolerance beyond float's reach too. The
/// report says converged only where that is true, and something else where it is not.
TYPED_TEST(Solvers, ReportTheErrorThatIsThere) {
  using Scalar = typename TypeParam::Scalar;
  for (const double young : {5e5, 5e8}) {
    const BeamSystem<Scalar, typename TypeParam::Element> beam({6, 2, 2}, young);
    const Eigen::MatrixXd a = dense(beam.matrix);
    const Eigen::VectorXd exact = a.llt().solve(flat(beam.right_side).template cast<double>());
    for (const PreconditionerKind kind : all_preconditioners)
      for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
        Field<Scalar> x;
        const SolveReport report = solve(
            beam,
            {.method = SolverMethod::pcg, .preconditioner = kind, .tolerance = tolerance, .max_iterations = 20000}, x);
        const Eigen::VectorXd error = flat(x).template cast<double>() - exact;
        const double there = std::sqrt(error.dot(a * error) / exact.dot(a * exact));
        if (report.status == SolveStatus::converged)
          EXPECT_LE(there, 2 * tolerance) << "E " << young << ", preconditioner " << int(kind);
        else
          EXPECT_EQ(report.status, SolveStatus::stagnated);
        EXPECT_TRUE(sizeof(Scalar) == 4 || report.status == SolveStatus::converged);
        EXPECT_TRUE(tolerance < 1e-4 || young > 1e6 || report.status == SolveStatus::converged);
      }
  }
}

TYPED_TEST(Solvers, RefuseOptionsOutOfRange) {
  using Scalar = typename TypeParam::Scalar;
  const BeamSystem<Scalar, typename TypeParam::Element> beam({2, 1, 1});
  Field<Scalar> x;
  for (const SolverMethod method : {SolverMethod::pcg, SolverMethod::cholesky})
    for (const double tolerance : {0.0, 1.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
      EXPECT_EQ(solve(beam, {.method = method, .tolerance = tolerance}, x).status, SolveStatus::invalid_options);
}

TYPED_TEST(Solvers, ReachingTheIterationLimitIsReported) {
  using Scalar = typename TypeParam::Scalar;
  const BeamSystem<Scalar, typename TypeParam::Element> beam({4, 2, 2});
  Field<Scalar> x;
  for (const PreconditionerKind kind : {PreconditionerKind::block_jacobi, PreconditionerKind::rigid_aggregates}) {
    const SolveReport report =
        solve(beam, {.method = SolverMethod::pcg, .preconditioner = kind, .tolerance = 1e-6, .max_iterations = 3}, x);
    EXPECT_EQ(report.status, SolveStatus::iteration_limit);
    EXPECT_EQ(report.iterations, 3);
    EXPECT_GT(report.residual, 1e-6);
  }
}

TYPED_TEST(Solvers, AMatrixThatIsNotPositiveDefiniteIsReported) {
  const testing::WithoutTraps not_a_number_is_meant;
  using Scalar = typename TypeParam::Scalar;
  for (const Scalar diagonal : {Scalar(-1), std::numeric_limits<Scalar>::quiet_NaN()}) {
    BeamSystem<Scalar, typename TypeParam::Element> beam({2, 1, 1});
    beam.matrix.block(beam.matrix.pattern().diagonal.back()) = diagonal * Mat3<Scalar>::Identity();
    Field<Scalar> x;
    EXPECT_EQ(solve(beam, {.method = SolverMethod::cholesky}, x).status, SolveStatus::breakdown);
    for (const PreconditionerKind kind : all_preconditioners)
      EXPECT_EQ(solve(beam, {.method = SolverMethod::pcg, .preconditioner = kind}, x).status, SolveStatus::breakdown);
  }
}

TYPED_TEST(Solvers, ZeroRightSideNeedsNoIteration) {
  using Scalar = typename TypeParam::Scalar;
  BeamSystem<Scalar, typename TypeParam::Element> beam({2, 1, 1});
  flat(beam.right_side).setZero();
  for (const SolverMethod method : {SolverMethod::pcg, SolverMethod::cholesky})
    for (const PreconditionerKind kind : all_preconditioners) {
      Field<Scalar> x = testing::random_field<Scalar>(beam.matrix.rows(), 1, 5);
      const SolveReport report = solve(beam, {.method = method, .preconditioner = kind}, x);
      EXPECT_EQ(report.status, SolveStatus::converged);
      EXPECT_EQ(report.iterations, 0);
      EXPECT_EQ(flat(x).norm(), 0);
    }
}

/// A guess is no farther away than zero is, whatever was solved before; and a system that was solved needs nothing
/// more.
TYPED_TEST(Solvers, StartFromWhatTheLastSolutionsAreWorth) {
  using Scalar = typename TypeParam::Scalar;
  BeamSystem<Scalar, typename TypeParam::Element> beam({6, 2, 2});
  const double tolerance = 1e-3;
  AutoSolver<Scalar> solver(
      {.method = SolverMethod::pcg, .preconditioner = PreconditionerKind::rigid_aggregates, .tolerance = tolerance});
  solver.analyze(beam.matrix.shared_pattern(), beam.rest());
  SerialExecutor serial;
  Field<Scalar> x(beam.right_side.size());
  const int cold = solver.solve(beam.system(), x, serial).iterations;
  EXPECT_GT(cold, 2);
  EXPECT_EQ(solver.solve(beam.system(), x, serial).iterations, 0);
  const Field<Scalar> first = beam.right_side;
  beam.right_side = testing::random_field<Scalar>(beam.matrix.rows(), 1, 77);  // has nothing to do with the first
  for (const Index v : beam.pinned) beam.right_side[at(v)].setZero();
  EXPECT_LE(solver.solve(beam.system(), x, serial).iterations, cold + 2);
  flat(beam.right_side) += flat(first);  // a combination of both
  const SolveReport both = solver.solve(beam.system(), x, serial);
  EXPECT_LE(both.iterations, cold / 2);
  const Eigen::MatrixXd a = dense(beam.matrix);
  const Eigen::VectorXd exact = a.llt().solve(flat(beam.right_side).template cast<double>());
  const Eigen::VectorXd error = flat(x).template cast<double>() - exact;
  EXPECT_LE(std::sqrt(error.dot(a * error) / exact.dot(a * exact)), 2 * tolerance);
}

/// The fill-reducing order works: the factor of a beam, which is a band, stays near its band, far below a dense factor;
/// and one symbolic analysis serves matrix after matrix.
TEST(BlockCholesky, KeepsTheFactorSparseAndRefactorizes) {
  BeamSystem<double, Tet4> beam({24, 2, 2});
  BlockMatrix<double>& a = beam.matrix;
  BlockCholesky<double> cholesky;
  cholesky.analyze(a.pattern());
  const double n = a.rows();
  EXPECT_LT(static_cast<double>(cholesky.symbolic().blocks), 0.15 * n * n / 2);
  const Field<double> b = testing::random_field<double>(a.rows(), 1, 6);
  Field<double> x(b.size());
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(cholesky.factorize(a));
    cholesky.solve(b, x);
    EXPECT_LT((dense(a) * flat(x) - flat(b)).norm(), 1e-10 * flat(b).norm());
    BlockCholesky<float> rounded;
    rounded.analyze(a.pattern());
    ASSERT_TRUE(rounded.factorize(a));
    Field<float> b32(b.size()), x32(b.size());
    flat(b32) = flat(b).cast<float>();
    rounded.solve(b32, x32);
    EXPECT_LT((flat(x32).cast<double>() - flat(x)).norm(), 1e-3 * flat(x).norm());
    for (const Index slot : a.pattern().diagonal) a.block(slot) = 1.5 * a.block(slot).value();
  }
}

/// A factor that is kept in float while it is made is that of double precision, rounded: also for a stiff free body,
/// where float alone would lose forty times as much. It takes half the memory.
TEST(BlockCholesky, KeptInFloatIsTheFactorOfDoublePrecision) {
  for (const double young : {5e5, 5e9}) {
    const BeamSystem<float, Tet4> beam({8, 2, 2}, young, Mat3<double>::Identity(), false);
    const BlockPattern& pattern = beam.matrix.pattern();
    BlockCholesky<float> in_double, in_float;
    const auto symbolic = detail::Shared<detail::SymbolicFactor>::make(pattern);
    in_double.analyze(symbolic);
    in_float.analyze(symbolic, true);
    EXPECT_LT(double(in_float.memory().owned), 0.6 * double(in_double.memory().owned));
    ASSERT_TRUE(in_double.factorize(beam.matrix));
    const auto block = [&](Index row, Index slot) {
      EXPECT_TRUE(pattern.row_start[at(row)] <= slot && slot < pattern.row_start[at(row) + 1]);
      return beam.matrix.block(slot).cast<double>();
    };
    ASSERT_TRUE(in_float.factorize(pattern, block));
    Field<float> x(beam.right_side.size()), y = x;
    in_double.solve(beam.right_side, x);
    in_float.solve(beam.right_side, y);
    const Eigen::MatrixXd a = dense(beam.matrix);
    const Eigen::VectorXd exact = flat(x).cast<double>(), difference = exact - flat(y).cast<double>();
    EXPECT_LE(difference.dot(a * difference), 1e-10 * exact.dot(a * exact)) << young;
  }
}

/// The same with 6x6 blocks, against Eigen's dense factorisation.
TEST(BlockCholesky, WorksOnBlocksOfSix) {
  const auto mesh = testing::block<double, Tet4>({.cells = {3, 2, 2}});
  const auto pattern = std::make_shared<const BlockPattern>(BlockPattern::of(mesh.elements(), mesh.vertex_count()));
  BlockMatrix<double, 6> a(pattern);
  testing::Random random(5);
  const Index n = a.rows();
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  for (const auto& [slot, mirror] : pattern->upper) {
    Eigen::Matrix<double, 6, 6> block = Eigen::Matrix<double, 6, 6>::NullaryExpr([&] { return random.uniform(-1, 1); });
    const Index row = pattern->column[at(mirror)], column = pattern->column[at(slot)];
    if (row == column) block = (block * block.transpose() + 100 * Eigen::Matrix<double, 6, 6>::Identity()).eval();
    a.block(slot) = block;
    a.block(mirror) = block.transpose();
    full.block<6, 6>(6 * row, 6 * column) = block;
    full.block<6, 6>(6 * column, 6 * row) = block.transpose();
  }
  BlockCholesky<double, 6> cholesky;
  cholesky.analyze(*pattern);
  ASSERT_TRUE(cholesky.factorize(a));
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(6 * n, -1, 2);
  Eigen::VectorXd x(b.size());
  cholesky.solve(b.data(), x.data());
  EXPECT_LT((full * x - b).norm(), 1e-12 * b.norm());
}

}  // namespace
}  // namespace corotet::solver_test
