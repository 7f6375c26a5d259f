// summary.json: what a run was, what it cost, and with what error.
#pragma once

#include <corotet/detail/dynamics/step_report.hpp>
#include <optional>
#include <string>
#include <vector>

#include "json_file.hpp"
#include "phase_clock.hpp"
#include "run_input.hpp"
#include "scene.hpp"
#include "simulation.hpp"
#include "step_counts.hpp"

namespace corotet::program {

/// Collects what the steps report.
class StepStatistics {
 public:
  explicit StepStatistics(int steps);

  void add(const StepReport& report, const PhaseClock& clock, double cpu_s);

  [[nodiscard]] const StepCounts& counts() const { return counts_; }
  [[nodiscard]] double worst_newton_residual() const { return worst_newton_residual_; }
  [[nodiscard]] Index inverted_elements() const { return last_.inverted_elements; }
  [[nodiscard]] double worst_residual() const { return worst_residual_; }
  [[nodiscard]] double median_step_ms() const;

  /// Adds the keys of summary.json that come from the steps.
  void write_to(Json& summary) const;

 private:
  std::vector<double> step_ms_, assembly_ms_, solve_ms_;
  double cpu_s_ = 0;
  double iterations_ = 0, newton_iterations_ = 0;
  int max_newton_iterations_ = 0;
  double sub_steps_ = 0;
  int max_sub_steps_ = 0;
  double worst_residual_ = 0, worst_newton_residual_ = 0;
  StepCounts counts_;
  Index max_inverted_ = 0;
  StepReport last_;
};

/// What is known of a run besides its steps.
struct RunFacts {
  SimulationFacts simulation;
  int threads = 1;
  Index pinned_vertices = 0;
  double setup_ms = 0;
  double peak_rss_mb = 0;
  double spmv_us = 0;
  std::optional<BindingFacts> surface;
  std::string stopped_because;  ///< empty: it was completed
};

/// The text of summary.json.
[[nodiscard]] std::string format_summary(const Scene& scene, const RunInput& input, const RunFacts& facts,
                                         const StepStatistics& steps);

}  // namespace corotet::program
