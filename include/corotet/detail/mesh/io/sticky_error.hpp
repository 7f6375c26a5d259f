// The first thing that went wrong while reading a file.
#pragma once

#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

namespace corotet::inline v0_1::detail {

/// Text from a file, made fit for a message: short, and without bytes that a terminal would obey.
inline std::string quoted(std::string_view text) {
  constexpr std::size_t most = 40;
  std::string out = "'";
  for (const char c : text.substr(0, most)) out += (c < ' ' || c > '~') ? '?' : c;
  return out + (text.size() > most ? "...'" : "'");
}

struct Misfit {
  std::string reason;
  ErrorCode code = ErrorCode::malformed_file;
};

/// Why an announced number of items cannot be true where there is room for `room` of them; an empty reason if it can.
inline Misfit misfit_of(std::size_t items, std::string_view what, std::size_t room, std::size_t bytes_left) {
  if (items > room)
    return {"announces " + std::to_string(items) + " " + std::string(what) + ", but only " +
            std::to_string(bytes_left) + " bytes follow"};
  if (items > static_cast<std::size_t>((std::numeric_limits<Index>::max)()))
    return {"has more " + std::string(what) + " than 32-bit indices can number", ErrorCode::unsupported};
  return {};
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

}  // namespace corotet::inline v0_1::detail
