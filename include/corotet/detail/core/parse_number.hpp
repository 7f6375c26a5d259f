// A number from text, the same in every locale and by every standard library.
#pragma once

#include <charconv>
#include <cstdint>
#include <limits>
#include <system_error>
#include <version>

// libc++ has no std::from_chars of double: there fast_float stands in where it is found, else the C library.
#if defined(__cpp_lib_to_chars) && __cpp_lib_to_chars >= 201611L
namespace corotet::inline v0_1::detail {
inline constexpr auto from_chars_of_double = [](const char* first, const char* last, double& value) {
  return std::from_chars(first, last, value);
};
}  // namespace corotet::inline v0_1::detail
#elif __has_include(<fast_float/fast_float.h>)
#include <corotet/detail/core/macros_off.hpp>

#include <fast_float/fast_float.h>

#include <corotet/detail/core/macros_on.hpp>
namespace corotet::inline v0_1::detail {
inline constexpr auto from_chars_of_double = [](const char* first, const char* last, double& value) {
  return fast_float::from_chars(first, last, value);
};
}  // namespace corotet::inline v0_1::detail
#else
#include <corotet/detail/core/from_chars_by_strtod.hpp>
namespace corotet::inline v0_1::detail {
inline constexpr auto from_chars_of_double = from_chars_by_strtod;
}  // namespace corotet::inline v0_1::detail
#endif

namespace corotet::inline v0_1::detail {

/// What a text begins with. Where that is no number, `end` is where the text begins.
struct ParsedNumber {
  double value = 0;  ///< too large is infinite, too small is zero
  const char* end = nullptr;
};

/// Whether the decimal number [first, end) is at least 1: tells too large from too small where that is all that is left
/// to know.
[[nodiscard]] inline bool is_at_least_one(const char* first, const char* end) {
  constexpr std::int64_t bound = std::int64_t{1} << 50;  // above the length of any text; greater exponents count as it
  std::int64_t exponent = 0, place = 0;                  // `place`: of the first digit that is not zero, 0: the ones
  bool seen = false, behind_point = false;
  const char* p = first != end && *first == '-' ? first + 1 : first;
  for (; p != end && *p != 'e' && *p != 'E'; ++p) {
    if (*p == '.') {
      behind_point = true;
    } else if (seen) {
      if (!behind_point) ++place;
    } else if (*p != '0') {
      seen = true;
      if (behind_point) --place;
    } else if (behind_point) {
      --place;
    }
  }
  if (!seen) return false;
  if (p != end) ++p;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  for (; p != end; ++p)
    if (exponent < bound) exponent = 10 * exponent + (*p - '0');
  return place + (negative ? -exponent : exponent) >= 0;
}

/// The number that [first, last) begins with: decimal, with a '-' but no '+' and no white space before it; "inf" and
/// "nan" are numbers. It is rounded to the nearest. `from_chars` may be another function that does as std::from_chars.
template <class FromChars = decltype(from_chars_of_double)>
[[nodiscard]] ParsedNumber parse_number(const char* first, const char* last,
                                        const FromChars& from_chars = from_chars_of_double) {
  double value = 0;
  const auto [end, code] = from_chars(first, last, value);
  if (code == std::errc::invalid_argument) return {0, first};
  if (code == std::errc::result_out_of_range) {  // which does not say which way, and need not set the value
    value = is_at_least_one(first, end) ? std::numeric_limits<double>::infinity() : 0.0;
    if (*first == '-') value = -value;
  }
  return {value, end};
}

}  // namespace corotet::inline v0_1::detail
