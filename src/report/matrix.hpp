// Which configurations a report runs.
#pragma once

#include <string>
#include <vector>

#include "study.hpp"

namespace corotet::program {

struct Planned {
  Configuration configuration;
  std::string role;  ///< "grid": all meshes by all time steps; or the setting that alone differs from the base
};

/// Where one setting after the other is varied: 10-node elements on the study's base level, or the nearest that is
/// coarser than the reference; 4-node elements on the coarsest mesh if there is none.
[[nodiscard]] Configuration base_of(const Study& study, int reference_level);

/// Grid first, cheap meshes first, so that what a short allowance leaves out is the dearest.
[[nodiscard]] std::vector<Planned> plan(const Study& study, const Configuration& base);

}  // namespace corotet::program
