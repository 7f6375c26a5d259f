// std::from_chars of double for standard libraries that have none, by the C library.
#pragma once

#include <locale.h>  // NOLINT(modernize-deprecated-headers): newlocale and _create_locale are not in <clocale>

#include <charconv>
#include <cstdlib>
#include <limits>
#include <string>
#include <system_error>
#if __has_include(<xlocale.h>) && !defined(_WIN32)
#include <xlocale.h>  // strtod_l of macOS and FreeBSD
#endif

namespace corotet::inline v0_1::detail {

/// Where the decimal number at `first` ends; `first` if there is none. An optional '-', digits with a point before,
/// between or behind them, an optional exponent with its optional sign.
[[nodiscard]] inline const char* end_of_decimal(const char* first, const char* last) {
  const auto skip_digits = [last](const char* p) {
    while (p != last && *p >= '0' && *p <= '9') ++p;
    return p;
  };
  const char* const start = first != last && *first == '-' ? first + 1 : first;
  const char* p = skip_digits(start);
  auto digits = p - start;
  if (p != last && *p == '.') {
    const char* const fraction = p + 1;
    p = skip_digits(fraction);
    digits += p - fraction;
  }
  if (digits == 0) return first;
  if (p != last && (*p == 'e' || *p == 'E')) {
    const char* exponent = p + 1;
    if (exponent != last && (*exponent == '+' || *exponent == '-')) ++exponent;
    const char* const behind = skip_digits(exponent);
    if (behind != exponent) p = behind;
  }
  return p;
}

/// A word that means infinity or "not a number", with an optional '-': "inf", "infinity", "nan" and "nan(...)" in small
/// and capital letters.
[[nodiscard]] inline std::from_chars_result from_chars_non_finite(const char* first, const char* last, double& value) {
  const bool negative = first != last && *first == '-';
  const char* const start = negative ? first + 1 : first;
  const auto skip_word = [last](const char* p, const char* word) -> const char* {
    for (; *word != '\0'; ++p, ++word)
      if (p == last || (*p != *word && *p != *word - 'a' + 'A')) return nullptr;
    return p;
  };
  const double infinity = std::numeric_limits<double>::infinity();
  if (const char* p = skip_word(start, "inf")) {
    const char* const longer = skip_word(p, "inity");
    value = negative ? -infinity : infinity;
    return {longer != nullptr ? longer : p, std::errc{}};
  }
  if (const char* p = skip_word(start, "nan")) {
    const char* q = p;
    if (q != last && *q == '(') {
      ++q;
      while (q != last &&
             ((*q >= '0' && *q <= '9') || (*q >= 'a' && *q <= 'z') || (*q >= 'A' && *q <= 'Z') || *q == '_'))
        ++q;
      if (q != last && *q == ')') p = q + 1;
    }
    value = std::numeric_limits<double>::quiet_NaN();
    return {p, std::errc{}};
  }
  return {first, std::errc::invalid_argument};
}

/// The C library's strtod in the "C" locale, whatever locale the program has set.
[[nodiscard]] inline double strtod_in_c_locale(const char* text) {
#if defined(_WIN32)
  static const _locale_t c_locale = _create_locale(LC_ALL, "C");
  return _strtod_l(text, nullptr, c_locale);
#else
  static const locale_t c_locale = newlocale(LC_ALL_MASK, "C", nullptr);
  return strtod_l(text, nullptr, c_locale);
#endif
}

/// As std::from_chars, but that numbers out of range succeed: too large is infinite, too small is zero.
[[nodiscard]] inline std::from_chars_result from_chars_by_strtod(const char* first, const char* last, double& value) {
  const char* const end = end_of_decimal(first, last);
  if (end == first) return from_chars_non_finite(first, last, value);
  value = strtod_in_c_locale(std::string(first, end).c_str());
  return {end, std::errc{}};
}

}  // namespace corotet::inline v0_1::detail
