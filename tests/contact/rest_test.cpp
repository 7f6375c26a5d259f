// Bodies that rest, stick, slide and are pressed: against what statics and Coulomb's law say.
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/scene.hpp"

namespace corotet::contact_rest_test {
namespace {

using namespace contact_scene;

class ContactRest : public ByMethod {};
INSTANTIATE_TEST_SUITE_P(Methods, ContactRest, all_methods, by_name);

/// How long it takes until nothing changes: multipliers follow at a half a step, under BDF2 by a twentieth.
int settling_steps(const Method& method) { return method.is_bdf2() ? 360 : 120; }

/// Then the floor carries the weight to the last digits, nothing sinks in, nothing moves, and nothing creeps.
void expect_rest(const Method& method, Scene& scene, double size, double h = frame_time) {
  const double weight = scene.total_mass() * g, speed = std::sqrt(size / 0.4);
  const int steps = std::max(settling_steps(method), static_cast<int>(2 / h * speed));
  scene.run(steps * h, h);
  EXPECT_NEAR(scene.report().normal_force / weight, 1, 1e-5);
  EXPECT_LT(scene.report().deepest, 1e-6 * size);
  EXPECT_LT(scene.fastest(), 1e-5 * speed);
  EXPECT_TRUE(scene.report().settled);
  const V before = scene.centre();
  scene.run(120 * h, h);
  EXPECT_LT((scene.centre() - before).norm(), 1e-6 * size);
  EXPECT_EQ(scene.report().dropped, 0);
}

TEST_P(ContactRest, ABlockStandsStill) {
  for (const double young : {5e5, 5e7}) {
    SCOPED_TRACE(young);
    expect_rest(method(), *on_floor(method(), cube(method(), 3, young)), 0.4);
  }
}

/// Many more points than the mesh has vertices there, embedded in its elements.
TEST_P(ContactRest, AFineSkinStandsStill) {
  SceneOptions options = cube(method(), 2, 5e6);
  options.skin = 12;
  auto scene = on_floor(method(), options);
  expect_rest(method(), *scene, 0.4);
  EXPECT_GT(scene->report().touching, 100);
}

/// From a millimetre to a kilometre: with Young's modulus in proportion, so that all strains are the same.
TEST(ContactScale, BodiesOfAnySizeStandStill) {
  for (const Method& method : {euler, Method{Kind::double_tet10_euler, false}})
    for (const double size : {1e-3, 1e3}) {
      SCOPED_TRACE(size);
      SceneOptions options = cube(method, 2, 1e6 * size);
      options.block.size = V::Constant(size);
      expect_rest(method, *on_floor(method, options), size, std::sqrt(size / 0.4) / 60);
      if (size < 1) expect_rest(method, *on_floor(method, options), size);
    }
}

TEST(ContactScale, AnyLengthOfStepStandsStill) {
  for (const Method& method : {euler, Method{Kind::double_tet10_euler, false}, bdf2})
    for (const double h : {1e-3, 4e-3, 1.0 / 30, 0.1}) {
      SCOPED_TRACE(h);
      if (method.is_float() && h < 4e-3) continue;  // the rounding of positions over the step is more than the bound
      SceneOptions options = cube(method, 2, 5e6);
      options.tolerance = 1e-4;
      options.body.damping = {.mass = 0, .stiffness = 5e-3};
      expect_rest(method, *on_floor(method, options), 0.4, h);
    }
}

/// The world's origin is ten kilometres away, the mesh's is near; and with gravity along any axis.
TEST_P(ContactRest, StandsStillFarAwayAndSideways) {
  const V far(1e4, -1e4, 1e4);
  SceneOptions options = cube(method(), 3, 5e5);
  options.block.corner = options.origin = far;
  auto scene = make_scene(method(), options);
  scene->obstacles.add(HalfSpace{{-1, 0, 0}, 0}, {.pose = {.position = far + V(0.4, 0, 0)}});
  scene->set_gravity({g, 0, 0});
  expect_rest(method(), *scene, 0.4);
}

/// A plate comes down on a block on a floor; nu = 0: the strain is that of the plates everywhere, with friction or
/// without, and the pressure uniform.
TEST_P(ContactRest, ABlockBetweenPlatesHasTheAffineField) {
  SceneOptions options;
  options.block.size = {0.3, 0.2, 0.4};
  options.block.cells = method().is_tet4() ? std::array<Index, 3>{3, 2, 4} : std::array<Index, 3>{2, 1, 2};
  options.material.poisson = 0;
  options.contact.friction = method().is_tet4() ? 0 : 0.5;
  options.tolerance = 1e-5;
  auto scene = make_scene(method(), options);
  scene->obstacles.add(HalfSpace{});
  const Index plate = scene->obstacles.add(HalfSpace{{0, 0, -1}, 0}, {.pose = {.position = {0, 0, 0.4}}});
  const double strain = 0.1, seconds = 0.5;
  scene->obstacles[plate].velocity = {0, 0, -0.4 * strain / seconds};
  scene->run(seconds);
  scene->obstacles[plate].velocity.setZero();
  scene->run(settling_steps(method()) * frame_time);
  double error = 0;
  for (Index v = 0; v < scene->vertex_count(); ++v) {
    const V x = scene->rest(v), expected(x.x(), x.y(), (1 - strain) * x.z());
    error = std::max(error, (scene->position(v) - expected).norm());
  }
  const double noise = method().is_float() ? 3e-6 : 1e-6;
  EXPECT_LT(error, noise * 0.4);
  const double force = options.material.young * strain * 0.3 * 0.2;
  EXPECT_NEAR(scene->report().normal_force / (2 * force), 1, noise / strain);
  if (!method().is_tet4()) return;  // corners of Tet10 carry none of a uniform pressure
  // A vertex carries a third of the triangles around it.
  std::map<Index, double> area;
  double pressed = 0;
  for (const Touch& touch : scene->touches()) {
    const Index v = scene->points().vertex(scene->points().first(touch.point));
    const V x = scene->rest(v);
    pressed += touch.impulse.norm() / frame_time;
    const bool edge_x = x.x() < 1e-6 || x.x() > 0.3 - 1e-6, edge_y = x.y() < 1e-6 || x.y() > 0.2 - 1e-6;
    if (edge_x || edge_y) continue;  // inside, with alternating diagonals, four or eight triangles of a half cell
    area[v] = touch.impulse.norm() / frame_time / (options.material.young * strain) / 0.01;
  }
  EXPECT_NEAR(pressed, 2 * force, 1e-4 * force);
  ASSERT_FALSE(area.empty());
  for (const auto& [v, cells] : area)  // 4/6 or 8/6 cells
    EXPECT_LT(std::min(std::fabs(cells - 4.0 / 6), std::fabs(cells - 8.0 / 6)), 1e-3) << cells;
}

/// On a slope: gravity that is not normal to the floor. `ratio`: of its tangent to the friction's coefficient.
std::unique_ptr<Scene> on_slope(const Method& method, double ratio, double young, double friction = 0.5) {
  SceneOptions options;
  options.block.size = {0.4, 0.4, 0.1};
  options.block.cells = {method.cells(4), method.cells(4), method.cells(2)};
  options.material.young = young;
  options.contact.friction = friction;
  auto scene = make_scene(method, options);
  scene->obstacles.add(HalfSpace{});
  const double slope = std::atan(friction * ratio);
  scene->set_gravity({g * std::sin(slope), 0, -g * std::cos(slope)});
  return scene;
}

TEST_P(ContactRest, ABlockSticksOnASlopeUpToItsFriction) {
  for (const double young : {5e5, 5e7}) {
    auto scene = on_slope(method(), 0.99, young);
    scene->run(settling_steps(method()) * frame_time);
    const V before = scene->centre();
    scene->run(2);
    EXPECT_LT((scene->centre() - before).norm() / 2, 1e-5) << young;
  }
}

TEST_P(ContactRest, ABlockSlidesDownASteeperSlopeAsCoulombSays) {
  for (const double ratio : {1.02, 1.2}) {
    auto scene = on_slope(method(), ratio, 5e6);
    const double slope = std::atan(0.5 * ratio), expected = g * (std::sin(slope) - 0.5 * std::cos(slope));
    scene->run(method().is_bdf2() ? 2 : 1);
    const double before = scene->mean_velocity().x();
    scene->run(1);
    const double a = scene->mean_velocity().x() - before;
    EXPECT_NEAR(a / expected, 1, 1e-4) << ratio;
    EXPECT_NEAR(scene->mean_velocity().y(), 0, 1e-4 * a);
  }
}

/// A wall of friction: far steeper than any block could slide.
TEST(ContactFriction, LargeCoefficientsHold) {
  auto scene = on_slope(euler, 0.2, 5e6, 10);  // tangent 2
  scene->run(2);
  const V before = scene->centre();
  scene->run(1);
  EXPECT_LT((scene->centre() - before).norm(), 1e-5);
}

/// Friction brakes a block that slides on a floor over v^2 / (2 mu g); in steps of backward Euler over v h / 2 less.
TEST(ContactFriction, BrakesOverItsDistance) {
  constexpr double v = 2, exact = v * v / (2 * 0.5 * g), own = exact - v * frame_time / 2;
  for (const double young : {5e5, 5e7})
    for (const Method& method : {euler, bdf2}) {
      auto scene = on_slope(method, 0, young);
      scene->obstacles[0].friction = 0;
      scene->run(2);
      scene->obstacles[0].friction = 0.5;
      const double start = scene->centre().x();
      scene->throw_with([&](const V&) { return V(v, 0, 0); });
      scene->run(1);
      const double way = scene->centre().x() - start;
      EXPECT_NEAR(way / (method.is_bdf2() ? exact : own), 1, method.is_bdf2() ? 0.005 : 0.001) << young;
      EXPECT_LT(scene->fastest(), 1e-3);
    }
}

/// Between two plates that press with F each, a block is held if 2 mu F > m g. nu = 0: then F is that of the strain.
TEST(ContactFriction, AGripHoldsWhatItsForceCanHold) {
  constexpr double size = 0.2, young = 5e5, friction = 0.5, lift = 0.2;
  for (const double ratio : {0.98, 1.02})
    for (const Method& method : {euler, Method{Kind::double_tet10_euler, true}}) {
      SceneOptions options = cube(method, 4, young);
      options.block.size = V::Constant(size);
      options.material.poisson = 0;
      options.contact.friction = friction;
      auto scene = make_scene(method, options);
      for (const double side : {1.0, -1.0})
        scene->obstacles.add(HalfSpace{{side, 0, 0}, 0}, {.pose = {.position = {side > 0 ? 0 : size, 0, 0}}});
      const double weight = scene->total_mass() * g, force = ratio * weight / (2 * friction);
      const double close = force / (young * size * size) * size / 2;  // of each plate
      const auto lead = [&](double inwards, double up) {
        scene->obstacles[0].velocity = {inwards, 0, up};
        scene->obstacles[1].velocity = {-inwards, 0, up};
      };
      lead(2 * close, 0);
      scene->run(0.5);
      lead(0, 0);
      for (int i = 1; i <= 60; ++i) {  // then weight comes slowly
        scene->set_gravity({0, 0, -g * i / 60});
        scene->step();
      }
      double pressed = 0;
      for (const Touch& touch : scene->touches()) pressed += touch.normal.dot(touch.impulse) / frame_time;
      EXPECT_NEAR(pressed / (2 * force), 1, 2e-3);
      for (int i = 1; i <= 120; ++i) {  // and up: never faster than by 0.1 m/s^2, 1 % of the weight
        lead(0, lift * std::min(1.0, i / 120.0));
        scene->step();
      }
      scene->run(0.5);
      const double before = scene->centre().z();
      scene->run(0.5);
      const double slip = lift * 0.5 - (scene->centre().z() - before);
      if (ratio > 1)
        EXPECT_LT(std::fabs(slip), 1e-5);
      else
        EXPECT_GT(slip, 0.1);
    }
}

/// Led walls squeeze a block to 70 % and let go of it: it takes its shape again.
TEST(ContactPress, ABlockTakesItsShapeAgain) {
  for (const double young : {5e5, 5e7})
    for (const Method& method : {euler, Method{Kind::double_tet10_euler, true}}) {
      SceneOptions options = cube(method, 4, young);
      options.body.damping = {.mass = 0, .stiffness = 1e-3};
      auto scene = make_scene(method, options);
      for (const double side : {1.0, -1.0})
        scene->obstacles.add(OrientedBox{{0.1, 1, 1}}, {.pose = {.position = {side > 0 ? -0.1 : 0.5, 0, 0}}});
      double deepest = 0;
      const auto lead = [&](double inwards, double seconds) {
        scene->obstacles[0].velocity = {inwards, 0, 0};
        scene->obstacles[1].velocity = {-inwards, 0, 0};
        for (int i = 0; i < seconds * 60; ++i) {
          const StepReport report = scene->step();
          ASSERT_TRUE(report.accepted());
          EXPECT_EQ(report.inverted_elements, 0);
          deepest = std::max(deepest, scene->report().deepest);
        }
      };
      lead(0.06, 1);
      EXPECT_LT(deepest, 0.01 * 0.4);
      lead(0, 0.5);
      EXPECT_LT(scene->report().deepest, 1e-5 * 0.4);
      EXPECT_LT(scene->fastest(), 1e-3);
      EXPECT_GT(scene->elastic_energy(), 0);
      const double stored = scene->elastic_energy();
      lead(-0.06, 1.2);
      lead(0, 0.5);
      EXPECT_LT(scene->elastic_energy(), 1e-6 * stored);
    }
}

}  // namespace
}  // namespace corotet::contact_rest_test
