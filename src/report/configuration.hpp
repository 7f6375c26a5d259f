// One choice of everything that costs time or makes an error: a row of the report.
#pragma once

#include <string>
#include <vector>

#include "../scene.hpp"

namespace corotet::program {

/// The scene's own `mesh` and `order` are not looked at; `scene.steps` follows from the study's duration.
struct Configuration {
  Scene scene;
  int level = 0;  ///< of the study's mesh family
  int order = 1;  ///< 1: Tet4, 2: Tet10
};

/// A setting by its name, as it stands in a scene file.
struct Setting {
  const char* name;
  std::string (*value)(const Configuration&);
};

/// All that may differ between two rows of a study, but for the mesh. The report has a column for each.
[[nodiscard]] const std::vector<Setting>& settings();

/// All settings and the mesh, as text that no other configuration of the study has.
[[nodiscard]] std::string key_of(const Configuration& configuration);

/// The same mesh, mass and integrator with all that a computer is to blame for as small as it gets: double, solved to
/// 1e-10, polar rotations at each quadrature point.
[[nodiscard]] Configuration tightened(Configuration configuration);

/// The same with the equations of each time step solved by Newton's method, instead of linearised. Of a tightened one.
[[nodiscard]] Configuration converged(Configuration configuration);

}  // namespace corotet::program
