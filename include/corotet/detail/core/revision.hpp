// Marks that tell whether something has changed since.
#pragma once

#include <atomic>
#include <cstdint>

namespace corotet::inline v0_1 {

/// One state of something, another than any other in the program. Without a state of its own (the default) it equals no
/// other but that.
struct Revision {
  const void* module = nullptr;  ///< of the program that numbered it: shared libraries may count each for itself
  std::uint64_t number = 0;      ///< counted from 1; 0: none

  friend bool operator==(const Revision&, const Revision&) = default;
};

namespace detail {

/// Another at every call, on any thread, in any shared library.
[[nodiscard]] inline Revision new_revision() {
  static std::atomic<std::uint64_t> last{0};
  return {&last, last.fetch_add(1, std::memory_order_relaxed) + 1};
}

/// Of what lies in Scratch memory, whose copies have no values: copies have no state.
struct ScratchRevision : Revision {
  ScratchRevision() = default;
  ScratchRevision(const Revision& revision) : Revision(revision) {}  // NOLINT(google-explicit-constructor): as one
  ScratchRevision(const ScratchRevision&) : Revision() {}  // NOLINT(bugprone-copy-constructor-init): as it says
  ScratchRevision(ScratchRevision&&) noexcept = default;
  ScratchRevision& operator=(const ScratchRevision&) {  // NOLINT(cert-oop54-cpp): of itself too
    static_cast<Revision&>(*this) = {};
    return *this;
  }
  ScratchRevision& operator=(ScratchRevision&&) noexcept = default;
  ~ScratchRevision() = default;
};

}  // namespace detail

}  // namespace corotet::inline v0_1
