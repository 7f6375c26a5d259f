// Lists of values tried in pairs in place of all combinations.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>

#include "stress/pairwise.hpp"

namespace corotet::testing {

/// Calls visit(a, b, ...) with a value of each list, so often that each two values of any two lists meet: see
/// program::stress::pairwise. Other seeds try other triples. Ends where a call fails fatally.
template <class Visit, class... Lists>
void for_pairs(std::uint32_t seed, const Visit& visit, const Lists&... lists) {
  const std::array<std::size_t, sizeof...(Lists)> levels{std::size(lists)...};
  const std::tuple<const Lists&...> all(lists...);
  for (const auto& choice : program::stress::pairwise(levels, seed)) {
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      visit(std::get<i>(all)[choice[i]]...);
    }(std::index_sequence_for<Lists...>());
    if (::testing::Test::HasFatalFailure()) return;
  }
}

/// A seed for each pair of scalar and element, so that typed tests try different triples.
template <class Scalar, class Element>
constexpr std::uint32_t seed_of = sizeof(Scalar) + std::uint32_t{Element::nodes};

}  // namespace corotet::testing
