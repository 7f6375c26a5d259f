// Pieces of one mesh that do not touch move as each does alone: bit for bit, whatever the others do.
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/substepping_integrator.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "support/bodies.hpp"
#include "support/floating_point_traps.hpp"
#include "support/pairs.hpp"
#include "support/solver_choice.hpp"

namespace corotet::pieces_test {
namespace {

using testing::must;

/// Three blocks of different sizes, apart from each other: a beam, a cube and a slab.
std::vector<BlockOptions> blocks() {
  return {{.corner = {0, 0, 0}, .size = {1, 0.2, 0.2}, .cells = {5, 2, 2}},
          {.corner = {2, 0, 0}, .size = {0.3, 0.3, 0.3}, .cells = {2, 2, 2}},
          {.corner = {-2, 0.5, 0}, .size = {0.6, 0.6, 0.1}, .cells = {3, 3, 1}}};
}

template <class K>
class Pieces : public ::testing::Test {
 public:
  using Real = typename K::Scalar;
  using Body = SoftBody<Real, typename K::Element>;
  static constexpr Real h = Real(1) / 60;

  /// The blocks as bodies of their own, and as one body whose elements and vertices are in any order: piece p's vertex
  /// i is the whole's whole_vertex[p][i].
  struct Scene {
    std::vector<Body> alone;
    std::vector<Body> whole;  // one
    std::vector<std::vector<Index>> whole_vertex;
  };

  static Scene scene(const BodyOptions& options = {}, double poisson = 0.3) {
    Scene scene;
    MeshData all;
    std::vector<Material> materials;
    double young = 2e5;
    for (BlockOptions block : blocks()) {
      block.order = K::Element::order;
      const MeshData data = must(make_block(block));
      const Material material{.young = young, .poisson = poisson, .density = 1000};
      young *= 3;
      scene.alone.push_back(
          must(Body::create(must(TetMesh<Real, typename K::Element>::create(data)), material, options)));
      std::vector<Index> vertices;
      for (std::size_t v = 0; v < data.positions.size(); ++v) vertices.push_back(size_of(all.positions) + Index(v));
      all.nodes_per_element = data.nodes_per_element;
      for (const Index v : data.connectivity) all.connectivity.push_back(v + size_of(all.positions));
      all.positions.insert(all.positions.end(), data.positions.begin(), data.positions.end());
      materials.insert(materials.end(), data.connectivity.size() / at(data.nodes_per_element), material);
      scene.whole_vertex.push_back(vertices);
    }
    scene.whole.push_back(
        must(Body::create(must(TetMesh<Real, typename K::Element>::create(std::move(all))), materials, options)));
    return scene;
  }

  /// Does the same to each vertex of the whole and of the pieces.
  static void start(Scene& scene, const std::function<Vec3<double>(std::size_t, const Vec3<double>&)>& velocity) {
    Field<Real> all(at(scene.whole[0].vertex_count()));
    for (std::size_t p = 0; p < scene.alone.size(); ++p) {
      Field<Real> v;
      for (Index i = 0; i < scene.alone[p].vertex_count(); ++i)
        v.push_back(velocity(p, scene.alone[p].mesh().position(i).template cast<double>()).template cast<Real>());
      for (std::size_t i = 0; i < v.size(); ++i) all[at(scene.whole_vertex[p][i])] = v[i];
      must(scene.alone[p].set_velocities(v));
    }
    must(scene.whole[0].set_velocities(all));
  }

  template <class Do>
  static void to_all(Scene& scene, const Do& change) {
    for (std::size_t p = 0; p < scene.alone.size(); ++p)
      for (Index i = 0; i < scene.alone[p].vertex_count(); ++i) {
        change(scene.alone[p], p, i, i);
        change(scene.whole[0], p, i, scene.whole_vertex[p][at(i)]);
      }
  }

  static void expect_equal(const Scene& scene, const std::string& when) {
    for (std::size_t p = 0; p < scene.alone.size(); ++p) {
      EXPECT_GT(testing::max_displacement(scene.alone[p]), 1e-3) << when << ", piece " << p << " must have moved";
      for (Index i = 0; i < scene.alone[p].vertex_count(); ++i) {
        const std::size_t w = at(scene.whole_vertex[p][at(i)]);
        ASSERT_EQ(scene.alone[p].displacements()[at(i)], scene.whole[0].displacements()[w])
            << when << ", piece " << p << ", vertex " << i;
        ASSERT_EQ(scene.alone[p].velocities()[at(i)], scene.whole[0].velocities()[w]) << when;
      }
    }
  }

  template <template <class, class> class Integrator>
  static void run(
      Scene& scene, int steps, const StepOptions& newton, const std::function<void(int)>& before = [](int) {}) {
    using Stepper = Integrator<Body, AutoSolver<Real>>;
    std::vector<Stepper> alone;
    for (const Body& body : scene.alone) alone.emplace_back(body, testing::solver(), newton);
    Stepper whole(scene.whole[0], testing::solver(), newton);
    for (int step = 0; step < steps; ++step) {
      before(step);
      for (std::size_t p = 0; p < alone.size(); ++p) ASSERT_TRUE(alone[p].step(scene.alone[p], h).accepted());
      ASSERT_TRUE(whole.step(scene.whole[0], h).accepted());
    }
  }
};
TYPED_TEST_SUITE(Pieces, testing::AllCases);

const auto different_spins = [](std::size_t p, const Vec3<double>& x) -> Vec3<double> {
  const std::array<Vec3<double>, 3> spin{{{0, 3, 8}, {0, 0, 0}, {-5, 1, 0}}};
  const std::array<Vec3<double>, 3> flight{{{1, 0, 0}, {0, -2, 0}, {0, 0, 5}}};
  return spin[p].cross(x) + flight[p];
};

TYPED_TEST(Pieces, FlyAndSpinAsAlone) {
  const auto expect_alike = [this](MassModel mass, const StepOptions& newton, bool second_order) {
    auto scene = this->scene({.mass = mass, .damping = {.mass = 0.1, .stiffness = 0.005}});
    this->start(scene, different_spins);
    if (second_order)
      this->template run<Bdf2>(scene, 30, newton);
    else
      this->template run<ImplicitEuler>(scene, 30, newton);
    this->expect_equal(scene, second_order ? "BDF2" : "backward Euler");
  };
  testing::for_pairs(testing::seed_of<typename TypeParam::Scalar, typename TypeParam::Element>, expect_alike,
                     std::array{MassModel::lumped, MassModel::consistent},
                     std::array{StepOptions{}, StepOptions{.iterations = 8, .tangent = Tangent::consistent}},
                     std::array{false, true});
}

/// One held, one free, one led and released; forces and gravity; mean dilatation.
TYPED_TEST(Pieces, HeldAndFreeAsAlone) {
  using Scalar = typename TypeParam::Scalar;
  auto scene = this->scene({.volumetric_strain = VolumetricStrain::averaged}, 0.49);
  const auto is_held = [](const auto& body, std::size_t p, Index i) {
    return p != 1 && body.mesh().position(i).y() < Scalar(0.51) && body.mesh().position(i).x() < Scalar(0.01);
  };
  for (auto* bodies : {&scene.alone, &scene.whole})
    for (auto& body : *bodies) body.set_gravity({0, Scalar(1), Scalar(-9.81)});
  this->to_all(scene, [&](auto& body, std::size_t p, Index i, Index v) {
    if (is_held(scene.alone[p], p, i))
      body.pins().pin(v, {0, 0, 0}, p == 2 ? PinnedAxes{true, false, true} : PinnedAxes{});
    body.external_forces()[at(v)] = {Scalar(0.01) * Scalar(i), 0, Scalar(p)};
  });
  const auto lead = [&](int step) {
    this->to_all(scene, [&](auto& body, std::size_t p, Index i, Index v) {
      if (!is_held(scene.alone[p], p, i) || p == 2) return;
      if (step < 15) body.pins().move(v, {0, Scalar(0.01) * Scalar(step), 0});
      if (step == 20) body.pins().release(v);
    });
  };
  this->template run<Bdf2>(scene, 40, {}, lead);
  this->expect_equal(scene, "BDF2");
}

/// What one piece cannot bear divides its own steps alone.
TYPED_TEST(Pieces, DivideTheirOwnSteps) {
  using Scalar = typename TypeParam::Scalar;
  auto scene = this->scene();
  this->start(scene, [](std::size_t p, const Vec3<double>& x) -> Vec3<double> {
    return p == 1 ? Vec3<double>(-3000 * (x.x() - 2.15), 0, 0) : Vec3<double>(0, x.x(), 0);
  });
  using Stepper = ImplicitEuler<typename TestFixture::Body, AutoSolver<Scalar>>;
  std::vector<SubsteppingIntegrator<Stepper, typename TestFixture::Body>> alone;
  for (const auto& body : scene.alone) alone.emplace_back(Stepper(body), body);
  SubsteppingIntegrator<Stepper, typename TestFixture::Body> whole(Stepper(scene.whole[0]), scene.whole[0]);
  int most = 1;
  for (int step = 0; step < 10; ++step) {
    int divided = 1;
    for (std::size_t p = 0; p < alone.size(); ++p)
      divided = std::max(divided, alone[p].step(scene.alone[p], this->h).sub_steps);
    EXPECT_EQ(whole.step(scene.whole[0], this->h).sub_steps, divided);
    most = std::max(most, divided);
  }
  EXPECT_GT(most, 1) << "nothing was divided: the test shows nothing";
  this->expect_equal(scene, "divided");
}

/// Energy that one piece would gain is found although others lose as much.
TYPED_TEST(Pieces, AreBoundInEnergyEach) {
  auto scene = this->scene({}, 0.499);
  this->start(scene, [](std::size_t p, const Vec3<double>& x) -> Vec3<double> {
    return p == 0 ? Vec3<double>(0, 0, 30 * x.x() * x.x()) : Vec3<double>(0, 5 * x.z(), 0);
  });
  this->template run<ImplicitEuler>(scene, 30, {});
  this->expect_equal(scene, "nearly incompressible");
}

/// On any executor, and all or none.
TYPED_TEST(Pieces, AreSteppedTogetherOrNotAtAll) {
  using Scalar = typename TypeParam::Scalar;
  auto scene = this->scene();
  this->start(scene, different_spins);
  auto& body = scene.whole[0];
  ImplicitEuler euler(body, testing::solver());
  ASSERT_TRUE(euler.step(body, this->h).accepted());
  const auto before = body.displacements();
  const Index last = scene.whole_vertex[2][3];
  body.external_forces()[at(last)] = {std::numeric_limits<Scalar>::quiet_NaN(), 0, 0};
  const StepReport report = euler.step(body, this->h);
  EXPECT_EQ(report.error, StepError::external_force);
  EXPECT_EQ(report.vertex, last);
  {
    const testing::WithoutTraps so_that_numbers_may_overflow;
    body.external_forces()[at(last)] = {std::numeric_limits<Scalar>::max(), 0, 0};
    EXPECT_FALSE(euler.step(body, this->h).accepted());
  }
  EXPECT_EQ(body.displacements(), before);
  body.external_forces()[at(last)].setZero();
  ASSERT_TRUE(euler.step(body, this->h).accepted());
}

}  // namespace
}  // namespace corotet::pieces_test
