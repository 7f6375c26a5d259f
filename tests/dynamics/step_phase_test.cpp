#include <gtest/gtest.h>

#include <corotet/core/executor.hpp>
#include <corotet/dynamics/implicit_euler.hpp>
#include <corotet/dynamics/soft_body.hpp>
#include <corotet/dynamics/step_phase.hpp>
#include <corotet/mesh/make_block.hpp>
#include <corotet/mesh/tet_mesh.hpp>
#include <limits>
#include <vector>

namespace {

using corotet::StepPhase;
using Body = corotet::SoftBody<double>;

Body hanging_block() {
  auto mesh = corotet::TetMesh<double>::create(corotet::make_block({.cells = {2, 2, 2}}).value());
  Body body = Body::create(std::move(mesh).value(), corotet::Material{}).value();
  body.pin_where([](const auto& x) { return x[0] < 1e-9; });
  body.set_gravity({0, 0, -9.81});
  return body;
}

TEST(StepPhase, ObserverHearsEachPhaseOnceAndInOrder) {
  Body body = hanging_block();
  corotet::ImplicitEuler<Body> integrator(body);
  corotet::SerialExecutor serial;
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
  corotet::ImplicitEuler<Body> integrator(body);
  corotet::SerialExecutor serial;
  int calls = 0;
  const auto count = [&](StepPhase) { ++calls; };
  EXPECT_FALSE(integrator.step(body, std::numeric_limits<double>::quiet_NaN(), serial, count).accepted());
  EXPECT_EQ(calls, 0);
}

TEST(StepPhase, ObservingChangesNoBit) {
  Body observed = hanging_block(), alone = hanging_block();
  corotet::ImplicitEuler<Body> first(observed), second(alone);
  corotet::SerialExecutor serial;
  for (int step = 0; step < 5; ++step) {
    ASSERT_TRUE(first.step(observed, 0.01, serial, [](StepPhase) {}).ok());
    ASSERT_TRUE(second.step(alone, 0.01, serial).ok());
  }
  EXPECT_EQ(observed.displacements(), alone.displacements());
  EXPECT_EQ(observed.velocities(), alone.velocities());
}

}  // namespace
