#include "process_usage.hpp"

#include <ctime>
#include <fstream>
#include <string>
#if __has_include(<sys/resource.h>)
#include <sys/resource.h>
#endif

namespace corotet::program {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double peak_rss_mb() {
  // First choice: getrusage also counts what a parent process used before it became this program.
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    double kib = 0;
    if (key == "VmHWM:" && status >> kib) return kib / 1024;
    std::getline(status, key);
  }
#if __has_include(<sys/resource.h>)
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) {
#if defined(__APPLE__)
    return static_cast<double>(usage.ru_maxrss) / (1024 * 1024);  // bytes there, KiB elsewhere
#else
    return static_cast<double>(usage.ru_maxrss) / 1024;
#endif
  }
#endif
  return 0;
}

}  // namespace corotet::program
