// The terms that every body has: gravity, forces on its vertices, and Rayleigh damping.
#pragma once

#include <corotet/detail/assembly/mass.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/terms/step_term.hpp>

namespace corotet::inline v0_1 {

/// Uniform gravity: the force m g on each vertex, with m the row sum of the mass matrix.
template <std::floating_point Scalar>
class GravityTerm final : public StepTerm<Scalar> {
 public:
  Vec3<Scalar> acceleration = Vec3<Scalar>::Zero();  ///< m/s^2

  void add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) override {
    out.add_each([&](Index v) -> Vec3<Scalar> { return state.mass->row_sum(v) * acceleration; });
  }
};

/// A given force on each vertex, constant in space during a step.
template <std::floating_point Scalar>
class NodalForceTerm final : public StepTerm<Scalar> {
 public:
  Field<Scalar> force;  ///< N, one a vertex

  void add_force(const TermState<Scalar>& /*state*/, TermForces<Scalar>& out) override {
    out.add_each([&](Index v) -> const Vec3<Scalar>& { return force[at(v)]; });
  }
};

/// Forces -D v: see RayleighDamping.
template <std::floating_point Scalar>
class RayleighDampingTerm final : public StepTerm<Scalar> {
 public:
  RayleighDamping damping;  ///< 1/s and s

  void add_force(const TermState<Scalar>& /*state*/, TermForces<Scalar>& /*out*/) override {}
  [[nodiscard]] RayleighDamping proportional_damping() const override { return damping; }
};

}  // namespace corotet::inline v0_1
