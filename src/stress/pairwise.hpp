// Lists of configurations: all of them, or few that try each pair of values of two factors.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

namespace corotet::program::stress {

/// For each factor the number of its value.
using Choice = std::vector<std::size_t>;

/// All combinations, the last factor fastest. `levels`: how many values each factor has.
[[nodiscard]] inline std::vector<Choice> full_product(std::span<const std::size_t> levels) {
  std::vector<Choice> all{Choice()};
  for (const std::size_t count : levels) {
    std::vector<Choice> longer;
    for (const Choice& choice : all)
      for (std::size_t value = 0; value < count; ++value) {
        longer.push_back(choice);
        longer.back().push_back(value);
      }
    all = std::move(longer);
  }
  return all;
}

/// The pairs of values of two factors that no choice has tried yet.
class UntriedPairs {
 public:
  explicit UntriedPairs(std::span<const std::size_t> levels) : starts_(levels.size()) {
    std::size_t values = 0;
    for (std::size_t factor = 0; factor < levels.size(); ++factor) {
      starts_[factor] = values;
      values += levels[factor];
    }
    side_ = values;
    tried_.assign(values * values, false);
  }

  [[nodiscard]] std::size_t count_in(const Choice& choice) const {
    std::size_t count = 0;
    for_pairs(choice, [&](std::size_t pair) { count += tried_[pair] ? 0 : 1; });
    return count;
  }
  void remove(const Choice& choice) {
    for_pairs(choice, [&](std::size_t pair) { tried_[pair] = true; });
  }

 private:
  template <class Visit>
  void for_pairs(const Choice& choice, const Visit& visit) const {
    for (std::size_t a = 0; a < choice.size(); ++a)
      for (std::size_t b = a + 1; b < choice.size(); ++b)
        visit((starts_[a] + choice[a]) * side_ + starts_[b] + choice[b]);
  }

  std::vector<std::size_t> starts_;  // of each factor among the values of all
  std::size_t side_ = 0;
  std::vector<bool> tried_;
};

/// A covering array of strength two, in the order of full_product: each two values of any two factors meet in a choice.
/// The choice of all first values, which are the defaults, is among them. Greedy: each next choice is the one with most
/// new pairs, which chance decides among equals (Cohen, Dalal, Fredman & Patton 1997). `seed` makes the same array
/// everywhere; another makes another.
[[nodiscard]] inline std::vector<Choice> pairwise(std::span<const std::size_t> levels, std::uint32_t seed) {
  std::vector<Choice> candidates = full_product(levels);
  if (candidates.size() < 2 || levels.size() < 2) return candidates;
  std::mt19937 random(seed);
  for (std::size_t i = candidates.size() - 1; i > 1; --i)  // the defaults stay first
    std::swap(candidates[i], candidates[1 + random() % i]);
  UntriedPairs untried(levels);
  std::vector<Choice> chosen;
  for (auto next = candidates.begin(); untried.count_in(*next) > 0;) {
    chosen.push_back(*next);
    untried.remove(*next);
    next = std::max_element(candidates.begin(), candidates.end(), [&](const Choice& a, const Choice& b) {
      return untried.count_in(a) < untried.count_in(b);
    });
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace corotet::program::stress
