// States as bytes that the caller owns: how they are measured, written, checked and read.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/matrix.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Goes through the numbers of a state. A class of which a snapshot tells has one function
/// `visit_state(StateArchive&)` that names its state once, for all modes. Numbers are little-endian, floating-point
/// ones IEEE 754: the same bytes on every platform.
class StateArchive {
 public:
  enum class Mode : std::uint8_t {
    measure,  ///< counts bytes
    write,
    compare,  ///< goes through bytes and compares what must agree, changes nothing
    read      ///< replaces the state
  };

  StateArchive() = default;  // measures
  explicit StateArchive(std::span<std::byte> out) : mode_(Mode::write), out_(out) {}
  StateArchive(std::span<const std::byte> in, Mode mode) : mode_(mode), in_(in) {}

  [[nodiscard]] bool reads() const { return mode_ == Mode::read; }
  /// Bytes so far.
  [[nodiscard]] std::size_t size() const { return place_; }
  /// No byte was missing, and all that must agree did.
  [[nodiscard]] bool ok() const { return ok_; }
  /// FNV-1a of the bytes so far (Fowler, Noll & Vo 1991).
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

  template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void operator()(T& number) {
    numbers(&number, sizeof(T), 1);
  }
  template <class Scalar, int R, int C>
  void operator()(Matrix<Scalar, R, C>& matrix) {
    numbers(matrix.data(), sizeof(Scalar), at(R * C));
  }
  /// Numbers or matrices side by side, as many as there are now: another length is another state's.
  template <class T>
  void operator()(std::vector<T>& several) {
    range(several.data(), several.size());
  }
  template <class T>
  void operator()(Buffer<T>& several) {
    range(several.data(), several.size());
  }
  template <class T, std::size_t n>
  void operator()(std::array<T, n>& several) {
    for (T& each : several) (*this)(each);
  }

  template <class T>
    requires requires(T& object, StateArchive& archive) { object.visit_state(archive); }
  void operator()(T& object) {
    object.visit_state(*this);
  }

  /// A list whose length is part of the state.
  template <class T>
  void list(std::vector<T>& several) {
    std::uint64_t count = several.size();
    numbers(&count, sizeof count, 1, true);
    if (mode_ == Mode::compare) return skip(count, sizeof(T));
    if (mode_ == Mode::read) several.resize(as_size(count));
    for (T& each : several) (*this)(each);
  }

  /// Numbers side by side whose count is part of the state: that which was written.
  template <class T>
  std::size_t some(T* first, std::size_t count) {
    std::uint64_t stored = count;
    numbers(&stored, sizeof stored, 1, true);
    numbers(first, sizeof(T), as_size(stored));
    return as_size(stored);
  }

  /// What must be the same when it is read.
  void expect(std::uint64_t value) {
    std::uint64_t stored = value;
    numbers(&stored, sizeof stored, 1, true);
    if (mode_ == Mode::compare && stored != value) ok_ = false;
  }

 private:
  template <class T>
  void range(T* first, std::size_t count) {
    expect(count);
    if constexpr (std::is_arithmetic_v<T>) {
      numbers(first, sizeof(T), count);
    } else if constexpr (requires { first->data()[0]; }) {
      if (count > 0) numbers(first->data(), sizeof(first->data()[0]), count * sizeof(T) / sizeof(first->data()[0]));
    } else {
      for (std::size_t i = 0; i < count; ++i) (*this)(first[i]);
    }
  }

  /// A count on this machine; a template, as the cast is none where numbers of both kinds are the same.
  template <class Count>
  [[nodiscard]] static std::size_t as_size(Count count) {
    return static_cast<std::size_t>(count);
  }

  /// `always`: read also where only checked.
  void numbers(void* data, std::size_t size, std::size_t count, bool always = false) {
    if (mode_ != Mode::measure && count > (mode_ == Mode::write ? out_.size() : in_.size()) / size) {
      ok_ = false;
      return;
    }
    const std::size_t bytes = size * count;
    auto* const object = static_cast<std::byte*>(data);
    if (mode_ == Mode::write && bytes <= out_.size() - place_) {
      copy(out_.data() + place_, object, size, count);
      add_to_hash(out_.data() + place_, bytes);
    } else if ((mode_ == Mode::read || mode_ == Mode::compare) && ok_ && bytes <= in_.size() - place_) {
      if (mode_ == Mode::read || always) copy(object, in_.data() + place_, size, count);
      add_to_hash(in_.data() + place_, bytes);
    } else if (mode_ != Mode::measure) {
      ok_ = false;
      return;
    }
    place_ += bytes;
  }

  void skip(std::uint64_t count, std::size_t size) {
    if (!ok_ || count > (in_.size() - place_) / size) {
      ok_ = false;
      return;
    }
    const std::size_t bytes = as_size(count) * size;
    add_to_hash(in_.data() + place_, bytes);
    place_ += bytes;
  }

  static void copy(std::byte* to, const std::byte* from, std::size_t size, std::size_t count) {
    if (count == 0) return;
    if constexpr (std::endian::native == std::endian::little) {
      std::memcpy(to, from, size * count);
    } else {
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t b = 0; b < size; ++b) to[i * size + b] = from[i * size + size - 1 - b];
    }
  }

  void add_to_hash(const std::byte* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) hash_ = (hash_ ^ static_cast<std::uint64_t>(bytes[i])) * 1099511628211u;
  }

  Mode mode_ = Mode::measure;
  std::span<std::byte> out_;
  std::span<const std::byte> in_;
  std::size_t place_ = 0;
  std::uint64_t hash_ = 14695981039346656037u;
  bool ok_ = true;
};

/// FNV-1a of numbers, the same on every platform.
class Fingerprint {
 public:
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(std::int32_t number) { add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(number))); }
  void add(std::uint64_t bits) {
    for (int byte = 0; byte < 8; ++byte) value_ = (value_ ^ ((bits >> (8 * byte)) & 0xff)) * 1099511628211u;
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037u;
};

/// Whether `known` is the revision `now`: so again after it is read, where revisions have other numbers.
inline void visit_revision(StateArchive& archive, Revision& known, const Revision& now) {
  bool same = known == now;
  archive(same);
  if (archive.reads()) known = same ? now : Revision{};
}

}  // namespace corotet::inline v0_1::detail
