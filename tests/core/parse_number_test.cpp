#include <corotet/detail/core/parse_number.hpp>

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <clocale>
#include <cmath>
#include <corotet/detail/core/from_chars_by_strtod.hpp>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include "support/seeds.hpp"

#if __has_include(<fast_float/fast_float.h>)
#include <fast_float/fast_float.h>
#endif

namespace corotet {
namespace {

using detail::ParsedNumber;

ParsedNumber by_default(std::string_view text) { return detail::parse_number(text.data(), text.data() + text.size()); }
ParsedNumber by_strtod(std::string_view text) {
  return detail::parse_number(text.data(), text.data() + text.size(), detail::from_chars_by_strtod);
}
ParsedNumber by_fast_float([[maybe_unused]] std::string_view text) {
#if __has_include(<fast_float/fast_float.h>)
  return detail::parse_number(text.data(), text.data() + text.size(), [](const char* a, const char* b, double& value) {
    return fast_float::from_chars(a, b, value);
  });
#else
  return by_default(text);
#endif
}

/// What a reading is, in a form that compares: all NaN are one.
struct Reading {
  std::uint64_t bits;
  std::ptrdiff_t length;
  friend bool operator==(const Reading&, const Reading&) = default;
};
Reading reading(const ParsedNumber& parsed, std::string_view text) {
  const double value = std::isnan(parsed.value) ? std::nan("") : parsed.value;
  return {std::bit_cast<std::uint64_t>(value), parsed.end - text.data()};
}

void expect_agreement(const std::string& text) {
  const Reading expected = reading(by_default(text), text);
  EXPECT_EQ(reading(by_strtod(text), text), expected) << text;
  EXPECT_EQ(reading(by_fast_float(text), text), expected) << text;
}

std::string digits(std::mt19937_64& random, std::size_t most) {
  std::string text;
  for (std::size_t left = random() % (most + 1); left > 0; --left) text += static_cast<char>('0' + random() % 10);
  return text;
}

/// Each way to read a number reads the same: any double, short or with all its digits or with more of them.
TEST(ParseNumber, AllWaysAgreeOnNumbers) {
  testing::for_seeds(10, [](unsigned seed) {
    std::mt19937_64 random(seed);
    for (int i = 0; i < 2000; ++i) {
      const auto value = std::bit_cast<double>(random());
      std::array<char, 40> text;
      const int length = std::snprintf(text.data(), text.size(), "%.*e", static_cast<int>(random() % 25), value);
      expect_agreement(std::string(text.data(), static_cast<std::size_t>(length)));
    }
  });
}

/// The same of numbers at and beside the middle between two doubles, where rounding needs all digits.
TEST(ParseNumber, AllWaysAgreeOnTies) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t odd = (random() >> 10) | 1 | std::uint64_t{1} << 53;  // 54 bits, of which a double holds 53
    for (const char* behind : {"", ".0", ".00000000000000000000000000001", "e0", "e-15", "e20"})
      expect_agreement(std::to_string(odd) + behind);
    expect_agreement(std::to_string(odd - 1) + ".99999999999999999999999999999");
  }
  for (const char* text : {"9007199254740993", "9007199254740992.9999999999999999999999",
                           "9007199254740993.00000000001", "2.4703282292062327208e-324", "2.4703282292062328e-324",
                           "1.7976931348623158e308", "1.7976931348623159e308", "2.2250738585072011e-308", "8.5e-324"})
    expect_agreement(text);
}

/// The same of anything made of the letters of numbers, numbers or not; and each ends within the text.
TEST(ParseNumber, AllWaysAgreeOnAnyText) {
  constexpr std::string_view letters = "0123456789..--+eEinfatyNx( )_";
  testing::for_seeds(10, [&](unsigned seed) {
    std::mt19937_64 random(seed);
    for (int i = 0; i < 5000; ++i) {
      std::string text;
      for (std::size_t left = random() % 9; left > 0; --left) text += letters[random() % letters.size()];
      expect_agreement(text);
      expect_agreement((i % 2 ? "-" : "") + digits(random, 30) + (i % 3 ? "." : "") + digits(random, 30) +
                       (i % 5 ? "e" + std::string(i % 7 ? "-" : "") + digits(random, i % 11 ? 3 : 25) : ""));
    }
  });
  for (const char* text : {"inf",  "-inf",   "infinity", "INFINITYx", "infinit", "nan", "-nan", "nan(12_a)",
                           "nan(", "nan(-)", "0x10",     "-0",        "-0.0e-5", "1e",  "1e+",  "1e-",
                           "-",    "-.",     ".",        "",          " 1",      "+1",  "1.",   ".5e1x"})
    expect_agreement(text);
}

/// Out of range: infinite or zero by the size of the number, not by the sign of its exponent.
TEST(ParseNumber, OutOfRangeIsInfiniteOrZero) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::string zeros(400, '0');
  for (const auto& [text, value] :
       std::vector<std::pair<std::string, double>>{{"1e999", infinity},
                                                   {"-1e999", -infinity},
                                                   {"1e-999", 0.0},
                                                   {"1" + zeros, infinity},
                                                   {"-1" + zeros + "e-50", -infinity},
                                                   {"1" + zeros + ".5", infinity},
                                                   {"0." + zeros + "1", 0.0},
                                                   {"0." + zeros + "1e50", 0.0},
                                                   {"0." + zeros + "1e400", 0.1},
                                                   {"." + zeros + "1e800", infinity},
                                                   {zeros + "1e-999", 0.0},
                                                   {"1e99999999999999999999999999", infinity},
                                                   {"1e-99999999999999999999999999", 0.0},
                                                   {"0e99999999999999999999999999", 0.0}}) {
    for (const auto& parsed : {by_default(text), by_strtod(text), by_fast_float(text)}) {
      EXPECT_EQ(parsed.value, value) << text;
      EXPECT_EQ(parsed.end, text.data() + text.size()) << text;
    }
  }
}

/// A decimal comma in the program's locale changes nothing.
TEST(ParseNumber, IsTheSameInEveryLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  const char* found = nullptr;
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "German"})
    if (found == nullptr) found = std::setlocale(LC_ALL, name);
  EXPECT_EQ(by_strtod("1.5").value, 1.5);
  EXPECT_EQ(by_default("1.5").value, 1.5);
  EXPECT_EQ(by_strtod("1,5").value, 1.0);
  std::setlocale(LC_ALL, before.c_str());
  if (found == nullptr) GTEST_SKIP() << "no locale with a decimal comma is installed";
}

}  // namespace
}  // namespace corotet
