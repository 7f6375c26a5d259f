// Where the time of a step goes.
#pragma once

#include <chrono>
#include <corotet/detail/dynamics/step_phase.hpp>

namespace corotet::program {

/// Observes the phases of a step with a clock: start it before a step, stop it after.
class PhaseClock {
 public:
  void start() {
    total_ms_ = solve_ms_ = 0;
    in_solve_ = false;
    last_ = Clock::now();
  }

  void operator()(StepPhase phase) {
    add_interval();
    in_solve_ = phase == StepPhase::solve;
  }

  void stop() { add_interval(); }

  [[nodiscard]] double total_ms() const { return total_ms_; }
  [[nodiscard]] double solve_ms() const { return solve_ms_; }
  /// Everything but the solve: rotations, forces, matrix, right-hand side, new state.
  [[nodiscard]] double assembly_ms() const { return total_ms_ - solve_ms_; }

 private:
  using Clock = std::chrono::steady_clock;

  void add_interval() {
    const Clock::time_point now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    total_ms_ += ms;
    if (in_solve_) solve_ms_ += ms;
  }

  Clock::time_point last_;
  double total_ms_ = 0, solve_ms_ = 0;
  bool in_solve_ = false;
};

}  // namespace corotet::program
