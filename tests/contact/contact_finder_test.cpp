// Which points find which obstacles: none leaps over one, at any speed.
#include <corotet/detail/contact/contact_finder.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support/random.hpp"

namespace corotet::contact_finder_test {
namespace {

using detail::ContactMemory;
using detail::ContactQuery;
using detail::PointContact;
using V = Vec3<double>;

constexpr double near_distance = 1e-3, reach_factor = 1.5;

/// Obstacles of many sizes and thicknesses, some of which move.
std::vector<Obstacle> obstacles() {
  const auto placed = [](const V& position, const Matrix<double, 4, 1>& rotation) {
    ObstacleOptions options;
    options.pose = {position, rotation};
    return options;
  };
  std::vector<Obstacle> all;
  all.emplace_back(HalfSpace{}, placed({0, 0, -0.2}, {1, 0.1, 0, 0}));
  all.emplace_back(OrientedBox{{0.5, 0.5, 0.001}}, placed({0, 0, 0}, {1, 0, 0.3, 0}));  // a plate of 2 mm
  all.emplace_back(Sphere{0.05}, placed({0.1, 0.2, 0}, {1, 0, 0, 0}));
  all.emplace_back(Capsule{0.01, 0.4}, placed({0, 0, 0.1}, {1, 1, 0, 0}));  // a wire
  for (std::size_t i = 0; i < 4; ++i) {
    all.push_back(all[i]);
    all.back().velocity = {3, -5, 40};
  }
  return all;
}

ContactQuery some_query(testing::Random& random) {
  const double h = 1.0 / 60, speed = std::pow(10, random.uniform(-1, 3));
  ContactQuery query{};
  query.start = V(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)) * 0.6;
  query.h = h;
  query.end = query.start + h * speed * random.vector().normalized();
  if (random.uniform() < 0.3) {  // towards the middle, where they all are
    const V to = random.vector(0.1) - query.start;
    query.end = query.start + random.uniform(0.5, 4) * to;
  }
  query.near_distance = near_distance;
  query.max_depenetration = 1;
  return query;
}

/// The least distance on the way to `end`, relative to the obstacle.
double least_distance(const Obstacle& obstacle, const ContactQuery& query, const V& end) {
  const V path = end - query.start - query.h * obstacle.velocity;
  double least = std::numeric_limits<double>::infinity(), way = 0;
  const double length = path.norm();
  while (true) {
    const double here = obstacle.distance(query.start + (length > 0 ? way / length : 0) * path).distance;
    least = std::min(least, here);
    if (here <= 0 || way >= length) return least;
    way = std::min(way + std::max(here, 1e-5), length);
  }
}

TEST(ContactFinder, NoPathThroughAnObstacleIsMissed) {
  testing::Random random(1);
  int through = 0, missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const ContactQuery query = some_query(random);
    for (const Obstacle& obstacle : obstacles()) {
      if (least_distance(obstacle, query, query.end) > 0) continue;
      ++through;
      double slack = std::numeric_limits<double>::infinity();
      missed += !detail::find_contact(query, obstacle, reach_factor, nullptr, slack).has_value();
    }
  }
  EXPECT_GT(through, 5000);
  EXPECT_EQ(missed, 0) << "of " << through;
}

/// A point that was told that it has no contact may end by `slack` elsewhere, and still meets nothing on its way.
TEST(ContactFinder, SlackIsSafe) {
  testing::Random random(2);
  int tried = 0, hit = 0;
  for (int i = 0; i < 10000; ++i) {
    const ContactQuery query = some_query(random);
    for (const Obstacle& obstacle : obstacles()) {
      double slack = std::numeric_limits<double>::infinity();
      if (detail::find_contact(query, obstacle, reach_factor, nullptr, slack)) continue;
      ASSERT_GE(slack, 0);
      for (int k = 0; k < 3; ++k) {
        ++tried;
        hit += least_distance(obstacle, query, query.end + 0.999 * slack * random.vector().normalized()) <= 0;
      }
    }
  }
  EXPECT_GT(tried, 50000);
  EXPECT_EQ(hit, 0) << "of " << tried;
}

/// The plane of a contact keeps the point out: it has the obstacle behind it where the path meets it, and a gap that is
/// the distance there.
TEST(ContactFinder, AContactIsTheSurfaceThatThePathMeets) {
  testing::Random random(3);
  int found = 0;
  for (int i = 0; i < 10000; ++i) {
    const ContactQuery query = some_query(random);
    for (const Obstacle& obstacle : obstacles()) {
      double slack = 0;
      const auto contact = detail::find_contact(query, obstacle, reach_factor, nullptr, slack);
      if (!contact) continue;
      ++found;
      EXPECT_NEAR(contact->normal.norm(), 1, 1e-12);
      EXPECT_EQ(contact->start, query.start);
      EXPECT_LT((contact->led - query.h * obstacle.velocity).norm(), 1e-15);
      const SurfaceDistance there = obstacle.distance(contact->reference);
      EXPECT_NEAR(contact->measured_gap, there.distance, 1e-12);
      EXPECT_GE(contact->gap, -query.max_depenetration * query.h);
      EXPECT_GE(contact->gap, contact->measured_gap - 1e-15);
      const V way = contact->reference - query.start, path = detail::path_of(query, obstacle);
      if (way.norm() > 0) {
        EXPECT_NEAR(way.normalized().dot(path.normalized()), 1, 1e-9);
        EXPECT_LE(way.norm(), reach_factor * path.norm() * (1 + 1e-12));
      }
    }
  }
  EXPECT_GT(found, 5000);
}

/// A point of a thin plate leaves by the side on which it came in, also once it is past the middle.
TEST(ContactFinder, RemembersTheSideOfAThinObstacle) {
  testing::Random random(4);
  for (int i = 0; i < 500; ++i) {
    ObstacleOptions options;
    options.pose = {random.vector(), quaternion_of(random.rotation())};
    Obstacle plate(OrientedBox{{1, 1, 0.001}}, options);
    const V up = plate.to_world(V::UnitZ());
    PointContact first;
    first.normal = up;
    first.reference = plate.pose().position + 0.001 * up;
    first.given = 2.0 * up;
    const ContactMemory memory = detail::memory_of(first, plate, 0.01, 1);
    // It has moved and turned since.
    plate.set_pose({plate.pose().position + random.vector(), quaternion_of(random.rotation())});
    const V now = plate.to_world(V::UnitZ()), side = plate.to_world(V(random.uniform(-0.5, 0.5), 0.1, 0));
    for (const double depth : {0.0002, 0.0009, 0.0011, 0.0018, 0.003, 0.1}) {  // the plate ends at 0.002
      ContactQuery query{};
      query.start = query.end = plate.pose().position + (0.001 - depth) * now + side;
      query.h = 0.01;
      query.near_distance = near_distance;
      query.max_depenetration = 1;
      double slack = 0;
      const auto contact = detail::find_contact(query, plate, reach_factor, &memory, slack);
      ASSERT_TRUE(contact.has_value()) << depth;
      EXPECT_LT((contact->normal - now).norm(), 1e-9) << depth;
      EXPECT_NEAR(contact->measured_gap, -depth, 1e-12);
      EXPECT_NEAR(contact->gap, std::max(-depth, -0.01), 1e-12) << "deeper, it is led out at a bounded speed";
      EXPECT_NEAR(contact->multiplier, 200, 1e-9);
    }
  }
}

/// The friction of the last step turns with the surface and keeps its size.
TEST(ContactFinder, FrictionTurnsWithTheSurface) {
  testing::Random random(5);
  const Obstacle ball(Sphere{1}, {});
  for (int i = 0; i < 500; ++i) {
    const V before = random.vector().normalized(), axis = random.vector().normalized();
    PointContact first;
    first.normal = first.reference = before;
    first.given = 3.0 * before + first.tangential_part(random.vector());
    const ContactMemory memory = detail::memory_of(first, ball, 0.01, 0.5);
    EXPECT_NEAR(memory.force, 300, 1e-9);
    EXPECT_NEAR(memory.multiplier, 150, 1e-9);
    ContactQuery query{};
    query.start = query.end = rotation_by(random.uniform(0, 0.3) * axis) * before;
    query.h = 0.01;
    query.near_distance = near_distance;
    query.max_depenetration = 1;
    double slack = 0;
    const auto contact = detail::find_contact(query, ball, reach_factor, &memory, slack);
    ASSERT_TRUE(contact.has_value());
    EXPECT_NEAR(contact->anchor.dot(contact->normal), 0, 1e-9);
    EXPECT_NEAR(contact->anchor.norm(), memory.friction.norm(), 1e-9);
    EXPECT_GT(contact->anchor.dot(memory.friction), 0.9 * memory.friction.squaredNorm());
  }
}

}  // namespace
}  // namespace corotet::contact_finder_test
