// Laws of the shapes that bodies collide with, of ready ones and of one written here.
#include <corotet/detail/contact/collider.hpp>
#include <corotet/detail/contact/mesh_collider.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "contact/surfaces.hpp"
#include "support/random.hpp"

namespace corotet::collider_test {
namespace {

using V = Vec3<double>;

std::string text(const V& p) {
  return "(" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " + std::to_string(p.z()) + ")";
}

/// A torus about the z axis.
struct Ring {
  double large, small;

  [[nodiscard]] SurfaceDistance operator()(const V& p) const {
    const double around = std::hypot(p.x(), p.y());
    const V out = around > 0 ? V(p.x() / around, p.y() / around, 0) : V(1, 0, 0);
    const V away = p - large * out;
    const double r = away.norm();
    return {r - small, r > 0 ? V(away / r) : V(0, 0, 1)};
  }
};

/// A shape, and whether a point is in it by another way than the sign of its distance.
struct Sample {
  std::string name;
  detail::AnyCollider shape;
  bool (*contains)(const V&);
};

constexpr double radius = 0.3, half_height = 0.5;
const V extents(0.3, 0.5, 0.2), slope(1, -2, 2);

std::vector<Sample> samples() {
  return {
      {"half-space", detail::AnyCollider(HalfSpace{slope, 0.2}),
       [](const V& p) { return p.x() - 2 * p.y() + 2 * p.z() < 3 * 0.2; }},
      {"sphere", detail::AnyCollider(Sphere{radius}), [](const V& p) { return p.squaredNorm() < radius * radius; }},
      {"box", detail::AnyCollider(OrientedBox{extents}),
       [](const V& p) {
         return std::fabs(p.x()) < extents.x() && std::fabs(p.y()) < extents.y() && std::fabs(p.z()) < extents.z();
       }},
      {"capsule", detail::AnyCollider(Capsule{radius, half_height}),
       [](const V& p) {
         const double beyond = std::max(0.0, std::fabs(p.z()) - half_height);
         return p.x() * p.x() + p.y() * p.y() + beyond * beyond < radius * radius;
       }},
      {"ring", detail::AnyCollider(Ring{0.5, 0.2}),
       [](const V& p) {
         const double away = std::sqrt(p.x() * p.x() + p.y() * p.y()) - 0.5;
         return away * away + p.z() * p.z() < 0.2 * 0.2;
       }},
      {"mesh", detail::AnyCollider(MeshCollider::create(contact_surfaces::l_surface()).value()),
       contact_surfaces::l_contains},
  };
}

/// Points in and around the shapes; a third of them lie on planes, axes and edges of these.
V some_point(testing::Random& random) {
  V p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  if (random.uniform() > 0.7)
    for (int i = 0; i < 3; ++i) {
      const double which = random.uniform();
      if (which < 0.4) p[i] = 0;
      if (which > 0.7) p[i] = std::copysign(extents[i], p[i]);
    }
  return p;
}

TEST(Collider, TheNormalHasLengthOneEverywhere) {
  for (const Sample& s : samples()) {
    testing::Random random(1);
    for (int i = 0; i < 2000; ++i) {
      const V p = some_point(random) * std::pow(10, random.uniform(-12, 6));
      EXPECT_NEAR(s.shape(p).normal.norm(), 1, 1e-12) << s.name << ' ' << text(p);
    }
    EXPECT_NEAR(s.shape(V::Zero()).normal.norm(), 1, 1e-12) << s.name;
  }
  const V far(1, 2, 3);
  for (const V& p : {V(V::Zero()), far, V(-far)}) {  // shapes without a size
    EXPECT_NEAR(Sphere{0}(p).normal.norm(), 1, 1e-12);
    EXPECT_NEAR(OrientedBox{V::Zero()}(p).normal.norm(), 1, 1e-12);
    EXPECT_NEAR((Capsule{0, 0}(p).normal.norm()), 1, 1e-12);
    EXPECT_NEAR((HalfSpace{V(0, 1e-200, 0), 0}(p).normal - V::UnitY()).norm(), 0, 1e-12);
    EXPECT_NEAR((HalfSpace{V(0, 0, 1e200), 0}(p).normal - V::UnitZ()).norm(), 0, 1e-12);
  }
}

TEST(Collider, TheDistanceIsNegativeInsideAlone) {
  for (const Sample& s : samples()) {
    testing::Random random(2);
    int inside = 0;
    for (int i = 0; i < 5000; ++i) {
      const V p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      EXPECT_EQ(s.shape(p).distance < 0, s.contains(p)) << s.name << ' ' << text(p);
      inside += s.contains(p);
    }
    EXPECT_GT(inside, 50) << s.name;
  }
}

/// The normal leads to a point of the surface, as far away as the distance says.
TEST(Collider, TheDistanceLeadsToTheSurface) {
  for (const Sample& s : samples()) {
    testing::Random random(3);
    for (int i = 0; i < 2000; ++i) {
      const V p = some_point(random);
      const SurfaceDistance to = s.shape(p);
      EXPECT_NEAR(s.shape(p - to.distance * to.normal).distance, 0, 1e-12) << s.name << ' ' << text(p);
    }
  }
}

TEST(Collider, TheDistanceGrowsNoFasterThanTheWay) {
  for (const Sample& s : samples()) {
    testing::Random random(4);
    for (int i = 0; i < 5000; ++i) {
      const V p = some_point(random), q = p + random.vector() * std::pow(10, random.uniform(-6, 0));
      EXPECT_LE(std::fabs(s.shape(p).distance - s.shape(q).distance), (p - q).norm() + 1e-14) << s.name;
    }
  }
}

TEST(Collider, TheNormalIsTheGradientOfTheDistance) {
  constexpr double step = 1e-6;
  for (const Sample& s : samples()) {
    testing::Random random(5);
    int seen = 0;
    const int count = 2000;
    for (int i = 0; i < count; ++i) {
      const V p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      V gradient;
      bool smooth = true;  // not across an edge, or the middle
      for (int k = 0; k < 3; ++k) {
        V e = V::Zero();
        e[k] = step;
        const SurfaceDistance before = s.shape(p - e), after = s.shape(p + e);
        gradient[k] = (after.distance - before.distance) / (2 * step);
        smooth = smooth && (after.normal - before.normal).norm() < 1e-2;
      }
      if (!smooth) continue;
      ++seen;
      EXPECT_LT((gradient - s.shape(p).normal).norm(), 1e-6) << s.name << ' ' << text(p);
    }
    EXPECT_GT(seen, count * 99 / 100) << s.name;
  }
}

/// Of 1 kg in the points where the distance is negative.
template <class Shape>
V integrated_inertia(const Shape& shape, const V& bound) {
  const int n = 80;
  V moments = V::Zero();
  int inside = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const V p = bound.cwiseProduct(V(2.0 * i + 1, 2.0 * j + 1, 2.0 * k + 1) / n - V::Ones());
        if (shape(p).distance >= 0) continue;
        ++inside;
        const V squares = p.cwiseProduct(p);
        moments += V::Constant(squares.sum()) - squares;
      }
  return moments / inside;
}

TEST(Collider, InertiaIsThatOfAUniformSolid) {
  const auto expect_right = [](const auto& shape, const V& bound, const char* name) {
    const V told = shape.inertia(), seen = integrated_inertia(shape, bound);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(told[i], seen[i], 2e-3 * told.maxCoeff()) << name << ", axis " << i;
  };
  expect_right(Sphere{0.3}, V::Constant(0.3), "sphere");
  expect_right(OrientedBox{extents}, extents, "box");
  expect_right(Capsule{0.3, 0.5}, V(0.3, 0.3, 0.8), "capsule");
  expect_right(Capsule{0.3, 0.02}, V(0.3, 0.3, 0.32), "short capsule");
  const V slender = Capsule{0.01, 1}.inertia(), rod = OrientedBox{V(0.01, 0.01, 1)}.inertia();
  EXPECT_NEAR(slender.x(), rod.x(), 0.02 * rod.x());
}

/// In an obstacle, a shape has the same distance wherever its pose takes both it and the point.
TEST(Collider, MovesWithItsObstacle) {
  testing::Random random(6);
  for (int i = 0; i < 200; ++i) {
    Pose pose;
    pose.position = random.vector(3);
    pose.rotation = quaternion_of(random.rotation());
    const Mat3<double> r = rotation_of(pose.rotation);
    const OrientedBox box{extents};
    const Obstacle obstacle(box, {.pose = pose});
    const V p = some_point(random);
    const SurfaceDistance here = box(p), there = obstacle.distance(pose.position + r * p);
    EXPECT_NEAR(here.distance, there.distance, 1e-12);
    if (here.distance > 1e-9) {
      EXPECT_LT((r * here.normal - there.normal).norm(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace corotet::collider_test
