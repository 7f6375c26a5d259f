#include "process_usage.hpp"

#include <ctime>
#include <fstream>
#include <string>
#if defined(__GLIBC__)
#include <malloc.h>
#endif
#if __has_include(<sys/resource.h>)
#include <sys/resource.h>
#endif

namespace corotet::program {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

namespace {

/// A memory figure of Linux's /proc, MiB; 0 if there is none.
double status_mb(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    double kib = 0;
    if (key == name && status >> kib) return kib / 1024;
    std::getline(status, key);
  }
  return 0;
}

}  // namespace

double current_rss_mb() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
  return status_mb("VmRSS:");
}

void reset_peak_rss() { std::ofstream("/proc/self/clear_refs") << "5"; }

double peak_rss_mb() {
  // First choice: getrusage also counts what a parent process used before it became this program.
  if (const double peak = status_mb("VmHWM:"); peak > 0) return peak;
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
