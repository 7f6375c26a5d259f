// The first thing that went wrong while reading a file.
#pragma once

#include <corotet/core/result.hpp>
#include <string>
#include <string_view>
#include <utility>

namespace corotet::detail {

/// Text from a file, made fit for a message: short, and without bytes that a terminal would obey.
inline std::string quoted(std::string_view text) {
  constexpr std::size_t most = 40;
  std::string out = "'";
  for (const char c : text.substr(0, most)) out += (c < ' ' || c > '~') ? '?' : c;
  return out + (text.size() > most ? "...'" : "'");
}

/// Base of the scanners. The first failure sticks: every later read returns zero or nothing at once, so that a reader
/// need not test each number, only each record, and before it returns its result.
class StickyError {
 public:
  [[nodiscard]] bool ok() const { return !failed_; }
  [[nodiscard]] const Error& error() const {
    COROTET_ASSERT(failed_, "nothing has failed, so there is no error to read");
    return error_;
  }

 protected:
  void set_error(ErrorCode code, std::string where, std::string reason) {
    if (failed_) return;
    failed_ = true;
    error_ = Error{code, std::move(where), std::move(reason)};
  }

 private:
  bool failed_ = false;
  Error error_;
};

}  // namespace corotet::detail
