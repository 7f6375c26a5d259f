// Numbers of one kind side by side, as many as were asked for.
#pragma once

#include <corotet/detail/core/compiler.hpp>
#include <cstddef>
#include <cstring>
#include <new>
#include <type_traits>
#include <utility>

namespace corotet::inline v0_1::detail {

/// Bytes on a boundary of 64.
class RawBuffer {
 public:
  RawBuffer() = default;
  COROTET_NOINLINE explicit RawBuffer(std::size_t size)
      : data_(size == 0 ? nullptr : ::operator new(size, std::align_val_t{alignment})), size_(size) {}
  RawBuffer(const RawBuffer& other) : RawBuffer(other.size_) {
    if (size_ > 0) std::memcpy(data_, other.data_, size_);
  }
  RawBuffer(RawBuffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  /// Allocates only where the sizes differ.
  RawBuffer& operator=(const RawBuffer& other) {
    if (this == &other) return *this;
    if (size_ != other.size_) return *this = RawBuffer(other);
    if (size_ > 0) std::memcpy(data_, other.data_, size_);
    return *this;
  }
  RawBuffer& operator=(RawBuffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  COROTET_NOINLINE ~RawBuffer() {
    if (data_ != nullptr) ::operator delete(data_, std::align_val_t{alignment});
  }

  [[nodiscard]] COROTET_NOINLINE static RawBuffer zeros(std::size_t size) {
    RawBuffer buffer(size);
    if (size > 0) std::memset(buffer.data_, 0, size);
    return buffer;
  }

  [[nodiscard]] void* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

  static constexpr std::size_t alignment = 64;

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

/// What a std::vector is for arrays of plain numbers that are made once and then written to, at a tenth of the compile
/// time for each type of entry.
template <class T>
class Buffer {
 public:
  using value_type = T;
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  static_assert(alignof(T) <= RawBuffer::alignment);

  Buffer() = default;
  /// Entries as T() makes them: numbers are 0.
  explicit Buffer(std::size_t count)
    requires(std::is_trivially_default_constructible_v<T>)
      : bytes_(RawBuffer::zeros(count * sizeof(T))) {}
  explicit Buffer(std::size_t count) : Buffer(count, T()) {}
  Buffer(std::size_t count, const T& value) : bytes_(count * sizeof(T)) {
    for (std::size_t i = 0; i < count; ++i) ::new (static_cast<void*>(data() + i)) T(value);
  }

  /// Replaces all entries; allocates only where there were more or fewer.
  void assign(std::size_t count, const T& value) {
    if (count != size())
      *this = Buffer(count, value);
    else
      for (T& entry : *this) entry = value;
  }

  /// As many entries, with any values: a copy whose pages are touched where they are written first.
  [[nodiscard]] Buffer without_values() const {
    Buffer copy;
    copy.bytes_ = RawBuffer(bytes_.size());
    return copy;
  }

  /// Makes the number of entries that of `other`, and leaves their values open; allocates only where it differs.
  void fit(const Buffer& other) {
    if (bytes_.size() != other.bytes_.size()) *this = other.without_values();
  }

  [[nodiscard]] std::size_t size() const { return bytes_.size() / sizeof(T); }
  [[nodiscard]] bool empty() const { return bytes_.size() == 0; }
  [[nodiscard]] T* data() { return static_cast<T*>(bytes_.data()); }
  [[nodiscard]] const T* data() const { return static_cast<const T*>(bytes_.data()); }
  [[nodiscard]] T& operator[](std::size_t i) { return data()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data()[i]; }
  [[nodiscard]] T& front() { return *data(); }
  [[nodiscard]] const T& front() const { return *data(); }
  [[nodiscard]] T* begin() { return data(); }
  [[nodiscard]] const T* begin() const { return data(); }
  [[nodiscard]] T* end() { return data() + size(); }
  [[nodiscard]] const T* end() const { return data() + size(); }

 private:
  RawBuffer bytes_;
};

/// Scratch memory: a Buffer whose values mean nothing between two calls of its owner, so that copies have as many
/// entries and no values. Copying it costs no time but that of the allocation.
template <class T>
class Scratch : public Buffer<T> {
 public:
  Scratch() = default;
  explicit Scratch(std::size_t count) : Buffer<T>(count) {}
  Scratch(const Scratch& other) : Buffer<T>(other.without_values()) {}
  Scratch(Scratch&&) noexcept = default;
  Scratch& operator=(const Scratch& other) {
    this->fit(other);
    return *this;
  }
  Scratch& operator=(Scratch&&) noexcept = default;
  ~Scratch() = default;
};

template <class T>
[[nodiscard]] std::size_t bytes_of(const Buffer<T>& buffer) {
  return buffer.size() * sizeof(T);
}

}  // namespace corotet::inline v0_1::detail
