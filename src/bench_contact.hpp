// What contact costs: steps of a body that touches beside steps of the same body whose bottom is pinned.
#pragma once

#include <corotet/detail/mesh/mesh_data.hpp>
#include <string>
#include <vector>

#include "scene.hpp"

namespace corotet::program {

struct ContactCost {
  std::string mesh, situation;
  Index vertices = 0;
  Index contacts = 0;                                      ///< with a force, the most of a step
  double step_ms = 0, free_ms = 0;                         ///< mean of the steps, and of those of the pinned body
  double worst_ms = 0;                                     ///< of the steps
  double iterations = 0, free_iterations = 0, passes = 0;  ///< mean
  int max_passes = 0;
};

/// Steps of `mesh` in each situation, interleaved with those of the same body pinned at its least z. `scene`:
/// material and solver. `steps` >= 8 are timed.
[[nodiscard]] std::vector<ContactCost> measure_contact(const std::string& name, const Scene& scene,
                                                       const MeshData& mesh, int steps);

/// For a terminal, and as .csv.
[[nodiscard]] std::string format_text(const std::vector<ContactCost>& rows);
[[nodiscard]] std::string format_csv(const std::vector<ContactCost>& rows);

}  // namespace corotet::program
