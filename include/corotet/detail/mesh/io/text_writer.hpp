// Text into memory, the same in every locale.
#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <corotet/detail/core/types.hpp>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

namespace corotet::inline v0_1::detail {

/// Appends to one string; `<<` as with streams, but without locale, flags or separators.
class TextWriter {
 public:
  TextWriter& operator<<(std::string_view text) {
    out_ += text;
    return *this;
  }
  TextWriter& operator<<(const char* text) { return *this << std::string_view(text); }
  TextWriter& operator<<(char c) {
    out_ += c;
    return *this;
  }
  /// Floating-point numbers get as many digits (up to 17 for double) as reading them back exactly takes.
  template <class T>
    requires(std::integral<T> || std::floating_point<T>)
  TextWriter& operator<<(T value) {
    std::array<char, 32> digits;
    const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    out_.append(digits.data(), result.ptr);
    return *this;
  }
  TextWriter& operator<<(const Vec3<double>& p) { return *this << p[0] << ' ' << p[1] << ' ' << p[2]; }

  /// The value as it lies in memory: the binary parts of formats that state their byte order.
  template <class T>
    requires(std::integral<T> || std::floating_point<T>)
  void raw(T value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    out_.append(bytes.data(), bytes.size());
  }

  void reserve(std::size_t bytes) { out_.reserve(bytes); }
  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

}  // namespace corotet::inline v0_1::detail
