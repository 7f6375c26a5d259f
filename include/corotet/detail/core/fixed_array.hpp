// Objects side by side, as many as room was made for.
#pragma once

#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <cstddef>
#include <new>
#include <utility>

namespace corotet::inline v0_1::detail {

/// What a std::vector is for a few large objects that are made once and stay where they are, at a fraction of the code:
/// nothing is ever moved.
template <class T>
class FixedArray {
 public:
  FixedArray() = default;
  explicit FixedArray(std::size_t capacity)
      : data_(capacity == 0 ? nullptr
                            : static_cast<T*>(::operator new(capacity * sizeof(T), std::align_val_t{alignof(T)}))),
        capacity_(capacity) {}
  COROTET_COLD FixedArray(const FixedArray& other) : FixedArray(other.capacity_) {
    for (const T& each : other) emplace_back(each);
  }
  FixedArray(FixedArray&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)),
        capacity_(std::exchange(other.capacity_, 0)),
        size_(std::exchange(other.size_, 0)) {}
  FixedArray& operator=(FixedArray other) noexcept {
    std::swap(data_, other.data_);
    std::swap(capacity_, other.capacity_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~FixedArray() {
    if (data_ != nullptr) destroy();
  }

  /// There must be room.
  template <class... Arguments>
  T& emplace_back(Arguments&&... arguments) {
    COROTET_ASSERT(size_ < capacity_, "no room for more");
    return *::new (static_cast<void*>(data_ + size_++)) T(std::forward<Arguments>(arguments)...);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] T& operator[](std::size_t i) { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data_[i]; }
  [[nodiscard]] T& front() { return *data_; }
  [[nodiscard]] const T& front() const { return *data_; }
  [[nodiscard]] T* begin() { return data_; }
  [[nodiscard]] const T* begin() const { return data_; }
  [[nodiscard]] T* end() { return data_ + size_; }
  [[nodiscard]] const T* end() const { return data_ + size_; }

 private:
  COROTET_COLD void destroy() {
    for (std::size_t i = 0; i < size_; ++i) data_[i].~T();
    ::operator delete(static_cast<void*>(data_), std::align_val_t{alignof(T)});
  }

  T* data_ = nullptr;
  std::size_t capacity_ = 0, size_ = 0;
};

}  // namespace corotet::inline v0_1::detail
