// Laws of contact between soft bodies, and of bodies with themselves.
#include "contact/soft_scene.hpp"
#include "support/count_allocations.hpp"

#include <corotet/detail/core/thread_pool.hpp>

#include <cmath>
#include <numbers>
#include <string>

namespace corotet::contact_scene {
namespace {

using Vec = Vec3<double>;

template <class Scene>
class SoftContactLaw : public ::testing::Test {};
using Scenes = ::testing::Types<SoftScene<float, Tet4, ImplicitEuler>, SoftScene<double, Tet10, Bdf2>>;
TYPED_TEST_SUITE(SoftContactLaw, Scenes);

/// Cells along an edge of a cube, for about as many vertices with either element.
template <class Scene>
constexpr Index cells(Index of_tet4) {
  return Scene::Element::nodes == 4 ? of_tet4 : (of_tet4 + 1) / 2;
}
template <class Scene>
BlockOptions cube(const Vec& corner, double edge, Index of_tet4) {
  const Index n = cells<Scene>(of_tet4);
  return {.corner = corner, .size = Vec::Constant(edge), .cells = {n, n, n}};
}
Material rubber(double young, double density = 1000) { return {.young = young, .poisson = 0.3, .density = density}; }

template <class Scene>
std::string bits_of(const Scene& s) {
  std::string all;
  for (const auto& m : s.members)
    for (const auto* field : {&m->body.displacements(), &m->body.velocities()})
      for (const auto& x : *field)
        all.append(reinterpret_cast<const char*>(x.data()), 3 * sizeof(typename Scene::Scalar));
  return all;
}

TYPED_TEST(SoftContactLaw, StackedBlocksRestOnEachOther) {
  using Scene = TypeParam;
  const double young = Scene::Element::nodes == 4 ? 5e5 : 5e7;
  Scene s;
  s.body.damping.mass = 3;  // a soft stack sways for long
  s.obstacles.add(HalfSpace{});
  for (const double i : {0.0, 1.0, 2.0})  // meshes that do not match, each block a little aside of the one below
    s.add(cube<Scene>({0.02 * i, -0.01 * i, 0.2 * i}, 0.2, 3 + static_cast<Index>(i) % 2), rubber(young));
  s.set_gravity(9.81);
  s.run(2);
  if (this->HasFatalFailure()) return;
  const double weight = 9.81 * 8;
  EXPECT_NEAR(s.soft.report().normal_force, (1 + 2) * weight, 0.02 * weight);
  EXPECT_NEAR(s.members[0]->contacts.report().normal_force, 3 * weight, 0.02 * weight);
  EXPECT_LT(s.soft.report().deepest, 1e-3 * 0.2);
  EXPECT_LT(s.fastest(), 0.02);
  EXPECT_TRUE(s.soft.report().settled);
  EXPECT_EQ(s.soft.report().dropped, 0);
}

TYPED_TEST(SoftContactLaw, ACollisionKeepsMomentaAndGainsNoEnergy) {
  using Scene = TypeParam;
  constexpr double rounding = std::is_same_v<typename Scene::Scalar, float> ? 1e-6 : 1e-12;
  for (const double friction : {0.0, 0.6})
    for (const double h : {1.0 / 60, 1.0 / 240}) {
      Scene s({.friction = friction});
      auto& a = s.add(cube<Scene>({0, 0, 0}, 0.4, 4), rubber(5e5));
      auto& b = s.add(cube<Scene>({0.5, 0.1, 0.13}, 0.4, 3), rubber(3e5, 500));
      s.throw_with(a, [](const Vec& x) -> Vec { return Vec(3, 0, 0) + Vec(0, 0, 2).cross(x - Vec(.2, .2, .2)); });
      s.throw_with(b, [](const Vec& x) -> Vec { return Vec(-2, .1, 0) + Vec(1, 0, 0).cross(x - Vec(.7, .3, .33)); });
      const Vec p = s.momentum(), l = s.angular_momentum();
      const double energy = s.energy();
      double most = 0;
      int touched = 0;
      for (int i = 0; i * h < 0.5; ++i) {
        s.step(h);
        most = std::max(most, s.energy());
        touched += s.soft.report().touching > 0 ? 1 : 0;
      }
      EXPECT_GT(touched, 0);
      EXPECT_LT((s.momentum() - p).norm(), 10 * rounding * p.norm());
      EXPECT_LT((s.angular_momentum() - l).norm(), 10 * rounding * l.norm());
      EXPECT_LT(most, energy * (1 + 1e-3));
      EXPECT_LT(s.energy(), 0.9 * energy) << "they must have met";
    }
}

/// A column of two blocks that are held at both ends and pressed together is as stiff as one of the same length.
TYPED_TEST(SoftContactLaw, PressedBlocksBearTheForceOfOneColumn) {
  using Scene = TypeParam;
  const double young = 1e5, edge = 0.2, strain = 0.05;
  Scene s({.friction = 0.5});
  auto& low = s.add(cube<Scene>({0, 0, 0}, edge, 4), {.young = young, .poisson = 0, .density = 1000});
  auto& high = s.add(cube<Scene>({0, 0, edge}, edge, 6), {.young = young, .poisson = 0, .density = 1000});
  const auto hold = [&](auto& member, double z, double way) {
    for (Index v = 0; v < member.body.vertex_count(); ++v)
      if (std::fabs(Scene::place(member, v).z() - z) < 1e-6)
        member.body.pins().pin(v, {0, 0, static_cast<typename Scene::Scalar>(way)});
  };
  hold(low, 0, 0);
  hold(high, 2 * edge, 0);
  std::vector<Index> top = high.body.pins().vertices();
  for (int i = 1; i <= 30; ++i) {
    const double way = -2 * edge * strain * std::min(i, 20) / 20;
    for (const Index v : top) high.body.pins().pin(v, {0, 0, static_cast<typename Scene::Scalar>(way)});
    s.step();
    if (this->HasFatalFailure()) return;
  }
  for (int i = 0; i < 20; ++i) s.step();
  const double expected = young * strain * edge * edge;
  // Forces of points on triangles pass the patch test with linear elements, with quadratic ones as the mesh gets fine.
  EXPECT_NEAR(s.soft.report().normal_force, expected, (Scene::Element::nodes == 4 ? 1e-3 : 0.02) * expected);
}

TYPED_TEST(SoftContactLaw, ABarFoldsOntoItselfAndNotThroughItself) {
  using Scene = TypeParam;
  const double radius = 0.1, arm = 0.5, half = 0.03, bend = std::numbers::pi * radius;
  const auto horseshoe = [&](const Vec& x) -> Vec {
    const double t = x.x(), z = x.z();
    if (t < arm) return x;
    if (t > arm + bend) return {arm - (t - arm - bend), x.y(), 2 * radius - z};
    const double angle = (t - arm) / radius;
    return {arm + (radius - z) * std::sin(angle), x.y(), radius - (radius - z) * std::cos(angle)};
  };
  const auto lowest_of_upper_arm = [&](bool touches) {
    Scene s({.friction = 0.4});
    s.touches = touches;
    const Index n = cells<Scene>(24);
    auto& m = s.add({.corner = {0, 0, -half},
                     .size = {2 * arm + bend, 0.15, 2 * half},
                     .cells = {n, cells<Scene>(3), cells<Scene>(2)}},
                    rubber(3e5), horseshoe);
    std::vector<Index> upper;
    for (Index v = 0; v < m.body.vertex_count(); ++v) {
      const Vec x = Scene::place(m, v);
      if (x.z() < -half + 1e-6 && x.x() < arm) m.body.pins().pin(v, {0, 0, 0});
      if (x.z() > 2 * radius - half - 1e-6 && x.x() < arm) upper.push_back(v);
    }
    s.set_gravity(9.81);
    s.run(1);
    double lowest = 1;
    for (const Index v : upper) lowest = std::min(lowest, Scene::place(m, v).z());
    return lowest;
  };
  EXPECT_LT(lowest_of_upper_arm(false), -half) << "without contact it falls through";
  EXPECT_GT(lowest_of_upper_arm(true), half - 5e-3);
}

TYPED_TEST(SoftContactLaw, BodiesThatDoNotTouchMoveAsAlone) {
  using Scene = TypeParam;
  const auto bits = [](bool touches) {
    Scene s;
    s.touches = touches;
    s.add(cube<Scene>({0, 0, 0}, 0.2, 3), rubber(1e5));
    auto& b = s.add(cube<Scene>({0, 0, 9}, 0.2, 3), rubber(1e5));
    s.throw_with(b, [](const Vec& x) -> Vec { return Vec(0, 3, 0).cross(x); });
    s.step(1e-3);  // with contact, the first step does not know how near they are
    s.run(0.3);
    return bits_of(s);
  };
  EXPECT_TRUE(bits(true) == bits(false));
}

TYPED_TEST(SoftContactLaw, ThreadsDoNotChangeABit) {
  using Scene = TypeParam;
  const auto bits = [](ExecutorRef executor) {
    Scene s;
    s.obstacles.add(HalfSpace{});
    s.add(cube<Scene>({0, 0, 0.01}, 0.2, 5), rubber(1e5));
    s.add(cube<Scene>({0.05, 0, 0.23}, 0.2, 5), rubber(1e5));
    s.set_gravity(9.81);
    for (int i = 0; i < 8; ++i) s.step(1.0 / 60, executor);
    EXPECT_GT(s.soft.report().touching, 0);
    return bits_of(s);
  };
  const std::string serial = bits({});
  for (const int threads : {2, 4}) {
    ThreadPool pool(threads);
    EXPECT_TRUE(serial == bits(pool));
  }
}

TYPED_TEST(SoftContactLaw, AStepAllocatesNothing) {
  using Scene = TypeParam;
  Scene s;
  s.obstacles.add(HalfSpace{});
  s.add(cube<Scene>({0, 0, 0.01}, 0.2, 3), rubber(3e5));
  s.add(cube<Scene>({0.02, 0, 0.22}, 0.2, 4), rubber(3e5));
  s.set_gravity(9.81);
  s.run(0.5);
  EXPECT_GT(s.soft.report().touching, 0);
  const long before = testing::allocation_count;
  for (int i = 0; i < 20; ++i) s.step();
  EXPECT_EQ(testing::allocation_count - before, 0);
}

TYPED_TEST(SoftContactLaw, WhatWasPutAsideGoesOnInTheSameBits) {
  using Scene = TypeParam;
  Scene s;
  s.obstacles.add(HalfSpace{});
  s.add(cube<Scene>({0, 0, 0.01}, 0.2, 3), rubber(3e5));
  s.add(cube<Scene>({0.02, 0, 0.22}, 0.2, 4), rubber(3e5));
  s.set_gravity(9.81);
  s.run(0.3);
  std::vector<typename Scene::Member> members;
  for (const auto& m : s.members) members.push_back(*m);
  const auto soft = s.soft;
  const Obstacles obstacles = s.obstacles;
  s.run(0.2);
  const std::string bits = bits_of(s);
  for (std::size_t i = 0; i < members.size(); ++i) *s.members[i] = members[i];
  s.soft = soft;
  s.obstacles = obstacles;
  EXPECT_FALSE(bits == bits_of(s));
  s.run(0.2);
  EXPECT_TRUE(bits == bits_of(s));
}

/// What the bodies' numbers are changes nothing but rounding and the solver's error.
TYPED_TEST(SoftContactLaw, TheOrderOfBodiesDoesNotMatter) {
  using Scene = TypeParam;
  const auto run = [](bool reversed) {
    Scene s;
    s.tolerance = 1e-6;
    s.obstacles.add(HalfSpace{});
    for (int i = 0; i < 2; ++i) {
      const double place = reversed ? 1 - i : i;
      s.add(cube<Scene>({0.03 * place, 0, 0.2 * place}, 0.2, place > 0 ? 3 : 4), rubber(1e5));
    }
    s.set_gravity(9.81);
    s.run(0.5);
    std::vector<Vec> corners;
    for (int i = 0; i < 2; ++i)
      corners.push_back(Scene::place(*s.members[static_cast<std::size_t>(reversed ? 1 - i : i)], 0));
    return corners;
  };
  const auto a = run(false), b = run(true);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((a[i] - b[i]).norm(), 1e-5 * 0.2);
}

TYPED_TEST(SoftContactLaw, NothingFastPassesASheet) {
  using Scene = TypeParam;
  for (const double speed : {10.0, 50.0}) {
    Scene s({.friction = 0.3});
    const double half = 0.01;
    const Index n = cells<Scene>(12);
    auto& plate = s.add({.corner = {-0.5, -0.5, -half}, .size = {1, 1, 2 * half}, .cells = {n, n, 1}}, rubber(1e7));
    for (Index v = 0; v < plate.body.vertex_count(); ++v) {
      const Vec x = Scene::place(plate, v);
      if (std::fabs(x.x()) > 0.499 || std::fabs(x.y()) > 0.499) plate.body.pins().pin(v, {0, 0, 0});
    }
    auto& ball = s.add(cube<Scene>({-0.1, -0.1, 0.6}, 0.2, 3), rubber(1e6, 100));
    s.throw_with(ball, [speed](const Vec&) -> Vec { return {0, 0, -speed}; });
    for (int i = 0; i < static_cast<int>(60 / speed) + 10; ++i) s.step();
    Vec centre = Vec::Zero();
    for (Index v = 0; v < ball.body.vertex_count(); ++v) centre += Scene::place(ball, v) / ball.body.vertex_count();
    double lowest = 0;  // of the plate
    for (Index v = 0; v < plate.body.vertex_count(); ++v) lowest = std::min(lowest, Scene::place(plate, v).z());
    EXPECT_GT(centre.z(), lowest) << "at " << speed << " m/s";
  }
}

}  // namespace
}  // namespace corotet::contact_scene
