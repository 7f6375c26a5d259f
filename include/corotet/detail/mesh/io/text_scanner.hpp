// Tokens, lines and numbers from text in memory, the same in every locale.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <corotet/detail/core/parse_number.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/io/sticky_error.hpp>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

namespace corotet::inline v0_1::detail {

/// What a format adds to white space. '\0' means "none".
struct TextSyntax {
  char comment = '\0';    ///< starts a comment that ends with the line
  char separator = '\0';  ///< separates tokens as a space does, as the commas of .veg do
};

/// Reads tokens one after the other. A failure sticks (see StickyError); errors say "name:line".
class TextScanner : public StickyError {
 public:
  TextScanner(std::string_view text, std::string_view name, TextSyntax syntax = {})
      : text_(text), name_(name), syntax_(syntax) {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") position_ = 3;  // UTF-8 byte order mark
  }

  /// The next token, on this line or a later one; empty at the end of the text or after a failure.
  std::string_view token() {
    skip_blanks(true);
    return take_token();
  }

  /// The next token of this line; empty where the line ends.
  std::string_view token_on_line() {
    skip_blanks(false);
    return take_token();
  }

  /// The next token without taking it.
  [[nodiscard]] std::string_view peek() const {
    TextScanner ahead(*this);
    return ahead.token();
  }

  /// The rest of this line, comment included, without its line end; the scanner moves to the next line.
  std::string_view rest_of_line() {
    if (!ok()) return {};
    const std::size_t end = (std::min)(text_.find('\n', position_), text_.size());
    std::string_view rest = text_.substr(position_, end - position_);
    if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
    position_ = end;
    if (position_ < text_.size()) {
      ++position_;
      ++line_;
    }
    return rest;
  }

  /// Moves to the next line that holds a token. False at the end of the text.
  bool next_line() {
    rest_of_line();
    return !at_end();
  }

  /// True if only white space and comments are left, or after a failure.
  [[nodiscard]] bool at_end() {
    skip_blanks(true);
    return !ok() || position_ == text_.size();
  }

  /// True if only white space or a comment is left on this line.
  [[nodiscard]] bool at_line_end() {
    skip_blanks(false);
    return !ok() || position_ == text_.size() || text_[position_] == '\n';
  }

  /// The next token as a finite number; `what` names it in errors.
  double number(std::string_view what) { return to_number(token(), what); }
  double number_on_line(std::string_view what) { return to_number(token_on_line(), what); }

  /// The next token as an integer within [least, most].
  std::int64_t integer(std::string_view what, std::int64_t least = (std::numeric_limits<std::int64_t>::min)(),
                       std::int64_t most = (std::numeric_limits<std::int64_t>::max)()) {
    return to_integer(token(), what, least, most);
  }
  std::int64_t integer_on_line(std::string_view what, std::int64_t least = (std::numeric_limits<std::int64_t>::min)(),
                               std::int64_t most = (std::numeric_limits<std::int64_t>::max)()) {
    return to_integer(token_on_line(), what, least, most);
  }

  /// A point: three numbers.
  Vec3<double> point() {
    const double x = number("a coordinate"), y = number("a coordinate"), z = number("a coordinate");
    return {x, y, z};
  }

  /// A number of items that follow, each of at least `tokens_each` tokens. Fails if the rest of the text is too short
  /// to hold them, so that memory for them can be reserved: a header's lie costs nothing.
  std::size_t count(std::string_view what, std::size_t tokens_each) {
    const auto items = static_cast<std::size_t>(
        to_integer(token(), "the number of " + std::string(what), 0, (std::numeric_limits<std::int64_t>::max)()));
    return fits(items, what, tokens_each) ? items : 0;
  }

  /// True if the rest of the text can hold `items` times `tokens_each` tokens (a token and its separator: 2 bytes).
  bool fits(std::size_t items, std::string_view what, std::size_t tokens_each) {
    if (!ok()) return false;
    const std::size_t room = tokens_each == 0 ? items : (remaining() + 1) / 2 / tokens_each;
    const Misfit misfit = misfit_of(items, what, room, remaining());
    if (!misfit.reason.empty()) fail(misfit.reason, misfit.code);
    return misfit.reason.empty();
  }

  /// Moves to just behind the next occurrence of `mark`. Fails if there is none.
  bool skip_past(std::string_view mark) {
    if (!ok()) return false;
    const std::size_t found = text_.find(mark, position_);
    if (found == std::string_view::npos) {
      fail("expected " + quoted(mark) + " further on, but the file ends without it");
      return false;
    }
    const std::string_view skipped = text_.substr(position_, found - position_);
    line_ += static_cast<std::size_t>(std::count(skipped.begin(), skipped.end(), '\n'));
    position_ = found + mark.size();
    return true;
  }

  /// Takes the next token, which must be `keyword`.
  bool expect(std::string_view keyword) {
    const std::string_view found = token();
    if (ok() && found != keyword)
      fail("expected " + quoted(keyword) + ", found " + (found.empty() ? "the end of the file" : quoted(found)));
    return ok();
  }

  /// Numbers from tokens that the caller took itself.
  double to_number(std::string_view text, std::string_view what) {
    if (!has_token(text, what)) return 0;
    const auto [value, end] = parse_number(without_plus(text), text.data() + text.size());
    if (end != text.data() + text.size()) {
      fail(std::string(what) + " is " + quoted(text) + ", not a number");
      return 0;
    }
    if (!std::isfinite(value)) {
      fail(std::string(what) + " is " + quoted(text) + ", not a finite number", ErrorCode::non_finite_value);
      return 0;
    }
    return value;
  }

  std::int64_t to_integer(std::string_view text, std::string_view what, std::int64_t least, std::int64_t most) {
    if (!has_token(text, what)) return 0;
    std::int64_t value = 0;
    const auto [end, code] = std::from_chars(without_plus(text), text.data() + text.size(), value);
    if (end != text.data() + text.size() || code == std::errc::invalid_argument) {
      fail(std::string(what) + " is " + quoted(text) + ", not an integer");
      return 0;
    }
    if (code == std::errc::result_out_of_range || value < least || value > most) {
      fail(std::string(what) + " is " + quoted(text) + ", out of range");
      return 0;
    }
    return value;
  }

  /// Records a failure here, unless there was one before.
  void fail(std::string reason, ErrorCode code = ErrorCode::malformed_file) {
    set_error(code, where(), std::move(reason));
  }

  /// Takes over the failure of a scanner that read a part of the same file.
  void adopt(const Error& error) { set_error(error.code, error.where, error.reason); }

  /// The place of the last token: "name:line", or "name@byte N" once the scanner has jumped over binary data.
  [[nodiscard]] std::string where() const {
    return jumped_ ? std::string(name_) + "@byte " + std::to_string(token_start_)
                   : std::string(name_) + ":" + std::to_string(token_line_);
  }

  [[nodiscard]] std::string_view name() const { return name_; }
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] std::size_t remaining() const { return text_.size() - position_; }

  /// Goes on at a byte offset: formats that mix text and binary data.
  void seek(std::size_t position) {
    position_ = token_start_ = (std::min)(position, text_.size());
    jumped_ = true;
  }

 private:
  static const char* without_plus(std::string_view text) {
    const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
    return text.data() + (plus ? 1 : 0);
  }

  bool has_token(std::string_view text, std::string_view what) {
    if (ok() && text.empty()) fail(std::string(what) + " is missing");
    return ok();
  }

  [[nodiscard]] bool is_blank(char c) const {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || (c == syntax_.separator && c != '\0');
  }
  [[nodiscard]] bool is_comment(char c) const { return c == syntax_.comment && c != '\0'; }

  void skip_blanks(bool across_lines) {
    if (!ok()) return;
    while (position_ < text_.size()) {
      const char c = text_[position_];
      if (is_comment(c)) {
        position_ = (std::min)(text_.find('\n', position_), text_.size());
        continue;
      }
      if (c == '\n') {
        if (!across_lines) return;
        ++line_;
      } else if (!is_blank(c)) {
        return;
      }
      ++position_;
    }
  }

  std::string_view take_token() {
    if (!ok()) return {};
    token_start_ = position_;
    token_line_ = line_;
    while (position_ < text_.size() && text_[position_] != '\n' && !is_blank(text_[position_]) &&
           !is_comment(text_[position_]))
      ++position_;
    return text_.substr(token_start_, position_ - token_start_);
  }

  std::string_view text_;
  std::string_view name_;
  TextSyntax syntax_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
  std::size_t token_start_ = 0;
  std::size_t token_line_ = 1;
  bool jumped_ = false;
};

}  // namespace corotet::inline v0_1::detail
