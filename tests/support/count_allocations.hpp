// Counts the program's heap allocations, the bytes they ask for, and those that are not freed yet. Include in one file
// of a test program only: it wraps malloc, which operator new uses.
#pragma once

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define COROTET_TEST_HAS_ASAN 1
#endif
#endif

namespace corotet::testing {
inline std::atomic<long> allocation_count{0}, allocated_bytes{0};
inline std::atomic<long> live_bytes{0};  ///< as the allocator rounds them

inline void count_allocation(std::size_t size) {
  ++allocation_count;
  allocated_bytes += static_cast<long>(size);
}
}

#if defined(COROTET_TEST_HAS_ASAN) || defined(__SANITIZE_ADDRESS__)
// The sanitizer owns malloc and tells of every allocation through a hook.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*, std::size_t),
                                                         void (*free_hook)(const volatile void*));
extern "C" std::size_t __sanitizer_get_allocated_size(const volatile void* memory);
namespace corotet::testing {
inline const int hooks_installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t size) {
      count_allocation(size);
      live_bytes += static_cast<long>(size);
    },
    [](const volatile void* memory) { live_bytes -= static_cast<long>(__sanitizer_get_allocated_size(memory)); });
}
#else
// glibc: the real allocator under its other name.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_calloc(std::size_t count, std::size_t size);
extern "C" void* __libc_realloc(void* old, std::size_t size);
extern "C" void* __libc_memalign(std::size_t alignment, std::size_t size);
extern "C" void __libc_free(void* memory);

namespace corotet::testing {
inline void* counted(void* memory, std::size_t size) {
  count_allocation(size);
  live_bytes += static_cast<long>(malloc_usable_size(memory));
  return memory;
}
}

extern "C" void* malloc(std::size_t size) { return corotet::testing::counted(__libc_malloc(size), size); }
extern "C" void* calloc(std::size_t count, std::size_t size) {
  return corotet::testing::counted(__libc_calloc(count, size), count * size);
}
extern "C" void* realloc(void* old, std::size_t size) {
  corotet::testing::live_bytes -= static_cast<long>(malloc_usable_size(old));
  return corotet::testing::counted(__libc_realloc(old, size), size);
}
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return corotet::testing::counted(__libc_memalign(alignment, size), size);
}
extern "C" int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  *out = corotet::testing::counted(__libc_memalign(alignment, size), size);
  return *out != nullptr ? 0 : 12;
}
extern "C" void free(void* memory) {
  corotet::testing::live_bytes -= static_cast<long>(malloc_usable_size(memory));
  __libc_free(memory);
}
#endif
