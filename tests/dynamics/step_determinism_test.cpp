// A step allocates nothing, and gives the same bits twice and on any number of threads. Built with optimisation for
// this machine's processor (tests/CMakeLists.txt): a compiler that contracts a * b + c can make two different loops of
// one.
#include <corotet/detail/core/thread_pool.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/measures.hpp>
#include <corotet/detail/dynamics/step_bodies.hpp>
#include <corotet/detail/embed/point_locator.hpp>
#include <corotet/detail/embed/point_on_body.hpp>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "support/bodies.hpp"
#include "support/count_allocations.hpp"

namespace corotet {
namespace {

using testing::must;

template <class Scalar, class Element>
SoftBody<Scalar, Element> swinging_beam(VolumetricStrain volumetric_strain) {
  // Long enough for several tasks in every parallel loop.
  const std::array<Index, 3> cells =
      Element::order == 1 ? std::array<Index, 3>{45, 6, 6} : std::array<Index, 3>{26, 3, 3};
  return testing::cantilever<Scalar, Element>(
      {.size = {1, 0.2, 0.2}, .cells = cells}, {.young = 5e5}, 9.81,
      {.damping = {.mass = 0.1, .stiffness = 0.001}, .volumetric_strain = volumetric_strain});
}

template <class Body>
auto state_of(const Body& body) {
  auto state = body.displacements();
  state.insert(state.end(), body.velocities().begin(), body.velocities().end());
  return state;
}

template <class State>
bool same_bits(const State& a, const State& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

/// Returns when each thread of the pool has begun to work: a thread may allocate when it starts.
void start_threads(ThreadPool& pool, int threads) {
  std::atomic<int> there = 0;
  pool(threads, [&](Index) {
    ++there;
    while (there < threads) std::this_thread::yield();
  });
}

// Each scalar and each element: all four pairs would compile for twice as long.
using ScalarsAndElements = ::testing::Types<testing::Case<float, Tet4>, testing::Case<double, Tet10>>;
template <class T>
class StepDeterminism : public ::testing::Test {};
TYPED_TEST_SUITE(StepDeterminism, ScalarsAndElements);

TYPED_TEST(StepDeterminism, SameBitsTwiceAndOnAnyNumberOfThreads) {
  using Scalar = typename TypeParam::Scalar;
  const auto expect_same_bits = [](const auto& start, PreconditionerKind kind) {
    ASSERT_GT(start.vertex_count(), 2 * DeterministicSum::grain - 1) << "too small to be split among threads";
    const auto run = [&](int threads) {
      auto body = start;
      ThreadPool pool(threads);
      ImplicitEuler euler(body, SolverOptions{.method = SolverMethod::pcg, .preconditioner = kind, .tolerance = 1e-4});
      for (int step = 0; step < 3; ++step) EXPECT_TRUE(euler.step(body, Scalar(1.0 / 60), pool).ok());
      return state_of(body);
    };
    const auto reference = run(1);
    for (const int threads : {1, 2, 4})
      EXPECT_TRUE(same_bits(reference, run(threads))) << threads << " threads, " << name_of(kind);
  };
  const auto start = swinging_beam<Scalar, typename TypeParam::Element>(VolumetricStrain::pointwise);
  for (const PreconditionerKind kind :
       {PreconditionerKind::block_jacobi, PreconditionerKind::rigid_aggregates, PreconditionerKind::warped_cholesky})
    expect_same_bits(start, kind);
  expect_same_bits(swinging_beam<Scalar, typename TypeParam::Element>(VolumetricStrain::averaged),
                   PreconditionerKind::rigid_aggregates);
}

/// Many bodies by one call: what each would have done alone.
TYPED_TEST(StepDeterminism, BodiesSteppedTogetherMoveAsTheyWouldAlone) {
  using Scalar = typename TypeParam::Scalar;
  using Element = typename TypeParam::Element;
  using Body = SoftBody<Scalar, Element>;
  std::vector<Body> bodies;
  for (int i = 0; i < 5; ++i) {
    bodies.push_back(testing::cantilever<Scalar, Element>({.size = {1, 0.2, 0.2}, .cells = {3 + i, 1, 1}},
                                                          {.young = 1e5 * (i + 1)}, 9.81));
  }
  const std::vector<Body> start = bodies;
  std::vector<ImplicitEuler<Body>> integrators;
  for (const Body& body : bodies) integrators.emplace_back(body);
  std::vector<StepReport> reports(bodies.size());
  ThreadPool pool(3);
  start_threads(pool, 3);
  const long before = testing::allocation_count;
  for (int step = 0; step < 4; ++step)
    step_bodies(std::span(integrators), std::span(bodies), Scalar(1.0 / 60), std::span(reports), pool);
  EXPECT_EQ(testing::allocation_count - before, 0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_TRUE(reports[i].ok());
    Body alone = start[i];
    ImplicitEuler<Body> euler(alone);
    for (int step = 0; step < 4; ++step) euler.step(alone, Scalar(1.0 / 60));
    EXPECT_TRUE(same_bits(state_of(alone), state_of(bodies[i])));
  }
}

TYPED_TEST(StepDeterminism, AStepAllocatesNothing) {
  using Scalar = typename TypeParam::Scalar;
  using Element = typename TypeParam::Element;
  ThreadPool pool(2);
  start_threads(pool, 2);
  using Body = SoftBody<Scalar, Element>;
  const auto expect_none = [&]<class Integrator = ImplicitEuler<Body>>(
      VolumetricStrain volumetric_strain, const SolverOptions& options, const StepOptions& newton = {}) {
    auto body = must(SoftBody<Scalar, Element>::create(
        testing::block<Scalar, Element>({.size = {1, 0.2, 0.2}, .cells = {8, 2, 2}}), Material{.young = 5e5},
        {.mass = MassModel::consistent,
         .damping = {.mass = 0, .stiffness = 1e-3},
         .volumetric_strain = volumetric_strain}));
    body.pin_where([](const Vec3<Scalar>& x) { return x.x() == 0; });
    body.set_gravity({0, 0, Scalar(-9.81)});
    const Index led = body.pins().vertices().front();
    Integrator euler(body, options, newton);
    const long before = testing::allocation_count;
    for (int step = 1; step < 5; ++step) {
      body.move_pin(led, body.position(led));
      euler.step(body, Scalar(1.0 / 60));
      euler.step(body, Scalar(step / 60.0), pool);  // another step: factors are made anew
      euler.step(body, Scalar(-1));                 // a refusal, too
    }
    EXPECT_EQ(testing::allocation_count - before, 0) << name_of(options.preconditioner);
  };
  expect_none(VolumetricStrain::pointwise, {.method = SolverMethod::cholesky});
  for (const PreconditionerKind kind :
       {PreconditionerKind::automatic, PreconditionerKind::jacobi, PreconditionerKind::block_jacobi,
        PreconditionerKind::rigid_aggregates, PreconditionerKind::warped_cholesky})
    expect_none(VolumetricStrain::pointwise, {.method = SolverMethod::pcg, .preconditioner = kind});
  expect_none(VolumetricStrain::averaged, {});
  const StepOptions exact{.iterations = 5, .tolerance = 1e-3, .tangent = Tangent::consistent};
  expect_none(VolumetricStrain::pointwise, {}, exact);
  expect_none(VolumetricStrain::averaged, {}, exact);
  expect_none.template operator()<Bdf2<Body>>(VolumetricStrain::pointwise, {});
  expect_none.template operator()<Bdf2<Body>>(VolumetricStrain::pointwise, {}, exact);
}

// What an engine reads between steps, and the points it pushes and strikes.
TYPED_TEST(StepDeterminism, ReadingABodyAllocatesNothingAndGivesTheSameBits) {
  using Scalar = typename TypeParam::Scalar;
  using Element = typename TypeParam::Element;
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
    auto body = swinging_beam<Scalar, Element>(volumetric_strain);
    ImplicitEuler euler(body);
    ThreadPool pool(3);
    start_threads(pool, 3);
    const auto u = body.displacements(), v = body.velocities();
    euler.step(body, Scalar(1.0 / 60));
    std::vector<ElementMeasures<Scalar>> serial(at(body.mesh().element_count())), parallel(serial);
    PinReactions reactions(body), parallel_reactions(body);
    const PointLocator locator(body.mesh());
    DeformedPointLocator<Scalar, Element> deformed(locator), parallel_deformed(locator);
    Field<Scalar> scratch(at(body.vertex_count()));
    const Vec3<double> p(0.7, 0.1, 0.1);

    const long before = testing::allocation_count;
    element_measures(body, std::span(serial));
    element_measures(body, std::span(parallel), pool);
    reactions.evaluate_static(body);
    reactions.evaluate_step(body, u, v, Scalar(1.0 / 60));
    parallel_reactions.evaluate_step(body, u, v, Scalar(1.0 / 60), pool);
    deformed.update(body.displacements());
    parallel_deformed.update(body.displacements(), pool);
    const auto found = deformed.locate(p), same = parallel_deformed.locate(p), at_rest = locator.locate(p);
    add_force_at(body, found, {1, 2, 3});
    const bool struck = apply_impulse_at(body, at_rest, {1, 2, 3}, scratch).ok();
    EXPECT_EQ(testing::allocation_count - before, 0);

    EXPECT_TRUE(struck);
    EXPECT_TRUE(same_bits(serial, parallel));
    ASSERT_FALSE(reactions.forces().empty());
    for (std::size_t i = 0; i < reactions.forces().size(); ++i)
      EXPECT_EQ(reactions.forces()[i], parallel_reactions.forces()[i]);
    EXPECT_EQ(found.element, same.element);
    EXPECT_EQ(found.weights, same.weights);
  }
}

TEST(AllocationCount, SeesAllocations) {
  const long before = testing::allocation_count;
  const std::unique_ptr<void, void (*)(void*)> by_malloc(std::malloc(100), &std::free);
  const std::vector<double> by_new(100);
  EXPECT_GE(testing::allocation_count - before, 2) << by_malloc.get() << by_new[0];
}

}  // namespace
}  // namespace corotet
