// `corotet run`: simulates a scene.
#include <fmt/core.h>

#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "body_run.hpp"
#include "command.hpp"
#include "failure.hpp"
#include "json_file.hpp"
#include "local_origin.hpp"
#include "obstacle_output.hpp"
#include "obstacle_run.hpp"
#include "output_folder.hpp"
#include "progress.hpp"
#include "run_summary.hpp"
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

using Bodies = std::vector<std::unique_ptr<BodyRun>>;

/// The box around all bodies at rest, m.
Bounds bounds_of(const Bodies& bodies) {
  Bounds all = bodies.front()->bounds();
  for (const auto& body : bodies) {
    const Bounds box = body->bounds();
    all = {all.least.cwiseMin(box.least), all.most.cwiseMax(box.most)};
  }
  return all;
}

/// All bodies together, and the obstacles that they share. Returns why the run ended early, or "".
std::string simulate(const Scene& shared, const Bodies& bodies, ObstacleRun& obstacles, ThreadPool& pool,
                     ObstacleOutput& output) {
  const auto record = [&](int step) {
    const double t = step * shared.dt;
    output.add_rows(t, shared.dt, obstacles);
    if (shared.frames_every > 0 && step % shared.frames_every == 0) output.add_frame(t, obstacles);
  };
  record(0);
  Progress progress(shared.steps);
  for (int step = 1; step <= shared.steps; ++step) {
    obstacles.begin_step(step * shared.dt, shared.dt);
    for (const auto& body : bodies)
      if (std::string refusal = body->step(step, pool); !refusal.empty()) return refusal;
    obstacles.advance(shared.dt);
    record(step);
    progress.show(step);
  }
  return "";
}

/// The text of summary.json: of the only body, or of all.
std::string format_summary(const Bodies& bodies, const std::string& stopped_because) {
  if (!bodies.front()->has_name()) return format_json(bodies.front()->finish(stopped_because));
  Json summary = summary_head(bodies.front()->scene(), stopped_because);
  for (const auto& body : bodies) summary["bodies"].push_back(body->finish(stopped_because));
  return format_json(summary);
}

int run(const RunCommandOptions& options) {
  std::vector<Scene> scenes = read_scenes(options.scene);
  for (Scene& scene : scenes) {
    if (options.steps >= 0) scene.steps = options.steps;
    if (options.frames_every >= 0) scene.frames_every = options.frames_every;
  }
  ThreadPool pool = make_pool(options.threads);
  ObstacleRun obstacles(scenes.front());
  Bodies bodies;
  for (const Scene& scene : scenes)
    bodies.push_back(std::make_unique<BodyRun>(scene, obstacles.obstacles(), options.threads, pool));
  print_notes(obstacles.notes());
  for (const auto& body : bodies) body->print_notes();

  OutputFolder folder(options.output);  // not before now: a scene that cannot run leaves nothing behind
  for (const auto& body : bodies) body->begin_output(folder);
  const auto [least, most] = bounds_of(bodies);
  ObstacleOutput output(folder.path(), least + (most - least) / 2, 2 * (most - least).norm());
  const std::string stopped_because = simulate(scenes.front(), bodies, obstacles, pool, output);
  folder.write_summary(format_summary(bodies, stopped_because));
  for (const auto& body : bodies) body->warn();
  if (!stopped_because.empty()) throw Failure(fmt::format("{}: {}", options.scene, stopped_because));
  for (const auto& body : bodies) body->print_result();
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
