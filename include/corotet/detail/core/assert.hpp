// Misuse that a programmer can prevent is an assertion, with a handler that the host program can replace.
#pragma once

#include <corotet/detail/core/compiler.hpp>

namespace corotet::inline v0_1 {

/// Called when an assertion fails. `expression` is the source text, `message` says what the caller should change.
/// If the handler returns, the program goes on as if the check were not there.
using AssertHandler = void (*)(const char* expression, const char* message, const char* file, int line);

/// Stops in the debugger (SIGILL or SIGTRAP without one).
[[noreturn]] inline void trap_on_assert(const char*, const char*, const char*, int) {
#if defined(_MSC_VER)
  __debugbreak();
  for (;;) {
  }
#else
  __builtin_trap();
#endif
}

/// The handler in force, program-wide. Assign to replace it, before other threads use the library.
inline AssertHandler assert_handler = &trap_on_assert;

namespace detail {

COROTET_COLD inline void assertion_failed(const char* expression, const char* message, const char* file, int line) {
  assert_handler(expression, message, file, line);
}

}  // namespace detail

}  // namespace corotet::inline v0_1

// Checks are on unless NDEBUG is set; either way the layout of every type and every result stay the same.
#if defined(NDEBUG)
#define COROTET_ASSERT(expression, message) static_cast<void>(0)
#else
#define COROTET_ASSERT(expression, message) \
  ((expression) ? static_cast<void>(0) : ::corotet::detail::assertion_failed(#expression, message, __FILE__, __LINE__))
#endif
