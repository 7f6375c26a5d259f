// `corotet tune`: the settings that a scene needs, no more.
#include <fmt/core.h>

#include <algorithm>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/write_msh.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "../command.hpp"
#include "../failure.hpp"
#include "../progress.hpp"
#include "../run_input.hpp"
#include "cases.hpp"
#include "scene_file.hpp"
#include "tuning.hpp"

namespace corotet::program {
namespace {

namespace fs = std::filesystem;

struct TuneOptions {
  std::string scene;
  std::string output;
  double error = 0;      // 0: not given
  double budget_ms = 0;  // the same
  double minutes = 3;
  bool quick = false;
  int threads = 0;  // 0: as many as the machine has, 2 at most
};

/// Writes the scene, and the mesh unless it is the scene's own. Returns the scene as it is read back.
Scene write(const TuneOptions& options, const Study& study, const Configuration& configuration) {
  const fs::path file = options.output;
  fs::path mesh = study.scene.mesh;
  if (configuration.level != study.meshes.own) {
    mesh = fs::path(file).replace_extension(".msh");
    require(write_msh(mesh, study.meshes.mesh(configuration.level, 1), {}));
  }
  require(write_file(file, format_scene(study.scene.file, configuration, mesh, file.parent_path())));
  return read_scene(file);
}

std::string describe(const Study& study, const Configuration& c) {
  std::string text =
      fmt::format("{} {}", c.order == 1 ? "4-node tetrahedra" : "10-node tetrahedra", study.meshes[c.level].name);
  for (const Setting& setting : settings()) {
    const std::string name = setting.name;
    if (name == "mass" || name == "integrator" || name == "dt" || name == "tolerance" || name == "preconditioner")
      text += fmt::format(", {} {}", name, setting.value(c));
  }
  return text;
}

int tune(const TuneOptions& options) {
  if ((options.error > 0) == (options.budget_ms > 0)) throw Failure("tune: ask for one of --error and --budget-ms");
  if (fs::path(options.output).extension() != ".json")
    throw Failure(fmt::format("--output {}: its name must end with .json", options.output));
  const Scene scene = read_scene(options.scene);
  refuse_contact(scene, "tune");
  std::error_code ignored;
  if (fs::equivalent(options.scene, options.output, ignored))
    throw Failure(fmt::format("--output {}: it would replace the scene itself", options.output));
  const RunInput input = read_input(scene);
  const Study study = study_of(scene, input, options.quick);
  const int machine = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 2);
  ThreadPool threads(options.threads > 0 ? options.threads : machine);
  TimeBudget budget(60 * options.minutes);
  TuningGoal goal;
  if (options.error > 0) goal.error = options.error;
  if (options.budget_ms > 0) goal.budget_ms = options.budget_ms;

  const auto confirm = [&](const Configuration& configuration) {
    const Scene written = write(options, study, configuration);
    ThreadPool serial(1);
    return run(study, written, read_input(written), serial);
  };
  const Tuning tuning = [&] {
    constexpr int parts = 1000;
    Progress progress(parts);
    return program::tune(study, goal, threads, budget, confirm, [&](const std::string& what, double part) {
      progress.show(static_cast<int>(parts * part), what);
    });
  }();

  if (!study.meshes.notes.empty()) fmt::print(stderr, "corotet: note: {}\n", study.meshes.notes);
  fmt::print("{}\n", describe(study, tuning.measured.configuration));
  fmt::print("            error      ms for {:.4g} s of motion\n", scene.dt);
  const auto line = [](const char* what, const Candidate& c) {
    fmt::print("{}  {:>7.3g} %  {:.4g}\n", what, 100 * c.error, c.frame_ms);
  };
  line("the scene ", tuning.as_it_was);
  line("predicted ", tuning.predicted);
  line("measured  ", tuning.measured);
  fmt::print("            of it: space {:.2g} %, time {:.2g} %, arithmetic {:.2g} %; {} settings tried\nwrote {}\n",
             100 * tuning.measured.space, 100 * tuning.measured.time, 100 * tuning.measured.arithmetic, tuning.tried,
             options.output);
  const bool missed =
      options.error > 0 ? tuning.measured.error > options.error : tuning.measured.frame_ms > options.budget_ms;
  if (missed) throw Failure("what was written misses the goal when it is run again: times on this machine vary");
  return 0;
}

}  // namespace

Command add_tune_command(CLI::App& app) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* syntax = app.add_subcommand("tune", "Find the settings that a scene needs, and write them");
  syntax->add_option("scene", options->scene, "The scene, a JSON file")->required();
  syntax
      ->add_option("-o,--output", options->output,
                   "The scene to write, .json; a mesh for it, if there must be one, is written beside it, .msh")
      ->required();
  auto* error = syntax
                    ->add_option("--error", options->error,
                                 "The cheapest settings whose displacements are off by at most this part (0.02: 2 %)")
                    ->check(CLI::Range(1e-9, 1e9));
  syntax
      ->add_option("--budget-ms", options->budget_ms,
                   "The most accurate settings that take at most this for one step of the scene, ms on one thread")
      ->check(CLI::PositiveNumber)
      ->excludes(error);
  syntax->add_option("--minutes", options->minutes, "How long the search may take, > 0 (3)")
      ->check(CLI::PositiveNumber);
  syntax->add_flag("--quick", options->quick, "Only meshes of up to 500 elements, or eight times the scene's");
  syntax->add_option("--threads", options->threads, "For the references, >= 1 (2); times are of one thread")
      ->check(CLI::Range(1, 1024));
  syntax->footer(
      "Looked through: the mesh (finer ones; coarser ones if it is a box cut into a grid), 4- or 10-node elements, "
      "the\n"
      "time step, the solver. Errors are against the library's own run at the tightest settings, in the norm of the\n"
      "mass, over all times together.\n\n"
      "Examples:\n"
      "  corotet tune scene.json --error 0.02 -o tuned.json && corotet run tuned.json -o out\n"
      "  corotet tune scene.json --budget-ms 2 -o tuned.json");
  return {syntax, [options] { return tune(*options); }};
}

}  // namespace corotet::program
