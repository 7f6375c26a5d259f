// Bodies that sleep: when they fall asleep, that nothing moves then, what wakes them, and that they go on as if they
// had never slept.
#include <corotet/attachment.hpp>
#include <corotet/contact.hpp>
#include <corotet/integrators.hpp>
#include <corotet/points.hpp>
#include <corotet/sleep.hpp>
#include <corotet/snapshot.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact/scene.hpp"
#include "support/bodies.hpp"
#include "support/random.hpp"

namespace corotet::sleep_test {
namespace {

using namespace contact_scene;
using testing::must;

class ContactSleep : public ByMethod {};
INSTANTIATE_TEST_SUITE_P(Methods, ContactSleep, all_methods, by_name);

constexpr double dt = frame_time;

/// Steps until the body sleeps, at most so long.
void run_to_sleep(Scene& scene, double seconds = 8) {
  for (int i = 0; i < seconds / dt && !scene.is_asleep(); ++i) ASSERT_TRUE(scene.step().accepted());
  ASSERT_TRUE(scene.is_asleep());
}

/// A block falls on a floor and comes to rest. Then it sleeps: it stays exactly where it is, without a linear solve,
/// and the floor bears it.
TEST_P(ContactSleep, ABlockAtRestSleepsAndStaysWhereItIs) {
  for (const double young : {5e5, 5e7}) {
    SceneOptions options = cube(method(), 3, young);
    options.body.damping = {.mass = 0.5, .stiffness = 1e-3};  // under BDF2 it rings for long without
    auto scene = on_floor(method(), options);
    scene->let_sleep();
    scene->place(moved_by({0, 0, 0.05}));
    run_to_sleep(*scene);
    EXPECT_LT(scene->fastest(), 0.01);
    ASSERT_TRUE(scene->step().ok());
    EXPECT_EQ(scene->fastest(), 0);
    const std::string bits = scene->bits();
    const double weight = scene->total_mass() * g;
    for (int i = 0; i < 200; ++i) {
      const StepReport report = scene->step_body(dt, {});
      EXPECT_TRUE(report.ok());
      EXPECT_EQ(report.iterations, 0);
      EXPECT_NEAR(scene->obstacles[0].load().impulse.z(), -weight * dt, 0.02 * weight * dt);
      scene->obstacles.advance(dt);
    }
    EXPECT_TRUE(bits == scene->bits());
    EXPECT_TRUE(scene->is_asleep());
  }
}

/// It falls asleep half a second after the last step that was fast, not before, whatever the length of steps.
TEST(Sleep, TakesHalfASecondOfRest) {
  for (const double h : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
    auto scene = on_floor(euler, cube(euler, 2, 5e6));
    scene->let_sleep();
    scene->place(moved_by({0, 0, 0.02}));
    double quiet = 0, least = 1, most = 0;
    for (int i = 0; i < 6 / h && !scene->is_asleep(); ++i) {
      ASSERT_TRUE(scene->step(h).accepted());
      if (scene->fastest() > 0.01) quiet = 0;
      quiet += h;
      least = std::min(least, scene->fastest());
      most = std::max(most, scene->fastest());
    }
    ASSERT_TRUE(scene->is_asleep());
    EXPECT_GT(most, 0.2);
    EXPECT_GE(quiet, 0.5);
    EXPECT_LT(quiet, 1.5);
  }
}

/// One way to disturb a scene.
struct Cause {
  std::string name;
  std::function<void(Scene&)> disturb;
};
std::vector<Cause> causes() {
  return {
      {"call",
       [](Scene& s) {
         if (s.sleep) s.sleep->wake(s.sleeper);
       }},
      {"wall comes",
       [](Scene& s) {
         s.obstacles[1].velocity = {-1, 0, 0};
       }},
      {"wall appears in it",
       [](Scene& s) {
         s.obstacles[1].set_pose({.position = {0.495, 0.2, 0.2}});
       }},
      {"floor tilts",
       [](Scene& s) {
         s.obstacles[0].angular_velocity = {0.5, 0, 0};
       }},
      {"floor is put lower",
       [](Scene& s) {
         s.obstacles[0].set_pose({.position = {0, 0, -0.1}});
       }},
      {"floor is gone", [](Scene& s) { s.obstacles[0].enabled = false; }},
      {"ball falls",
       [](Scene& s) {
         s.obstacles[2].enabled = true;
         s.obstacles[2].set_pose({.position = {0.2, 0.2, 1}});
       }},
      {"gravity",
       [](Scene& s) {
         s.set_gravity({2, 0, -g});
       }},
      {"velocity",
       [](Scene& s) {
         s.throw_with(constant({0, 0, 1}));
       }},
      {"place",
       [](Scene& s) {
         s.place(moved_by({0, 0, 0.1}));
       }},
      {"pin",
       [](Scene& s) {
         s.pin_where([](const V& x) { return x.z() > 0.39; });
         s.set_gravity({5, 0, -g});
       }},
  };
}

/// A body that is woken moves as one that never slept, at once, until it sleeps again.
TEST_P(ContactSleep, WhatWakesItMovesItAsIfItHadNeverSlept) {
  for (const Cause& cause : causes()) {
    SCOPED_TRACE(cause.name);
    const auto scene_of = [&] {
      SceneOptions options = cube(method(), 2, 1e6);
      options.body.damping = {.mass = 0.5, .stiffness = 1e-3};
      auto scene = on_floor(method(), options);
      scene->obstacles.add(OrientedBox{{0.1, 0.5, 0.5}}, {.pose = {.position = {0.9, 0.2, 0.5}}});
      scene->obstacles.add(Sphere{0.1}, {.pose = {.position = {0, 0, 1000}}, .mass = 5});
      scene->obstacles[2].enabled = false;
      return scene;
    };
    auto sleeping = scene_of(), awake = scene_of();
    sleeping->let_sleep();
    run_to_sleep(*sleeping);
    awake->run(8);
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(sleeping->step().accepted());
    for (Scene* scene : {sleeping.get(), awake.get()})
      scene->obstacles[2].velocity = {0, 0, -2};  // it fell all the time
    awake->throw_with(constant(V::Zero()));       // BDF2 begins anew, as after sleep
    double moved = 0;
    const V before = sleeping->centre();
    cause.disturb(*sleeping);
    cause.disturb(*awake);
    int awake_for = 0;
    for (int i = 0; i < 40; ++i) {
      ASSERT_TRUE(sleeping->step().accepted());
      ASSERT_TRUE(awake->step().accepted());
      double apart = 0;
      for (Index v = 0; v < awake->vertex_count(); ++v)
        apart = std::max(apart, (awake->position(v) - sleeping->position(v)).norm());
      ASSERT_LT(apart, method().is_bdf2() ? 2e-3 : 2e-4) << "step " << i;
      moved = std::max(moved, (sleeping->centre() - before).norm());
      awake_for += !sleeping->is_asleep();
    }
    EXPECT_GT(awake_for, 10);
    if (cause.name != "call") {
      EXPECT_GT(moved, 1e-4);
    }
  }
}

/// The same values written again, in each step, wake nothing.
TEST_P(ContactSleep, TheSameValuesAgainWakeNothing) {
  SceneOptions options = cube(method(), 2, 1e6);
  options.body.damping = {.mass = 0.5, .stiffness = 1e-3};
  auto scene = on_floor(method(), options);
  scene->obstacles.add(OrientedBox{{0.1, 0.5, 0.5}}, {.pose = {.position = {2, 0.2, 0.5}}, .velocity = {0, 0, 1}});
  scene->let_sleep();
  for (int i = 0; i < 600; ++i) {
    scene->set_gravity({0, 0, -g});
    scene->obstacles[0].set_pose({});
    scene->obstacles[0].velocity = V::Zero();
    ASSERT_TRUE(scene->step().accepted());
    if (scene->is_asleep() && i > 300) scene->throw_with(constant(V::Zero()));
  }
  EXPECT_TRUE(scene->is_asleep());
}

/// Copies that are put aside and taken up again, awake and asleep, go on to the same bits.
TEST_P(ContactSleep, CopiesGoOnToTheSameBits) {
  SceneOptions options = cube(method(), 2, 1e6);
  options.body.damping = {.mass = 0.5, .stiffness = 1e-3};
  auto scene = on_floor(method(), options);
  scene->obstacles.add(OrientedBox{{0.1, 0.5, 0.5}}, {.pose = {.position = {3, 0.2, 0.5}}, .velocity = {-0.5, 0, 0}});
  scene->let_sleep();
  scene->place(moved_by({0, 0, 0.02}));
  int times = 0;
  for (int i = 0; i < 420; ++i) {
    if (i % 60 == 30) {
      scene->save();
      std::string first, second;
      for (std::string* bits : {&first, &second}) {
        scene->go_back();
        for (int k = 0; k < 45; ++k) {
          ASSERT_TRUE(scene->step().accepted());
          *bits += scene->bits() + (scene->is_asleep() ? "z" : "a");
        }
      }
      EXPECT_TRUE(first == second) << i;
      scene->go_back();
    }
    ASSERT_TRUE(scene->step().accepted());
    times += scene->is_asleep();
  }
  EXPECT_GT(times, 60);              // it slept,
  EXPECT_FALSE(scene->is_asleep());  // until the wall came
}

/// Some blocks among shared obstacles.
struct World {
  using Body = SoftBody<float>;
  struct Item {
    Body body;
    ImplicitEuler<Body> euler;
    Contacts<float> contacts;
    std::vector<StepTerm<float>*> terms;
    Index id;
  };

  Obstacles obstacles;
  Sleep sleep{obstacles};
  std::vector<std::unique_ptr<Item>> items;
  bool may_sleep = true;

  explicit World(bool lets_sleep = true) : may_sleep(lets_sleep) { obstacles.gravity = {0, 0, -g}; }

  Item& add(const V& corner, double young = 1e6, double size = 0.4, double damping = 2) {
    auto body = must(
        Body::create(testing::block<float, Tet4>({.corner = corner, .size = V::Constant(size), .cells = {2, 2, 2}}),
                     Material{.young = young, .poisson = 0.3, .density = 1000}, {.damping = {.mass = damping}}));
    body.set_gravity({0, 0, float(-g)});
    ImplicitEuler<Body> euler(body);
    Contacts<float> contacts(must(ContactPoints::boundary(body.mesh())), obstacles, {.friction = 0.5});
    items.push_back(std::make_unique<Item>(Item{body, euler, contacts, {}, sleep.add()}));
    items.back()->terms.push_back(&items.back()->contacts);
    return *items.back();
  }
  int iterations = 0;  // of the last step
  void step() {
    iterations = 0;
    for (const auto& item : items) {
      StepContext<float> context;
      context.terms = Terms<float>(item->terms);
      const StepReport report = may_sleep ? sleep.step(item->id, item->euler, item->body, float(dt), context)
                                          : item->euler.step(item->body, float(dt), context);
      ASSERT_TRUE(report.accepted());
      iterations += report.iterations;
    }
    obstacles.advance(dt);
  }
  void run(double seconds) {
    for (int i = 0; i < seconds / dt; ++i) step();
  }
  [[nodiscard]] bool all_asleep() const {
    return std::all_of(items.begin(), items.end(), [&](const auto& i) { return sleep.is_asleep(i->id); });
  }
  [[nodiscard]] bool none_asleep() const {
    return std::none_of(items.begin(), items.end(), [&](const auto& i) { return sleep.is_asleep(i->id); });
  }
  [[nodiscard]] static V momentum(const Body& body) {
    V sum = V::Zero();
    for (Index v = 0; v < body.vertex_count(); ++v)
      sum += double(body.mass().row_sum(v)) * body.velocities()[at(v)].cast<double>();
    return sum;
  }
};

/// A crate across two blocks: all three sleep from one step on, and stay where they are. What wakes one wakes all.
TEST(SleepIslands, ACrateAcrossTwoBlocksSleepsWithBoth) {
  World world;
  world.obstacles.add(HalfSpace{});
  world.add({0, 0, 0});
  world.add({0.6, 0, 0}, 4e6);
  world.add({5, 0, 0});  // apart
  const Index crate =
      world.obstacles.add(OrientedBox{{0.45, 0.15, 0.1}}, {.pose = {.position = {0.5, 0.2, 0.52}}, .mass = 40});
  int steps = 0;
  for (; steps < 600 && !world.all_asleep(); ++steps) {
    world.step();
    EXPECT_EQ(world.sleep.is_asleep(0), world.sleep.is_asleep(1)) << "step " << steps;
    EXPECT_EQ(world.sleep.is_asleep(0), world.obstacles[crate].is_asleep());
  }
  ASSERT_TRUE(world.all_asleep());
  const V place = world.obstacles[crate].pose().position;
  for (int i = 0; i < 100; ++i) {
    for (const auto& item : world.items) {
      StepContext<float> context;
      context.terms = Terms<float>(item->terms);
      world.sleep.step(item->id, item->euler, item->body, float(dt), context);
    }
    EXPECT_NEAR(world.obstacles[crate].load().impulse.z(), 40 * g * dt, 0.02 * 40 * g * dt);
    EXPECT_NEAR(world.obstacles[0].load().impulse.z(), -(40 + 3 * 64) * g * dt, 0.02 * 232 * g * dt);
    world.obstacles.advance(dt);
  }
  EXPECT_EQ(world.obstacles[crate].pose().position, place);

  const std::array<std::function<void()>, 5> wakers = {[&] { world.sleep.wake(0); }, [&] { world.sleep.wake(1); },
                                                       [&] {
                                                         world.items[1]->body.set_gravity({0.1f, 0, float(-g)});
                                                       },
                                                       [&] {
                                                         world.obstacles[crate].velocity = {0, 0, -0.02};
                                                       },
                                                       [&] {
                                                         world.obstacles[crate].force = {0, 0, 1};
                                                       }};
  for (std::size_t k = 0; k < wakers.size(); ++k) {
    SCOPED_TRACE(k);
    const double before = world.obstacles[crate].pose().position.z();
    wakers[k]();
    for (int i = 0; i < 20; ++i) {
      world.step();
      // Nobody is let fall while they wake one after the other.
      EXPECT_NEAR(world.obstacles[crate].pose().position.z(), before, k == 3 ? 2e-3 : 1e-4) << i;
      if (i < 2) continue;
      EXPECT_FALSE(world.sleep.is_asleep(0) || world.sleep.is_asleep(1) || world.obstacles[crate].is_asleep());
      EXPECT_TRUE(world.sleep.is_asleep(2));
    }
    world.run(5);
    ASSERT_TRUE(world.all_asleep());
    EXPECT_TRUE(world.obstacles[crate].is_asleep());
  }
}

/// Blocks in pairs under crates, disturbed now and then: who sleeps does not move, crates sleep with all that carry
/// them or not at all, and none ever falls.
TEST(SleepIslands, SleepersNeverMoveAndCratesNeverFall) {
  World world;
  world.obstacles.add(HalfSpace{});
  std::vector<Index> crates;
  for (int i = 0; i < 6; ++i) {
    world.add({0.6 * i, 0, 0}, i % 3 == 0 ? 5e5 : 4e6);
    if (i % 2 == 1)
      crates.push_back(world.obstacles.add(OrientedBox{{0.45, 0.15, 0.1}},
                                           {.pose = {.position = {0.6 * i - 0.1, 0.2, 0.52}}, .mass = 10}));
  }
  testing::Random random(1);
  const auto some = [&](std::size_t count) { return static_cast<std::size_t>(random.uniform(0, double(count))); };
  int asleep_steps = 0, causes = 0;
  std::vector<bool> slept(world.items.size(), false), crate_slept(crates.size(), false);
  for (int step = 0; step < 1500; ++step) {
    if (random.uniform() < 0.02) {
      ++causes;
      World::Item& item = *world.items[some(6)];
      const double which = random.uniform();
      if (which < 0.3) world.sleep.wake(item.id);
      if (which > 0.3 && which < 0.6)
        item.body.external_forces()[some(27)] = Vec3<float>(0, 0, float(random.uniform(-20, 20)));
      if (which > 0.6) world.obstacles[crates[some(3)]].velocity = V(0, 0, random.uniform(-0.1, 0.1));
    }
    std::vector<Field<float>> before;
    for (const auto& item : world.items) before.push_back(item->body.displacements());
    world.step();
    for (std::size_t i = 0; i < world.items.size(); ++i) {
      const bool sleeps = world.sleep.is_asleep(world.items[i]->id);
      if (sleeps && slept[i]) {
        EXPECT_EQ(world.items[i]->body.displacements(), before[i]) << step;
      }
      slept[i] = sleeps;
      asleep_steps += sleeps;
    }
    for (std::size_t c = 0; c < crates.size(); ++c) {
      const Obstacle& crate = world.obstacles[crates[c]];
      EXPECT_GT(crate.pose().position.z(), 0.44) << step;
      // One that is woken within a step is let go before the next.
      if (crate.is_asleep() && crate_slept[c]) {
        EXPECT_EQ(slept[2 * c], slept[2 * c + 1]) << step;
        EXPECT_EQ(crate.velocity, V(V::Zero())) << step;
      }
      if (slept[2 * c] && slept[2 * c + 1]) {
        EXPECT_TRUE(crate.is_asleep()) << step;
      }
      crate_slept[c] = crate.is_asleep();
    }
  }
  EXPECT_GT(causes, 15);
  EXPECT_GT(asleep_steps, 1500);
  EXPECT_LT(asleep_steps, 6 * 1400);
}

/// A crate that still moves keeps awake what it moves on.
TEST(SleepIslands, AMovingCrateKeepsItsBodyAwake) {
  World world;
  world.add({0, 0, 0}, 1e8).body.pin_where([](const Vec3<float>& x) { return x.z() < 1e-6f; });
  const Index crate =
      world.obstacles.add(OrientedBox{{0.3, 0.3, 0.05}},
                          {.pose = {.position = {0.2, 0.2, 0.45}}, .velocity = {0.05, 0, 0}, .friction = 0, .mass = 1});
  for (int i = 0; i < 120; ++i) {
    world.step();
    EXPECT_TRUE(world.none_asleep());
    if (i > 20) {
      EXPECT_GT(world.obstacles[crate].velocity.x(), 0.02);
    }
  }
}

/// Bodies that the caller ties sleep and wake together.
TEST(SleepIslands, TiedBodiesSleepTogether) {
  World world;
  world.obstacles.add(HalfSpace{});
  world.add({0, 0, 0});
  world.add({1, 0, 0.5});  // comes to rest later
  world.sleep.tie(0, 1);
  int both = 0;
  for (int i = 0; i < 600; ++i) {
    world.step();
    EXPECT_EQ(world.sleep.is_asleep(0), world.sleep.is_asleep(1)) << i;
    both += world.all_asleep();
  }
  EXPECT_GT(both, 60);
  world.sleep.wake(1);
  EXPECT_TRUE(world.none_asleep());
}

/// A ball at any speed meets a body that sleeps as one that is awake; momentum is kept.
TEST(SleepIslands, AnImpactWakesBeforeItStrikes) {
  for (const double speed : {0.5, 5.0, 50.0}) {
    SCOPED_TRACE(speed);
    World sleeping(true), awake(false);
    for (World* world : {&sleeping, &awake}) {
      world->obstacles.gravity = V::Zero();
      world->add({0, 0, 0}, 1e6, 0.4, 0).body.set_gravity({0, 0, 0});
      world->obstacles.add(Sphere{0.1},
                           {.pose = {.position = {0.6 + 3 * speed, 0.2, 0.2}}, .velocity = {-speed, 0, 0}, .mass = 10});
      world->run(2);
    }
    EXPECT_TRUE(sleeping.all_asleep());
    const V momentum = V(-10 * speed, 0, 0);
    for (int i = 0; i < 110; ++i) {
      sleeping.step();
      awake.step();
      const V p = World::momentum(sleeping.items[0]->body) + 10 * sleeping.obstacles[0].velocity;
      EXPECT_LT((p - momentum).norm(), 1e-5 * momentum.norm()) << i;
      EXPECT_LT((sleeping.obstacles[0].pose().position - awake.obstacles[0].pose().position).norm(), 5e-5 * speed) << i;
    }
    EXPECT_TRUE(sleeping.none_asleep());
    EXPECT_LT(World::momentum(sleeping.items[0]->body).x(), -speed);
  }
}

/// A body thrown at a crate that sleeps pushes it: it does not bounce as from a wall.
TEST(SleepIslands, ABodyWakesTheCrateThatItStrikes) {
  World world;
  world.obstacles.add(HalfSpace{});
  World::Item& base = world.add({0, 0, 0});
  const Index crate = world.obstacles.add(OrientedBox{{0.1, 0.1, 0.1}},
                                          {.pose = {.position = {0.2, 0.2, 0.51}}, .friction = 0, .mass = 5});
  world.run(4);
  ASSERT_TRUE(world.all_asleep());
  ASSERT_TRUE(world.obstacles[crate].is_asleep());
  World::Item& thrown = world.add({1.5, 0.1, 0.45}, 1e6, 0.2);
  Field<float> v(at(thrown.body.vertex_count()), Vec3<float>(-6, 0, 1));
  must(thrown.body.set_velocities(v));
  double before = World::momentum(thrown.body).x(), fastest = 0;
  for (int i = 0; i < 30; ++i) {
    world.step();
    fastest = std::max(fastest, -world.obstacles[crate].velocity.x());
  }
  EXPECT_FALSE(world.sleep.is_asleep(base.id));
  EXPECT_GT(fastest, 0.5 * -before / (8 + 5));
}

/// A pendulum stands still for a moment at each turn, and swings on.
TEST(Sleep, APendulumDoesNotSleepAtItsTurningPoint) {
  for (const double amplitude : {0.3, 0.03, 0.01}) {  // rad; of 0.4 m: 0.02 m/s in its middle at last
    SceneOptions options = cube(bdf2, 2, 1e7);
    auto scene = make_scene(bdf2, options);
    scene->has_contacts = false;
    scene->let_sleep();
    const double a = std::sin(amplitude);
    scene->set_gravity({a * g, 0, -std::cos(amplitude) * g});
    scene->pin_where([](const V& x) { return x.z() > 0.39 && x.x() < 0.01; });  // an edge: it swings about that
    bool slept = false;
    double fastest = 0, slowest = 1;
    for (int i = 0; i < 240; ++i) {
      ASSERT_TRUE(scene->step().accepted());
      slept = slept || scene->is_asleep();
      fastest = std::max(fastest, scene->fastest());
      if (i > 20) slowest = std::min(slowest, scene->fastest());
    }
    EXPECT_FALSE(slept) << amplitude;
    EXPECT_GT(fastest, 0.01) << amplitude;
    EXPECT_LT(slowest, 0.3 * fastest) << amplitude;
  }
}

/// A lift that is slower than the bound of speed carries its load all the way.
TEST(Sleep, ABodyOnASlowLiftStaysAwake) {
  auto scene = on_floor(euler, cube(euler, 2, 1e6));
  scene->let_sleep();
  scene->run(2);
  ASSERT_TRUE(scene->is_asleep());
  const double before = scene->centre().z();
  scene->obstacles[0].velocity = {0, 0, 0.004};
  for (int i = 0; i < 240; ++i) {
    ASSERT_TRUE(scene->step().accepted());
    EXPECT_FALSE(scene->is_asleep());
  }
  EXPECT_NEAR(scene->centre().z(), before + 240 * dt * 0.004, 1e-4);
}

/// Attachments that are enabled, moved or changed wake; those that hold still let sleep.
TEST(Sleep, AttachmentsWake) {
  World world;
  World::Item& item = world.add({0, 0, 0});
  const PointLocator locator(item.body.mesh());
  Attachment<float> hook(locator.locate(V(0.2, 0.2, 0.4)), {.stiffness = 1e5, .damping = 1e3});
  Attachment<float> grab(locator.locate(V(0.2, 0.2, 0)), {.stiffness = 1e4, .damping = 100});
  const Index post = world.obstacles.add(Sphere{0.01}, {.pose = {.position = {0.2, 0.2, 1}}});
  hook.set_target(world.obstacles, post, V(0, 0, -0.6));
  grab.enabled = false;
  item.terms = {&item.contacts, &hook, &grab};
  const auto rests = [&] {
    world.run(6);
    return world.all_asleep();
  };
  ASSERT_TRUE(rests());
  const double weight = item.body.mass().total() * g;
  {  // the post bears it
    StepContext<float> context;
    context.terms = Terms<float>(item.terms);
    world.sleep.step(item.id, item.euler, item.body, float(dt), context);
    EXPECT_NEAR(world.obstacles[post].load().impulse.z(), -weight * dt, 1e-2 * weight * dt);
    world.obstacles.advance(dt);
  }
  const std::array<std::function<void()>, 6> wakers = {[&] {
                                                         grab.enabled = true;
                                                         grab.set_target(V(0.3, 0.2, -0.1));
                                                       },
                                                       [&] { grab.set_target(V(0.1, 0.2, -0.1)); },
                                                       [&] { grab.set_options({.stiffness = 2e4, .damping = 100}); },
                                                       [&] { grab.enabled = false; },
                                                       [&] {
                                                         world.obstacles[post].set_pose({.position = {0.2, 0.3, 1}});
                                                       },
                                                       [&] { item.terms.pop_back(); }};
  for (std::size_t k = 0; k < wakers.size(); ++k) {
    SCOPED_TRACE(k);
    const Field<float> before = item.body.displacements();
    wakers[k]();
    world.step();
    EXPECT_TRUE(world.none_asleep());
    for (int i = 0; i < 10; ++i) world.step();
    if (k < 5) {
      EXPECT_NE(item.body.displacements(), before);
    }
    ASSERT_TRUE(rests());
    if (k < 3) grab.set_target(grab.target());  // the same again
    world.step();
    EXPECT_TRUE(world.all_asleep());
  }
}

/// Forces, pins and materials wake a body; the same ones again do not.
TEST(Sleep, ForcesPinsAndMaterialsWake) {
  World world;
  world.obstacles.add(HalfSpace{});
  World::Item& item = world.add({0, 0, 0});
  SoftBody<float>& body = item.body;
  const auto rests = [&] {
    world.run(6);
    return world.all_asleep();
  };
  body.pins().pin(0, body.displacements()[0]);
  ASSERT_TRUE(rests());
  const std::array<std::function<void()>, 5> wakers = {
      [&] {
        body.external_forces()[5] = {0, 0, 100};
      },
      [&] { body.move_pin(0, body.position(0) + Vec3<float>(0.01f, 0, 0)); },
      [&] { must(body.set_materials(Material{.young = 5e5, .poisson = 0.3, .density = 1000})); },
      [&] { body.pins().release(0); }, [&] { body.reset(); }};
  const std::array<std::function<void()>, 5> same = {
      [&] {
        body.external_forces()[5] = {0, 0, 100};
      },
      [&] { body.pins().move(0, body.pins().targets()[0]); }, [&] { body.set_gravity(body.gravity()); },
      [&] { body.pins().release(0); }, [&] { must(body.set_velocities(Field<float>(body.velocities()))); }};
  for (std::size_t k = 0; k < wakers.size(); ++k) {
    SCOPED_TRACE(k);
    wakers[k]();
    world.step();
    EXPECT_TRUE(world.none_asleep());
    EXPECT_GT(world.iterations, 0);
    ASSERT_TRUE(rests());
    same[k]();
    world.step();
    EXPECT_TRUE(world.all_asleep());
    EXPECT_EQ(world.iterations, 0);
  }
}

/// A snapshot of a body that sleeps, restored: it sleeps on; of one that was awake: it wakes.
TEST(Sleep, SnapshotsAreStates) {
  World world;
  world.obstacles.add(HalfSpace{});
  World::Item& item = world.add({0, 0, 0.1});
  const auto save = [&] {
    std::vector<std::byte> bytes(snapshot_size(item.body, item.euler));
    must(save_snapshot(item.body, item.euler, bytes));
    return bytes;
  };
  world.step();
  const std::vector<std::byte> falling = save();
  world.run(6);
  ASSERT_TRUE(world.all_asleep());
  must(restore_snapshot(save(), item.body, item.euler));
  world.step();
  EXPECT_TRUE(world.all_asleep());
  must(restore_snapshot(falling, item.body, item.euler));
  world.step();
  EXPECT_TRUE(world.none_asleep());
}

/// A term that says nothing of itself keeps its body awake.
TEST(Sleep, AnUnknownTermKeepsAwake) {
  struct Breath final : StepTerm<float> {
    void add_force(const TermState<float>& /*state*/, TermForces<float>& /*out*/) override {}
  } breath;
  World world;
  world.obstacles.add(HalfSpace{});
  World::Item& item = world.add({0, 0, 0});
  item.terms.push_back(&breath);
  world.run(3);
  EXPECT_TRUE(world.none_asleep());
  item.terms.pop_back();
  world.run(3);
  EXPECT_TRUE(world.all_asleep());
}

/// A shape that counts how often it is asked.
struct Counting {
  HalfSpace shape;
  std::shared_ptr<long> count;

  SurfaceDistance operator()(const V& p) const {
    ++*count;
    return shape(p);
  }
};

/// A step of a body that sleeps asks no obstacle for its distance.
TEST(Sleep, AStepAsleepLooksAtNoShape) {
  auto scene = make_scene(euler, cube(euler, 2, 1e6));
  scene->set_gravity({0, 0, -g});
  const auto count = std::make_shared<long>(0);
  scene->obstacles.add(Counting{HalfSpace{}, count});
  scene->obstacles.add(Counting{HalfSpace{{1, 0, 0}, -1}, count});
  scene->let_sleep();
  run_to_sleep(*scene);
  scene->step();
  *count = 0;
  scene->run(1);
  EXPECT_EQ(*count, 0);
  scene->obstacles[1].velocity = {0.5, 0, 0};  // it comes nearer, and is asked once a step
  scene->step();
  EXPECT_EQ(*count, 1);
}

}  // namespace
}  // namespace corotet::sleep_test
