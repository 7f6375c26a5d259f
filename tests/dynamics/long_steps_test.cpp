// Steps that are long against the time in which a body moves.
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/wave_transit_time.hpp>
#include <gtest/gtest.h>

#include <algorithm>

#include "support/bodies.hpp"
#include "support/solver_choice.hpp"

namespace corotet::long_steps_test {
namespace {

using testing::must;

template <class Element>
class LongSteps : public ::testing::Test {};
using Elements = ::testing::Types<Tet4, Tet10>;
TYPED_TEST_SUITE(LongSteps, Elements);

/// The largest motion of a vertex in the last ten of `steps` steps, and where the last vertex then is.
struct End {
  double motion = 0;
  Vec3<double> displacement;
};
template <class Integrator, class Body>
End hang(Body body, double h, int steps) {
  Integrator integrator(body, testing::solver({.tolerance = 1e-8}));
  End end;
  for (int step = 0; step < steps; ++step) {
    const auto before = body.displacements();
    EXPECT_TRUE(integrator.step(body, h).accepted());
    if (step < steps - 10) continue;
    for (Index v = 0; v < body.vertex_count(); ++v)
      end.motion = std::max(end.motion, (body.displacements()[at(v)] - before[at(v)]).norm());
  }
  end.displacement = body.displacements()[at(body.mesh().nearest_vertex({1, 0.05, 0.05}))];
  return end;
}

/// A slender bar (20:1) that hangs by its end, rho g L / E = 0.2, is longer by rho g L^2 / 2 E and rests, whatever the
/// step: 0.7 to 70 times as long as sound takes along it.
TYPED_TEST(LongSteps, AHangingBarComesToRest) {
  const Material soft{.young = 49050, .poisson = 0, .density = 1000};
  auto body = must(SoftBody<double, TypeParam>::create(
      testing::block<double, TypeParam>({.size = {1, 0.05, 0.05}, .cells = {20, 1, 1}}), soft,
      {.damping = {.mass = 10, .stiffness = 0}}));
  body.pin_where([](const auto& x) { return x.x() == 0; });
  body.set_gravity({9.81, 0, 0});
  for (const double h : {0.1, 0.3, 1.0, 10.0})
    for (const End& end :
         {hang<ImplicitEuler<decltype(body)>>(body, h, 200), hang<Bdf2<decltype(body)>>(body, h, 200)}) {
      EXPECT_LT(end.motion, 1e-4) << "h = " << h;
      EXPECT_NEAR(end.displacement.x(), 0.1, 1e-3) << "h = " << h;
    }
}

/// In a small bar that bends by a tenth of its length, the second order formula ends where backward Euler does.
TYPED_TEST(LongSteps, BothIntegratorsSettleInTheSameShape) {
  auto body = testing::cantilever<double, TypeParam>({.size = {0.01, 0.005, 0.005}, .cells = {2, 1, 1}},
                                                     Material{.young = 5e5, .poisson = 0.3, .density = 1000}, 0,
                                                     {.damping = {.mass = 2000, .stiffness = 0}});
  body.set_gravity({0, 0, -2000});
  for (const double h : {0.01, 0.1, 1.0}) {
    const End euler = hang<ImplicitEuler<decltype(body)>>(body, h, 100),
              bdf2 = hang<Bdf2<decltype(body)>>(body, h, 100);
    EXPECT_LT((euler.displacement - bdf2.displacement).norm(), 1e-4 * euler.displacement.norm()) << "h = " << h;
    EXPECT_GT(euler.displacement.norm(), 1e-4) << "the case must tell";
  }
}

/// 4 V / A of blocks; vertices at edges make it larger, by a seventh in a bar of four cells across, by 1/sin 45 degrees
/// at most where all vertices lie on its edges.
TYPED_TEST(LongSteps, ThicknessIsThatOfBarsAndTwiceThatOfPlates) {
  const auto of = [](const Vec3<double>& size, const std::array<Index, 3>& cells) {
    return detail::hydraulic_diameter(testing::block<double, TypeParam>({.size = size, .cells = cells}));
  };
  EXPECT_NEAR(of({10, 0.1, 0.1}, {10, 4, 4}), 0.11, 0.01);
  EXPECT_NEAR(of({10, 0.1, 0.1}, {10, 1, 1}), 0.13, 0.02);
  EXPECT_NEAR(of({1, 1, 0.01}, {20, 20, 1}), 0.02, 0.002);
  const double one = of({1, 2, 3}, {2, 2, 2});
  EXPECT_NEAR(of({1e-3, 2e-3, 3e-3}, {2, 2, 2}), 1e-3 * one, 1e-15);
}

TEST(CrossingTime, IsThatOfTheFastestMaterial) {
  const Material slow{.young = 1e4, .poisson = 0.3, .density = 1e4}, fast{.young = 4e6, .poisson = 0, .density = 1e2};
  EXPECT_DOUBLE_EQ(detail::wave_transit_time(0.5, slow, 7), 0.5);
  EXPECT_DOUBLE_EQ(detail::wave_transit_time(0.5, std::vector<Material>{slow, fast, slow}, 3), 0.5 / 200);
}

}  // namespace
}  // namespace corotet::long_steps_test
