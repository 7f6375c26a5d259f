// An immutable object that copies hold together.
#pragma once

#include <atomic>
#include <utility>

namespace corotet::inline v0_1::detail {

/// A std::shared_ptr<const T> made by std::make_shared, at a fifth of its compile time for each T.
template <class T>
class Shared {
 public:
  Shared() = default;
  template <class... Arguments>
  [[nodiscard]] static Shared make(Arguments&&... arguments) {
    return Shared(new Node(std::forward<Arguments>(arguments)...));
  }
  Shared(const Shared& other) : node_(other.node_) {
    if (node_ != nullptr) node_->owners.fetch_add(1, std::memory_order_relaxed);
  }
  Shared(Shared&& other) noexcept : node_(std::exchange(other.node_, nullptr)) {}
  Shared& operator=(Shared other) noexcept {
    std::swap(node_, other.node_);
    return *this;
  }
  ~Shared() {
    if (node_ != nullptr && node_->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete node_;
  }

  [[nodiscard]] explicit operator bool() const { return node_ != nullptr; }
  [[nodiscard]] const T& operator*() const { return node_->value; }
  [[nodiscard]] const T* operator->() const { return &node_->value; }

 private:
  struct Node {
    std::atomic<long> owners{1};
    const T value;

    template <class... Arguments>
    explicit Node(Arguments&&... arguments) : value(std::forward<Arguments>(arguments)...) {}
  };

  explicit Shared(Node* node) : node_(node) {}

  Node* node_ = nullptr;
};

}  // namespace corotet::inline v0_1::detail
