// Numbers that tell whether something has changed since.
#pragma once

#include <atomic>
#include <cstdint>

namespace corotet {

/// Different at every call, on any thread; never 0.
[[nodiscard]] inline std::uint64_t new_revision() {
  static std::atomic<std::uint64_t> last{0};
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

}  // namespace corotet
