// Bytes as text (RFC 4648, section 4).
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

namespace corotet::inline v0_1::detail {

inline std::string to_base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t present = (std::min<std::size_t>)(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = (bits << 8) | (k < present ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= present ? digits[(bits >> (18 - 6 * k)) & 63] : '=';
  }
  return text;
}

}  // namespace corotet::inline v0_1::detail
