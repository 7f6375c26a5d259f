// A step allocates nothing, and gives the same bits twice and on any number of threads.
#include <corotet/dynamics/implicit_euler.hpp>
#include <gtest/gtest.h>

#include <cstring>

#include "../src/thread_pool.hpp"
#include "support/bodies.hpp"
#include "support/count_allocations.hpp"

namespace corotet {
namespace {

using testing::must;

template <class Scalar, class Element>
SoftBody<Scalar, Element> swinging_beam() {
  // Long enough for several tasks in every parallel loop.
  const std::array<Index, 3> cells =
      Element::order == 1 ? std::array<Index, 3>{45, 6, 6} : std::array<Index, 3>{26, 3, 3};
  return testing::cantilever<Scalar, Element>({.size = {1, 0.2, 0.2}, .cells = cells}, {.young = 5e5}, 9.81,
                                              {.damping = {.mass = 0.1, .stiffness = 0.001}});
}

template <class T>
class StepDeterminism : public ::testing::Test {};
TYPED_TEST_SUITE(StepDeterminism, testing::AllCases);

TYPED_TEST(StepDeterminism, SameBitsTwiceAndOnAnyNumberOfThreads) {
  using Scalar = typename TypeParam::Scalar;
  const auto start = swinging_beam<Scalar, typename TypeParam::Element>();
  ASSERT_GT(start.vertex_count(), 2 * RangeSum::grain - 1) << "too small to be split among threads";
  const auto run = [&](int threads) {
    auto body = start;
    program::ThreadPool pool(threads);
    ImplicitEuler euler(body, SolverOptions{.method = SolverMethod::pcg, .tolerance = 1e-4});
    for (int step = 0; step < 4; ++step) EXPECT_TRUE(euler.step(body, Scalar(1.0 / 60), pool).ok());
    Field<Scalar> state = body.displacements();
    state.insert(state.end(), body.velocities().begin(), body.velocities().end());
    return state;
  };
  const auto reference = run(1);
  for (const int threads : {1, 2, 4}) {
    const auto again = run(threads);
    EXPECT_EQ(std::memcmp(reference.data(), again.data(), reference.size() * sizeof(reference[0])), 0)
        << threads << " threads";
  }
}

TYPED_TEST(StepDeterminism, AStepAllocatesNothing) {
  using Scalar = typename TypeParam::Scalar;
  using Element = typename TypeParam::Element;
  auto body = must(
      SoftBody<Scalar, Element>::create(testing::block<Scalar, Element>({.size = {1, 0.2, 0.2}, .cells = {8, 2, 2}}),
                                        Material{.young = 5e5}, {.mass = MassModel::consistent, .damping = {}}));
  body.pin_where([](const Vec3<Scalar>& x) { return x.x() == 0; });
  body.set_gravity({0, 0, Scalar(-9.81)});
  const Index led = body.pins().vertices().front();
  program::ThreadPool pool(2);
  for (const SolverMethod method : {SolverMethod::pcg, SolverMethod::cholesky}) {
    ImplicitEuler euler(body, SolverOptions{.method = method});
    const long before = testing::allocation_count;
    for (int step = 0; step < 5; ++step) {
      body.move_pin(led, body.position(led));
      euler.step(body, Scalar(1.0 / 60));
      euler.step(body, Scalar(1.0 / 60), pool);
      euler.step(body, Scalar(-1));  // a refusal, too
    }
    EXPECT_EQ(testing::allocation_count - before, 0) << (method == SolverMethod::pcg ? "pcg" : "cholesky");
  }
}

TEST(AllocationCount, SeesAllocations) {
  const long before = testing::allocation_count;
  const Eigen::VectorXd by_eigen = Eigen::VectorXd::Ones(100);
  const std::vector<double> by_new(100);
  EXPECT_GE(testing::allocation_count - before, 2) << by_eigen.sum() + by_new[0];
}

}  // namespace
}  // namespace corotet
