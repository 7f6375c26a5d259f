#include <gtest/gtest.h>

#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/lag_key.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/dynamics/step_phase.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstdint>
#include <limits>
#include <vector>

namespace corotet::step_phase_test {
namespace {

using Body = SoftBody<double>;

Body hanging_block() {
  auto mesh = TetMesh<double>::create(make_block({.cells = {2, 2, 2}}).value());
  Body body = Body::create(std::move(mesh).value(), Material{}).value();
  body.pin_where([](const auto& x) { return x[0] < 1e-9; });
  body.set_gravity({0, 0, -9.81});
  return body;
}

TEST(StepPhase, ObserverHearsEachPhaseOnceAndInOrder) {
  Body body = hanging_block();
  ImplicitEuler<Body> integrator(body);
  SerialExecutor serial;
  std::vector<StepPhase> heard;
  const std::vector<StepPhase> one_step{StepPhase::assembly, StepPhase::solve, StepPhase::update};
  std::vector<StepPhase> expected;
  for (int step = 0; step < 3; ++step) {
    expected.insert(expected.end(), one_step.begin(), one_step.end());
    ASSERT_TRUE(integrator.step(body, 0.01, serial, [&](StepPhase phase) { heard.push_back(phase); }).ok());
    ASSERT_EQ(heard, expected);
  }
}

TEST(StepPhase, ObserverHearsNothingOfAStepThatIsRefusedAtTheDoor) {
  Body body = hanging_block();
  ImplicitEuler<Body> integrator(body);
  SerialExecutor serial;
  int calls = 0;
  const auto count = [&](StepPhase) { ++calls; };
  EXPECT_FALSE(integrator.step(body, std::numeric_limits<double>::quiet_NaN(), serial, count).accepted());
  EXPECT_EQ(calls, 0);
}

TEST(StepPhase, ObservingChangesNoBit) {
  Body observed = hanging_block(), alone = hanging_block();
  ImplicitEuler<Body> first(observed), second(alone);
  SerialExecutor serial;
  for (int step = 0; step < 5; ++step) {
    ASSERT_TRUE(first.step(observed, 0.01, serial, [](StepPhase) {}).ok());
    ASSERT_TRUE(second.step(alone, 0.01, serial).ok());
  }
  EXPECT_EQ(observed.displacements(), alone.displacements());
  EXPECT_EQ(observed.velocities(), alone.velocities());
  EXPECT_NE(alone.velocities(), hanging_block().velocities()) << "the case must tell";
}

/// Motion, and steps that vary a little, go on with what was factored; anything else begins a new era.
TEST(LagKey, ChangesWithAllThatChangesTheMatrixButMotion) {
  detail::LagKey lag_key;
  detail::LagKey::Settings now{
      .mass_factor = 1, .stiffness_factor = 3e-4, .materials = detail::new_revision(), .pins = detail::new_revision()};
  EXPECT_EQ(lag_key.of(now), 1U);
  for (const double factor : {1.0, 1.2, 0.8, 1.0}) {
    now.stiffness_factor = factor * 3e-4;
    EXPECT_EQ(lag_key.of(now), 1U);
  }
  now.stiffness_factor = 6e-4;
  EXPECT_EQ(lag_key.of(now), 2U);
  now.mass_factor = 2;
  EXPECT_EQ(lag_key.of(now), 3U);
  now.materials = detail::new_revision();
  EXPECT_EQ(lag_key.of(now), 4U);
  now.pins = detail::new_revision();
  EXPECT_EQ(lag_key.of(now), 5U);
  now.pins.module = &now;  // the same number, of another shared library
  EXPECT_EQ(lag_key.of(now), 6U);
  // Slow growth does not creep past the limit: what counts is the first step of the era.
  std::uint64_t last = 6;
  for (int i = 0; i < 10; ++i) {
    now.stiffness_factor *= 1.1;
    last = lag_key.of(now);
  }
  EXPECT_EQ(last, 9U);  // 1.1^3 > 1.25 three times
}

}  // namespace
}  // namespace corotet::step_phase_test
