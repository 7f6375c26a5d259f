// Checks that hold whatever the bytes, with or without NDEBUG.
#pragma once

#include <corotet/detail/core/result.hpp>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace corotet::fuzz {

inline void check(bool holds) {
  if (!holds) __builtin_trap();
}

inline int check_error(const Error& error) {
  check(!error.where.empty());
  check(!error.reason.empty());
  return 0;
}

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace corotet::fuzz
