// Words and numbers put together to the text of an error.
#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/result.hpp>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>

namespace corotet::inline v0_1::detail {

/// A piece of a message. Text is referred to, not copied.
struct MessagePart {
  MessagePart(const char* words) : text(words), size(to_the_zero) {}  // NOLINT(google-explicit-constructor)
  MessagePart(std::string_view words)                                 // NOLINT(google-explicit-constructor)
      : text(words.data()), size(std::ptrdiff_t(words.size())) {}
  MessagePart(const std::string& words)  // NOLINT(google-explicit-constructor)
      : MessagePart(std::string_view(words)) {}
  template <std::integral Integer>
  // NOLINTNEXTLINE(google-explicit-constructor)
  MessagePart(Integer value) : integer(static_cast<long long>(value)), size(is_integer) {}
  MessagePart(double value) : real(value), size(is_real) {}  // NOLINT(google-explicit-constructor)

  static constexpr std::ptrdiff_t to_the_zero = -1, is_integer = -2, is_real = -3;

  union {
    const char* text;
    long long integer;
    double real;
  };
  std::ptrdiff_t size;  ///< of the text, or one of these
};

/// The parts one after the other; real numbers with as few digits as tell them from their neighbours, the same in every
/// locale.
[[nodiscard]] COROTET_COLD inline std::string message(std::initializer_list<MessagePart> parts) {
  std::string all;
  for (const MessagePart& part : parts) {
    std::array<char, 40> digits;
    char* const end = digits.data() + digits.size();
    const char* text = part.text;
    std::ptrdiff_t size = part.size;
    if (size == MessagePart::to_the_zero) size = std::ptrdiff_t(std::strlen(text));
    if (size < 0) {
      text = digits.data();
      size = (size == MessagePart::is_integer ? std::to_chars(digits.data(), end, part.integer)
                                              : std::to_chars(digits.data(), end, part.real))
                 .ptr -
             text;
    }
    all.append(text, std::size_t(size));
  }
  return all;
}

[[nodiscard]] COROTET_COLD inline OptionalError error(ErrorCode code, std::initializer_list<MessagePart> where,
                                                      std::initializer_list<MessagePart> reason) {
  return OptionalError(Error{code, message(where), message(reason)});
}
/// The same of one part each.
[[nodiscard]] COROTET_COLD inline OptionalError error(ErrorCode code, const char* where, const char* reason) {
  return error(code, std::initializer_list<MessagePart>{where}, std::initializer_list<MessagePart>{reason});
}

}  // namespace corotet::inline v0_1::detail
