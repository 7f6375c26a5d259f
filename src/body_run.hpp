// One body of a run: from its scene to the files that it leaves.
#pragma once

#include <corotet/detail/core/thread_pool.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "json_file.hpp"
#include "local_origin.hpp"
#include "obstacle_run.hpp"
#include "output_folder.hpp"
#include "run_input.hpp"
#include "run_setup.hpp"
#include "run_summary.hpp"
#include "scene.hpp"
#include "simulation.hpp"

namespace corotet::program {

/// On stderr.
void print_notes(const std::vector<std::string>& notes);

class BodyRun {
 public:
  /// Reads the scene's files and sets the body up. `obstacles` must outlive it. Throws a Failure that lists all that is
  /// wrong with them; writes nothing.
  BodyRun(const Scene& scene, Obstacles& obstacles, int threads, ThreadPool& pool);

  /// Says on stderr what was changed or left out.
  void print_notes() const;
  /// Writes how the body begins: into the results of the run, or into a folder of its own there if it has a name.
  void begin_output(OutputFolder& run);
  /// Step number `step`, from 1, with what it leaves in the folder. Returns why it was refused, or "".
  [[nodiscard]] std::string step(int step, ThreadPool& pool);
  /// Writes final.txt, unless the run was stopped; returns what summary.json says of the body. `stopped_because`: empty
  /// for a run that was completed.
  [[nodiscard]] Json finish(const std::string& stopped_because);
  /// Says on stderr what the steps warn of.
  void warn() const;
  /// One line on stdout: what was done.
  void print_result() const;

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] bool has_name() const { return !scene_.name.empty(); }
  /// The box around the body at rest, m.
  [[nodiscard]] Bounds bounds() const { return Bounds::of(input_.mesh); }

 private:
  void record(int step);

  const Scene& scene_;
  RunInput input_;
  RunFacts facts_;
  std::unique_ptr<Simulation> simulation_;
  ContactSetup contact_;
  StepStatistics statistics_;
  std::optional<OutputFolder> own_folder_;
  OutputFolder* output_ = nullptr;
};

}  // namespace corotet::program
