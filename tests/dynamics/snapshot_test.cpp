// States that are saved and restored: what follows is the same to the last bit.
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/snapshot.hpp>
#include <corotet/detail/dynamics/substepping_integrator.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "support/bodies.hpp"
#include "support/seeds.hpp"
#include "support/solver_choice.hpp"

namespace corotet::snapshot_test {
namespace {

using testing::must;

template <class K>
class Snapshot : public ::testing::Test {
 public:
  using Real = typename K::Scalar;
  using Body = SoftBody<Real, typename K::Element>;
  static constexpr Real h = Real(1) / 60;

  static Body beam(double poisson = 0.3, const BodyOptions& options = {}) {
    return must(Body::create(testing::block<Real, typename K::Element>({.size = {1, 0.2, 0.2}, .cells = {3, 1, 1}}),
                             Material{.young = 2e5, .poisson = poisson, .density = 1000}, options));
  }

  /// What a caller does before step `step`: leads, pins, releases, pulls.
  static void act(Body& body, int step) {
    if (step == 0) body.set_gravity({0, 1, Real(-9.81)});
    if (step == 0) body.pin_where([](const Vec3<Real>& x) { return x.x() == 0; });
    if (step == 10) body.pins().pin(6, body.displacements()[6], {true, false, true});
    if (step == 18) body.pins().release(6);
    if (step == 25)
      for (Index v = 0; v < body.vertex_count(); ++v) body.pins().release(v);
    body.external_forces()[at(Index{3})] = {Real(step % 7), 0, Real(0.5)};
  }
};
TYPED_TEST_SUITE(Snapshot, testing::AllCases);

template <class Body, class Integrator>
std::vector<std::byte> saved(const Body& body, const Integrator& integrator) {
  std::vector<std::byte> bytes(snapshot_size(body, integrator));
  must(save_snapshot(body, integrator, bytes));
  return bytes;
}

/// Saved at step n of a run; restored into the same objects later, and into others that have made other steps or none:
/// all go on as the run did. Saving changes nothing.
template <class Integrator, class Body, class Scalar>
void restore_anywhere(const Body& start, Scalar h, const std::function<Integrator(const Body&)>& make,
                      const std::function<void(Body&, int)>& act) {
  constexpr int most = 36;
  Body undisturbed = start;
  Integrator alone = make(undisturbed);
  std::vector<Field<Scalar>> path;
  for (int step = 0; step < most; ++step) {
    act(undisturbed, step);
    ASSERT_TRUE(alone.step(undisturbed, h).accepted());
    path.push_back(undisturbed.displacements());
  }
  EXPECT_GT(testing::max_displacement(undisturbed), 0.01) << "the case must tell";
  for (const int when : {0, 1, 12, 30}) {
    Body body = start;
    Integrator integrator = make(body);
    for (int step = 0; step < when; ++step) {
      act(body, step);
      integrator.step(body, h);
    }
    const auto bytes = saved(body, integrator);
    const auto goes_on = [&](Body& b, Integrator& i, const char* who) {
      for (int step = when; step < most; ++step) {
        act(b, step);
        ASSERT_TRUE(i.step(b, h).accepted());
        ASSERT_EQ(b.displacements(), path[at(step)]) << who << ", saved before " << when << ", step " << step;
      }
    };
    goes_on(body, integrator, "the one that was saved");
    must(restore_snapshot(bytes, body, integrator));
    EXPECT_EQ(saved(body, integrator), bytes) << "what is restored is what was saved";
    goes_on(body, integrator, "rolled back");
    Body late = start;
    Integrator joiner = make(late);
    must(restore_snapshot(bytes, late, joiner));
    goes_on(late, joiner, "a late joiner");
    must(late.set_velocities(testing::random_field<Scalar>(late.vertex_count(), 1, 3)));
    for (int step = 0; step < 3; ++step) joiner.step(late, h / 3);
    must(restore_snapshot(bytes, late, joiner));
    goes_on(late, joiner, "one that went elsewhere");
  }
}

template <class Body>
using Euler = ImplicitEuler<Body>;

TYPED_TEST(Snapshot, GoesOnWithTheSameBits) {
  using B = typename TestFixture::Body;
  const auto act = [](B& body, int step) { TestFixture::act(body, step); };
  const std::function<ImplicitEuler<B>(const B&)> euler = [](const B& b) {
    return ImplicitEuler<B>(b, testing::solver());
  };
  const std::function<Bdf2<B>(const B&)> bdf2 = [](const B& b) { return Bdf2<B>(b, testing::solver()); };
  restore_anywhere<ImplicitEuler<B>, B>(this->beam(), this->h, euler, act);
  restore_anywhere<Bdf2<B>, B>(this->beam(), this->h, bdf2, act);
  // Where the energy bound acts, and every preconditioner has something to remember.
  restore_anywhere<Bdf2<B>, B>(this->beam(0.495, {.damping = {.mass = 0, .stiffness = 0.002}}), this->h, bdf2, act);
}

TYPED_TEST(Snapshot, OfAFreeBodyAndOfDividedSteps) {
  using B = typename TestFixture::Body;
  auto start = this->beam();
  must(start.set_velocities(testing::spin_of(start.mesh(), {3, 9, -4})));
  const auto act = [](B& body, int step) {
    if (step == 12) body.external_forces()[4] = {0, 0, 2000};  // pulled hard for a step
    if (step == 13) body.external_forces()[4].setZero();
  };
  const std::function<Bdf2<B>(const B&)> bdf2 = [](const B& b) { return Bdf2<B>(b, testing::solver()); };
  restore_anywhere<Bdf2<B>, B>(start, this->h, bdf2, act);
  using Adaptive = SubsteppingIntegrator<Bdf2<B>, B>;
  const std::function<Adaptive(const B&)> adaptive = [](const B& b) {
    return Adaptive(Bdf2<B>(b, testing::solver()), b);
  };
  restore_anywhere<Adaptive, B>(start, this->h, adaptive, act);
}

TYPED_TEST(Snapshot, WithEachSolver) {
  using B = typename TestFixture::Body;
  using enum PreconditionerKind;
  const auto act = [](B& body, int step) { TestFixture::act(body, step); };
  for (const SolverOptions& options :
       {SolverOptions{.method = SolverMethod::cholesky}, SolverOptions{.preconditioner = jacobi},
        SolverOptions{.preconditioner = rigid_aggregates}, SolverOptions{.preconditioner = warped_cholesky}}) {
    const std::function<ImplicitEuler<B>(const B&)> euler = [&](const B& b) { return ImplicitEuler<B>(b, options); };
    restore_anywhere<ImplicitEuler<B>, B>(this->beam(), this->h, euler, act);
  }
}

/// Also of a body of pieces.
TYPED_TEST(Snapshot, OfPieces) {
  using B = typename TestFixture::Body;
  MeshData data;
  for (const double x : {0.0, 2.0}) {
    const MeshData block = must(make_block(
        {.corner = {x, 0, 0}, .size = {0.5, 0.2, 0.2}, .cells = {3, 2, 2}, .order = TypeParam::Element::order}));
    for (const Index v : block.connectivity) data.connectivity.push_back(v + size_of(data.positions));
    data.positions.insert(data.positions.end(), block.positions.begin(), block.positions.end());
    data.nodes_per_element = block.nodes_per_element;
  }
  const B start = must(B::create(must(B::Mesh::create(std::move(data))), Material{.young = 2e5}));
  const std::function<Bdf2<B>(const B&)> bdf2 = [](const B& b) { return Bdf2<B>(b, testing::solver()); };
  restore_anywhere<Bdf2<B>, B>(start, this->h, bdf2, [](B& body, int step) { TestFixture::act(body, step); });
}

/// A body and an integrator that are reset are as new.
TYPED_TEST(Snapshot, ResetIsAsNew) {
  auto body = this->beam(), fresh = body;
  Bdf2 used(body, testing::solver());
  for (int step = 0; step < 20; ++step) {
    this->act(body, step);
    used.step(body, this->h);
  }
  for (Index v = 0; v < body.vertex_count(); ++v) body.pins().release(v);
  body.reset();
  used.reset(body);
  Bdf2 unused(fresh, testing::solver());
  for (int step = 0; step < 20; ++step) {
    this->act(body, step);
    this->act(fresh, step);
    ASSERT_TRUE(used.step(body, this->h).accepted());
    ASSERT_TRUE(unused.step(fresh, this->h).accepted());
    ASSERT_EQ(body.displacements(), fresh.displacements()) << "step " << step;
  }
  EXPECT_GT(testing::max_displacement(body), 0.01) << "the case must tell";
}

/// What is not a snapshot of this body is refused, and nothing changes: cut off anywhere, any byte another, of another
/// mesh, material, integrator, or of a body alone.
TYPED_TEST(Snapshot, RefusesWhatIsNotOne) {
  auto body = this->beam();
  ImplicitEuler euler(body, testing::solver());
  for (int step = 0; step < 5; ++step) {
    this->act(body, step);
    euler.step(body, this->h);
  }
  const auto bytes = saved(body, euler);
  std::vector<std::byte> too_few(bytes.size() - 1);
  EXPECT_FALSE(save_snapshot(body, euler, too_few).ok());
  must(body.set_velocities(testing::random_field<typename TypeParam::Scalar>(body.vertex_count(), 1, 3)));
  const auto before = saved(body, euler);
  const auto refused = [&](std::span<const std::byte> wrong) {
    const bool was_refused = !restore_snapshot(wrong, body, euler).ok();
    return was_refused && saved(body, euler) == before;
  };
  testing::for_seeds(40, [&](unsigned seed) {
    testing::Random random(seed);
    const auto place = static_cast<std::size_t>(random.uniform(0, double(bytes.size() - 1)));
    EXPECT_TRUE(refused(std::span(bytes).first(place))) << "cut off at " << place;
    auto damaged = bytes;
    damaged[place] ^= std::byte(1U << static_cast<unsigned>(random.uniform(0, 8)));
    EXPECT_TRUE(refused(damaged)) << "byte " << place;
  });
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_TRUE(refused(longer));
  auto other = body;
  must(other.set_materials(Material{.young = 3e5}));
  ImplicitEuler others(other, testing::solver());
  EXPECT_TRUE(refused(saved(other, others)));
  Bdf2 second(body, testing::solver());
  EXPECT_TRUE(refused(saved(body, second)));
  std::vector<std::byte> alone(snapshot_size(body));
  must(save_snapshot(body, alone));
  EXPECT_TRUE(refused(alone));
  must(body.set_velocities(Field<typename TypeParam::Scalar>(body.velocities().size())));
  must(restore_snapshot(alone, body));
  EXPECT_FALSE(
      std::all_of(body.velocities().begin(), body.velocities().end(), [](const auto& v) { return v.isZero(); }));
}

}  // namespace
}  // namespace corotet::snapshot_test
