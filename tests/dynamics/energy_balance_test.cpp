// No step makes energy out of nothing.
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "support/bodies.hpp"
#include "support/floating_point_traps.hpp"
#include "support/solver_choice.hpp"

namespace corotet::energy_balance_test {
namespace {

using testing::must;

template <class K>
class Energy : public ::testing::Test {
 public:
  using Body = SoftBody<typename K::Scalar, typename K::Element>;
  static constexpr auto h = static_cast<typename K::Scalar>(1.0 / 60);

  static Body bar(double poisson, VolumetricStrain volumetric_strain, const RayleighDamping& damping = {}) {
    return testing::cantilever<typename K::Scalar, typename K::Element>(
        {.corner = {0, -0.1, -0.1}, .size = {1, 0.2, 0.2}, .cells = {5, 1, 1}},
        Material{.young = 5e5, .poisson = poisson, .density = 1000}, 9.81,
        {.mass = MassModel::lumped, .damping = damping, .volumetric_strain = volumetric_strain});
  }

  /// The most that the energy ever rises in a swing of 5 s, over the swing's kinetic energy.
  template <class Integrator>
  static double rise(Body body, const StepOptions& newton) {
    Integrator integrator(body, testing::solver(), newton);
    testing::EnergyWatch watch(testing::energy(body));
    double scale = 0;
    for (int step = 0; step < 300; ++step) {
      EXPECT_TRUE(integrator.step(body, h).accepted());
      scale = std::max(scale, testing::kinetic_energy(body));
      watch.see(testing::energy(body));
    }
    return watch.rise() / scale;
  }
};
TYPED_TEST_SUITE(Energy, testing::AllCases);

/// Nearly incompressible, the bar's pressure answers to each stretch along a straight line.
TYPED_TEST(Energy, OfASwingNeverRises) {
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged})
    for (const double poisson : {0.3, 0.45, 0.499}) {
      const auto bar = this->bar(poisson, volumetric_strain);
      const double kept = this->template rise<ImplicitEuler<typename TestFixture::Body>>(bar, {});
      EXPECT_LT(kept, 1e-3) << "nu = " << poisson;
      if (poisson < 0.49 || volumetric_strain == VolumetricStrain::averaged) continue;
      EXPECT_GT(
          this->template rise<ImplicitEuler<typename TestFixture::Body>>(bar, StepOptions{.bounds_energy = false}),
          5e-3)
          << "the case must tell";
    }
}

/// The error of the second order formula has either sign: also solved to the end its energy rises by two thousandths.
TYPED_TEST(Energy, OfASwingHardlyRisesWithTheSecondOrder) {
  using Bdf = Bdf2<typename TestFixture::Body>;
  EXPECT_LT(this->template rise<Bdf>(this->bar(0.499, VolumetricStrain::averaged), {}), 1e-3);
  for (const double poisson : {0.3, 0.499}) {
    const auto bar = this->bar(poisson, VolumetricStrain::pointwise);
    EXPECT_LT(this->template rise<Bdf>(bar, {}), 1e-3) << "nu = " << poisson;
    EXPECT_GT(this->template rise<Bdf>(bar, StepOptions{.bounds_energy = false}), poisson > 0.4 ? 1e-2 : 1.5e-3)
        << "the case must tell, nu = " << poisson;
  }
}

/// What forces and pins do to a body is no gain: steps are solved once.
TYPED_TEST(Energy, GivenByPinsAndForcesIsNotTakenForAGain) {
  using Scalar = typename TypeParam::Scalar;
  for (const RayleighDamping& damping : {RayleighDamping{0, 0}, RayleighDamping{2, 0}, RayleighDamping{1, 0.05}})
    for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
      auto body = this->bar(0.3, volumetric_strain, damping);
      body.pin_where([](const auto& x) { return x.x() == 1; });
      body.external_forces()[at(body.mesh().nearest_vertex({Scalar(0.5), 0, 0}))].y() = 400;
      ImplicitEuler euler(body);
      double strain = 0;
      const double start = testing::energy(body);
      for (int step = 0; step < 60; ++step) {  // to 1.6 times its length within a second, and to the side
        for (const Index v : std::vector<Index>(body.pins().vertices()))
          if (body.mesh().position(v).x() == 1)
            body.move_pin(v, body.mesh().position(v) + Scalar(step + 1) * Vec3<Scalar>(Scalar(0.01), 0, Scalar(0.003)));
        const StepReport report = euler.step(body, this->h);
        ASSERT_TRUE(report.accepted());
        EXPECT_EQ(report.newton_iterations, 1) << "step " << step;
        strain = std::max(strain, report.max_strain);
      }
      EXPECT_GT(strain, 0.3) << "so far that gains count";
      EXPECT_GT(testing::energy(body), start + 500) << "J: the case must tell";
    }
}

/// A stiff wheel on an axle gains in each step what the next takes back; to solve that again would brake it.
TYPED_TEST(Energy, OfAWheelOnAnAxleIsLeftAlone) {
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
    auto body = must(
        TestFixture::Body::create(testing::block<typename TypeParam::Scalar, typename TypeParam::Element>(
                                      {.corner = {-0.2, -0.2, -0.1}, .size = {0.4, 0.4, 0.2}, .cells = {2, 2, 1}}),
                                  Material{.young = 5e7, .poisson = 0.3, .density = 1000},
                                  {.mass = MassModel::lumped, .damping = {}, .volumetric_strain = volumetric_strain}));
    body.pin_where([](const auto& x) { return x.x() == 0 && x.y() == 0; });
    must(body.set_velocities(testing::spin_of(body.mesh(), {0, 0, 6})));
    ImplicitEuler euler(body, testing::solver({.tolerance = 1e-5}));
    const double start = testing::kinetic_energy(body);
    for (int step = 0; step < 60; ++step) EXPECT_EQ(euler.step(body, this->h).newton_iterations, 1) << "step " << step;
    EXPECT_GT(testing::kinetic_energy(body), 0.9 * start);
  }
}

/// A body at rest is not solved again because of rounding.
TYPED_TEST(Energy, AtRestIsNotTakenForAGain) {
  const auto try_with = [this]<class Integrator>(Integrator*, double damping, int steps) {
    auto body = this->bar(0.3, VolumetricStrain::pointwise, {.mass = damping});
    body.set_gravity({0, 0, -20});  // bent to a stress at which gains count
    Integrator integrator(body);
    int again = 0;
    double strain = 0;
    for (int step = 0; step < steps; ++step) {
      const StepReport report = integrator.step(body, this->h);
      if (step > 600 && report.newton_iterations > 1) ++again;
      strain = report.max_strain;
    }
    EXPECT_GT(strain, 0.1);
    EXPECT_EQ(again, 0);
  };
  try_with(static_cast<ImplicitEuler<typename TestFixture::Body>*>(nullptr), 0, 900);
  try_with(static_cast<Bdf2<typename TestFixture::Body>*>(nullptr), 10, 4000);
}

/// The projection of a free body's angular momentum gives and takes energy, too.
TYPED_TEST(Energy, OfAFreeBodyThatSpinsAndBendsHardlyRisesWithTheSecondOrder) {
  using Scalar = typename TypeParam::Scalar;
  auto body = this->bar(0.499, VolumetricStrain::pointwise);
  body.set_gravity({0, 0, 0});
  for (const Index v : std::vector<Index>(body.pins().vertices())) body.pins().release(v);
  must(body.set_displacements(testing::displacement_of(
      body.mesh(), [](const Vec3<double>& x) { return Vec3<double>(x.x(), x.y(), x.z() + 0.4 * x.x() * x.x()); })));
  must(body.set_velocities(testing::spin_of(body.mesh(), {0, 0, Scalar(0.1) / this->h})));
  const auto rise_of = [&](const StepOptions& newton) {
    auto copy = body;
    Bdf2 bdf2(copy, testing::solver(), newton);
    testing::EnergyWatch watch(testing::energy(copy));
    const double scale = watch.least();
    for (int step = 0; step < 300; ++step) {
      EXPECT_TRUE(bdf2.step(copy, this->h).accepted());
      watch.see(testing::energy(copy));
    }
    return watch.rise() / scale;
  };
  const double bounded = rise_of({}), left = rise_of({.bounds_energy = false});
  std::printf("free bar, rise of the energy: %.2g bounded, %.2g else\n", bounded, left);
  // In float 2e-4 in the mean of 40 such starts, bent by 0.36 to 0.44, and 7e-4 at most: rounding decides.
  EXPECT_LT(bounded, 1e-3);
  EXPECT_GT(left, 2 * bounded) << "the case must tell";
}

}  // namespace
}  // namespace corotet::energy_balance_test
