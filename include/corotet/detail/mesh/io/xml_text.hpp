// Names as XML attribute values.
#pragma once

#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/sticky_error.hpp>
#include <string>
#include <string_view>

namespace corotet::inline v0_1::detail {

/// `text` (UTF-8) fit to stand between double quotes. Errors: invalid_argument if it is empty or holds a control
/// character, which XML 1.0 (section 2.2) cannot express.
inline Result<std::string> xml_attribute(std::string_view text, std::string_view what) {
  if (text.empty()) return Error{ErrorCode::invalid_argument, std::string(what), "it must not be empty"};
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7F)
      return Error{ErrorCode::invalid_argument, std::string(what), quoted(text) + " holds a control character"};
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&apos;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace corotet::inline v0_1::detail
