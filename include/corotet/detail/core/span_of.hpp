// Vectors as spans.
#pragma once

#include <span>
#include <vector>

namespace corotet::inline v0_1::detail {

/// All entries of a vector. (Cheaper to compile than std::span's own conversion.)
template <class T>
[[nodiscard]] std::span<const T> span_of(const std::vector<T>& vector) {
  return {vector.data(), vector.size()};
}

}  // namespace corotet::inline v0_1::detail
