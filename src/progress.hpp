// One line on a terminal that says how far a run is.
#pragma once

#include <chrono>
#include <string>

namespace corotet::program {

/// Writes to stderr, only if that is a terminal, at most ten times a second; takes the line away at the end.
class Progress {
 public:
  explicit Progress(int steps);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  void show(int steps_done);
  /// The same, with `what` is being done in place of the number of steps.
  void show(int steps_done, const std::string& what);

 private:
  using Clock = std::chrono::steady_clock;

  bool on_;
  int steps_;
  Clock::time_point start_, last_;
};

}  // namespace corotet::program
