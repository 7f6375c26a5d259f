// For tests that hand numbers to the library of which infinities are made: see floating_point_traps.cpp.
#pragma once

#include <fenv.h>

namespace corotet::testing {

/// No traps while it lives.
class WithoutTraps {
 public:
  WithoutTraps() {
#if defined(__GLIBC__)
    enabled_ = fegetexcept();
    fedisableexcept(FE_ALL_EXCEPT);
#endif
  }
  ~WithoutTraps() {
#if defined(__GLIBC__)
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(enabled_);
#endif
  }
  WithoutTraps(const WithoutTraps&) = delete;
  WithoutTraps& operator=(const WithoutTraps&) = delete;

 private:
  [[maybe_unused]] int enabled_ = 0;
};

}  // namespace corotet::testing
