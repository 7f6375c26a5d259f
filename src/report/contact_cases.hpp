// Cases of contact whose solution is known in closed form, and what a run of one is worth.
#pragma once

#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <functional>
#include <string>
#include <vector>

#include "../scene.hpp"

namespace corotet::program {

/// How a case is run. All else is as in a scene that does not say, in float.
struct ContactSetting {
  int order = 1;  ///< 1: Tet4, 2: Tet10
  bool fine = false;
  IntegratorKind integrator = IntegratorKind::implicit_euler;
  double dt = 1.0 / 60;  ///< s
  double young = 5e5;    ///< Pa
};

/// A number that a run measured, beside the one that is known.
struct ContactQuantity {
  std::string name;  ///< with its unit: "sag, m"
  double known = 0, measured = 0;
  double scale = 0;  ///< what the error is relative to; 0: the known value

  [[nodiscard]] double error() const { return std::fabs(measured - known) / (scale > 0 ? scale : std::fabs(known)); }
};

struct ContactRow {
  ContactSetting setting;
  std::string status = "ok";  ///< or why the run is worth nothing
  std::string mesh;           ///< "Tet4 4x4x2"
  Index elements = 0, vertices = 0;
  std::vector<ContactQuantity> quantities;
  int steps = 0;
  double step_ms = 0, frame_ms = 0;   ///< mean over all steps; for 1/60 s of motion
  double iterations = 0, passes = 0;  ///< mean
  int max_passes = 0;
  Index most_touching = 0;
  int unsettled = 0;      ///< steps whose passes ended while contacts were changing
  bool frontier = false;  ///< no other row of its stiffness has less error in the first quantity for less frame_ms
};

struct ContactCase {
  std::string name, title;
  std::string known_from;
  std::vector<double> dts{1.0 / 60, 1.0 / 240};  ///< s
  std::vector<double> youngs{5e5, 5e7};          ///< Pa
  std::vector<IntegratorKind> integrators{IntegratorKind::implicit_euler, IntegratorKind::bdf2};
  /// Fills all of the row but its setting. Throws a Failure if no body can be made.
  std::function<void(ContactRow&)> run;
};

[[nodiscard]] std::vector<ContactCase> contact_cases();

/// All runs of a case, the frontier marked; `quick`: the coarse meshes and the first stiffness.
/// `observer(part)` is told how much is done, 0 ... 1.
[[nodiscard]] std::vector<ContactRow> run_contact_case(const ContactCase& contact_case, bool quick,
                                                       const std::function<void(double)>& observer);

}  // namespace corotet::program
