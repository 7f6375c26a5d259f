#include "body_run.hpp"

#include <fmt/core.h>

#include <chrono>
#include <corotet/detail/dynamics/step_report.hpp>
#include <cstddef>
#include <cstdio>

#include "phase_clock.hpp"
#include "problems.hpp"
#include "process_usage.hpp"

namespace corotet::program {
namespace {

/// What messages about one of several bodies begin with.
std::string label(const Scene& scene) { return scene.name.empty() ? "" : fmt::format("body {}: ", scene.name); }

}  // namespace

BodyRun::BodyRun(const Scene& scene, Obstacles& obstacles, int threads, ThreadPool& pool)
    : scene_(scene), input_(read_input(scene)), statistics_(scene.steps) {
  facts_.threads = threads;
  const auto start = std::chrono::steady_clock::now();
  simulation_ = make_simulation(scene, input_.mesh);
  facts_.pinned_vertices = set_up(*simulation_, scene, input_);
  facts_.setup_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  facts_.simulation = simulation_->facts();
  if (input_.surface) {
    Problems problems(scene.file.string(), scene.key_prefix);
    facts_.surface = problems.take("surface", simulation_->bind(*input_.surface, pool));
    problems.stop_if_any();
  }
  contact_ = set_up_contact(*simulation_, scene, obstacles);
  facts_.contact_points = contact_.points;
  for (const PointOnBody& point : contact_.attached)
    facts_.attachments.push_back({place_of(point, [&](Index v) { return input_.mesh.positions[at(v)]; })});
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) fmt::print(stderr, "corotet: note: {}\n", note);
}

void BodyRun::print_notes() const {
  program::print_notes(input_.notes);
  if (facts_.simulation.flipped_elements > 0)
    fmt::print(stderr, "corotet: note: {}: {} of {} elements were wound the other way round and have been turned\n",
               scene_.mesh.string(), facts_.simulation.flipped_elements, facts_.simulation.elements);
}

void BodyRun::begin_output(OutputFolder& run) {
  output_ = has_name() ? &own_folder_.emplace(run.path() / body_folder(scene_.name)) : &run;
  record(0);
}

void BodyRun::record(int step) {
  const double t = step * scene_.dt;
  output_->add_probes(t, *simulation_, input_.probes);
  std::vector<AttachmentState> attachments;
  for (std::size_t i = 0; i < contact_.attached.size(); ++i)
    attachments.push_back({place_of(contact_.attached[i], [&](Index v) { return simulation_->position(v); }),
                           facts_.attachments[i].force});
  output_->add_attachments(t, attachments);
  if (scene_.frames_every > 0 && step % scene_.frames_every == 0)
    output_->add_frame(t, *simulation_, input_.mesh, input_.surface ? &*input_.surface : nullptr);
}

std::string BodyRun::step(int step, ThreadPool& pool) {
  move_pins(*simulation_, input_, step * scene_.dt);
  lead_attachments(*simulation_, scene_, step * scene_.dt, scene_.dt);
  PhaseClock clock;
  const double cpu_before = cpu_seconds();
  clock.start();
  const StepReport report = simulation_->step(scene_.dt, pool, clock);
  clock.stop();
  statistics_.add(report, clock, cpu_seconds() - cpu_before);
  if (!report.accepted()) {
    const std::string vertex = report.vertex < 0 ? "" : fmt::format(" (vertex {})", report.vertex);
    return fmt::format("{}step {} of {} was refused{}: {}", label(scene_), step, scene_.steps, vertex, report.advice());
  }
  if (facts_.contact_points > 0) facts_.contact.add(simulation_->contact_terms().contact_report());
  for (std::size_t i = 0; i < facts_.attachments.size(); ++i)
    facts_.attachments[i].force = simulation_->contact_terms().attachment_force(static_cast<Index>(i));
  record(step);
  return "";
}

Json BodyRun::finish(const std::string& stopped_because) {
  facts_.stopped_because = stopped_because;
  facts_.peak_rss_mb = peak_rss_mb();
  facts_.spmv_us = simulation_->measure_spmv_us();
  if (stopped_because.empty()) output_->write_final(*simulation_, facts_.simulation.vertices);
  return summary_of(scene_, input_, facts_, statistics_);
}

void BodyRun::warn() const {
  const auto say = [&](const std::string& text) {
    fmt::print(stderr, "corotet: warning: {}{}\n", label(scene_), text);
  };
  const StepCounts& counts = statistics_.counts();
  if (counts.unconverged > 0) {
    say(
        fmt::format("the solver stopped before its tolerance in {} of {} steps (worst residual {:.3g}): raise "
                    "solver.max_iterations, loosen solver.tolerance, or use solver.name cholesky",
                    counts.unconverged, counts.accepted, statistics_.worst_residual()));
  }
  if (counts.newton_unconverged > 0) {
    say(fmt::format(
        "Newton's method stopped before its tolerance in {} of {} steps (worst estimate of the error {:.3g}): "
        "raise integrator.newton, loosen integrator.newton_tolerance, or use smaller steps",
        counts.newton_unconverged, counts.accepted, statistics_.worst_newton_residual()));
  }
  if (counts.unreliable > 0) {
    say(fmt::format(
        "{} of {} steps cannot be trusted: the solve ended far from its solution, elements were turned inside "
        "out, or the strain grew too far; use smaller steps, or set integrator.untrusted to divide",
        counts.unreliable, counts.accepted));
  }
  if (statistics_.inverted_elements() > 0) {
    say(fmt::format("{} elements are inverted at the end: use smaller steps, gentler pins, or a stiffer material",
                    statistics_.inverted_elements()));
  }
  if (facts_.contact.unsettled() > 0) {
    say(fmt::format(
        "contacts were still changing when the passes of {} of {} steps ended: raise contact.passes, or use "
        "smaller steps",
        facts_.contact.unsettled(), counts.accepted));
  }
  if (facts_.contact.dropped() > 0) {
    say(fmt::format("there was no memory for up to {} contacts of a step: raise contact.max_contacts_per_point",
                    facts_.contact.dropped()));
  }
  if (facts_.surface && facts_.surface->outside > 0) {
    say(fmt::format("{} surface vertices lie outside the mesh, by up to {:.3g} m; they follow the nearest element",
                    facts_.surface->outside, facts_.surface->max_distance));
  }
}

void BodyRun::print_result() const {
  fmt::print(
      "{}{} vertices, {} elements, {} pinned; {} steps of {:.6g} s by {}, median {:.3g} ms a step; results in {}\n",
      label(scene_), facts_.simulation.vertices, facts_.simulation.elements, facts_.pinned_vertices,
      statistics_.counts().accepted, scene_.dt, facts_.simulation.solver, statistics_.median_step_ms(),
      output_->path().string());
}

}  // namespace corotet::program
