#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/embed/point_locator.hpp>
#include <limits>
#include <vector>

#include "embed/embed_fixtures.hpp"

namespace corotet {
namespace {

template <class K>
class PointLocators : public EmbedFixture<K> {
 protected:
  /// The value of a mesh field at a located point.
  template <class Field>
  static Vec3<double> value(const LocatedPoint<typename K::Element>& point, const Field& field) {
    return point.interpolate([&](Index v) { return field[at(v)]; });
  }
  static double weight(const LocatedPoint<typename K::Element>& point) {
    double sum = 0;
    for (const double w : point.weights) sum += std::fabs(w);
    return sum;
  }
};
TYPED_TEST_SUITE(PointLocators, AllKinds);

// A locator finds what a surface is bound to.
TYPED_TEST(PointLocators, PointsAreFoundAsSurfacesAreBound) {
  USE_KIND;
  const Mesh mesh = this->block();
  const PointLocator locator(mesh);
  Points points = this->inside(mesh, 300);
  const Points around = this->around(300);
  points.insert(points.end(), around.begin(), around.end());
  const auto surface = Surface::bind(mesh, points).value();
  std::vector<Index> outside;
  for (Index v = 0; v < size_of(points); ++v) {
    const auto found = locator.locate(points[at(v)]);
    ASSERT_TRUE(found.found());
    EXPECT_EQ(found.vertices, surface.carriers(v));
    EXPECT_EQ(found.vertices, mesh.element(found.element));
    double sum = 0;
    for (std::size_t a = 0; a < found.weights.size(); ++a) {
      sum += found.weights[a];
      EXPECT_NEAR(found.weights[a], surface.body_point(v).weights[a], 100 * Fixture::epsilon * this->weight(found));
    }
    EXPECT_NEAR(sum, 1, 1e-14 * this->weight(found));
    EXPECT_LE((this->value(found, mesh.positions()) - points[at(v)]).norm(), 1e-13 * this->weight(found));
    if (found.distance_outside > 0) outside.push_back(v);
  }
  EXPECT_EQ(outside, surface.outside_vertices());
}

TYPED_TEST(PointLocators, PointsOfEachElementAreFoundThere) {
  USE_KIND;
  const Mesh mesh = this->block();
  const PointLocator locator(mesh);
  for (Index e = 0; e < mesh.element_count(); ++e)
    for (int i = 0; i < 3; ++i) {
      const Vec3<double> xi = 0.8 * this->random_natural() + Vec3<double>::Constant(0.05);
      const auto found = locator.locate(this->interpolate_position(mesh, e, xi));
      EXPECT_EQ(found.element, e);
      EXPECT_EQ(found.distance_outside, 0);
      const auto expected = Element::shape({xi[0], xi[1], xi[2]});
      for (std::size_t a = 0; a < found.weights.size(); ++a)
        EXPECT_NEAR(found.weights[a], expected[a], 200 * Fixture::epsilon);
    }
}

/// x -> a smooth motion with gradients far from the identity, without folds.
Vec3<double> motion(const Vec3<double>& x) {
  const double turn = 2 * x[0];
  return {x[0] + 3, 0.8 * (std::cos(turn) * x[1] - std::sin(turn) * x[2]),
          1.1 * (std::sin(turn) * x[1] + std::cos(turn) * x[2])};
}

TYPED_TEST(PointLocators, DeformedMeshesAreSearchedWhereTheyAre) {
  USE_KIND;
  const Mesh mesh = this->block();
  DeformedPointLocator<Scalar, Element> locator{PointLocator(mesh)};
  for (const double share : {0.0, 0.5, 1.0, 0.2}) {
    const Field<Scalar> u =
        this->displacements(mesh, [&](const Vec3<double>& x) { return Vec3<double>(x + share * (motion(x) - x)); });
    Field<Scalar> now = u;
    for (Index v = 0; v < mesh.vertex_count(); ++v) now[at(v)] += mesh.position(v);
    locator.update(u);
    for (int i = 0; i < 100; ++i) {
      const auto e = static_cast<Index>(this->random_() % at(mesh.element_count()));
      const Vec3<double> xi = 0.8 * this->random_natural() + Vec3<double>::Constant(0.05);
      const Vec3<double> p =
          this->interpolate(mesh, e, xi, [&](Index v) { return Vec3<double>(now[at(v)].template cast<double>()); });
      const auto found = locator.locate(p);
      EXPECT_EQ(found.element, e);
      EXPECT_EQ(found.distance_outside, 0);
      EXPECT_LE((this->value(found, now) - p).norm(), 100 * Fixture::epsilon);
    }
    // Outside: no point of the mesh is nearer, and the weights give the point.
    Points sample;
    for (int i = 0; i < 3000; ++i)
      sample.push_back(this->interpolate(mesh, static_cast<Index>(this->random_() % at(mesh.element_count())),
                                         this->random_natural(),
                                         [&](Index v) { return Vec3<double>(now[at(v)].template cast<double>()); }));
    for (const Vec3<double>& shift : {Vec3<double>(0.5, -1, 0.2), Vec3<double>(-2, 0, 3)}) {
      const Vec3<double> p = sample.front() + shift;
      const auto found = locator.locate(p);
      for (const Vec3<double>& x : sample)
        EXPECT_LE(found.distance_outside, (x - p).norm() * (1 + 1e-5) + 100 * Fixture::epsilon);
      EXPECT_LE((this->value(found, now) - p).norm(), 1e-12 * this->weight(found));
    }
  }
}

// At rest both say the same; crushed bodies have no extension, but a nearest point.
TYPED_TEST(PointLocators, CrushedMeshesGiveTheNearestPoint) {
  USE_KIND;
  const Mesh mesh = this->block();
  DeformedPointLocator<Scalar, Element> locator{PointLocator(mesh)};
  for (const Vec3<double>& scale : {Vec3<double>(0, 0, 0), Vec3<double>(1, 1, 0), Vec3<double>(-1, 1, 1)}) {
    locator.update(this->displacements(mesh, [&](const Vec3<double>& x) { return x.cwiseProduct(scale); }));
    for (const Vec3<double>& p : this->around(20)) {
      const auto found = locator.locate(p);
      ASSERT_TRUE(found.found());
      double sum = 0;
      for (const double w : found.weights) {
        EXPECT_TRUE(std::isfinite(w));
        EXPECT_LE(std::fabs(w), 1 + 1e-9);
        sum += w;
      }
      EXPECT_NEAR(sum, 1, 1e-12);
      const Vec3<double> x =
          found.interpolate([&](Index v) { return mesh.position(v).template cast<double>().cwiseProduct(scale); });
      EXPECT_NEAR((x - p).norm(), found.distance_outside, 1e-5);
    }
  }
}

TYPED_TEST(PointLocators, CopiesShareAndOutliveTheirMesh) {
  USE_KIND;
  const Points points = this->around(20);
  std::vector<PointLocator<Scalar, Element>> locators;
  {
    const Mesh mesh = this->block();
    locators.emplace_back(mesh);
  }
  locators.push_back(locators.front());
  EXPECT_EQ(&locators[0].mesh(), &locators[1].mesh());
  for (const Vec3<double>& p : points) {
    const auto a = locators[0].locate(p), b = locators[1].locate(p);
    EXPECT_EQ(a.element, b.element);
    EXPECT_EQ(a.weights, b.weights);
    EXPECT_EQ(locators[0].locate(p.template cast<float>()).element >= 0, true);
  }
}

TYPED_TEST(PointLocators, PointsNowhereAreNotFound) {
  USE_KIND;
  const PointLocator locator(this->block());
  const DeformedPointLocator<Scalar, Element> deformed(locator);
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity, 1e200})
    for (int i = 0; i < 3; ++i) {
      Vec3<double> p(0, 0.2, 0.3);
      EXPECT_TRUE(locator.locate(p).found());
      p[i] = bad;
      EXPECT_FALSE(locator.locate(p).found());
      EXPECT_FALSE(deformed.locate(p).found());
    }
}

}  // namespace
}  // namespace corotet
