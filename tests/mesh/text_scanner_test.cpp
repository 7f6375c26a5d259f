#include <corotet/detail/mesh/io/text_scanner.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <corotet/detail/mesh/io/byte_reader.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/text_writer.hpp>
#include <limits>
#include <random>
#include <string>

#include "mesh/mesh_files.hpp"

namespace corotet {
namespace {

using detail::ByteReader;
using detail::TextScanner;
using detail::TextWriter;

TEST(TextScanner, TokensLinesAndComments) {
  TextScanner in("\xEF\xBB\xBF a b,c # d\r\n\n  e#f\ng", "n", {.comment = '#', .separator = ','});
  EXPECT_EQ(in.token(), "a");
  EXPECT_EQ(in.peek(), "b");
  EXPECT_EQ(in.token_on_line(), "b");
  EXPECT_EQ(in.token_on_line(), "c");
  EXPECT_TRUE(in.at_line_end());
  EXPECT_EQ(in.token_on_line(), "");
  EXPECT_EQ(in.token(), "e");
  EXPECT_EQ(in.where(), "n:3");
  EXPECT_TRUE(in.next_line());
  EXPECT_EQ(in.rest_of_line(), "g");
  EXPECT_TRUE(in.at_end());
  EXPECT_EQ(in.token(), "");
  EXPECT_TRUE(in.ok());
}

/// What a number must be: all of the token, finite, a '+' allowed.
TEST(TextScanner, Numbers) {
  const auto number = [](std::string_view text) {
    TextScanner in(text, "n");
    const double value = in.number("it");
    return in.ok() ? value : std::numeric_limits<double>::quiet_NaN();
  };
  EXPECT_EQ(number("+1.5"), 1.5);
  EXPECT_EQ(number("-.5e-1"), -0.05);
  EXPECT_EQ(number("1e-999"), 0.0);
  EXPECT_EQ(number("0." + std::string(400, '0') + "1"), 0.0);
  EXPECT_EQ(number("4.9406564584124654e-324"), std::numeric_limits<double>::denorm_min());
  for (const std::string bad :
       {"", "+", "-", "+-1", "++1", "1e", "1.5x", "0x10", "1,5", "nan", "-inf", "1e999", "1d5", "--1", "e5", "."})
    EXPECT_TRUE(std::isnan(number(bad))) << bad;
  EXPECT_TRUE(std::isnan(number(std::string(400, '9'))));
}

TEST(TextScanner, IntegersAndTheirRange) {
  const auto fails = [](std::string_view text, std::int64_t least, std::int64_t most) {
    TextScanner in(text, "n");
    in.integer("it", least, most);
    return !in.ok();
  };
  EXPECT_FALSE(fails("+5", 0, 5));
  EXPECT_FALSE(fails("-9223372036854775808", std::numeric_limits<std::int64_t>::min(), 0));
  for (const std::string bad : {"6", "-1", "5.0", "9223372036854775808", "1e3", "", "five"})
    EXPECT_TRUE(fails(bad, 0, 5)) << bad;
}

/// A count is accepted exactly if the rest of the text could hold that many tokens.
TEST(TextScanner, CountsAreBoundedByTheText) {
  for (std::size_t tokens : {1u, 4u}) {
    for (std::size_t items = 0; items < 20; ++items) {
      std::string text = std::to_string(items);
      for (std::size_t i = 0; i < 10; ++i) text += " 1";
      TextScanner in(text, "n");
      in.count("items", tokens);
      EXPECT_EQ(in.ok(), items * tokens <= 10) << items << " of " << tokens;
    }
  }
  TextScanner most("9223372036854775807 1", "n");
  EXPECT_EQ(most.count("items", 1000000), 0u);
  EXPECT_FALSE(most.ok());
}

TEST(TextScanner, FirstFailureSticks) {
  TextScanner in("1\nx\n3 4", "file");
  EXPECT_EQ(in.number("a"), 1.0);
  EXPECT_EQ(in.number("b"), 0.0);
  EXPECT_EQ(in.number("c"), 0.0);
  EXPECT_EQ(in.token(), "");
  EXPECT_TRUE(in.at_end());
  in.fail("later");
  EXPECT_EQ(in.error().message(), "file:2: b is 'x', not a number");
}

TEST(TextScanner, MessagesHoldNoControlBytes) {
  const std::string text = std::string(1, '\x1b') + "[31m" + std::string(100, 'z');
  TextScanner in(text, "n");
  in.number("it");
  EXPECT_LT(in.error().reason.size(), 80u);
  for (const char c : in.error().reason) EXPECT_TRUE(c >= ' ' && c <= '~');
}

TEST(TextWriter, NumbersReadBackExactly) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20000; ++i) {
    const auto value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    TextWriter out;
    out << value;
    const std::string text = out.take();
    TextScanner in(text, "n");
    EXPECT_EQ(std::bit_cast<std::uint64_t>(in.number("it")), std::bit_cast<std::uint64_t>(value)) << text;
  }
}

TEST(ByteReader, BothByteOrders) {
  const std::string bytes("\1\2\3\4\5\6\7\10", 8);
  EXPECT_EQ(ByteReader(bytes, "n", std::endian::little).read<std::uint32_t>("it"), 0x04030201u);
  EXPECT_EQ(ByteReader(bytes, "n", std::endian::big).read<std::uint32_t>("it"), 0x01020304u);
  EXPECT_EQ(ByteReader(bytes, "n", std::endian::big).read<std::uint64_t>("it"), 0x0102030405060708u);
  EXPECT_EQ(ByteReader(bytes, "n", std::endian::little, 6).read<std::int16_t>("it"), 0x0807);
}

TEST(ByteReader, EndsAndCounts) {
  const std::string bytes("\2\0\0\0\1\1\1\1\377\377\377\377", 12);
  ByteReader in(bytes, "n");
  EXPECT_EQ(in.count<std::uint32_t>("items", 4), 2u);
  in.skip(4, "items");
  EXPECT_EQ(in.count<std::int32_t>("items", 1), 0u);
  EXPECT_EQ(in.error().where, "n@byte 8");
  ByteReader past(bytes, "n", std::endian::little, 9);
  EXPECT_EQ(past.read<std::uint32_t>("it"), 0u);
  EXPECT_EQ(past.error().message(), "n@byte 9: the file ends within it");
  ByteReader huge(bytes, "n", std::endian::little, 8);
  EXPECT_EQ(huge.count<std::uint32_t>("items", 1), 0u);
  EXPECT_FALSE(huge.ok());
}

TEST(FileBytes, AnyContentComesBack) {
  const TemporaryFolder folder;
  std::string content;
  for (int i = 0; i < 300000; ++i) content += static_cast<char>(i * 7 % 256);
  for (const std::string& bytes : {std::string{}, std::string("\0\r\n\x1a", 4), content}) {
    ASSERT_TRUE(write_file(folder / "file", bytes));
    const auto back = read_file(folder / "file");
    ASSERT_TRUE(back) << back.error().message();
    EXPECT_TRUE(*back == bytes);
  }
}

}  // namespace
}  // namespace corotet
