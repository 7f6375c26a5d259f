// How many bytes an object takes.
#pragma once

#include <cstddef>
#include <vector>

namespace corotet::inline v0_1 {

/// Bytes on the heap. `owned`: of the object alone, which each copy has again. `shared`: immutable, and held by all
/// copies together. Neither counts the object itself (sizeof), nor what the allocator adds to a block.
struct MemoryUse {
  std::size_t owned = 0;   ///< bytes of the object alone
  std::size_t shared = 0;  ///< bytes that all copies hold together

  friend MemoryUse operator+(const MemoryUse& a, const MemoryUse& b) {
    return {a.owned + b.owned, a.shared + b.shared};
  }
  /// Adds both counts.
  MemoryUse& operator+=(const MemoryUse& other) { return *this = *this + other; }
};

namespace detail {

template <class T>
[[nodiscard]] std::size_t bytes_of(const std::vector<T>& array) {
  return array.capacity() * sizeof(T);
}

}  // namespace detail

}  // namespace corotet::inline v0_1
