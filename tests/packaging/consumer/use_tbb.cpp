#include <atomic>
#include <corotet/tbb.hpp>

// Runs before main; a wrong result ends the program, which the test sees.
static const bool all_tasks_ran = [] {
  std::atomic<corotet::Index> sum{0};
  corotet::TbbExecutor{}(100, [&](corotet::Index i) { sum += i; });
  return sum == 4950 ? true : (__builtin_trap(), false);
}();
