// What a report studies: its own cases, or a scene of the user's.
#pragma once

#include <vector>

#include "../run_input.hpp"
#include "study.hpp"

namespace corotet::program {

/// Beams at rest and swinging, under weight, tip load and torsion; a block that spins, and one that sags. `quick`: on
/// fewer meshes.
[[nodiscard]] std::vector<Study> default_studies(bool quick);

/// `scene` on its own mesh and on coarser and finer ones. Probes: the scene's, or the point that lies farthest from
/// the pins.
[[nodiscard]] Study study_of(const Scene& scene, const RunInput& input, bool quick);

}  // namespace corotet::program
