// What acts on a body in a step besides elasticity and inertia.
#pragma once

#include <corotet/detail/assembly/mass.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/terms/term_state.hpp>
#include <cstddef>
#include <span>

namespace corotet::inline v0_1 {

template <std::floating_point Scalar>
class PiecewiseTerm;
struct TermRest;

/// A force on a body, and how it changes with position and velocity: a spring, an attachment, a contact, a drag.
///
/// Derive from it where a force depends on the state, above all if it is stiff: the step solves it implicitly, with its
/// impulse in the balance of momenta and its energy in the energy bound. For forces that are known before the step use
/// SoftBody::external_forces; to hold vertices use pins.
/// @snippet term.cpp term
/// @snippet term.cpp use
/// An integrator calls, in this order: `begin_step` once; then for each linearisation `add_force` and `add_stiffness`
/// with the same state; `energy` with any state in between; `end_step` once if the step is accepted. A step that is
/// solved again (energy bound, projected tangent) repeats the middle part. All calls come from the thread that called
/// `step`; a term may use state.executor.
///
/// The tangent is that of x' = x_history + gamma v': gamma^2 K + gamma D enters the matrix (Baraff & Witkin 1998,
/// eq. 6). It must be symmetric and positive semi-definite: leave out what is not. Terms must not allocate once they
/// have been stepped.
template <std::floating_point Scalar>
class StepTerm {
 public:
  virtual ~StepTerm() = default;

  /// The body at the start of a step: for finding contacts, aiming, lagged quantities.
  virtual void begin_step(const TermState<Scalar>& /*start*/) {}

  /// Adds the force on each vertex that the term acts on, at this state.
  virtual void add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) = 0;

  /// Adds minus the derivative of that force, at the state of the last `add_force`. Of none: an explicit force.
  virtual void add_stiffness(const TermState<Scalar>& /*state*/, TermStiffness<Scalar>& /*out*/) {}

  /// Whether the force is minus the gradient of `energy`. If not, the energy bound counts its work, and Newton's line
  /// search its force as constant.
  [[nodiscard]] virtual bool has_energy() const { return false; }
  /// J, up to a constant.
  [[nodiscard]] virtual double energy(const TermState<Scalar>& /*state*/) { return 0; }

  /// Multiples of M and K' that the term adds to the damping matrix.
  [[nodiscard]] virtual RayleighDamping proportional_damping() const { return {}; }

  /// The largest fraction, 0 ... 1, of the way from one state to the other that is safe to go.
  [[nodiscard]] virtual double max_safe_fraction(const TermState<Scalar>& /*from*/, const TermState<Scalar>& /*to*/) {
    return 1;
  }

  /// The body at the end of an accepted step: for what a term carries on (multipliers, plastic slip).
  virtual void end_step(const TermState<Scalar>& /*end*/) {}

  /// Once the step has begun: whether it must be of backward Euler, because motion is not smooth here.
  [[nodiscard]] virtual bool needs_first_order() const { return false; }

  /// Terms that are solved for in passes return themselves.
  [[nodiscard]] virtual PiecewiseTerm<Scalar>* piecewise() { return nullptr; }

  /// Between steps: fills in what Sleep must know of the term. Where it returns false, the body never sleeps.
  [[nodiscard]] virtual bool describe_rest(TermRest& /*out*/) const { return false; }

 protected:
  StepTerm() = default;
  StepTerm(const StepTerm&) = default;
  StepTerm(StepTerm&&) noexcept = default;
  StepTerm& operator=(const StepTerm&) = default;
  StepTerm& operator=(StepTerm&&) noexcept = default;
};

/// The terms of a step besides those that the body has itself (gravity, nodal forces, damping): refers to one term, or
/// to several, which must outlive the step.
template <std::floating_point Scalar>
class Terms {
 public:
  Terms() = default;
  /// One term, which must outlive the step.
  Terms(StepTerm<Scalar>& term) : one_(&term), count_(1) {}  // NOLINT(google-explicit-constructor): as the term
  /// Several, which must outlive the step.
  Terms(std::span<StepTerm<Scalar>* const> several)  // NOLINT(google-explicit-constructor): as these
      : several_(several.data()), count_(several.size()) {}

  /// Number of terms.
  [[nodiscard]] std::size_t size() const { return count_; }
  /// Whether there is none.
  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// Term number i.
  [[nodiscard]] StepTerm<Scalar>& operator[](std::size_t i) const { return several_ == nullptr ? *one_ : *several_[i]; }

 private:
  StepTerm<Scalar>* one_ = nullptr;
  StepTerm<Scalar>* const* several_ = nullptr;
  std::size_t count_ = 0;
};

}  // namespace corotet::inline v0_1
