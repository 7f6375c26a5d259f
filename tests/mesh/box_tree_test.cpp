#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/mesh/box_tree.hpp>
#include <random>
#include <vector>

namespace corotet {
namespace {

using Points = std::vector<Vec3<double>>;

Vec3<double> random_vector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> coordinate(-size, size);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

/// Boxes of several characters: random, flat, all alike, nested, on a line, and a few far larger than the rest.
std::vector<std::vector<Box>> families(std::mt19937& random) {
  const auto around = [](const Vec3<double>& centre, const Vec3<double>& half) {
    Box box;
    box.add(centre - half.cwiseAbs());
    box.add(centre + half.cwiseAbs());
    return box;
  };
  std::vector<std::vector<Box>> all(7);
  for (int i = 0; i < 500; ++i) {
    const Vec3<double> centre = random_vector(random, 1), half = random_vector(random, 0.1);
    all[0].push_back(around(centre, half));
    all[1].push_back(around({centre[0], centre[1], 0}, {half[0], half[1], 0}));
    all[2].push_back(around({0.25, 0.5, -0.25}, {0.25, 0.125, 0.5}));
    all[3].push_back(around({0, 0, 0}, Vec3<double>::Constant(i / 500.0)));
    all[4].push_back(around({i / 250.0 - 1, 0, 0}, {1 / 500.0, 0, 0}));
    all[5].push_back(around(centre, half * (i % 50 == 0 ? 10 : 0.1)));
  }
  all[6].push_back(around({0, 0, 0}, {1, 1, 1}));
  return all;
}

TEST(BoxTree, FindsTheSameContainingBoxesAsBruteForce) {
  std::mt19937 random(1);
  Index found_in_all = 0;
  for (const std::vector<Box>& boxes : families(random)) {
    const detail::BoxTree tree(boxes);
    for (int q = 0; q < 200; ++q) {
      Vec3<double> p = random_vector(random, 1.1);
      if (q % 4 == 0) p = boxes[at(q) % boxes.size()].low;  // corners belong to the box
      if (q % 4 == 1) p[2] = 0;
      std::vector<Index> expected, found;
      for (Index i = 0; i < size_of(boxes); ++i)
        if (boxes[at(i)].contains(p)) expected.push_back(i);
      tree.for_each_containing(p, [&](Index i) { found.push_back(i); });
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, expected);
      found_in_all += size_of(found);
    }
  }
  EXPECT_GT(found_in_all, 1000);
}

TEST(BoxTree, FindsTheSameNearestDistanceAsBruteForce) {
  std::mt19937 random(2);
  for (const std::vector<Box>& boxes : families(random)) {
    // The primitive in each box: a point of it, farther than the box itself from almost everywhere.
    Points primitives;
    for (const Box& box : boxes) {
      const Vec3<double> t = random_vector(random, 0.5) + Vec3<double>::Constant(0.5);
      primitives.push_back(box.low + t.cwiseProduct(box.high - box.low));
    }
    const detail::BoxTree tree(boxes);
    for (int q = 0; q < 200; ++q) {
      const Vec3<double> p = random_vector(random, q % 2 == 0 ? 1 : 20);
      const auto squared_distance = [&](Index i) { return (primitives[at(i)] - p).squaredNorm(); };
      double expected = squared_distance(0);
      for (Index i = 1; i < size_of(boxes); ++i) expected = std::min(expected, squared_distance(i));
      const detail::NearestPrimitive nearest = tree.nearest(p, squared_distance);
      EXPECT_EQ(nearest.squared_distance, expected);
      ASSERT_NE(nearest.primitive, detail::NearestPrimitive::none);
      EXPECT_EQ(squared_distance(nearest.primitive), expected);
    }
  }
}

TEST(BoxTree, BoundsEverything) {
  std::mt19937 random(3);
  for (const std::vector<Box>& boxes : families(random)) {
    Box all;
    for (const Box& box : boxes) all.add(box);
    EXPECT_EQ(detail::BoxTree(boxes).bounds().low, all.low);
    EXPECT_EQ(detail::BoxTree(boxes).bounds().high, all.high);
  }
}

TEST(BoxTree, EmptyTreeFindsNothing) {
  const detail::BoxTree tree{std::vector<Box>{}};
  EXPECT_TRUE(tree.empty());
  EXPECT_EQ(tree.for_each_containing({0, 0, 0}, [](Index) { FAIL(); }), 0);
  const detail::NearestPrimitive nearest = tree.nearest({0, 0, 0}, [](Index) { return 0.0; });
  EXPECT_EQ(nearest.primitive, detail::NearestPrimitive::none);
  EXPECT_TRUE(std::isinf(nearest.squared_distance));
}

/// Boxes looked at by an average query in a cube filled with n^3 cells.
double visits_per_query(Index n, bool nearest) {
  std::vector<Box> boxes;
  for (Index i = 0; i < n * n * n; ++i) {
    Box box;
    box.add(Vec3<double>(i % n, i / n % n, i / n / n) / n);
    box.add(box.low + Vec3<double>::Constant(1.0 / n));
    boxes.push_back(box);
  }
  const detail::BoxTree tree(boxes);
  std::mt19937 random(4);
  std::int64_t visited = 0;
  constexpr int queries = 500;
  for (int q = 0; q < queries; ++q) {
    const Vec3<double> p = random_vector(random, 0.5) + Vec3<double>::Constant(0.5);
    visited += nearest ? tree.nearest(p, [&](Index i) { return boxes[at(i)].squared_distance(p); }).visited
                       : tree.for_each_containing(p, [](Index) {});
  }
  return double(visited) / queries;
}

TEST(BoxTree, QueriesCostTheLogarithmOfTheSize) {
  for (const bool nearest : {false, true}) {
    // 64 times as many boxes add 6 levels.
    const double small = visits_per_query(8, nearest), large = visits_per_query(32, nearest);
    EXPECT_LT(large, small + 6 * 8) << small;
    EXPECT_LT(large, 10 * std::log2(32.0 * 32 * 32)) << small;
  }
}

}  // namespace
}  // namespace corotet
