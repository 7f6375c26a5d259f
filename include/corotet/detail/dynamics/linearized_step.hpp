// The equation of one step and its linearisation.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/detail/assembly/add_twist.hpp>
#include <corotet/detail/assembly/assemble.hpp>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/span_of.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/lag_key.hpp>
#include <corotet/detail/dynamics/term_sum.hpp>
#include <corotet/detail/dynamics/time_step.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <cstdint>
#include <limits>
#include <optional>

namespace corotet::inline v0_1::detail {

/// The equation of a TimeStep with the elastic force linearised at x_k = x_history + gamma v_k: docs/theory.md,
/// equation 13. A v = M v_history + gamma (f + f_el(x_k)) + gamma^2 K v_k with A = M + gamma D + gamma^2 K, and f the
/// sum of all terms. K is the Tangent asked for.
///
/// D = a M + b K' with the warped stiffness K' where the step's force is linearised first. So damping has a potential
/// in each step, and the torques of the exact tangent do not enter it. Implicit terms add to A and f: see StepTerm.
template <class Body>
class LinearizedStep {
 public:
  using Scalar = typename Body::scalar_type;

  /// Memory.
  COROTET_COLD LinearizedStep(const Body& body, Tangent tangent)
      : evaluation_(body.law(), tangent),
        matrix_(body.pattern()),
        right_side_(at(body.vertex_count()), Vec3<Scalar>::Zero()),
        terms_(body.vertex_count()),
        sums_(body.vertex_count()),
        momentum_(body.vertex_count()) {
    if (body.damping().stiffness > 0) damping_.emplace(body.pattern());
  }

  [[nodiscard]] const BlockMatrix<Scalar>& matrix() const { return matrix_; }
  [[nodiscard]] const Field<Scalar>& right_side() const { return right_side_; }
  /// For terms that change the system between solves.
  [[nodiscard]] BlockMatrix<Scalar>& matrix_of_terms() { return matrix_; }
  [[nodiscard]] Field<Scalar>& right_side_of_terms() { return right_side_; }
  [[nodiscard]] std::uint64_t lag_key() const { return lag_key_number_; }
  [[nodiscard]] DeformationExtremes summary() const { return evaluation_.summary(); }
  [[nodiscard]] TermSum<Scalar>& terms() { return terms_; }
  [[nodiscard]] const TermSum<Scalar>& terms() const { return terms_; }

  /// See TwistModes::project: from the next evaluation on.
  void project_twist(bool on) {
    const bool before = evaluation_.twist.projects();
    evaluation_.twist.project(on);
    if (evaluation_.twist.projects() != before) revision_ = {};
  }

  /// Sets the cap of the twist modes for steps with this gamma (s): docs/theory.md, equation 9.
  void prepare(const Body& body, Scalar gamma) {
    const Scalar before = evaluation_.twist.cap();
    evaluation_.twist.set_cap((std::min)(0.5, body.wave_transit_time() / double(gamma)));
    if (!detail::exactly_equal(evaluation_.twist.cap(), before)) revision_ = {};
  }

  /// A state of the body for its terms: see TermState.
  [[nodiscard]] TermState<Scalar> state(const Body& body, const TimeStep<Scalar>& step,
                                        const Field<Scalar>& displacement, const Field<Scalar>& velocity,
                                        ExecutorRef executor) const {
    TermState<Scalar> state;
    state.rest = span_of(body.mesh().positions());
    state.origin = body.origin();
    state.displacement = span_of(displacement);
    state.velocities = span_of(velocity);
    state.mass = &body.mass();
    state.h = step.h;
    state.gamma = step.gamma;
    state.executor = executor;
    return state;
  }

  /// Evaluates the elastic force at the body's displacement, unless that is what was evaluated last.
  void evaluate(const Body& body, ExecutorRef executor) {
    if (revision_ == body.revision()) return;
    body.evaluate(body.displacements(), evaluation_, executor);
    revision_ = body.revision();
  }

  /// Evaluates the elastic force at another displacement.
  void evaluate(const Body& body, const Field<Scalar>& displacement, ExecutorRef executor) {
    revision_ = {};
    body.evaluate(displacement, evaluation_, executor);
  }

  /// After an accepted step, whose last evaluation was of the body's displacement: see SoftBody::commit.
  void commit(Body& body) const { body.commit(evaluation_); }

  /// The displacement that was evaluated last is the body's now.
  void mark_evaluated(const Body& body) { revision_ = body.revision(); }

  /// matrix = A at the evaluated state, without the terms that the caller gave. `first`: of this step. `often`: whether
  /// the equation is linearised at other velocities than v_k = 0.
  COROTET_COLD void assemble_matrix(const Body& body, Scalar gamma, bool first, bool often, ExecutorRef executor) {
    const Scalar mass = mass_factor(gamma), viscosity = damping_factor(gamma);
    if (first && often && viscosity > 0) {
      if (!damping_) damping_.emplace(body.pattern());
      assemble(body.law(), evaluation_, body.mass(), Scalar(0), Scalar(1), *damping_, executor);
    }
    assemble(body.law(), evaluation_, body.mass(), mass, first ? gamma * (gamma + stiffness_damping()) : gamma * gamma,
             matrix_, executor);
    if (!first && viscosity > 0) matrix_.add(viscosity, *damping_, executor);
    if (evaluation_.twist.active_share() > 0) add_twist(body.law(), evaluation_, gamma * gamma, matrix_, executor);
    lag_key_number_ = lag_key_.of(
        {double(mass), double(gamma * gamma + viscosity), body.material_revision(), body.pins().revision()});
  }

  /// right_side = M v_history + gamma f - A v: of the equation for the change of v, where v_k = 0.
  void linearize_at_rest(const Body& body, const TimeStep<Scalar>& step, const Field<Scalar>& v, ExecutorRef executor) {
    // The rows of A sum to (1 + gamma a) times those of M, because those of all elastic stiffnesses sum to zero.
    const Scalar mass = mass_factor(step.gamma);
    const bool implicit = terms_.is_implicit();
    for_vertices(body, executor, [&](Index i) {
      right_side_[at(i)] = body.mass().row_product(*body.pattern(), i, step.v_history) -
                           mass * body.mass().row_sum(i) * v[at(i)] - difference(matrix_, i, v) +
                           step.gamma * force(body, i);
      if (implicit) right_side_[at(i)] -= terms_.row_sum(i) * v[at(i)];
    });
  }

  /// The same where v = v_k, without A: right_side = M (v_history - v) + gamma (f + f_el - D v), minus the gradient of
  /// the incremental energy. Zero at pins.
  void linearize_here(const Body& body, const TimeStep<Scalar>& step, const Field<Scalar>& v, ExecutorRef executor) {
    for_vertices(body, executor, [&](Index i) {
      right_side_[at(i)] = body.mass().row_product(*body.pattern(), i, step.v_history) -
                           inertia(body, step.gamma, i, v) + step.gamma * force(body, i);
    });
    body.pins().for_each_component([&](std::size_t, Index p, int i) { right_side_[at(p)][i] = 0; });
  }

  /// Adds to the right side what a prescribed change (m/s) of a pin's velocity does to the other vertices.
  void prescribe(Index pin, const Vec3<Scalar>& change) {
    const BlockPattern& pattern = matrix_.pattern();
    for (Index k = pattern.row_start[at(pin)]; k < pattern.row_start[at(pin) + 1]; ++k)
      right_side_[at(pattern.column[at(k)])] -= matrix_.block(k).transpose() * change;
  }

  /// Adds gamma^2 K + gamma D of the caller's terms: after `assemble_matrix`.
  void add_terms_to_matrix(const TermState<Scalar>& state, bool at_rest) {
    if (terms_.has_given()) terms_.add_to_matrix(state, at_rest, matrix_);
  }

  /// Makes the equations of what is pinned stand alone, with no change.
  void eliminate_pinned_rows(const Body& body) {
    const auto& pins = body.pins();
    pins.for_each_component([&](std::size_t, Index v, int i) { right_side_[at(v)][i] = 0; });
    for (std::size_t p = 0; p < pins.vertices().size(); ++p) {
      if (pins.axes()[p].all()) matrix_.isolate(pins.vertices()[p]);
      for (int i = 0; i < 3; ++i)
        if (!pins.axes()[p].all() && pins.axes()[p][i]) matrix_.isolate(pins.vertices()[p], i);
    }
  }

  /// Adds to the change d of the velocity v of a body without pins the translation that its momentum lacks. Rows of
  /// elastic stiffnesses sum to zero, so that of the whole equation this is left, in sum over vertices:
  /// (1 + gamma a) M (v + d) = M v_history + impulses of the terms, implicit ones as they are after the translation
  /// (Galerkin projection onto translations). Neither what the solver has left nor rounding of elastic
  /// forces is in that.
  COROTET_COLD void project_linear_momentum(const Body& body, const TimeStep<Scalar>& step, const Field<Scalar>& v,
                                            Field<Scalar>& d, ExecutorRef executor) {
    const double mass = double(mass_factor(step.gamma));
    const auto lacking = momentum_(executor, [&](Index begin, Index end) {
      Vec3<double> sum = Vec3<double>::Zero();
      for (Index i = begin; i < end; ++i) {
        const Vec3<double> change = d[at(i)].template cast<double>(), before = v[at(i)].template cast<double>();
        const Vec3<double> more = step.v_history[at(i)].template cast<double>() - before;
        sum += double(body.mass().row_sum(i)) * (more - (mass - 1) * before - mass * change) +
               terms_.impulse(i, step.gamma).template cast<double>();
      }
      return DeterministicReduction<3>::Sums{sum[0], sum[1], sum[2]};
    });
    const Vec3<double> momentum(lacking[0], lacking[1], lacking[2]);
    Vec3<double> translation = momentum / (mass * body.mass().total());
    if (terms_.is_implicit()) {
      Mat3<double> all = mass * body.mass().total() * Mat3<double>::Identity();
      for (Index i = 0; i < body.vertex_count(); ++i) all += terms_.row_sum(i).template cast<double>();
      translation = all.inverse() * momentum;
    }
    const Vec3<Scalar> everywhere = translation.template cast<Scalar>();
    for_vertices(body, executor, [&](Index i) { d[at(i)] += everywhere; });
  }

  /// d . (M + gamma D) d, J, and gamma d . f, J, of the forces that have an energy at the evaluated state.
  struct DirectionalTerms {
    double curvature, slope;
  };
  [[nodiscard]] COROTET_COLD DirectionalTerms directional_terms(const Body& body, Scalar gamma, const Field<Scalar>& d,
                                                                ExecutorRef executor) {
    const auto sums = sums_(executor, [&](Index begin, Index end) {
      Sums part{};
      for (Index i = begin; i < end; ++i) {
        part[0] += static_cast<double>(d[at(i)].dot(inertia(body, gamma, i, d)));
        part[1] += static_cast<double>(d[at(i)].dot(evaluation_.vertex_force(*body.pattern(), i)));
        if (terms_.has_given()) part[1] += static_cast<double>(d[at(i)].dot(terms_.conservative_force(i)));
      }
      return part;
    });
    return {sums[0], double(gamma) * sums[1]};
  }

  /// right_side . d.
  [[nodiscard]] double right_side_dot(const Field<Scalar>& d, ExecutorRef executor) {
    return sums_(executor, [&](Index begin, Index end) { return Sums{range_dot(right_side_, d, begin, end), 0}; })[0];
  }

  /// |right_side| in the norm of the inverse of the matrix's diagonal, which may be negative: Tangent::consistent.
  [[nodiscard]] double right_side_norm(ExecutorRef executor) {
    return detail::square_root(sums_(executor, [&](Index begin, Index end) {
      double sum = 0;
      for (Index i = begin; i < end; ++i)
        sum += right_side_[at(i)].template cast<double>().squaredNorm() /  // whose range float would leave
               std::fabs(static_cast<double>(matrix_.diagonal(i).trace()));
      return Sums{sum, 0};
    })[0]);
  }

  /// How far the rounding of positions goes in the energy norm of velocities, sqrt(J): no correction is worth less.
  [[nodiscard]] COROTET_COLD double position_rounding(const Body& body, Scalar gamma, ExecutorRef executor) {
    const double sum = sums_(executor, [&](Index begin, Index end) {
      double part = 0;
      for (Index i = begin; i < end; ++i) {
        const Scalar size2 = body.mesh().position(i).squaredNorm() + body.displacements()[at(i)].squaredNorm();
        part += std::fabs(static_cast<double>(matrix_.diagonal(i).trace())) / 3 * static_cast<double>(size2);
      }
      return Sums{part, 0};
    })[0];
    return 4 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) / double(gamma) * detail::square_root(sum);
  }

  /// Elastic and of all terms on a vertex, at the evaluated state, N.
  [[nodiscard]] Vec3<Scalar> force(const Body& body, Index i) const {
    return evaluation_.vertex_force(*body.pattern(), i) + terms_.force(i);
  }

  [[nodiscard]] MemoryUse memory() const {
    return MemoryUse{evaluation_.bytes() + matrix_.bytes() + (damping_ ? damping_->bytes() : 0) + bytes_of(right_side_),
                     0} +
           terms_.memory() + sums_.memory() + momentum_.memory();
  }

  /// For snapshots. What was evaluated is found again from the displacement.
  void visit_state(detail::StateArchive& archive, const Body& body) {
    lag_key_.visit_state(archive, body.material_revision(), body.pins().revision());
    if (archive.reads()) revision_ = {};
  }

 private:
  using Sums = DeterministicReduction<2>::Sums;

  [[nodiscard]] Scalar mass_factor(Scalar gamma) const {
    return static_cast<Scalar>(1 + static_cast<double>(gamma) * terms_.damping().mass);
  }
  [[nodiscard]] Scalar stiffness_damping() const { return static_cast<Scalar>(terms_.damping().stiffness); }
  [[nodiscard]] Scalar damping_factor(Scalar gamma) const { return gamma * stiffness_damping(); }

  /// ((M + gamma D) v) of a vertex.
  [[nodiscard]] Vec3<Scalar> inertia(const Body& body, Scalar gamma, Index i, const Field<Scalar>& v) const {
    Vec3<Scalar> sum = mass_factor(gamma) * body.mass().row_product(*body.pattern(), i, v);
    if (stiffness_damping() > 0) sum += damping_factor(gamma) * difference(*damping_, i, v);
    return sum;
  }

  [[nodiscard]] static Vec3<Scalar> difference(const BlockMatrix<Scalar>& matrix, Index i, const Field<Scalar>& v) {
    Vec3<Scalar> product;
    matrix.row_difference(i, v).template store_part<3>(product.data());
    return product;
  }

  template <std::invocable<Index> Visit>
  static void for_vertices(const Body& body, ExecutorRef executor, Visit&& visit) {
    for_ranges(executor, body.vertex_count(), BlockMatrix<Scalar>::row_grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) visit(i);
    });
  }

  typename Body::Law::Evaluation evaluation_;
  ScratchMatrix<Scalar> matrix_;
  std::optional<ScratchMatrix<Scalar>> damping_;  // K' of D, where A alone does not do
  Field<Scalar> right_side_;
  TermSum<Scalar> terms_;
  DeterministicReduction<2> sums_;
  DeterministicReduction<3> momentum_;
  ScratchRevision revision_;  // of the body's state in evaluation_, if it is one
  LagKey lag_key_;
  std::uint64_t lag_key_number_ = 0;
};

}  // namespace corotet::inline v0_1::detail
