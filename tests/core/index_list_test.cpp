// Lists of indices: sorted, and divided by an order, as the standard library does it.
#include <corotet/detail/core/index_list.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "support/random.hpp"

namespace corotet {
namespace {

using testing::Random;

/// Lengths about the gaps of the sort, and beyond all of them.
constexpr int lengths[] = {0, 1, 2, 3, 4, 5, 10, 24, 58, 131, 133, 302, 700, 701, 702, 3000};

/// `count` indices in [0, range).
std::vector<Index> random_list(Random& random, int count, double range) {
  std::vector<Index> list;
  for (int k = 0; k < count; ++k) list.push_back(static_cast<Index>(random.uniform(0, range)));
  return list;
}

TEST(IndexList, IsSortedAsByTheStandardLibraryAndHasEachIndexOnce) {
  Random random(1);
  for (const int count : lengths)
    for (const double range : {1.0, 7.0, 1e9}) {
      std::vector<Index> list = random_list(random, count, range), expected = list;
      std::sort(expected.begin(), expected.end());
      std::vector<Index> united = list;
      detail::sort(list.data(), list.size());
      EXPECT_EQ(list, expected) << count << " below " << range;
      const std::set<Index> once(expected.begin(), expected.end());
      detail::sort_and_unite(united);
      EXPECT_EQ(united, std::vector<Index>(once.begin(), once.end())) << count << " below " << range;
    }
}

TEST(IndexList, HasTheLeastInFrontWhateverTheirOrder) {
  Random random(2);
  for (const int count : lengths) {
    if (count == 0) continue;
    std::vector<Index> ascending;
    for (Index i = 0; i < count; ++i) ascending.push_back(i);
    const std::vector<Index> descending(ascending.rbegin(), ascending.rend());
    std::vector<double> key;  // a few values, so that the index decides between many
    for (Index i = 0; i < count; ++i) key.push_back(double(static_cast<Index>(random.uniform(0, 5))));
    const auto by_key = [&](Index a, Index b) {
      return key[at(a)] < key[at(b)] || (!(key[at(b)] < key[at(a)]) && a < b);
    };
    std::vector<Index> expected = ascending;
    std::sort(expected.begin(), expected.end(), by_key);
    for (const auto& start : {ascending, descending})
      for (const Index least : {Index{0}, Index{1}, count / 3, count / 2, count - 1}) {
        if (least >= count) continue;
        std::vector<Index> list = start;
        detail::put_in_front(list.data(), count, least, by_key);
        const auto middle = list.begin() + least;
        std::sort(list.begin(), middle, by_key);
        std::sort(middle, list.end(), by_key);
        EXPECT_EQ(list, expected) << least << " of " << count;
      }
  }
}

}  // namespace
}  // namespace corotet
