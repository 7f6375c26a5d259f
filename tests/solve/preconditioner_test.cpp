// Preconditioners: their law, their use, and the cases in which they degenerate.
#include <corotet/detail/rotation/quaternion.hpp>
#include <corotet/detail/solve/block_jacobi.hpp>
#include <corotet/detail/solve/pcg.hpp>
#include <corotet/detail/solve/rigid_aggregates.hpp>
#include <corotet/detail/solve/warped_cholesky.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <set>
#include <thread>

#include "solve/step_matrices.hpp"
#include "support/floating_point_traps.hpp"
#include "support/matrices.hpp"

namespace corotet::preconditioner_test {
namespace {

using testing::BeamSystem;

template <template <class> class P>
constexpr bool is_preconditioner = Preconditioner<P<float>, float> && Preconditioner<P<double>, double>;
static_assert(is_preconditioner<BlockJacobi> && is_preconditioner<RigidAggregates> &&
              is_preconditioner<WarpedCholesky>);

template <class Scalar>
PaddedField<Scalar> padded(const Field<Scalar>& field) {
  PaddedField<Scalar> out(field.size());
  for (std::size_t v = 0; v < field.size(); ++v) out[v].set(field[v]);
  return out;
}

template <class Scalar>
double dot(const PaddedField<Scalar>& a, const PaddedField<Scalar>& b) {
  double sum = 0;
  for (std::size_t v = 0; v < a.size(); ++v)
    for (std::size_t i = 0; i < 4; ++i) sum += double(a[v][i]) * double(b[v][i]);
  return sum;
}

/// Linear, symmetric, positive definite; returns r . z; keeps the zeros behind the vectors.
template <class Scalar, class P>
void expect_lawful(const StepSystem<Scalar>& system, P& preconditioner, double condition = 1) {
  SerialExecutor serial;
  preconditioner.update(system, serial);
  const Index n = system.matrix.rows();
  const double epsilon = condition * std::numeric_limits<Scalar>::epsilon();
  for (unsigned seed = 0; seed < 4; ++seed) {
    const auto a = padded(testing::random_field<Scalar>(n, 1, 2 * seed)),
               b = padded(testing::random_field<Scalar>(n, 1, 2 * seed + 1));
    PaddedField<Scalar> pa(a.size()), pb(a.size()), sum(a), p_sum(a.size());
    for (std::size_t v = 0; v < a.size(); ++v) sum[v].set(a[v].vec4() + b[v].vec4());
    const double a_pa = preconditioner.apply(a, pa, serial), b_pb = preconditioner.apply(b, pb, serial);
    const double sum_p_sum = preconditioner.apply(sum, p_sum, serial);
    EXPECT_GT(a_pa, 0);
    EXPECT_NEAR(a_pa, dot(a, pa), 1e4 * epsilon * a_pa);
    EXPECT_NEAR(dot(a, pb), dot(b, pa), 1e4 * epsilon * std::sqrt(a_pa * b_pb));
    EXPECT_NEAR(sum_p_sum, a_pa + b_pb + dot(a, pb) + dot(b, pa), 1e4 * epsilon * (a_pa + b_pb));
    for (const auto& z : pa) EXPECT_EQ(z[3], 0);
  }
}

template <class Scalar, class P>
int iterations(const StepSystem<Scalar>& system, P& preconditioner, double tolerance = 1e-3) {
  Pcg<Scalar> pcg(system.matrix.rows());
  Field<Scalar> x(at(system.matrix.rows()));
  SerialExecutor serial;
  preconditioner.update(system, serial);
  const SolveReport report = pcg.solve(system, preconditioner, x, {.tolerance = tolerance}, serial);
  EXPECT_EQ(report.status, SolveStatus::converged);
  return report.iterations;
}

template <class Scalar, class Element, class P>
P analyzed(const BeamSystem<Scalar, Element>& beam, P preconditioner) {
  preconditioner.analyze(beam.matrix.shared_pattern(), beam.rest());
  return preconditioner;
}

template <class Scalar, class Element>
RigidAggregates<Scalar> rigid_for(const BeamSystem<Scalar, Element>& beam, Index aggregates, Index coarse = 0) {
  return analyzed(beam, RigidAggregates<Scalar>({aggregates, coarse}));
}

template <class Scalar, class Element>
WarpedCholesky<Scalar> warped_for(const BeamSystem<Scalar, Element>& beam) {
  return analyzed(beam, WarpedCholesky<Scalar>());
}

template <class T>
class Preconditioners : public ::testing::Test {};
TYPED_TEST_SUITE(Preconditioners, testing::AllCases);

TYPED_TEST(Preconditioners, ObeyTheirLaw) {
  const BeamSystem<typename TypeParam::Scalar, typename TypeParam::Element> beam({6, 2, 2});
  auto blocks = analyzed(beam, BlockJacobi<typename TypeParam::Scalar>()),
       numbers = analyzed(beam, BlockJacobi<typename TypeParam::Scalar>(false));
  auto two_levels = rigid_for(beam, 8), three_levels = rigid_for(beam, 12, 4);
  auto warped = warped_for(beam);
  expect_lawful(beam.system(), blocks);
  expect_lawful(beam.system(), numbers);
  expect_lawful(beam.system(), two_levels);
  expect_lawful(beam.system(), three_levels);
  expect_lawful(beam.system(), warped);
}

/// From one thread, in order, and from two, in the opposite order.
TYPED_TEST(Preconditioners, GiveTheSameBitsOnAnyNumberOfThreads) {
  using Scalar = typename TypeParam::Scalar;
  const BeamSystem<Scalar, typename TypeParam::Element> beam({24, 4, 4});  // several tasks in each loop
  ASSERT_GT(beam.matrix.rows(), 2 * DeterministicSum::grain);
  const auto on_two_threads = [](Index count, auto&& task) {
    std::thread other([&] {
      for (Index i = count - 1; i >= 0; --i)
        if (i % 2 == 1) task(i);
    });
    for (Index i = count - 1; i >= 0; --i)
      if (i % 2 == 0) task(i);
    other.join();
  };
  const PaddedField<Scalar> r = padded(testing::random_field<Scalar>(beam.matrix.rows(), 1, 4));
  const auto expect_same_bits = [&](const auto& analyzed, const char* name) {
    auto serial = analyzed, parallel = analyzed;
    serial.update(beam.system(), {});
    parallel.update(beam.system(), on_two_threads);
    PaddedField<Scalar> z(r.size()), same(r.size());
    EXPECT_EQ(serial.apply(r, z, {}), parallel.apply(r, same, on_two_threads)) << name;
    EXPECT_EQ(std::memcmp(z.data(), same.data(), r.size() * sizeof(r[0])), 0) << name;
  };
  expect_same_bits(analyzed(beam, BlockJacobi<Scalar>()), "block-Jacobi");
  expect_same_bits(rigid_for(beam, 30), "rigid aggregates");
  expect_same_bits(rigid_for(beam, 80, 70), "three levels");
  expect_same_bits(warped_for(beam), "warped Cholesky");
}

/// One factor in turn for matrices on larger and smaller patterns, and copies of it.
TYPED_TEST(Preconditioners, AFactorIsAnalyzedForOtherPatterns) {
  using Scalar = typename TypeParam::Scalar;
  BlockCholesky<Scalar> factor, copy;
  for (const std::array<Index, 3> cells : {std::array<Index, 3>{1, 1, 1}, {6, 2, 2}, {2, 1, 1}}) {
    const BeamSystem<Scalar, typename TypeParam::Element> beam(cells);
    factor.analyze(beam.matrix.pattern());
    EXPECT_FALSE(factor.has_factor());
    copy = factor;  // which has numbers of its own
    ASSERT_TRUE(factor.factorize(beam.matrix));
    EXPECT_FALSE(copy.has_factor());
    copy = factor;
    factor.begin();
    Field<Scalar> x(beam.right_side.size(), Vec3<Scalar>::Zero()), product = x;
    copy.solve(beam.right_side, x);
    beam.matrix.apply(x, product, {});
    for (std::size_t v = 0; v < x.size(); ++v)
      EXPECT_LT((product[v] - beam.right_side[v]).norm(), Scalar(1e-2)) << "vertex " << v;
  }
}

/// Aggregates of one vertex, of a few on a line, and those whose vertices are all pinned have no rotation, or no motion
/// at all: what is left must work as before.
TYPED_TEST(Preconditioners, AggregatesThatCannotMoveOrTurnDoNoHarm) {
  const BeamSystem<typename TypeParam::Scalar, typename TypeParam::Element> beam({5, 2, 2});
  for (const Index aggregates : {1, 2, 30, 60, int(beam.rest().size())})
    for (const Index coarse : {0, 1, 7}) {
      auto rigid = rigid_for(beam, aggregates, coarse);
      expect_lawful(beam.system(), rigid);
    }
  const BeamSystem<typename TypeParam::Scalar, typename TypeParam::Element> free({5, 2, 2}, 5e5,
                                                                                 Mat3<double>::Identity(), false);
  auto rigid = rigid_for(free, 9);
  expect_lawful(free.system(), rigid);
}

/// A body that turns as a whole is the same to preconditioners that turn along: no new factor is needed.
TYPED_TEST(Preconditioners, FollowRotations) {
  using Scalar = typename TypeParam::Scalar;
  using Beam = BeamSystem<Scalar, typename TypeParam::Element>;
  const Mat3<double> turn = rotation_by(2.5 * Vec3<double>(1, -2, 0.5).normalized());
  const Beam still({8, 2, 2});
  Beam turned({8, 2, 2}, 5e5, turn);
  for (std::size_t v = 0; v < turned.right_side.size(); ++v)
    turned.right_side[v] = turn.cast<Scalar>() * still.right_side[v];
  auto rigid = rigid_for(still, 10), three_levels = rigid_for(still, 20, 5);
  auto warped = warped_for(still);
  const auto expect_same = [&](auto& preconditioner) {
    const int before = iterations(still.system(), preconditioner);
    EXPECT_NEAR(iterations(turned.system(), preconditioner), before, 1);
  };
  expect_same(rigid);
  expect_same(three_levels);
  expect_same(warped);
}

/// On a long beam: what block-Jacobi takes many iterations for, rigid aggregates need a fraction of; and a factor of
/// nearly the same matrix a few.
TYPED_TEST(Preconditioners, CoarseLevelsSaveIterations) {
  const BeamSystem<typename TypeParam::Scalar, typename TypeParam::Element> beam({20, 2, 2}, 5e6);
  auto blocks = analyzed(beam, BlockJacobi<typename TypeParam::Scalar>());
  auto rigid = rigid_for(beam, size_of(beam.rest()) / 15), three_levels = rigid_for(beam, size_of(beam.rest()) / 8, 10);
  auto warped = warped_for(beam);
  const int plain = iterations(beam.system(), blocks);
  EXPECT_LT(iterations(beam.system(), rigid), plain / 3);
  EXPECT_LT(iterations(beam.system(), three_levels), plain / 2);
  EXPECT_LE(iterations(beam.system(), warped), 3);
}

/// Other pins, materials or steps are a new era: the factors follow.
TYPED_TEST(Preconditioners, ANewEraIsNoticed) {
  using Scalar = typename TypeParam::Scalar;
  const BeamSystem<Scalar, typename TypeParam::Element> soft({8, 2, 2}, 5e4), stiff({8, 2, 2}, 5e7);
  auto rigid = rigid_for(soft, 10);
  auto warped = warped_for(soft);
  iterations(soft.system(), rigid);
  iterations(soft.system(), warped);
  StepSystem<Scalar> later = stiff.system();
  later.lag_key = 2;
  auto fresh_rigid = rigid_for(stiff, 10);
  auto fresh_warped = warped_for(stiff);
  EXPECT_EQ(iterations(later, rigid), iterations(later, fresh_rigid));
  EXPECT_EQ(iterations(later, warped), iterations(later, fresh_warped));
}

/// A matrix that cannot be factored, once, is no reason to fail ever after.
TYPED_TEST(Preconditioners, RecoverFromAMatrixThatCannotBeFactored) {
  const testing::WithoutTraps not_a_number_is_meant;
  using Scalar = typename TypeParam::Scalar;
  const BeamSystem<Scalar, typename TypeParam::Element> good({6, 2, 2});
  BeamSystem<Scalar, typename TypeParam::Element> bad({6, 2, 2});
  bad.matrix.block(bad.matrix.pattern().diagonal.back()) =
      Mat3<Scalar>::Constant(std::numeric_limits<Scalar>::quiet_NaN());
  SerialExecutor serial;
  const auto expect_recovery = [&](auto& preconditioner) {
    preconditioner.update(bad.system(), serial);
    EXPECT_GT(iterations(good.system(), preconditioner), 0);
    StepSystem<Scalar> later = bad.system();
    later.lag_key = 2;
    preconditioner.update(later, serial);
    StepSystem<Scalar> last = good.system();
    last.lag_key = 2;
    EXPECT_GT(iterations(last, preconditioner), 0);
  };
  auto rigid = rigid_for(good, 8), three_levels = rigid_for(good, 12, 4);
  auto warped = warped_for(good);
  expect_recovery(rigid);
  expect_recovery(three_levels);
  expect_recovery(warped);
}

/// A matrix whose softest motions rounding has made slightly unstable still gives a lawful preconditioner.
TYPED_TEST(Preconditioners, AreLawfulForASlightlyIndefiniteMatrix) {
  using Scalar = typename TypeParam::Scalar;
  BeamSystem<Scalar, typename TypeParam::Element> beam({6, 2, 2}, 5e9, Mat3<double>::Identity(), false);
  BlockMatrix<Scalar>& a = beam.matrix;
  for (const Index slot : a.pattern().diagonal) a.block(slot) = Scalar(1 - 1e-5) * a.block(slot).value();
  BlockCholesky<Scalar> cholesky;
  cholesky.analyze(a.pattern());
  ASSERT_FALSE(cholesky.factorize(a)) << "is positive definite";
  auto warped = warped_for(beam);
  auto two_levels = rigid_for(beam, 8);
  expect_lawful(beam.system(), two_levels, 100);
  expect_lawful(beam.system(), warped, 100);
}

/// What was factored while a body lay collapsed on a line or in a point must still serve once it has unfolded.
TYPED_TEST(Preconditioners, AggregatesMadeForACollapsedBodyServeWhenItUnfolds) {
  using Scalar = typename TypeParam::Scalar;
  const BeamSystem<Scalar, typename TypeParam::Element> unfolded({6, 2, 2});
  for (const double stretch : {1.0, 0.0}) {
    const Mat3<double> flat = testing::diagonal({stretch, 0, 0});
    const BeamSystem<Scalar, typename TypeParam::Element> collapsed({6, 2, 2}, 5e5, flat);
    SerialExecutor serial;
    const auto expect_service = [&](auto&& preconditioner, const char* name) {
      preconditioner.update(collapsed.system(), serial);
      EXPECT_LT(iterations(unfolded.system(), preconditioner), 100) << name << " stretch " << stretch;
    };
    expect_service(rigid_for(unfolded, 8), "rigid aggregates");
    expect_service(rigid_for(unfolded, 12, 4), "three levels");
  }
}

/// Blocks whose determinant leaves the range of float are still inverted.
TEST(BlockJacobi, InvertsBlocksOfAnyMagnitude) {
  const auto mesh = testing::block<float, Tet4>({});
  BlockMatrix<float> a(std::make_shared<const BlockPattern>(BlockPattern::of(mesh.elements(), mesh.vertex_count())));
  const Mat3<float> block = testing::of_rows({4, 1, 0}, {1, 3, 1}, {0, 1, 2}).cast<float>();
  SerialExecutor serial;
  const Field<float> any(at(a.rows()), Vec3<float>(1, 2, 3));
  for (const float magnitude : {1e-30f, 1e-15f, 1.0f, 1e15f, 1e30f}) {
    for (Index i = 0; i < a.rows(); ++i) a.block(a.pattern().diagonal[at(i)]) = magnitude * block;
    BlockJacobi<float> preconditioner;
    preconditioner.analyze(a.shared_pattern(), mesh.positions());
    preconditioner.update({a, any, any, {}, 1}, serial);
    PaddedField<float> z(any.size());
    preconditioner.apply(padded(any), z, serial);
    EXPECT_LT((magnitude * (block * z[0].vector()) - any[0]).norm(), 1e-5f) << magnitude;
  }
}

TEST(Aggregates, ArePartitionsOfNearlyEqualSize) {
  const Field<double> points = testing::random_field<double>(1000, 1, 9);
  for (const Index count : {1, 2, 7, 64, 999, 1000}) {
    const detail::Aggregates aggregates = detail::Aggregates::of_positions(points, count);
    ASSERT_EQ(aggregates.count(), count);
    std::set<Index> seen;
    for (Index a = 0; a < count; ++a) {
      const Index size = aggregates.start[at(a + 1)] - aggregates.start[at(a)];
      EXPECT_GE(size, 1000 / count / 2);
      EXPECT_LE(size, 2 * (1000 / count) + 1);
      for (Index k = aggregates.start[at(a)]; k < aggregates.start[at(a + 1)]; ++k) {
        EXPECT_EQ(aggregates.aggregate_of[at(aggregates.member[at(k)])], a);
        seen.insert(aggregates.member[at(k)]);
      }
    }
    EXPECT_EQ(seen.size(), points.size());
  }
}

/// Once an era; and again, but not soon, when solves take far longer than they did.
TEST(RefactorizationPolicy, FollowsErasAndWear) {
  RefactorizationPolicy policy;
  const auto solve = [&](std::uint64_t lag_key, int applications) {
    const bool due = policy.should_refactor(lag_key);
    for (int i = 0; i < applications; ++i) policy.count();
    return due;
  };
  EXPECT_TRUE(solve(1, 10));
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(solve(1, 12)) << i;
  EXPECT_TRUE(solve(2, 10));
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(solve(2, 10));
  int factors = 0;
  for (int i = 0; i < 100; ++i) factors += solve(2, 30) ? 1 : 0;
  EXPECT_EQ(factors, 1);  // 30 is then what it takes
}

}  // namespace
}  // namespace corotet::preconditioner_test
