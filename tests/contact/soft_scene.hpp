// Soft bodies that touch each other, for tests.
#pragma once

#include <corotet/contact.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/soft_contact.hpp>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace corotet::contact_scene {

/// Of several bodies, each with an integrator and with contact with obstacles.
template <class ScalarType, class ElementType, template <class, class> class IntegratorOf>
struct SoftScene {
  using Scalar = ScalarType;
  using Element = ElementType;
  using Body = SoftBody<Scalar, Element>;
  using Integrator = IntegratorOf<Body, AutoSolver<Scalar>>;
  using V = Vec3<double>;

  struct Member {
    Body body;
    Integrator integrator;
    Contacts<Scalar> contacts;
    StepReport report;
  };

  explicit SoftScene(const ContactOptions& options = {.friction = 0.5}) : soft(options) {}

  Obstacles obstacles;
  SoftContacts<Scalar> soft;
  std::vector<std::unique_ptr<Member>> members;
  bool touches = true;  // each other
  BodyOptions body;
  double tolerance = 1e-3;  // of the linear solver

  /// `warp` moves the corners of the block, of which there are `cells` along its edges.
  Member& add(BlockOptions block, const Material& material, const std::function<V(const V&)>& warp = {}) {
    auto data = *make_block(block);
    if (warp)
      for (V& x : data.positions) x = warp(x);
    if (Element::nodes == 10) data = raise_order(data);
    auto created = *Body::create(*TetMesh<Scalar, Element>::create(data), material, body);
    auto surface = *ContactSurface::boundary(created.mesh());
    Contacts<Scalar> contacts(surface.points(), obstacles, soft.options());
    soft.add(std::move(surface));
    Integrator integrator(created, SolverOptions{.tolerance = tolerance});
    members.push_back(
        std::make_unique<Member>(Member{std::move(created), std::move(integrator), std::move(contacts), {}}));
    return *members.back();
  }

  void set_gravity(double down) {
    for (auto& member : members) member->body.set_gravity({0, 0, static_cast<Scalar>(-down)});
    obstacles.gravity = {0, 0, -down};
  }

  void step(double h = 1.0 / 60, ExecutorRef executor = {}) {
    const auto one = [&](Index i, StepTerm<Scalar>& term) {
      Member& m = *members[static_cast<std::size_t>(i)];
      const std::array<StepTerm<Scalar>*, 2> terms{&m.contacts, &term};
      StepContext<Scalar> context;
      context.executor = executor;
      context.terms = Terms<Scalar>(std::span<StepTerm<Scalar>* const>(terms).first(touches ? 2 : 1));
      m.report = m.integrator.step(m.body, static_cast<Scalar>(h), context);
    };
    if (touches)
      soft.step(one);
    else
      for (Index i = 0; i < soft.size(); ++i) one_alone(one, i);
    obstacles.advance(h);
    for (const auto& m : members) ASSERT_TRUE(m->report.accepted()) << m->report.advice();
  }
  void run(double seconds, double h = 1.0 / 60) {
    const int steps = static_cast<int>(seconds / h + 0.5);
    for (int i = 0; i < steps && !::testing::Test::HasFatalFailure(); ++i) step(h);
  }

  [[nodiscard]] static V place(const Member& m, Index v) {
    return (m.body.mesh().position(v) + m.body.displacements()[static_cast<std::size_t>(v)]).template cast<double>() +
           m.body.origin();
  }
  [[nodiscard]] static V velocity(const Member& m, Index v) {
    return m.body.velocities()[static_cast<std::size_t>(v)].template cast<double>();
  }
  [[nodiscard]] static double mass(const Member& m, Index v) { return static_cast<double>(m.body.mass().row_sum(v)); }

  template <class F>
  [[nodiscard]] V sum(const F& f) const {
    V all = V::Zero();
    for (const auto& m : members)
      for (Index v = 0; v < m->body.vertex_count(); ++v) all += f(*m, v);
    return all;
  }
  [[nodiscard]] V momentum() const {
    return sum([](const Member& m, Index v) -> V { return mass(m, v) * velocity(m, v); });
  }
  [[nodiscard]] V angular_momentum() const {
    return sum([](const Member& m, Index v) -> V { return mass(m, v) * place(m, v).cross(velocity(m, v)); });
  }
  [[nodiscard]] double kinetic_energy() const {
    return sum([](const Member& m, Index v) -> V {
             return V::Constant(0.5 * mass(m, v) * velocity(m, v).squaredNorm());
           })
        .x();
  }
  [[nodiscard]] double energy() const {
    double all = kinetic_energy();
    for (const auto& m : members) all += m->body.law().energy(m->body.displacements());
    return all;
  }
  /// Gives all vertices of a body the velocity map(place).
  static void throw_with(Member& m, const std::function<V(const V&)>& map) {
    Field<Scalar> v(static_cast<std::size_t>(m.body.vertex_count()));
    for (Index i = 0; i < m.body.vertex_count(); ++i)
      v[static_cast<std::size_t>(i)] = map(place(m, i)).template cast<Scalar>();
    ASSERT_TRUE(m.body.set_velocities(v).ok());
  }
  [[nodiscard]] double fastest() const {
    double most = 0;
    for (const auto& m : members)
      for (Index v = 0; v < m->body.vertex_count(); ++v) most = std::max(most, velocity(*m, v).norm());
    return most;
  }

 private:
  template <class One>
  void one_alone(const One& one, Index i) {
    struct Nothing final : StepTerm<Scalar> {
      void add_force(const TermState<Scalar>&, TermForces<Scalar>&) override {}
    } nothing;
    one(i, nothing);
  }
};

}  // namespace corotet::contact_scene
