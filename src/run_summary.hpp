// summary.json: what a run was, what it cost, and with what error.
#pragma once

#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/core/types.hpp>
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

/// Collects what contact reports of the steps.
class ContactStatistics {
 public:
  void add(const ContactReport& report);

  [[nodiscard]] Index unsettled() const { return unsettled_; }
  [[nodiscard]] Index dropped() const { return dropped_; }

  /// The value of the key "contact" of summary.json; `points`: that may touch.
  [[nodiscard]] Json summary(Index points) const;

 private:
  ContactReport last_;
  double passes_ = 0, deepest_ = 0;
  Index steps_ = 0, unsettled_ = 0, dropped_ = 0;
  int max_passes_ = 0;
};

/// An attachment, and how it pulled in the last step.
struct AttachmentFacts {
  Vec3<double> rest;                          ///< of the point that is tied, m
  Vec3<double> force = Vec3<double>::Zero();  ///< on the body, N
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
  Index contact_points = 0;  ///< 0: the body touches nothing
  ContactStatistics contact;
  std::vector<AttachmentFacts> attachments;
  std::string stopped_because;  ///< empty: it was completed
};

/// How each summary begins: program, scene, and whether the run was completed (`stopped_because` is empty).
[[nodiscard]] Json summary_head(const Scene& scene, const std::string& stopped_because);

/// Of a body, for summary.json: with the head, or with the name if it is one of several bodies.
[[nodiscard]] Json summary_of(const Scene& scene, const RunInput& input, const RunFacts& facts,
                              const StepStatistics& steps);

/// The text of summary.json.
[[nodiscard]] std::string format_json(const Json& summary);

}  // namespace corotet::program
