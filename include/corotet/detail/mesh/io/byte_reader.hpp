// Numbers from binary data in memory: bounds-checked, in either byte order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/io/sticky_error.hpp>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

namespace corotet::inline v0_1::detail {

/// Reads values one after the other. A failure sticks (see StickyError); errors say "name@byte N".
class ByteReader : public StickyError {
 public:
  ByteReader(std::string_view bytes, std::string_view name, std::endian order = std::endian::little,
             std::size_t position = 0)
      : bytes_(bytes),
        name_(name),
        order_(order),
        position_((std::min)(position, bytes.size())),
        value_start_(position_) {}

  /// The next value of type `T`, in the file's byte order; `what` names it in errors.
  template <class T>
    requires std::integral<T> || std::floating_point<T>
  T read(std::string_view what) {
    const std::string_view source = take(sizeof(T), what);
    if (source.empty()) return T{};
    std::array<char, sizeof(T)> raw;
    std::copy(source.begin(), source.end(), raw.begin());
    if (order_ != std::endian::native) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

  /// A floating-point value that must be finite, as a double.
  template <std::floating_point T>
  double read_finite(std::string_view what) {
    const T value = read<T>(what);
    if (!std::isfinite(value)) {
      fail(std::string(what) + " is not a finite number", ErrorCode::non_finite_value);
      return 0;
    }
    return static_cast<double>(value);
  }

  /// A point: three finite values of type `T`.
  template <std::floating_point T>
  Vec3<double> read_point() {
    const double x = read_finite<T>("a coordinate"), y = read_finite<T>("a coordinate"),
                 z = read_finite<T>("a coordinate");
    return {x, y, z};
  }

  /// A number of items that follow, stored as a `T`, each of at least `bytes_each` bytes. Fails if the rest of the data
  /// is too short to hold them, so that memory for them can be reserved: a header's lie costs nothing.
  template <std::integral T>
  std::size_t count(std::string_view what, std::size_t bytes_each) {
    const T items = read<T>("the number of " + std::string(what));
    if constexpr (std::signed_integral<T>) {
      if (items < 0) {
        fail("announces " + std::to_string(items) + " " + std::string(what));
        return 0;
      }
    }
    return fits(static_cast<std::size_t>(items), what, bytes_each) ? static_cast<std::size_t>(items) : 0;
  }

  /// True if the rest of the data can hold `items` of `bytes_each` bytes.
  bool fits(std::size_t items, std::string_view what, std::size_t bytes_each) {
    if (!ok()) return false;
    const std::size_t room = bytes_each == 0 ? items : remaining() / bytes_each;
    const Misfit misfit = misfit_of(items, what, room, remaining());
    if (!misfit.reason.empty()) fail(misfit.reason, misfit.code);
    return misfit.reason.empty();
  }

  /// The next `size` bytes as they are; empty after a failure.
  std::string_view take(std::size_t size, std::string_view what) {
    if (!ok()) return {};
    value_start_ = position_;
    if (size > remaining()) {
      fail("the file ends within " + std::string(what));
      return {};
    }
    position_ += size;
    return bytes_.substr(value_start_, size);
  }

  void skip(std::size_t size, std::string_view what) { static_cast<void>(take(size, what)); }

  /// Records a failure here, unless there was one before.
  void fail(std::string reason, ErrorCode code = ErrorCode::malformed_file) {
    set_error(code, where(), std::move(reason));
  }

  /// The place of the last value: "name@byte N".
  [[nodiscard]] std::string where() const { return std::string(name_) + "@byte " + std::to_string(value_start_); }

  [[nodiscard]] std::string_view name() const { return name_; }
  [[nodiscard]] std::endian order() const { return order_; }
  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] std::size_t remaining() const { return bytes_.size() - position_; }
  [[nodiscard]] bool at_end() const { return !ok() || remaining() == 0; }

 private:
  std::string_view bytes_;
  std::string_view name_;
  std::endian order_;
  std::size_t position_;
  std::size_t value_start_;
};

}  // namespace corotet::inline v0_1::detail
