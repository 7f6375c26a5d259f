// Ends a test program at the first operation whose result is not a number, or infinite: nothing in the library may
// count on such a result. glibc only. Not with Clang, which assumes that nothing traps, and moves divisions to before
// the tests that guard them.
#include <fenv.h>

#if defined(__GLIBC__) && !defined(__clang__)
namespace {

[[maybe_unused]] const int trapping = feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);

}  // namespace
#endif
