// What can be read from a body: strain, stress and energy of its elements, and the forces of its pins.
#pragma once

#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/assembly/element_measures.hpp>
#include <corotet/detail/assembly/twist_modes.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <cstddef>
#include <span>
#include <vector>

namespace corotet::inline v0_1 {

/// Measures each element of the body where it is now: strain, stress, energy, volume.
///
/// StepReport has the largest strain of a step for nothing; use this for fields and for stress.
/// @snippet queries.cpp measures
/// `out` has one entry an element: see element_measures of a law.
template <class Body>
void element_measures(const Body& body, std::span<ElementMeasures<typename Body::scalar_type>> out,
                      ExecutorRef executor = {}) {
  element_measures(body.law(), body.displacements(), out, executor);
}

/// The reactions of a body's pins: the force that each pin exerts on the body, N, along the axes that it holds.
///
/// Use it for supports in statics, and to couple a body with a rigid one that carries its pins.
/// @snippet queries.cpp reactions
/// The body pulls at the pin with the opposite force. For vertex i, M the mass, D the damping:
///   reaction_i = (M a + D v)_i - f_elastic_i - f_external_i - m_i g.
/// Terms that an integrator has besides the body's own are not counted: add what they exert on pinned vertices to
/// f_external.
/// Made once for a body and its copies; then nothing allocates. Costs one evaluation of the elastic law.
template <class Body>
class PinReactions {
 public:
  using Scalar = typename Body::scalar_type;  ///< of the body

  /// Memory.
  COROTET_COLD explicit PinReactions(const Body& body)
      : evaluation_(body.law(), Tangent::warped),
        slot_(at(body.vertex_count()), none),
        displacement_(body.damping().stiffness > 0 ? at(body.vertex_count()) : 0, Vec3<Scalar>::Zero()) {
    vertices_.reserve(at(body.vertex_count()));
    forces_.reserve(at(body.vertex_count()));
  }

  /// Of a body at rest: without a and v.
  void evaluate_static(const Body& body, ExecutorRef executor = {}) {
    evaluate_forces(body, executor);
    keep_pinned_axes(body);
  }

  /// Of a step of backward Euler that the body has just made: a = (v - velocity_before) / h. Stiffness damping is
  /// that of the state before the step, `displacement_before` (which may be empty if there is none). With these
  /// reactions momentum balances where Newton's method has converged; after one linear solve, to an error of first
  /// order in h. For another integrator, give the acceleration instead.
  void evaluate_step(const Body& body, std::span<const Vec3<Scalar>> displacement_before,
                     std::span<const Vec3<Scalar>> velocity_before, Scalar h, ExecutorRef executor = {}) {
    COROTET_ASSERT(size_of(velocity_before) == body.vertex_count(), "velocities need one entry per vertex");
    COROTET_ASSERT(h > 0, "a step has a length");
    evaluate_moving(
        body, displacement_before,
        [&](Index i) -> Vec3<Scalar> { return (body.velocities()[at(i)] - velocity_before[at(i)]) / h; }, executor);
  }
  /// The same with an acceleration for each vertex, m/s^2.
  void evaluate_dynamic(const Body& body, std::span<const Vec3<Scalar>> displacement_of_damping,
                        std::span<const Vec3<Scalar>> acceleration, ExecutorRef executor = {}) {
    COROTET_ASSERT(size_of(acceleration) == body.vertex_count(), "accelerations need one entry per vertex");
    evaluate_moving(
        body, displacement_of_damping, [&](Index i) -> Vec3<Scalar> { return acceleration[at(i)]; }, executor);
  }

  /// The pinned vertices when this was evaluated, and the force of each pin, N.
  [[nodiscard]] std::span<const Index> vertices() const { return vertices_; }
  /// The force of each pin on the body, N, in the order of Pins::vertices.
  [[nodiscard]] std::span<const Vec3<Scalar>> forces() const { return forces_; }

  /// N.
  [[nodiscard]] Vec3<double> total_force() const {
    Vec3<double> sum = Vec3<double>::Zero();
    for (const Vec3<Scalar>& f : forces_) sum += f.template cast<double>();
    return sum;
  }
  /// About a point (m, relative to body.origin()), of forces at the present positions, N m.
  [[nodiscard]] Vec3<double> total_torque(const Body& body, const Vec3<double>& about) const {
    Vec3<double> sum = Vec3<double>::Zero();
    for (std::size_t p = 0; p < vertices_.size(); ++p)
      sum += (body.position(vertices_[p]).template cast<double>() - about).cross(forces_[p].template cast<double>());
    return sum;
  }

 private:
  /// Without a and v, in all axes.
  void evaluate_forces(const Body& body, ExecutorRef executor) {
    body.law().evaluate(body.displacements(), evaluation_, executor);
    for (const Index i : vertices_) slot_[at(i)] = none;
    vertices_.assign(body.pins().vertices().begin(), body.pins().vertices().end());
    forces_.resize(vertices_.size(), Vec3<Scalar>::Zero());
    for (std::size_t p = 0; p < vertices_.size(); ++p) {
      const Index i = vertices_[p];
      slot_[at(i)] = static_cast<Index>(p);
      forces_[p] = -(evaluation_.vertex_force(*body.pattern(), i) + body.external_forces()[at(i)] +
                     body.mass().row_sum(i) * body.gravity());
    }
  }

  void keep_pinned_axes(const Body& body) {
    for (std::size_t p = 0; p < vertices_.size(); ++p)
      for (int i = 0; i < 3; ++i)
        if (!body.pins().axes()[p][i]) forces_[p][i] = 0;
  }

  template <class Acceleration>
  void evaluate_moving(const Body& body, std::span<const Vec3<Scalar>> displacement_of_damping,
                       const Acceleration& acceleration, ExecutorRef executor) {
    evaluate_forces(body, executor);
    const auto mass_damping = static_cast<Scalar>(body.damping().mass);
    for (std::size_t p = 0; p < vertices_.size(); ++p) {
      const Index i = vertices_[p];
      forces_[p] += body.mass().row_product(*body.pattern(), i, acceleration) +
                    mass_damping * body.mass().row_product(*body.pattern(), i, body.velocities());
    }
    if (body.damping().stiffness > 0) add_stiffness_damping(body, displacement_of_damping, executor);
    keep_pinned_axes(body);
  }

  /// b K' v with the warped stiffness K' at `displacement`.
  void add_stiffness_damping(const Body& body, std::span<const Vec3<Scalar>> displacement, ExecutorRef executor) {
    COROTET_ASSERT(size_of(displacement) == body.vertex_count(), "displacements need one entry per vertex");
    using Law = typename Body::Law;
    const BlockPattern& pattern = *body.pattern();
    const Field<Scalar>& v = body.velocities();
    const auto factor = static_cast<Scalar>(body.damping().stiffness);
    displacement_.assign(displacement.begin(), displacement.end());
    body.law().evaluate(displacement_, evaluation_, executor);
    for (std::size_t p = 0; p < vertices_.size(); ++p) {
      const Index i = vertices_[p];
      for (Index k = pattern.incidence_start[at(i)]; k < pattern.incidence_start[at(i) + 1]; ++k) {
        const Index e = pattern.incidence[at(k)] / Law::nodes, a = pattern.incidence[at(k)] % Law::nodes;
        for (int b = 0; b < Law::nodes; ++b)
          if (b != a) {  // blocks of a row sum to zero
            const Vec3<Scalar> difference = v[at(body.mesh().element(e)[at(b)])] - v[at(i)];
            forces_[p] += factor * (body.law().stiffness_block(evaluation_, e, a, b) * difference);
          }
      }
    }
    if constexpr (requires { body.law().mean_dilatation().patches(); })
      add_damping_of_patches(body, body.law().mean_dilatation().patches().vertices, factor);
  }

  /// Of patches of mean dilatation: the sum of g g^T.
  void add_damping_of_patches(const Body& body, const Stencils& groups, Scalar factor) {
    const Field<Scalar>& v = body.velocities();
    const auto gradient = [&](Index k) { return Vec3<Scalar>::load(evaluation_.mean_gradient(at(k))); };
    for (Index g = 0; g < groups.count(); ++g) {
      Scalar rate = 0;
      for (Index k = groups.start[at(g)]; k < groups.start[at(g) + 1]; ++k)
        rate += gradient(k).dot(v[at(groups.vertex[at(k)])]);
      for (Index k = groups.start[at(g)]; k < groups.start[at(g) + 1]; ++k)
        if (const Index p = slot_[at(groups.vertex[at(k)])]; p != none) forces_[at(p)] += factor * rate * gradient(k);
    }
  }

  static constexpr Index none = -1;

  typename Body::Law::Evaluation evaluation_;
  std::vector<Index> vertices_;
  detail::Buffer<Index> slot_;  // of each vertex, in vertices_
  Field<Scalar> forces_;
  Field<Scalar> displacement_;
};

}  // namespace corotet::inline v0_1
