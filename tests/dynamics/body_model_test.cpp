// What copies of a body share, and bodies that travel far.
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "support/bodies.hpp"
#include "support/count_allocations.hpp"
#include "support/solver_choice.hpp"

namespace corotet::body_model_test {
namespace {

using testing::must;

template <class K>
class ModelledBody : public ::testing::Test {
 public:
  using Real = typename K::Scalar;
  using Body = SoftBody<Real, typename K::Element>;
  static constexpr Real h = Real(1) / 60;

  static Body bar(const BodyOptions& options = {}) {
    return must(Body::create(testing::block<Real, typename K::Element>({.size = {1, 0.2, 0.2}, .cells = {5, 1, 1}}),
                             Material{.young = 2e5, .poisson = 0.3, .density = 1000}, options));
  }
};
TYPED_TEST_SUITE(ModelledBody, testing::AllCases);

/// Copies share the model and nothing else; new materials are one body's alone.
TYPED_TEST(ModelledBody, IsSharedByCopies) {
  const auto body = this->bar();
  std::vector<typename TestFixture::Body> copies(1000, body);
  for (const auto& copy : copies) ASSERT_EQ(copy.model(), body.model());
  must(copies[7].set_materials(Material{.young = 1e6, .poisson = 0.2, .density = 500}));
  EXPECT_NE(copies[7].model(), body.model());
  EXPECT_EQ(copies[8].model(), body.model());
  EXPECT_EQ(copies[7].pattern(), body.pattern()) << "the same mesh: integrators of the others serve";
  EXPECT_NEAR(copies[7].mass().total(), body.mass().total() / 2, 1e-6 * body.mass().total());
  EXPECT_NE(copies[7].model()->fingerprint(), body.model()->fingerprint());
  EXPECT_EQ(this->bar().model()->fingerprint(), body.model()->fingerprint()) << "of the same in another program, too";
}

/// What is told of memory is what is asked for: of a copy, what it owns.
TYPED_TEST(ModelledBody, TellsItsMemory) {
  using Scalar = typename TypeParam::Scalar;
  const auto body = this->bar();
  const Bdf2 integrator(body, testing::solver());
  const auto near_to = [](std::size_t told, std::size_t asked) {
    return double(told) > 0.95 * double(asked) - 1000 && double(told) < 1.05 * double(asked) + 1000;
  };
  const long before = testing::allocated_bytes;
  const auto copy = std::make_unique<typename TestFixture::Body>(body);
  const std::size_t body_bytes = std::size_t(testing::allocated_bytes - before);
  EXPECT_TRUE(near_to(body.memory().owned, body_bytes)) << body.memory().owned << " of " << body_bytes;
  const long middle = testing::allocated_bytes;
  const auto second = std::make_unique<Bdf2<typename TestFixture::Body>>(integrator);
  const std::size_t bytes = std::size_t(testing::allocated_bytes - middle);
  EXPECT_TRUE(near_to(integrator.memory().owned, bytes)) << integrator.memory().owned << " of " << bytes;
  EXPECT_LT(body.memory().owned, std::size_t(60 + 4 * 3 * sizeof(Scalar)) * std::size_t(body.vertex_count()));
  EXPECT_GT(body.memory().shared, body.memory().owned);
}

/// What each step computes anew is not copied, and not missed: a copy goes on bit for bit, and allocates nothing.
TYPED_TEST(ModelledBody, CopiesGoOnBitForBit) {
  auto first = this->bar({.damping = {.mass = 0.5, .stiffness = 1e-3}});
  first.set_gravity({0, 0, -9});
  first.pin_where([](const auto& x) { return x.x() < 1e-3; });
  const auto expect_same = [&](auto original, auto body) {
    for (int i = 0; i < 4; ++i) original.step(body, this->h);
    auto copy = original;
    auto of_copy = body;
    for (int i = 0; i < 4; ++i) {
      original.step(body, this->h);
      const long before = testing::allocation_count;
      copy.step(of_copy, this->h);
      EXPECT_EQ(testing::allocation_count, before);
      ASSERT_EQ(body.displacements(), of_copy.displacements()) << i;
      ASSERT_EQ(body.velocities(), of_copy.velocities()) << i;
    }
  };
  expect_same(ImplicitEuler(first, testing::solver()), first);
  expect_same(Bdf2(first, testing::solver()), first);
  expect_same(ImplicitEuler(first, testing::solver(), {.iterations = 4, .tangent = Tangent::consistent}), first);
}

/// Bytes that an integrator owns, at most, in float.
TEST(IntegratorMemory, StaysInItsBudget) {
  const auto expect_budget = [](auto&& mesh, Index elements, std::size_t bytes) {
    ASSERT_EQ(mesh.element_count(), elements);
    using Mesh = std::remove_cvref_t<decltype(mesh)>;
    const auto body = must(SoftBody<float, typename Mesh::element_type>::create(
        mesh, Material{.young = 2e5, .poisson = 0.3, .density = 1000}));
    const ImplicitEuler integrator(body);
    EXPECT_LE(integrator.memory().owned, bytes) << elements << " elements";
  };
  expect_budget(testing::block<float, Tet4>({.size = {0.5, 0.3, 0.3}, .cells = {5, 3, 3}}), 225, 139'000);
  expect_budget(testing::block<float, Tet10>({.size = {1, 0.1, 0.1}, .cells = {10, 1, 1}}), 50, 339'500);
  expect_budget(testing::block<float, Tet4>({.size = {2, 0.8, 0.8}, .cells = {20, 8, 8}}), 6400, 5'450'000);
}

/// A body made of a shared model is that model's body at rest.
TYPED_TEST(ModelledBody, MakesBodies) {
  using Scalar = typename TypeParam::Scalar;
  auto first = this->bar();
  typename TestFixture::Body second(first.model());
  ImplicitEuler euler(first, testing::solver()), copy = euler;
  for (auto* body : {&first, &second}) {
    body->pin_where([](const Vec3<Scalar>& x) { return x.x() == 0; });
    body->set_gravity({0, 0, Scalar(-9.81)});
  }
  for (int step = 0; step < 20; ++step) {
    ASSERT_TRUE(euler.step(first, this->h).accepted());
    ASSERT_TRUE(copy.step(second, this->h).accepted());
  }
  EXPECT_EQ(first.displacements(), second.displacements());
  EXPECT_GT(testing::max_displacement(first), 0.01) << "the case must tell";
}

TYPED_TEST(ModelledBody, RefusesCouplingsThatMeanNothing) {
  const auto mesh = this->bar().mesh();
  const Material material;
  using Created = typename TestFixture::Body;
  EXPECT_FALSE(
      Created::create(mesh, material, {.couplings = {.start = {0, 2}, .vertex = {0, mesh.vertex_count()}}}).ok());
  EXPECT_FALSE(Created::create(mesh, material, {.couplings = {.start = {0, 3}, .vertex = {0, 1}}}).ok());
  EXPECT_TRUE(Created::create(mesh, material, {.couplings = {.start = {0, 2}, .vertex = {0, 1}}}).ok());
}

/// A body that flies far away loses digits in float, and gets them back; what it does is not disturbed.
TYPED_TEST(ModelledBody, IsRebasedInFlight) {
  using Scalar = typename TypeParam::Scalar;
  const auto fly = [&](auto&& make_integrator, bool rebases) {
    auto body = this->bar();
    Field<Scalar> v = testing::spin_of(body.mesh(), {0, 2, 5});
    for (auto& each : v) each += Vec3<Scalar>(300, 0, 0);
    must(body.set_velocities(v));
    body.pins().pin(0, {0, 0, 0});
    body.pins().release(0);
    auto integrator = make_integrator(body);
    for (int step = 0; step < 120; ++step) {
      EXPECT_TRUE(integrator.step(body, this->h).accepted());
      if (rebases) body.rebase();
    }
    Field<double> shape;
    for (Index i = 0; i < body.vertex_count(); ++i)
      shape.push_back((body.position(i) - body.position(0)).template cast<double>());
    const Vec3<double> there = body.origin() + body.position(0).template cast<double>();
    shape.push_back(there - Vec3<double>(600, 0, 0));
    EXPECT_LT(shape.back().norm(), 10) << "where it has flown to";
    return shape;
  };
  const auto euler = [](const auto& body) { return ImplicitEuler(body, testing::solver({.tolerance = 1e-5})); };
  const auto bdf2 = [](const auto& body) { return Bdf2(body, testing::solver({.tolerance = 1e-5})); };
  const auto compare = [&](const auto& stays, const auto& moves, double tolerance) {
    for (std::size_t i = 0; i < stays.size(); ++i) EXPECT_LT((stays[i] - moves[i]).norm(), tolerance) << i;
  };
  const double tolerance = sizeof(Scalar) == 8 ? 1e-7 : 2e-3;  // float at 600 m: 6e-5 m
  compare(fly(euler, false), fly(euler, true), tolerance);
  compare(fly(bdf2, false), fly(bdf2, true), 5 * tolerance);
}

/// Put anywhere in the world: displacements stay small, pins stay where they are.
TYPED_TEST(ModelledBody, IsPutAnywhere) {
  using Scalar = typename TypeParam::Scalar;
  auto body = this->bar();
  body.pins().pin(2, {Scalar(0.125), 0, 0});
  Field<double> there;
  for (const auto& x : body.mesh().positions()) there.push_back(x.template cast<double>() + Vec3<double>(1e6, -2e5, 3));
  must(body.set_state(there, Field<Scalar>(there.size(), Vec3<Scalar>(1, 2, 3))));
  for (Index v = 0; v < body.vertex_count(); ++v) {
    EXPECT_LT((body.origin() + body.position(v).template cast<double>() - there[at(v)]).norm(), 1e-6);
    EXPECT_LT(body.displacements()[at(v)].norm(), Scalar(0.1));
    EXPECT_EQ(body.velocities()[at(v)], (Vec3<Scalar>(1, 2, 3)));
  }
  const Vec3<double> pinned =
      body.origin() + (body.mesh().position(2) + body.pins().targets()[0]).template cast<double>();
  EXPECT_LT((pinned - body.mesh().position(2).template cast<double>() - Vec3<double>(0.125, 0, 0)).norm(),
            sizeof(Scalar) == 8 ? 1e-9 : 0.1);
  EXPECT_FALSE(body.set_state(std::span(there).first(3), body.velocities()).ok());
}

}  // namespace
}  // namespace corotet::body_model_test
