// A body under test, and what can be measured of it.
#pragma once

#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../scene.hpp"
#include "../simulation.hpp"
#include "../step_counts.hpp"
#include "case_result.hpp"

namespace corotet::program::stress {

class TestBody {
 public:
  /// Throws a Failure as make_simulation does.
  TestBody(const Scene& scene, MeshData mesh);

  [[nodiscard]] Simulation& body() { return *simulation_; }
  [[nodiscard]] const MeshData& mesh() const { return mesh_; }
  [[nodiscard]] const Vec3<double>& rest(Index v) const { return mesh_.positions[at(v)]; }
  [[nodiscard]] double dt() const { return scene_.dt; }  ///< s
  [[nodiscard]] Index vertices() const { return mesh_.vertex_count(); }

  /// World positions and velocities, one function value a vertex. Throws a Failure if the body refuses them.
  void place(const std::function<Vec3<double>(Index)>& position);
  void push(const std::function<Vec3<double>(Index)>& velocity);

  /// Pins the vertices whose rest position satisfies `where`, where they are now; returns them.
  std::vector<Index> pin(const std::function<bool(const Vec3<double>&)>& where);

  /// Lets the body touch obstacles by the vertices of its boundary: those that are added to `obstacles`. Once. Throws a
  /// Failure for a body that has no boundary.
  void touch(const ContactOptions& options);
  Obstacles obstacles;  ///< move with the body's steps
  /// Of the last step.
  [[nodiscard]] ContactReport contact() const { return simulation_->contact_terms().contact_report(); }

  /// One step of the scene's length. False once a step has been refused; then nothing moves any more.
  bool step();
  /// Until `steps` are done or `stop` says so after one. False if one was refused.
  bool run(int steps, const std::function<bool()>& stop = nullptr);

  /// Of the last step.
  [[nodiscard]] double step_ms() const { return clock_.total_ms(); }
  [[nodiscard]] const StepReport& last() const { return last_; }
  [[nodiscard]] const StepCounts& counts() const { return counts_; }
  /// Why no step is possible any more; empty if steps are.
  [[nodiscard]] const std::string& error() const { return error_; }

  [[nodiscard]] bool finite() const;
  [[nodiscard]] double max_speed() const;
  /// Root mean square distance of vertices from where they rest, m.
  [[nodiscard]] double rms_to_rest() const;
  [[nodiscard]] double kinetic_energy() const;
  /// Kinetic, elastic and that of gravity, J.
  [[nodiscard]] double energy() const;
  [[nodiscard]] Vec3<double> centre() const;
  [[nodiscard]] Vec3<double> momentum() const;
  [[nodiscard]] Vec3<double> angular_momentum() const;  ///< about the centre of mass
  [[nodiscard]] double inertia_radius() const;          ///< sqrt(sum m r^2 / sum m), about the centre of mass
  /// Elements that are turned inside out at a corner, where there may be no quadrature point.
  [[nodiscard]] Index folded_elements() const;
  [[nodiscard]] double volume() const;  ///< of the straight tetrahedra, signed

  /// Adds the counts to the verdict, which fails if a step was refused or the state is not finite.
  void report_to(CaseResult& verdict) const;

 private:
  Scene scene_;
  MeshData mesh_;
  std::unique_ptr<Simulation> simulation_;
  ThreadPool pool_{1};
  PhaseClock clock_;
  StepReport last_;
  StepCounts counts_;
  std::string error_;
};

/// Of 1 x 0.5 x 0.5 m with its least corner at 0: 80 Tet4, or 10 Tet10 on as fine a grid of vertices.
[[nodiscard]] MeshData block(int order);
/// The same of 80 Tet4 or Tet10.
[[nodiscard]] MeshData fine_block(int order);
/// The same of 10 Tet4 or Tet10, for a great many runs.
[[nodiscard]] MeshData coarse_block(int order);
/// Of 1 x 0.2 x 0.2 m, along x from 0, its axis in y = z = 0: 200 Tet4 or 25 Tet10.
[[nodiscard]] MeshData bar(int order);
/// The same of 25 Tet4 or Tet10, for a great many steps.
[[nodiscard]] MeshData coarse_bar(int order);
/// The same for two turns of its end: of 50 Tet10, which an edge that turns by more than a right angle folds.
[[nodiscard]] MeshData twisted_bar(int order);

[[nodiscard]] inline bool at_left_end(const Vec3<double>& x) { return x.x() < 1e-9; }
[[nodiscard]] inline bool at_right_end(const Vec3<double>& x) { return x.x() > 1 - 1e-9; }

}  // namespace corotet::program::stress
