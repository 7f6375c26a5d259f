#include <gtest/gtest.h>

#include <corotet/detail/mesh/closest_point.hpp>
#include <numeric>
#include <random>

namespace corotet {
namespace {

class ClosestPoint : public ::testing::Test {
 protected:
  Vec3<double> random_vector(double size) {
    std::uniform_real_distribution<double> coordinate(-size, size);
    return {coordinate(random_), coordinate(random_), coordinate(random_)};
  }

  /// The nearest point q of a convex set is the only one with (p - q).(v - q) <= 0 for every v of the set; for a
  /// simplex it is enough to look at its corners. `size` is the scale of the coordinates.
  template <std::size_t N>
  void expect_nearest(const detail::SimplexPoint<N>& q, const std::array<Vec3<double>, N>& corners,
                      const Vec3<double>& p, double size) {
    const double rounding = 1e-13 * size * size;
    EXPECT_NEAR(std::accumulate(q.barycentric.begin(), q.barycentric.end(), 0.0), 1, 1e-9);
    Vec3<double> x = Vec3<double>::Zero();
    for (std::size_t i = 0; i < N; ++i) {
      EXPECT_GE(q.barycentric[i], 0);
      EXPECT_LE(q.barycentric[i], 1);
      EXPECT_LE((p - q.point).dot(corners[i] - q.point), rounding);
      x += q.barycentric[i] * corners[i];
    }
    EXPECT_LE((x - q.point).norm(), 1e-9 * size);
    EXPECT_NEAR(q.squared_distance, (p - q.point).squaredNorm(), rounding);
  }

  std::mt19937 random_{7};
};

TEST_F(ClosestPoint, OfSegmentsSatisfiesTheProjectionLaw) {
  for (int i = 0; i < 2000; ++i) {
    const Vec3<double> a = random_vector(1), b = i % 10 == 0 ? a : random_vector(1), p = random_vector(2);
    expect_nearest<2>(detail::closest_on_segment(a, b, p), {a, b}, p, 2);
  }
}

TEST_F(ClosestPoint, OfTrianglesSatisfiesTheProjectionLaw) {
  int inside = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3<double> a = random_vector(1), p = random_vector(i % 2 == 0 ? 0.5 : 2);
    Vec3<double> b = random_vector(1), c = random_vector(1);
    if (i % 10 == 0) c = a + 0.25 * (b - a);  // on a line, to rounding
    if (i % 50 == 0) b = c = a;
    const detail::SimplexPoint<3> q = detail::closest_on_triangle(a, b, c, p);
    if (i % 10 != 0) {
      expect_nearest<3>(q, {a, b, c}, p, 2);
      inside += q.barycentric[0] > 0 && q.barycentric[1] > 0 && q.barycentric[2] > 0;
    } else {
      EXPECT_NEAR(q.squared_distance, detail::closest_on_segment(a, b, p).squared_distance, 1e-12);
    }
  }
  EXPECT_GT(inside, 100);
}

TEST_F(ClosestPoint, OfTetrahedraSatisfiesTheProjectionLaw) {
  int inside = 0;
  for (int i = 0; i < 5000; ++i) {
    std::array<Vec3<double>, 4> x;
    for (Vec3<double>& v : x) v = random_vector(1);
    const Vec3<double> p = random_vector(i % 2 == 0 ? 0.5 : 2);
    const detail::SimplexPoint<4> q = detail::closest_on_tetrahedron(x, p);
    expect_nearest<4>(q, x, p, 2);
    inside += q.squared_distance == 0;
  }
  EXPECT_GT(inside, 50);
}

TEST_F(ClosestPoint, OfAFlatTetrahedronIsOnItsFaces) {
  for (int i = 0; i < 500; ++i) {
    std::array<Vec3<double>, 4> x;
    for (Vec3<double>& v : x) {
      v = random_vector(1);
      v[2] = 0.5;
    }
    const Vec3<double> p = random_vector(2);
    expect_nearest<4>(detail::closest_on_tetrahedron(x, p), x, p, 2);
  }
}

TEST_F(ClosestPoint, BarycentricCoordinatesAreExactlyZeroOffTheFeature) {
  const Vec3<double> a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(detail::closest_on_triangle(a, b, c, {-1, -1, 3}).barycentric, (std::array<double, 3>{1, 0, 0}));
  EXPECT_EQ(detail::closest_on_triangle(a, b, c, {0.25, -2, 1}).barycentric, (std::array<double, 3>{0.75, 0.25, 0}));
  EXPECT_EQ(detail::closest_on_triangle(a, b, c, {2, 2, 0}).barycentric, (std::array<double, 3>{0, 0.5, 0.5}));
  EXPECT_EQ(detail::closest_on_triangle(a, b, c, {0.25, 0.5, 0}).squared_distance, 0);
}

}  // namespace
}  // namespace corotet
