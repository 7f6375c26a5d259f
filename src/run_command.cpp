// `corotet run`: simulates a scene.
#include <fmt/core.h>

#include <exception>
#include <filesystem>
#include <memory>
#include <string>

#include "body_run.hpp"
#include "command.hpp"
#include "failure.hpp"
#include "obstacle_output.hpp"
#include "obstacle_run.hpp"
#include "progress.hpp"
#include "scene.hpp"

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

/// All bodies together, and the obstacles that they share. Returns why the run ended early, or "".
std::string simulate(const Scene& scene, BodyRun& body, ObstacleRun& obstacles, ThreadPool& pool,
                     const std::filesystem::path& folder) {
  const auto [least, most] = body.bounds();
  body.begin_output(folder);
  ObstacleOutput output(folder, least + (most - least) / 2, 2 * (most - least).norm());
  const auto record = [&](int step) {
    const double t = step * scene.dt;
    output.add_rows(t, scene.dt, obstacles);
    if (scene.frames_every > 0 && step % scene.frames_every == 0) output.add_frame(t, obstacles);
  };
  record(0);
  Progress progress(scene.steps);
  for (int step = 1; step <= scene.steps; ++step) {
    obstacles.begin_step(step * scene.dt, scene.dt);
    if (std::string refusal = body.step(step, pool); !refusal.empty()) return refusal;
    obstacles.advance(scene.dt);
    record(step);
    progress.show(step);
  }
  return "";
}

int run(const RunCommandOptions& options) {
  Scene scene = read_scene(options.scene);
  if (options.steps >= 0) scene.steps = options.steps;
  if (options.frames_every >= 0) scene.frames_every = options.frames_every;
  ThreadPool pool = make_pool(options.threads);
  ObstacleRun obstacles(scene);
  BodyRun body(scene, obstacles.obstacles(), options.threads, pool);
  print_notes(obstacles.notes());
  body.print_notes();
  const std::string stopped_because = simulate(scene, body, obstacles, pool, options.output);
  body.finish(stopped_because);
  if (!stopped_because.empty()) throw Failure(fmt::format("{}: {}", options.scene, stopped_because));
  body.print_result();
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
