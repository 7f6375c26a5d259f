// A case that is run again and again with other settings, and what is kept of each run.
#pragma once

#include <corotet/detail/core/thread_pool.hpp>
#include <corotet/detail/core/types.hpp>
#include <functional>
#include <string>
#include <vector>

#include "../run_input.hpp"
#include "../scene.hpp"
#include "../simulation.hpp"
#include "configuration.hpp"
#include "mesh_family.hpp"

namespace corotet::program {

/// Displacements at a study's points, m: one field for each time that is looked at.
using Track = std::vector<Field<double>>;

/// What a run left, and what it cost.
struct RunResult {
  std::string status = "ok";  ///< or why it is worth nothing
  std::string remarks;        ///< "3 steps unconverged", "2 elements inverted"
  SimulationFacts facts;
  int steps = 0;
  double setup_ms = 0, step_ms = 0;                            ///< median step
  double iterations = 0;                                       ///< mean
  Track track;                                                 ///< of the sample points
  Track probes;                                                ///< of the study's probes
  Vec3<double> angular_momentum_first, angular_momentum_last;  ///< about the origin, kg m^2/s

  [[nodiscard]] bool ok() const { return status == "ok"; }
};

/// A number that is known without computing.
struct ClosedForm {
  std::string what;    ///< "drop of the tip / L"
  std::string source;  ///< "elastica"
  double value = 0;
  std::function<double(const RunResult&)> measure;
};

struct Study {
  std::string name, title;
  Scene scene;
  MeshFamily meshes;
  int sample_level = 0;                  ///< whose vertices are the points at which runs are compared
  std::vector<Vec3<double>> probes;      ///< rest positions, m
  double duration = 1;                   ///< s, a multiple of sample_interval
  double sample_interval = 1.0 / 30;     ///< s, a multiple of each dt of the study
  bool at_rest = false;                  ///< only the state of rest counts: it is solved for after the steps
  std::vector<ClosedForm> closed_forms;  ///< measured on each run

  // What the matrix is made of.
  std::vector<IntegratorKind> integrators{IntegratorKind::implicit_euler, IntegratorKind::bdf2};
  std::vector<double> dts;                     ///< s; one of them the scene's
  std::vector<int> tet4_levels, tet10_levels;  ///< of `meshes`
  int own_order = 2;                           ///< of the scene's own mesh, meshes.own
  int base_level = 0;                          ///< in 10-node elements: where one setting after the other is varied
  int reference_level = 0;                     ///< in 10-node elements
  bool sizes = false;                          ///< preconditioners are compared on all sizes, not only at the base

  [[nodiscard]] int steps(double dt) const;
};

/// Runs `scene` on its own files.
[[nodiscard]] RunResult run(const Study& study, const Scene& scene, RunInput input, ThreadPool& pool);

/// Runs a configuration. A run that comes to nothing says so in its status, whatever the reason; it does not throw.
[[nodiscard]] RunResult run(const Study& study, const Configuration& configuration, ThreadPool& pool);

}  // namespace corotet::program
