// Whether a step has made energy out of nothing.
#pragma once

#include <algorithm>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/linearized_step.hpp>
#include <corotet/detail/dynamics/time_step.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <limits>

namespace corotet::inline v0_1::detail {

/// Compares the energy after a step with that before it and the work of terms and pins.
///
/// Backward Euler, solved exactly, gains no energy where the elastic energy is convex along the step: docs/theory.md,
/// equation 17. One linear solve may, above all in nearly incompressible bodies. Steps in which pins move a body with
/// stiffness damping are not compared: the work of the pins is not known there.
template <class Body>
class EnergyBound {
 public:
  using Scalar = typename Body::scalar_type;
  using Equation = LinearizedStep<Body>;

  explicit EnergyBound(const Body& body)
      : scratch_(body.law().mean_dilatation().scratch_size()),
        sums_(body.vertex_count()),
        vertices_(body.vertex_count()) {}

  /// W at a displacement, J.
  [[nodiscard]] double elastic(const Body& body, const Field<Scalar>& displacement, ExecutorRef executor) {
    return body.elastic_energy(displacement, {scratch_.data(), scratch_.size()}, executor);
  }

  /// Before a step. `evaluated`: what the equation has evaluated last is the body's present displacement. `terms`: the
  /// energy of its terms there, J.
  void begin(const Body& body, const Equation& equation, bool evaluated, double terms, ExecutorRef executor) {
    terms_ = terms;
    if (revision_ == body.revision())
      elastic_ = elastic_after_;
    else
      elastic_ = evaluated ? equation.summary().energy : elastic(body, body.displacements(), executor);
  }

  /// After the solve, from `velocity_before` and the body's displacement to these. Kinetic energy is as seen from the
  /// frame in which the step was solved. Terms without an energy give the work of their impulses; `terms`: the energy
  /// of the others now, J.
  void solved(const Body& body, const Equation& equation, Scalar gamma, const Field<Scalar>& velocity_before,
              const Field<Scalar>& displacement, const Field<Scalar>& velocity, double terms, ExecutorRef executor) {
    const auto in_double = [](const Field<Scalar>& field) {
      return [&field](Index i) -> Vec3<double> { return field[at(i)].template cast<double>(); };
    };
    const auto v0 = in_double(velocity_before), v1 = in_double(velocity);
    const auto sums = sums_(executor, [&](Index begin, Index end) {
      DeterministicReduction<5>::Sums part{};
      for (Index i = begin; i < end; ++i) {
        const auto of = [&](auto&& x) { return body.mass().row_product(*body.pattern(), i, x); };
        const Vec3<double> moved = (displacement[at(i)] - body.displacements()[at(i)]).template cast<double>();
        const Vec3<double> given =
            equation.terms().working_impulse(i, gamma).template cast<double>() / static_cast<double>(gamma);
        part[0] +=
            (v1(i) - v0(i)).dot(of([&](Index j) -> Vec3<double> { return v1(j) + v0(j); })) / 2 - moved.dot(given);
        const Vec3<double> momentum = of(v1);
        part[1] += v1(i).dot(momentum) / 2;
        for (int k = 0; k < 3; ++k) part[at(2 + k)] += momentum[k];
      }
      return part;
    });
    gained_ = sums[0] + terms - terms_;
    kinetic_ = sums[1] - Vec3<double>::load(&sums[2]).squaredNorm() / (2 * body.mass().total());
  }

  /// Once the body has moved and been evaluated: whether it has gained more than rounding explains. The error of steps
  /// of second order has either sign: what they gain is summed until steps lose it again, or a step is of
  /// backward Euler, and may be `max_gain` of the elastic energy before and after and the kinetic one about the mean
  /// motion. The fields are those before.
  [[nodiscard]] bool exceeds(const Body& body, const TimeStep<Scalar>& step, const Field<Scalar>& displacement_before,
                             const Field<Scalar>& velocity_before, Equation& equation, ExecutorRef executor) {
    const DeformationExtremes worst = equation.summary();
    elastic_after_ = worst.energy;
    revision_ = body.revision();
    const bool second_order = !step.is_first_order();
    if (!second_order) excess_ = 0;
    if (worst.max_stress2 < min_stress * min_stress) return false;
    double gained = gained_ + elastic_after_ - elastic_;
    const auto& pins = body.pins();
    for (std::size_t k = 0; k < pins.vertices().size(); ++k) {  // the work of what leads them
      const Index p = pins.vertices()[k];
      Vec3<Scalar> moved = body.displacements()[at(p)] - displacement_before[at(p)];
      for (int i = 0; i < 3; ++i)
        if (!pins.axes()[k][i]) moved[i] = 0;
      if (!moved.isZero() && equation.terms().damping().stiffness > 0) return false;  // which would need K' here
      const auto change = [&](Index j) -> Vec3<Scalar> { return body.velocities()[at(j)] - velocity_before[at(j)]; };
      const Vec3<Scalar> pull = body.mass().row_product(*body.pattern(), p, change) / step.h - equation.force(body, p) +
                                static_cast<Scalar>(equation.terms().damping().mass) *
                                    body.mass().row_product(*body.pattern(), p, body.velocities());
      gained -= static_cast<double>(pull.dot(moved));
    }
    const double stored = elastic_after_ + elastic_;
    if (second_order) gained = excess_ = (std::max)(0.0, excess_ + gained);
    if (!(gained > (rounding + (second_order ? max_gain : 0)) * (stored + kinetic_))) return false;
    return gained > noise(stored, equation.position_rounding(body, step.gamma, executor));
  }

  /// What rounding may add to an elastic energy, J: relative to itself, and by the forces on positions that are rounded
  /// at random, sqrt(J) in all.
  [[nodiscard]] double noise(double energy, double position_rounding) const {
    return rounding * energy +
           position_rounding * (detail::square_root(2 * energy / vertices_) + position_rounding / vertices_);
  }

  [[nodiscard]] MemoryUse memory() const { return MemoryUse{bytes_of(scratch_), 0} + sums_.memory(); }

  /// For snapshots.
  void visit_state(StateArchive& archive, const Body& body) {
    archive(elastic_after_);
    archive(excess_);
    visit_revision(archive, revision_, body.revision());
  }

 private:
  static constexpr double rounding = 16 * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  static constexpr double max_gain = 1e-4;
  /// The largest stress over mu from which on a gain counts. A stiff body that turns about a pinned axle stretches by
  /// (h w)^2 / 2 in each step, and is drawn back in the next: to solve that again would only damp its rotation.
  static constexpr double min_stress = 0.1;

  Buffer<double> scratch_;
  DeterministicReduction<5> sums_;
  double vertices_;
  double elastic_ = 0, elastic_after_ = 0, terms_ = 0, gained_ = 0, kinetic_ = 0, excess_ = 0;  // J
  Revision revision_;  // of the body that has elastic_after_
};

}  // namespace corotet::inline v0_1::detail
