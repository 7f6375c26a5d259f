// `corotet run`: simulates a scene.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command.hpp"
#include "failure.hpp"
#include "output_folder.hpp"
#include "problems.hpp"
#include "process_usage.hpp"
#include "progress.hpp"
#include "run_input.hpp"
#include "run_setup.hpp"
#include "run_summary.hpp"
#include "scene.hpp"
#include "simulation.hpp"

namespace corotet::program {
namespace {

struct RunCommandOptions {
  std::string scene;
  std::string output;
  int threads = 1;
  int steps = -1;         // < 0: the scene's
  int frames_every = -1;  // < 0: the scene's
};

ThreadPool make_pool(int threads) {
  try {
    return ThreadPool(threads);
  } catch (const std::exception& error) {
    throw Failure(fmt::format("--threads {}: so many threads cannot be made: {}", threads, error.what()));
  }
}

/// The steps, with what they leave behind. Returns why they ended early, or "".
std::string simulate(const Scene& scene, const RunInput& input, Simulation& simulation, ThreadPool& pool,
                     OutputFolder& output, StepStatistics& statistics) {
  const SurfaceMesh* surface = input.surface ? &*input.surface : nullptr;
  const auto record = [&](int step) {
    const double t = step * scene.dt;
    output.add_probes(t, simulation, input.probes);
    if (scene.frames_every > 0 && step % scene.frames_every == 0) output.add_frame(t, simulation, input.mesh, surface);
  };
  record(0);
  Progress progress(scene.steps);
  PhaseClock clock;
  for (int step = 1; step <= scene.steps; ++step) {
    move_pins(simulation, input, step * scene.dt);
    const double cpu_before = cpu_seconds();
    clock.start();
    const StepReport report = simulation.step(scene.dt, pool, clock);
    clock.stop();
    statistics.add(report, clock, cpu_seconds() - cpu_before);
    if (!report.accepted()) {
      const std::string vertex = report.vertex < 0 ? "" : fmt::format(" (vertex {})", report.vertex);
      return fmt::format("step {} of {} was refused{}: {}", step, scene.steps, vertex, report.advice());
    }
    record(step);
    progress.show(step);
  }
  return "";
}

void warn(const StepStatistics& steps, const RunFacts& facts) {
  const auto say = [](const std::string& text) { fmt::print(stderr, "corotet: warning: {}\n", text); };
  const StepCounts& counts = steps.counts();
  if (counts.unconverged > 0) {
    say(
        fmt::format("the solver stopped before its tolerance in {} of {} steps (worst residual {:.3g}): raise "
                    "solver.max_iterations, loosen solver.tolerance, or use solver.name cholesky",
                    counts.unconverged, counts.accepted, steps.worst_residual()));
  }
  if (counts.newton_unconverged > 0) {
    say(fmt::format(
        "Newton's method stopped before its tolerance in {} of {} steps (worst estimate of the error {:.3g}): "
        "raise integrator.newton, loosen integrator.newton_tolerance, or use smaller steps",
        counts.newton_unconverged, counts.accepted, steps.worst_newton_residual()));
  }
  if (counts.unreliable > 0) {
    say(fmt::format(
        "{} of {} steps cannot be trusted: the solve ended far from its solution, elements were turned inside "
        "out, or the strain grew too far; use smaller steps, or set integrator.untrusted to divide",
        counts.unreliable, counts.accepted));
  }
  if (steps.inverted_elements() > 0) {
    say(fmt::format("{} elements are inverted at the end: use smaller steps, gentler pins, or a stiffer material",
                    steps.inverted_elements()));
  }
  if (facts.surface && facts.surface->outside > 0) {
    say(fmt::format("{} surface vertices lie outside the mesh, by up to {:.3g} m; they follow the nearest element",
                    facts.surface->outside, facts.surface->max_distance));
  }
}

int run(const RunCommandOptions& options) {
  Scene scene = read_scene(options.scene);
  if (options.steps >= 0) scene.steps = options.steps;
  if (options.frames_every >= 0) scene.frames_every = options.frames_every;
  const RunInput input = read_input(scene);
  ThreadPool pool = make_pool(options.threads);

  RunFacts facts;
  facts.threads = options.threads;
  const auto start = std::chrono::steady_clock::now();
  const std::unique_ptr<Simulation> simulation = make_simulation(scene, input.mesh);
  facts.pinned_vertices = set_up(*simulation, scene, input);
  facts.setup_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  facts.simulation = simulation->facts();
  if (input.surface) {
    Problems problems(scene.file.string());
    facts.surface = problems.take("surface", simulation->bind(*input.surface, pool));
    problems.stop_if_any();
  }

  for (const std::string& note : input.notes) fmt::print(stderr, "corotet: note: {}\n", note);
  if (facts.simulation.flipped_elements > 0)
    fmt::print(stderr, "corotet: note: {}: {} of {} elements were wound the other way round and have been turned\n",
               scene.mesh.string(), facts.simulation.flipped_elements, facts.simulation.elements);

  OutputFolder output(options.output);  // not before now: a scene that cannot run leaves nothing behind
  StepStatistics statistics(scene.steps);
  facts.stopped_because = simulate(scene, input, *simulation, pool, output, statistics);
  facts.peak_rss_mb = peak_rss_mb();
  facts.spmv_us = simulation->measure_spmv_us();
  if (facts.stopped_because.empty()) output.write_final(*simulation, facts.simulation.vertices);
  output.write_summary(format_summary(scene, input, facts, statistics));
  warn(statistics, facts);
  if (!facts.stopped_because.empty()) throw Failure(fmt::format("{}: {}", options.scene, facts.stopped_because));
  fmt::print(
      "{} vertices, {} elements, {} pinned; {} steps of {:.6g} s by {}, median {:.3g} ms a step; results in {}\n",
      facts.simulation.vertices, facts.simulation.elements, facts.pinned_vertices, statistics.counts().accepted,
      scene.dt, facts.simulation.solver, statistics.median_step_ms(), output.path().string());
  return 0;
}

}  // namespace

Command add_run_command(CLI::App& app) {
  auto options = std::make_shared<RunCommandOptions>();
  CLI::App* syntax = app.add_subcommand("run", "Simulate a scene, write results and frames");
  syntax->add_option("scene", options->scene, "The scene, a JSON file; docs/scene.md describes it")->required();
  syntax
      ->add_option("-o,--output", options->output,
                   "Folder for summary.json, probes.csv, final.txt and frames; made if it is not there, otherwise an "
                   "earlier run's files in it are replaced")
      ->required();
  syntax->add_option("--threads", options->threads, "Threads, >= 1 (1); results are the same bits for any number")
      ->check(CLI::Range(1, 1024));
  syntax->add_option("--steps", options->steps, "Steps, >= 0, instead of the scene's")->check(CLI::NonNegativeNumber);
  syntax
      ->add_option("--frames-every", options->frames_every,
                   "Steps between frames, >= 0, 0: none, instead of the scene's")
      ->check(CLI::NonNegativeNumber);
  syntax->footer(
      "Every key of a scene but \"mesh\" has a default; paths are relative to the scene file. A small one:\n"
      "  {\"mesh\": \"beam.msh\", \"material\": {\"young\": 5e5, \"poisson\": 0.3, \"density\": 1000},\n"
      "   \"pins\": [{\"box\": [[0, 0, 0], [0, 1, 1]]}], \"probes\": [{\"nearest\": [1, 0.1, 0.1]}],\n"
      "   \"steps\": 120, \"frames\": {\"every\": 2}}\n\n"
      "Example:\n"
      "  corotet run scene.json -o out --threads 2");
  return {syntax, [options] { return run(*options); }};
}

}  // namespace corotet::program
