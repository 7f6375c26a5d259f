// A member that lies elsewhere.
#pragma once

#include <memory>
#include <utility>

namespace corotet::inline v0_1::detail {

/// Owns a T and copies it with itself. A class that holds its parts so is moved by one pointer, not part by part in
/// each file that moves it.
template <class T>
class DeepPointer {
 public:
  DeepPointer() : value_(std::make_unique<T>()) {}
  explicit DeepPointer(T value) : value_(std::make_unique<T>(std::move(value))) {}
  DeepPointer(const DeepPointer& other) : value_(other.value_ ? std::make_unique<T>(*other.value_) : nullptr) {}
  DeepPointer(DeepPointer&&) noexcept = default;
  DeepPointer& operator=(const DeepPointer& other) {
    if (this != &other) *this = DeepPointer(other);
    return *this;
  }
  DeepPointer& operator=(DeepPointer&&) noexcept = default;
  ~DeepPointer() = default;

  [[nodiscard]] T& operator*() { return *value_; }
  [[nodiscard]] const T& operator*() const { return *value_; }
  [[nodiscard]] T* operator->() { return value_.get(); }
  [[nodiscard]] const T* operator->() const { return value_.get(); }

 private:
  std::unique_ptr<T> value_;  // empty only after a move
};

}  // namespace corotet::inline v0_1::detail
