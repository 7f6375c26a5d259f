// Numbers in messages.
#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <string>

namespace corotet::inline v0_1::detail {

/// As few digits as tell the number from its neighbours, the same in every locale: "-1e-09", "0.3".
[[nodiscard]] inline std::string number_text(std::floating_point auto value) {
  std::array<char, 40> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

}  // namespace corotet::inline v0_1::detail
