// The equation of one step and its linearisation.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/assembly/add_twist.hpp>
#include <corotet/assembly/assemble.hpp>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/exactly.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/revision.hpp>
#include <corotet/core/types.hpp>
#include <corotet/dynamics/system_era.hpp>
#include <corotet/solve/range_sum.hpp>
#include <cstdint>
#include <limits>
#include <optional>

namespace corotet::inline v0_1 {

/// What an integrator asks for: v = vbar + c M^-1 (f_ext + f_el(x) - D v), x = xbar + c v.
template <std::floating_point Scalar>
struct StepFormula {
  Scalar c;                       ///< s
  const Field<Scalar>& position;  ///< xbar, as displacement from rest, m
  const Field<Scalar>& velocity;  ///< vbar, m/s
  Scalar h;                       ///< length of the step, s
  /// The force is linearised first where the body will be in this time (s) at its present velocity; or in its present
  /// state, which must then be xbar.
  std::optional<Scalar> ahead;
};

/// v' = v + h M^-1 (f_ext + f_el(x') - D v'), x' = x + h v', linearised where the body is.
template <class Body>
[[nodiscard]] StepFormula<typename Body::scalar_type> backward_euler(const Body& body, typename Body::scalar_type h) {
  return {.c = h, .position = body.displacements(), .velocity = body.velocities(), .h = h, .ahead = {}};
}

/// With the force linearised at x_k = xbar + c v_k, f_el(x) = f_el(x_k) - K (x - x_k), the new velocity of a
/// StepFormula follows from A v = M vbar + c (f_ext + f_el(x_k)) + c^2 K v_k, A = M + c D + c^2 K. K is the Tangent
/// asked for, and D = a M + b K' with the warped stiffness K' where the step's force is linearised first: so damping
/// has a potential in each step, and the torques of the exact tangent do not enter it.
template <class Body>
class StepEquation {
 public:
  using Scalar = typename Body::scalar_type;

  /// Memory.
  COROTET_COLD StepEquation(const Body& body, Tangent tangent)
      : evaluation_(body.law(), tangent),
        matrix_(body.pattern()),
        right_side_(at(body.vertex_count()), Vec3<Scalar>::Zero()),
        sums_(body.vertex_count()),
        momentum_(body.vertex_count()) {
    if (body.damping().stiffness > 0) damping_.emplace(body.pattern());
  }

  [[nodiscard]] const BlockMatrix<Scalar>& matrix() const { return matrix_; }
  [[nodiscard]] const Field<Scalar>& right_side() const { return right_side_; }
  [[nodiscard]] std::uint64_t era() const { return era_number_; }
  [[nodiscard]] DeformationExtremes worst() const { return evaluation_.worst(); }

  /// See TwistModes::project: from the next evaluation on.
  void project_twist(bool on) {
    const bool before = evaluation_.twist.projects();
    evaluation_.twist.project(on);
    if (evaluation_.twist.projects() != before) revision_ = {};
  }

  /// Before a step with this c, s. A bar that is pulled straightens by the stress s, besides its stiffness in bending.
  /// One solve a step comes to rest if what the matrix leaves out of that is less than 4 M / c^2 and the stiffness
  /// together, for each wave length; so if s is less than sqrt(4/3 rho E) thickness / c, a twist mode of s / 2.
  void prepare(const Body& body, Scalar c) {
    const Scalar before = evaluation_.twist.left();
    evaluation_.twist.leave((std::min)(0.5, body.crossing_time() / double(c)));
    if (!detail::exactly_equal(evaluation_.twist.left(), before)) revision_ = {};
  }

  /// Evaluates the body's displacement, unless that is what was evaluated last.
  void evaluate(const Body& body, ExecutorRef executor) {
    if (revision_ == body.revision()) return;
    body.law().evaluate(body.displacements(), evaluation_, executor);
    revision_ = body.revision();
  }

  /// Evaluates another displacement.
  void evaluate(const Body& body, const Field<Scalar>& displacement, ExecutorRef executor) {
    revision_ = {};
    body.law().evaluate(displacement, evaluation_, executor);
  }

  /// The displacement that was evaluated last is the body's now.
  void adopt(const Body& body) { revision_ = body.revision(); }

  /// matrix = A at the evaluated state. `first`: of this step. `often`: whether the equation is linearised at other
  /// velocities than v_k = 0.
  void build_matrix(const Body& body, Scalar c, bool first, bool often, ExecutorRef executor) {
    const Scalar mass = mass_factor(body, c), viscosity = damping_factor(body, c);
    if (first && often && damping_)
      assemble(body.law(), evaluation_, body.mass(), Scalar(0), Scalar(1), *damping_, executor);
    assemble(body.law(), evaluation_, body.mass(), mass, first ? c * (c + body_damping(body)) : c * c, matrix_,
             executor);
    if (!first && damping_) matrix_.add(viscosity, *damping_, executor);
    if (evaluation_.twist.active_share() > 0) add_twist(body.law(), evaluation_, c * c, matrix_, executor);
    era_number_ = era_.of({double(mass), double(c * c + viscosity), body.material_revision(), body.pins().revision()});
  }

  /// right_side = M vbar + c f - A v: of the equation for the change of v, where v_k = 0.
  void linearise_at_rest(const Body& body, const StepFormula<Scalar>& formula, const Field<Scalar>& v,
                         ExecutorRef executor) {
    // The rows of A sum to (1 + c a) times those of M, because those of all stiffnesses sum to zero.
    const Scalar mass = mass_factor(body, formula.c);
    for_rows(body, executor, [&](Index i) {
      right_side_[at(i)] = body.mass().row_product(*body.pattern(), i, formula.velocity) -
                           mass * body.mass().row_sum(i) * v[at(i)] - difference(matrix_, i, v) +
                           formula.c * force(body, i);
    });
  }

  /// The same where v = v_k, without A: right_side = M (vbar - v) + c (f_ext + f_el - D v), minus the gradient of the
  /// incremental energy. Zero at pins.
  void linearise_here(const Body& body, const StepFormula<Scalar>& formula, const Field<Scalar>& v,
                      ExecutorRef executor) {
    for_rows(body, executor, [&](Index i) {
      right_side_[at(i)] = body.mass().row_product(*body.pattern(), i, formula.velocity) -
                           inertia(body, formula.c, i, v) + formula.c * force(body, i);
    });
    for (const Index p : body.pins().vertices()) right_side_[at(p)].setZero();
  }

  /// What a change of a pin's velocity adds to the right side.
  void lead(Index pin, const Vec3<Scalar>& change) {
    const BlockPattern& pattern = matrix_.pattern();
    for (Index k = pattern.row_start[at(pin)]; k < pattern.row_start[at(pin) + 1]; ++k)
      right_side_[at(pattern.column[at(k)])] -= matrix_.block(k).transpose() * change;
  }

  /// From now on forces besides gravity turn with `q`, but for what only moves the centre of mass, `mean` (N/kg).
  void turn_forces(const Mat3<double>& q, const Vec3<double>& mean) {
    force_turn_ = q.template cast<Scalar>();
    mean_force_ = mean.template cast<Scalar>();
    turns_forces_ = true;
  }
  void leave_forces() { turns_forces_ = false; }

  /// Of a vertex, besides gravity, N.
  [[nodiscard]] Vec3<Scalar> external_force(const Body& body, Index i) const {
    const Vec3<Scalar>& f = body.external_forces()[at(i)];
    if (!turns_forces_) return f;
    const Vec3<Scalar> mean = body.mass().row_sum(i) * mean_force_;
    return force_turn_ * (f - mean) + mean;
  }

  /// Makes the pins' equations stand alone, with no change.
  void isolate_pins(const Body& body) {
    for (const Index v : body.pins().vertices()) {
      right_side_[at(v)].setZero();
      matrix_.isolate(v);
    }
  }

  /// Adds to the change d of the velocity v of a body without pins the translation that its momentum lacks. Rows of all
  /// stiffnesses sum to zero, so that of the whole equation this is left: (1 + c a) M (v + d) = M vbar + c f_ext, in
  /// sum. Neither what the solver has left nor rounding of elastic forces is in that.
  void settle_momentum(const Body& body, const StepFormula<Scalar>& formula, const Field<Scalar>& v, Field<Scalar>& d,
                       ExecutorRef executor) {
    const double mass = double(mass_factor(body, formula.c)), c = double(formula.c);
    const auto lacking = momentum_(executor, [&](Index begin, Index end) {
      Vec3<double> sum = Vec3<double>::Zero();
      for (Index i = begin; i < end; ++i) {
        const Vec3<double> change = d[at(i)].template cast<double>(), before = v[at(i)].template cast<double>();
        const Vec3<double> more = formula.velocity[at(i)].template cast<double>() - before;
        sum += double(body.mass().row_sum(i)) * (more - (mass - 1) * before - mass * change) +
               c * body.external_forces()[at(i)].template cast<double>();
      }
      return RangeSums<3>::Sums{sum[0], sum[1], sum[2]};
    });
    const Vec3<double> momentum = Vec3<double>(lacking[0], lacking[1], lacking[2]) +
                                  c * body.mass().total() * body.gravity().template cast<double>();
    const Vec3<Scalar> translation = (momentum / (mass * body.mass().total())).template cast<Scalar>();
    for_rows(body, executor, [&](Index i) { d[at(i)] += translation; });
  }

  /// d . (M + c D) d, J, and c d . f_el, J, at the evaluated state.
  struct AlongLine {
    double curvature, elastic;
  };
  [[nodiscard]] AlongLine along(const Body& body, Scalar c, const Field<Scalar>& d, ExecutorRef executor) {
    const auto sums = sums_(executor, [&](Index begin, Index end) {
      Sums part{};
      for (Index i = begin; i < end; ++i) {
        part[0] += static_cast<double>(d[at(i)].dot(inertia(body, c, i, d)));
        part[1] += static_cast<double>(d[at(i)].dot(evaluation_.vertex_force(*body.pattern(), i)));
      }
      return part;
    });
    return {sums[0], double(c) * sums[1]};
  }

  /// right_side . d.
  [[nodiscard]] double right_side_dot(const Field<Scalar>& d, ExecutorRef executor) {
    return sums_(executor, [&](Index begin, Index end) { return Sums{range_dot(right_side_, d, begin, end), 0}; })[0];
  }

  /// |right_side| in the norm of the inverse of the matrix's diagonal, which may be negative: Tangent::exact.
  [[nodiscard]] double right_side_norm(ExecutorRef executor) {
    return std::sqrt(sums_(executor, [&](Index begin, Index end) {
      double sum = 0;
      for (Index i = begin; i < end; ++i)
        sum += right_side_[at(i)].template cast<double>().squaredNorm() /  // whose range float would leave
               std::fabs(static_cast<double>(matrix_.diagonal(i).trace()));
      return Sums{sum, 0};
    })[0]);
  }

  /// How far the rounding of positions goes in the energy norm of velocities, sqrt(J): no correction is worth less.
  [[nodiscard]] COROTET_COLD double position_rounding(const Body& body, Scalar c, ExecutorRef executor) {
    const double sum = sums_(executor, [&](Index begin, Index end) {
      double part = 0;
      for (Index i = begin; i < end; ++i) {
        const Scalar size2 = body.mesh().position(i).squaredNorm() + body.displacements()[at(i)].squaredNorm();
        part += std::fabs(static_cast<double>(matrix_.diagonal(i).trace())) / 3 * static_cast<double>(size2);
      }
      return Sums{part, 0};
    })[0];
    return 4 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) / double(c) * std::sqrt(sum);
  }

  /// f_ext + f_el of a vertex at the evaluated state, N.
  [[nodiscard]] Vec3<Scalar> force(const Body& body, Index i) const {
    return evaluation_.vertex_force(*body.pattern(), i) + external_force(body, i) +
           body.mass().row_sum(i) * body.gravity();
  }

 private:
  using Sums = RangeSums<2>::Sums;

  [[nodiscard]] static Scalar mass_factor(const Body& body, Scalar c) {
    return static_cast<Scalar>(1 + static_cast<double>(c) * body.damping().mass);
  }
  [[nodiscard]] static Scalar body_damping(const Body& body) { return static_cast<Scalar>(body.damping().stiffness); }
  [[nodiscard]] static Scalar damping_factor(const Body& body, Scalar c) { return c * body_damping(body); }

  /// ((M + c D) v) of a vertex.
  [[nodiscard]] Vec3<Scalar> inertia(const Body& body, Scalar c, Index i, const Field<Scalar>& v) const {
    Vec3<Scalar> sum = mass_factor(body, c) * body.mass().row_product(*body.pattern(), i, v);
    if (damping_) sum += damping_factor(body, c) * difference(*damping_, i, v);
    return sum;
  }

  [[nodiscard]] static Vec3<Scalar> difference(const BlockMatrix<Scalar>& matrix, Index i, const Field<Scalar>& v) {
    Vec3<Scalar> product;
    matrix.row_difference(i, v).template store_part<3>(product.data());
    return product;
  }

  template <std::invocable<Index> Row>
  static void for_rows(const Body& body, ExecutorRef executor, Row&& row) {
    for_ranges(executor, body.vertex_count(), BlockMatrix<Scalar>::row_grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) row(i);
    });
  }

  typename Body::Law::Evaluation evaluation_;
  BlockMatrix<Scalar> matrix_;
  std::optional<BlockMatrix<Scalar>> damping_;  // K' of D, where A alone does not do
  Field<Scalar> right_side_;
  RangeSums<2> sums_;
  RangeSums<3> momentum_;
  Revision revision_;  // of the body's state in evaluation_, if it is one
  Mat3<Scalar> force_turn_ = Mat3<Scalar>::Identity();
  Vec3<Scalar> mean_force_ = Vec3<Scalar>::Zero();
  bool turns_forces_ = false;
  SystemEra era_;
  std::uint64_t era_number_ = 0;
};

}  // namespace corotet::inline v0_1
