// Covering arrays: each two values of any two factors meet, in few choices, the same everywhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <tuple>
#include <vector>

#include "stress/pairwise.hpp"

namespace pairwise_test {
namespace {

using corotet::program::stress::Choice;
using corotet::program::stress::full_product;
using corotet::program::stress::pairwise;
using Levels = std::vector<std::size_t>;

/// Counts of values as the cases of `stress` have them, and others.
const std::vector<Levels> shapes{{2, 2, 3, 6, 5}, {2, 2, 3, 6, 3}, {2, 2, 3, 6, 1},
                                 {2, 2, 3, 2, 5}, {2, 2, 3, 2, 1}, {1, 1, 1, 1, 1},
                                 {1, 1, 3, 1, 5}, {7, 2},          {4},
                                 {3, 3, 3, 3}};

std::size_t product(const Levels& levels) {
  std::size_t product = 1;
  for (const std::size_t count : levels) product *= count;
  return product;
}

/// {factor, value, factor, value} of all pairs in these choices.
std::set<std::tuple<std::size_t, std::size_t, std::size_t, std::size_t>> pairs_of(const std::vector<Choice>& choices) {
  std::set<std::tuple<std::size_t, std::size_t, std::size_t, std::size_t>> pairs;
  for (const Choice& choice : choices)
    for (std::size_t a = 0; a < choice.size(); ++a)
      for (std::size_t b = a + 1; b < choice.size(); ++b) pairs.insert({a, choice[a], b, choice[b]});
  return pairs;
}

TEST(FullProduct, HasEachCombinationOnceInOrder) {
  for (const Levels& levels : shapes) {
    const auto all = full_product(levels);
    ASSERT_EQ(all.size(), product(levels));
    for (std::size_t i = 0; i < all.size(); ++i) {
      ASSERT_EQ(all[i].size(), levels.size());
      for (std::size_t factor = 0; factor < levels.size(); ++factor) EXPECT_LT(all[i][factor], levels[factor]);
      if (i > 0) {
        EXPECT_LT(all[i - 1], all[i]);
      }
    }
  }
  EXPECT_TRUE(full_product(Levels{2, 0, 3}).empty());
}

/// No array has fewer choices than two factors have pairs; greedy ones have a few more.
TEST(Pairwise, TriesEachPairInHardlyMoreChoicesThanItMust) {
  for (const Levels& levels : shapes) {
    Levels sorted = levels;
    std::sort(sorted.rbegin(), sorted.rend());
    const std::size_t least = sorted[0] * (sorted.size() > 1 ? sorted[1] : 1);
    const auto all = pairs_of(full_product(levels));
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      const auto choices = pairwise(levels, seed);
      EXPECT_EQ(pairs_of(choices), all) << "seed " << seed;
      EXPECT_GE(choices.size(), least);
      EXPECT_LE(choices.size(), least + 6) << "seed " << seed;
      EXPECT_EQ(std::set<Choice>(choices.begin(), choices.end()).size(), choices.size()) << "one stands there twice";
      EXPECT_TRUE(std::is_sorted(choices.begin(), choices.end()));
      EXPECT_EQ(choices.front(), Choice(levels.size(), 0)) << "the defaults";
    }
  }
}

/// Other pairs meet in a third value with another seed, so that different cases try different triples.
TEST(Pairwise, IsAnotherWithAnotherSeedAndTheSameWithTheSame) {
  const Levels levels{2, 2, 3, 6, 5};
  std::set<std::vector<Choice>> different;
  std::set<Choice> tried;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const auto choices = pairwise(levels, seed);
    EXPECT_EQ(pairwise(levels, seed), choices);
    different.insert(choices);
    tried.insert(choices.begin(), choices.end());
  }
  EXPECT_EQ(different.size(), 20U);
  EXPECT_GT(tried.size(), product(levels) * 3 / 4);
}

/// With any compiler and standard library.
TEST(Pairwise, IsTheSameEverywhere) {
  EXPECT_EQ(pairwise(Levels{2, 2, 3}, 2),
            (std::vector<Choice>{{0, 0, 0}, {0, 0, 1}, {0, 1, 2}, {1, 0, 2}, {1, 1, 0}, {1, 1, 1}}));
}

/// Where a factor has no value there is nothing to choose.
TEST(Pairwise, OfNothingIsNothing) { EXPECT_TRUE(pairwise(Levels{2, 0, 3}, 1).empty()); }

}  // namespace
}  // namespace pairwise_test
