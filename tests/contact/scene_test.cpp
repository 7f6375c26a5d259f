// The scene that tests of contact step; and what must leave no trace in its bits: obstacles out of reach, threads,
// copies, memory.
#include "contact/scene.hpp"

#include <corotet/detail/core/thread_pool.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "support/bodies.hpp"
#include "support/count_allocations.hpp"

namespace corotet::contact_scene {
namespace {

using testing::must;

template <class S, class E, class Integrator>
class SceneOf final : public Scene {
 public:
  using Body = SoftBody<S, E>;

  SceneOf(const Method& method, const SceneOptions& options)
      : body_(must(Body::create(mesh_of(options), options.material, options.body))),
        integrator_(body_, SolverOptions{.tolerance = options.tolerance}, step_options(method, options)),
        contacts_(points_of(options, body_.mesh()), obstacles, options.contact) {
    friction = options.contact.friction;
  }

  StepReport step_body(double h, ExecutorRef executor) override {
    StepContext<S> context;
    context.executor = executor;
    if (has_contacts) context.terms = contacts_;
    if (sleep) return sleep->step(sleeper, integrator_, body_, static_cast<S>(h), context);
    return integrator_.step(body_, static_cast<S>(h), context);
  }

  [[nodiscard]] const ContactReport& report() const override { return contacts_.report(); }
  [[nodiscard]] std::span<const Touch> touches() const override { return contacts_.touches(); }
  [[nodiscard]] const ContactPoints& points() const override { return contacts_.points(); }
  void reset_contacts() override { contacts_.reset(); }

  void save() override {
    saved_.emplace(Saved{body_, integrator_, contacts_, obstacles, sleep});
    go_back();
  }
  void go_back() override {
    body_ = saved_->body;
    integrator_ = saved_->integrator;
    contacts_ = saved_->contacts;
    obstacles = saved_->obstacles;
    sleep = saved_->sleep;
  }
  [[nodiscard]] std::string bits() const override {
    std::string all;
    for (const Field<S>* field : {&body_.displacements(), &body_.velocities()})
      for (const Vec3<S>& x : *field) all.append(reinterpret_cast<const char*>(x.data()), 3 * sizeof(S));
    return all;
  }

  [[nodiscard]] Index vertex_count() const override { return body_.vertex_count(); }
  [[nodiscard]] V rest(Index v) const override {
    return body_.mesh().position(v).template cast<double>() + body_.mesh().origin();
  }
  [[nodiscard]] V position(Index v) const override {
    return body_.mesh().position(v).template cast<double>() + body_.displacements()[at(v)].template cast<double>() +
           body_.origin();
  }
  [[nodiscard]] V velocity(Index v) const override { return body_.velocities()[at(v)].template cast<double>(); }
  [[nodiscard]] double mass(Index v) const override { return double(body_.mass().row_sum(v)); }
  [[nodiscard]] double elastic_energy() const override { return body_.law().energy(body_.displacements()); }

  void place(const Map& map) override {
    Field<S> u;
    for (Index v = 0; v < vertex_count(); ++v) u.push_back((map(rest(v)) - rest(v)).template cast<S>());
    must(body_.set_displacements(u));
  }
  void throw_with(const Map& map) override {
    Field<S> w;
    for (Index v = 0; v < vertex_count(); ++v) w.push_back(map(position(v)).template cast<S>());
    must(body_.set_velocities(w));
  }
  void set_gravity(const V& gravity) override { body_.set_gravity(gravity.template cast<S>()); }
  Index pin_where(const std::function<bool(const V&)>& is_pinned) override {
    return body_.pin_where(
        [&](const Vec3<S>& x) { return is_pinned(x.template cast<double>() + body_.mesh().origin()); });
  }

 private:
  struct Saved {
    Body body;
    Integrator integrator;
    Contacts<S> contacts;
    Obstacles obstacles;
    std::optional<Sleep> sleep;
  };

  static StepOptions step_options(const Method& method, const SceneOptions& scene) {
    StepOptions options;
    options.keeps_angular_momentum = scene.keeps_angular_momentum;
    if (method.newton) {
      options.iterations = 10;
      options.tangent = Tangent::consistent;
    }
    return options;
  }
  static MeshData data_of(const SceneOptions& options) {
    MeshData all;
    std::vector<BlockOptions> blocks = options.pieces;
    blocks.insert(blocks.begin(), options.block);
    for (BlockOptions& block : blocks) {
      block.order = 1;
      const MeshData data = must(make_block(block));
      const Index first = size_of(all.positions);
      all.nodes_per_element = data.nodes_per_element;
      for (const V& x : data.positions) all.positions.push_back(options.warp ? options.warp(x) : x);
      for (const Index v : data.connectivity) all.connectivity.push_back(first + v);
    }
    return all;
  }
  static TetMesh<S, E> mesh_of(const SceneOptions& options) {
    MeshData data = data_of(options);
    if (E::order == 2) data = raise_order(std::move(data));
    return must(TetMesh<S, E>::create(std::move(data), options.origin));
  }
  static ContactPoints points_of(const SceneOptions& options, const TetMesh<S, E>& mesh) {
    if (options.skin == 0) return must(ContactPoints::boundary(mesh));
    SceneOptions fine = options;
    fine.block.cells = {options.skin, options.skin, options.skin};
    const auto fine_mesh = must(TetMesh<double, Tet4>::create(data_of(fine)));
    const auto boundary = must(extract_boundary(fine_mesh));
    std::vector<Index> outside;
    for (const auto& triangle : boundary.triangles) outside.insert(outside.end(), triangle.begin(), triangle.end());
    std::sort(outside.begin(), outside.end());
    outside.erase(std::unique(outside.begin(), outside.end()), outside.end());
    std::vector<V> skin;
    for (const Index v : outside) skin.push_back(fine_mesh.position(v));
    return ContactPoints(must(EmbeddedSurface<S, E>::bind(mesh, std::span<const V>(skin))), mesh);
  }

  Body body_;
  Integrator integrator_;
  Contacts<S> contacts_;
  std::optional<Saved> saved_;
};

template <class S, class E>
using EulerScene = SceneOf<S, E, ImplicitEuler<SoftBody<S, E>>>;
template <class S, class E>
using Bdf2Scene = SceneOf<S, E, Bdf2<SoftBody<S, E>>>;

}  // namespace

std::unique_ptr<Scene> make_scene(const Method& method, const SceneOptions& options) {
  switch (method.kind) {
    case Kind::float_tet4_euler:
      return std::make_unique<EulerScene<float, Tet4>>(method, options);
    case Kind::float_tet10_bdf2:
      return std::make_unique<Bdf2Scene<float, Tet10>>(method, options);
    case Kind::double_tet4_bdf2:
      return std::make_unique<Bdf2Scene<double, Tet4>>(method, options);
    case Kind::double_tet10_euler:
      break;
  }
  return std::make_unique<EulerScene<double, Tet10>>(method, options);
}

namespace {

class ContactBits : public ByMethod {};
INSTANTIATE_TEST_SUITE_P(Methods, ContactBits, all_methods, by_name);

/// A cube that falls on a tilted box and rubs along it, to a floor.
std::unique_ptr<Scene> tumbling(const Method& method, Index cells = 3) {
  auto scene = on_floor(method, cube(method, cells, 2e5));
  scene->obstacles.add(
      OrientedBox{{0.2, 0.3, 0.1}},
      {.pose = {.position = {0.1, 0.2, 0.3}, .rotation = {0.9, 0.2, 0.3, 0.0}}, .angular_velocity = {0, 1, 0}});
  scene->obstacles.add(Sphere{0.1}, {.pose = {.position = {0.5, 0.2, 0.2}}, .velocity = {-0.5, 0, 0}, .mass = 5});
  scene->place(moved_by({0, 0, 0.5}));
  return scene;
}

/// Steps of a scene, and the bits of each.
std::string run_bits(Scene& scene, int steps, ExecutorRef executor = {}) {
  std::string all;
  for (int i = 0; i < steps; ++i) {
    EXPECT_TRUE(scene.step(frame_time, executor).accepted());
    all += scene.bits();
  }
  return all;
}

TEST_P(ContactBits, ObstaclesOutOfReachLeaveNoTrace) {
  const auto falling = [&](const std::function<void(Scene&)>& change) {
    auto scene = make_scene(method(), cube(method(), 3, 1e5));
    scene->set_gravity({0, 0, -g});
    scene->place([](const V& x) -> V { return rotation_by({0.1, 0.4, 0.2}) * x + V(0, 0.05 * x.x(), 50); });
    scene->throw_with([](const V& x) -> V { return V(1, 2, 0).cross(x - V(0, 0, 50)); });
    change(*scene);
    return run_bits(*scene, 20);
  };
  const std::string alone = falling([](Scene& s) { s.has_contacts = false; });
  EXPECT_TRUE(alone == falling([](Scene&) {})) << "no obstacle";
  EXPECT_TRUE(alone == falling([](Scene& s) {
                s.obstacles.add(HalfSpace{});
                s.obstacles.add(Sphere{1}, {.pose = {.position = {0, 0, 80}}});
              }))
      << "obstacles far away";
  EXPECT_TRUE(alone == falling([](Scene& s) {
                s.obstacles.add(HalfSpace{.offset = 100});
                s.obstacles[0].enabled = false;
              }))
      << "a disabled obstacle around it";
}

TEST_P(ContactBits, AreTheSameInEachRun) {
  const std::string reference = run_bits(*tumbling(method()), 40);
  EXPECT_TRUE(reference == run_bits(*tumbling(method()), 40)) << "a second run";
}

/// A copy of the body, the integrator and the contacts goes on as they do.
TEST_P(ContactBits, OfACopyGoOnAsThoseOfItsOriginal) {
  auto scene = tumbling(method());
  run_bits(*scene, 30);
  scene->save();
  const std::string copy = run_bits(*scene, 20);
  scene->go_back();
  EXPECT_TRUE(copy == run_bits(*scene, 20));
  auto whole = tumbling(method());
  run_bits(*whole, 30);
  EXPECT_TRUE(copy == run_bits(*whole, 20));
}

TEST(ContactThreads, DoNotChangeABit) {
  for (const Method& method : {euler, Method{Kind::float_tet10_bdf2, true}}) {
    const auto start = [&] {  // it lands in the first steps, and has several ranges of each loop
      auto scene = tumbling(method, method.is_tet4() ? 9 : 7);
      scene->throw_with(constant({0, 0, -10}));
      return scene;
    };
    const std::string serial = run_bits(*start(), 8);
    for (const int threads : {2, 4}) {
      ThreadPool pool(threads);
      EXPECT_TRUE(serial == run_bits(*start(), 8, pool)) << threads << " threads, " << name_of(method);
    }
  }
}

TEST_P(ContactBits, AStepAllocatesNothing) {
  auto scene = tumbling(method());
  scene->step();
  const long before = testing::allocation_count;
  int touching = 0, passes = 0;
  for (int i = 0; i < 60; ++i) {
    scene->step();
    touching = std::max(touching, int(scene->report().touching));
    passes = std::max(passes, scene->report().passes);
  }
  EXPECT_EQ(testing::allocation_count - before, 0);
  EXPECT_GT(touching, 4);
  EXPECT_GT(passes, 1);
  EXPECT_EQ(scene->report().dropped, 0);
}

TEST(ContactAllocations, ABodyFallsAsleepAndWakesWithoutAllocating) {
  auto scene = on_floor(euler, cube(euler, 2, 1e6));
  scene->let_sleep();
  scene->run(0.1);
  const long before = testing::allocation_count;
  int asleep = 0;
  for (int i = 0; i < 180; ++i) {
    scene->step();
    asleep += scene->is_asleep();
    if (i == 120) scene->sleep->wake(scene->sleeper);
  }
  EXPECT_EQ(testing::allocation_count - before, 0);
  EXPECT_GT(asleep, 60);
  EXPECT_LT(asleep, 150);
}

}  // namespace
}  // namespace corotet::contact_scene
