// Words and numbers put together to the text of an error.
#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/result.hpp>
#include <initializer_list>
#include <string>
#include <string_view>

namespace corotet::inline v0_1::detail {

/// A piece of a message. Text is referred to, not copied.
struct MessagePart {
  MessagePart(const char* words) : text(words) {}         // NOLINT(google-explicit-constructor)
  MessagePart(std::string_view words) : text(words) {}    // NOLINT(google-explicit-constructor)
  MessagePart(const std::string& words) : text(words) {}  // NOLINT(google-explicit-constructor)
  template <std::integral Integer>
  // NOLINTNEXTLINE(google-explicit-constructor)
  MessagePart(Integer value) : integer(static_cast<long long>(value)), kind(Kind::integer) {}
  MessagePart(double value) : real(value), kind(Kind::real) {}  // NOLINT(google-explicit-constructor)

  enum class Kind : char { text, integer, real };

  std::string_view text;
  long long integer = 0;
  double real = 0;
  Kind kind = Kind::text;
};

/// The parts one after the other; real numbers with as few digits as tell them from their neighbours, the same in every
/// locale.
[[nodiscard]] COROTET_COLD inline std::string message(std::initializer_list<MessagePart> parts) {
  std::string all;
  for (const MessagePart& part : parts) {
    std::array<char, 40> digits;
    char* const end = digits.data() + digits.size();
    if (part.kind == MessagePart::Kind::text)
      all += part.text;
    else if (part.kind == MessagePart::Kind::integer)
      all.append(digits.data(), std::to_chars(digits.data(), end, part.integer).ptr);
    else
      all.append(digits.data(), std::to_chars(digits.data(), end, part.real).ptr);
  }
  return all;
}

[[nodiscard]] COROTET_COLD inline Error error(ErrorCode code, std::initializer_list<MessagePart> where,
                                              std::initializer_list<MessagePart> reason) {
  return {code, message(where), message(reason)};
}

}  // namespace corotet::inline v0_1::detail
