#include "progress.hpp"

#include <fmt/core.h>

#include <cstdio>
#if defined(_WIN32)
#include <io.h>
#else
#include <unistd.h>
#endif

namespace corotet::program {
namespace {

bool stderr_is_terminal() {
#if defined(_WIN32)
  return _isatty(_fileno(stderr)) != 0;
#else
  return isatty(STDERR_FILENO) != 0;
#endif
}

}  // namespace

Progress::Progress(int steps) : on_(stderr_is_terminal()), steps_(steps), start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
  if (on_) fmt::print(stderr, "\r\033[K");  // clear the line
}

void Progress::show(int steps_done) { show(steps_done, fmt::format("step {}/{}", steps_done, steps_)); }

void Progress::show(int steps_done, const std::string& what) {
  const Clock::time_point now = Clock::now();
  if (!on_ || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  constexpr int width = 30;
  const double part = static_cast<double>(steps_done) / steps_;
  const auto filled = static_cast<std::size_t>(part * width);
  const std::string bar = std::string(filled, '=') + std::string(width - filled, ' ');
  const double left = std::chrono::duration<double>(now - start_).count() * (1 - part) / part;
  fmt::print(stderr, "\r[{}] {}{}\033[K", bar, what, part > 0 ? fmt::format(", {:.0f} s left", left) : "");
  std::fflush(stderr);
}

}  // namespace corotet::program
