// A running simulation behind one interface: the choices that a scene makes at run time (scalar, element, rotation)
// around the library's types, which are chosen at compile time.
#pragma once

#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/thread_pool.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/static_report.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <memory>
#include <string>
#include <vector>

#include "contact_scene.hpp"
#include "phase_clock.hpp"
#include "scene.hpp"

namespace corotet::program {

/// What a simulation says of itself before the first step.
struct SimulationFacts {
  Index vertices = 0;
  Index elements = 0;
  Index flipped_elements = 0;     ///< wound the other way round in the file
  Vec3<double> origin;            ///< what positions are kept relative to, m
  double mass = 0;                ///< kg
  std::string solver;             ///< what "auto" came to: pcg, cholesky
  std::string preconditioner;     ///< the same; empty for cholesky
  double predicted_products = 0;  ///< what a solve should cost in products of the matrix; 0: not predicted
};

/// Median times of what a step is made of, us.
struct KernelTimes {
  double evaluate_us = 0;  ///< rotations, forces and gradients of all elements
  double assemble_us = 0;  ///< the matrix from them
  double product_us = 0;   ///< matrix times vector, as the solver does it
};

/// How an embedded surface lies in the mesh.
struct BindingFacts {
  Index outside = 0;        ///< vertices outside the mesh
  double max_distance = 0;  ///< of those, m
};

/// A surface as it is now, in world coordinates.
struct SurfaceState {
  Field<double> positions;  ///< m
  Field<double> normals;    ///< unit; empty if only points were bound
};

/// A point of the body: a field has the value sum_a weights[a] field[vertices[a]] there.
struct PointOnBody {
  std::vector<Index> vertices;
  std::vector<double> weights;
};

/// What acts on a body in a step besides gravity and nodal forces.
class ContactTerms {
 public:
  ContactTerms() = default;
  ContactTerms(const ContactTerms&) = delete;
  ContactTerms& operator=(const ContactTerms&) = delete;
  virtual ~ContactTerms() = default;

  /// Points that may touch an obstacle.
  [[nodiscard]] virtual Index contact_points() const = 0;
  /// Of the last step.
  [[nodiscard]] virtual ContactReport contact_report() const = 0;

  /// Where attachment number i pulls to at the end of the next step, m, and how fast that moves, m/s.
  virtual void lead_attachment(Index i, const Vec3<double>& target, const Vec3<double>& velocity) = 0;
  /// On the body in the last step, N.
  [[nodiscard]] virtual Vec3<double> attachment_force(Index i) const = 0;
};

/// All positions are world positions in m, displacements are from rest.
class Simulation {
 public:
  Simulation() = default;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;
  virtual ~Simulation() = default;

  [[nodiscard]] virtual SimulationFacts facts() const = 0;

  /// Replaces the state; one entry a vertex.
  virtual Result<void> set_positions(const Field<double>& positions) = 0;
  virtual Result<void> set_velocities(const Field<double>& velocities) = 0;

  /// One for the whole body, or one an element. The mass follows.
  virtual Result<void> set_materials(const Materials& materials) = 0;

  /// Forces besides gravity from now on, N, one a vertex. One that is infinite in this precision refuses the step.
  virtual void set_forces(const Field<double>& forces) = 0;

  /// Holds a vertex where it is now.
  virtual void pin(Index vertex) = 0;
  /// Lets go of it.
  virtual void release(Index vertex) = 0;
  /// Where a pinned vertex shall be after the next step, relative to where it was pinned.
  virtual void move_pin(Index vertex, const Vec3<double>& displacement) = 0;

  /// Lets the body touch obstacles, which must outlive it, by the points that the scene names; those of a surface must
  /// be bound. Once.
  virtual Result<void> touch(Obstacles& obstacles, const ContactScene& contact) = 0;
  /// Ties the points of the body that are nearest to those at rest; returns them. Once.
  virtual std::vector<PointOnBody> attach(const std::vector<AttachmentEntry>& attachments) = 0;
  [[nodiscard]] virtual ContactTerms& contact_terms() = 0;

  /// Advances by `h` s; tells `clock` of the step's phases.
  virtual StepReport step(double h, ThreadPool& pool, PhaseClock& clock) = 0;

  /// Moves the body to where it rests.
  virtual StaticReport solve_static(ThreadPool& pool) = 0;

  [[nodiscard]] virtual Vec3<double> position(Index vertex) const = 0;
  [[nodiscard]] virtual Vec3<double> displacement(Index vertex) const = 0;
  [[nodiscard]] virtual Vec3<double> velocity(Index vertex) const = 0;

  /// Binds a surface to the rest shape; it moves along from then on. Without triangles and normals: only points.
  virtual Result<BindingFacts> bind(const SurfaceMesh& surface, ThreadPool& pool) = 0;
  [[nodiscard]] virtual SurfaceState surface() = 0;

  /// Lumped mass, or row sum of the consistent one, kg.
  [[nodiscard]] virtual double vertex_mass(Index vertex) const = 0;

  /// Elastic energy of the present state, J.
  [[nodiscard]] virtual double elastic_energy() const = 0;
  /// e . K' e with the warped stiffness K' of the present state, J: twice the energy that a small change of the
  /// displacements by `change` (m, one a vertex) would take if it stretched a body at rest.
  [[nodiscard]] virtual double stiffness_product(const Field<double>& change) const = 0;

  /// Median time of one product of the step's matrix with a vector, in float, by plain_product: the yardstick for a
  /// step on this mesh and machine, us.
  [[nodiscard]] virtual double measure_spmv_us() const = 0;

  /// Of the present state.
  [[nodiscard]] virtual KernelTimes measure_kernels(ThreadPool& pool) const = 0;
};

/// The body of the scene at rest in the rest shape of `mesh`, which has the order it shall run with; gravity and
/// damping are set, pins are not. Throws a Failure that names the element or vertex if no body can be made of it.
[[nodiscard]] std::unique_ptr<Simulation> make_simulation(const Scene& scene, const MeshData& mesh);

}  // namespace corotet::program
