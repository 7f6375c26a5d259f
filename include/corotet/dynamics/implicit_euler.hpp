// Backward Euler with one linear solve a step.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/assembly/assemble.hpp>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/assert.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <corotet/dynamics/soft_body.hpp>
#include <corotet/dynamics/step_phase.hpp>
#include <corotet/dynamics/step_report.hpp>
#include <corotet/dynamics/system_era.hpp>
#include <corotet/solve/auto_solver.hpp>
#include <corotet/solve/solver.hpp>
#include <cstdint>
#include <utility>

namespace corotet {

/// One step solves (M + h D + h^2 K') dv = h (f_ext + f_el(x) - D v) - h^2 K' v, then v += dv, x += h v, with the
/// warped stiffness K' at the start of the step and D = a M + b K' (Müller & Gross 2004, section 3.4; Baraff & Witkin
/// 1998, eq. 6). In the form used here, A (v + dv) = M v + h (f_ext + f_el) with A = M + h D + h^2 K', only A is
/// needed.
///
/// The integrator owns all that a step needs besides the body: make it once for a body, then `step` allocates nothing.
template <class Body, class Solver = AutoSolver<typename Body::scalar_type>>
  requires LinearSolver<Solver, typename Body::scalar_type>
class ImplicitEuler {
 public:
  using Scalar = typename Body::scalar_type;

  /// Symbolic work and memory for `body` and its copies.
  explicit ImplicitEuler(const Body& body, Solver solver = Solver())
      : solver_(std::move(solver)),
        evaluation_(body.law()),
        matrix_(body.pattern()),
        right_side_(at(body.vertex_count()), Vec3<Scalar>::Zero()),
        change_(right_side_),
        velocity_(right_side_),
        displacement_(right_side_) {
    solver_.analyze(body.pattern(), body.mesh().positions());
  }
  ImplicitEuler(const Body& body, const typename Solver::Options& options) : ImplicitEuler(body, Solver(options)) {}

  [[nodiscard]] const Solver& solver() const { return solver_; }

  /// Advances `body` by `h` seconds. Whatever happens is in the report; a refused step leaves the body untouched.
  /// `observer` is told of each phase as it begins.
  template <Executor E, StepObserver O = IgnorePhases>
  StepReport step(Body& body, Scalar h, E& executor, O&& observer = O()) {
    COROTET_ASSERT(body.pattern() == matrix_.shared_pattern(), "this integrator was made for another body");
    StepReport report = check_input(body, h);
    if (!report.accepted()) return report;
    observer(StepPhase::assembly);
    evaluate(body, executor);
    build_system(body, h, executor);

    observer(StepPhase::solve);
    const StepSystem<Scalar> system{matrix_, right_side_, body.displacements(), body.pins().vertices(), era_number_};
    const SolveReport solve = solver_.solve(system, change_, executor);
    report.converged = solve.status == SolveStatus::converged;
    report.iterations = solve.iterations;
    report.residual = solve.residual;
    if (solve.status == SolveStatus::breakdown) return refuse(report, Refusal::solver_breakdown);
    if (solve.status == SolveStatus::invalid_options) return refuse(report, Refusal::solver_options);

    observer(StepPhase::update);
    flat(velocity_) += flat(change_);
    flat(displacement_) = flat(body.displacements()) + h * flat(velocity_);
    for (std::size_t p = 0; p < body.pins().vertices().size(); ++p)  // exactly there, without rounding of h * v
      displacement_[at(body.pins().vertices()[p])] = body.pins().targets()[p];
    if (!flat(velocity_).allFinite() || !flat(displacement_).allFinite()) return refuse(report, Refusal::overflow);

    body.swap_state(displacement_, velocity_);
    evaluate(body, executor);
    const DeformationExtremes worst = evaluation_.worst();
    report.inverted_elements = worst.inverted_elements;
    report.largest_rotation = worst.largest_rotation();
    report.largest_strain = worst.largest_strain();
    return report;
  }
  StepReport step(Body& body, Scalar h) {
    SerialExecutor serial;
    return step(body, h, serial);
  }

 private:
  static StepReport refuse(StepReport report, Refusal why, Index vertex = -1) {
    report.refusal = why;
    report.vertex = vertex;
    report.converged = false;
    return report;
  }

  [[nodiscard]] static StepReport check_input(const Body& body, Scalar h) {
    if (!(h > 0) || !std::isfinite(h)) return refuse({}, Refusal::time_step);
    if (!body.gravity().allFinite()) return refuse({}, Refusal::gravity);
    const auto force = body.external_forces();
    for (std::size_t v = 0; v < force.size(); ++v)
      if (!force[v].allFinite()) return refuse({}, Refusal::external_force, static_cast<Index>(v));
    for (std::size_t p = 0; p < body.pins().targets().size(); ++p)
      if (!body.pins().targets()[p].allFinite()) return refuse({}, Refusal::pin_target, body.pins().vertices()[p]);
    return {};
  }

  /// Brings `evaluation_` up to the body's displacement, unless it is there already from the end of the last step.
  template <Executor E>
  void evaluate(const Body& body, E& executor) {
    if (revision_ == body.revision()) return;
    body.law().evaluate(body.displacements(), evaluation_, executor);
    revision_ = body.revision();
  }

  /// matrix_ = A with pinned vertices taken out; velocity_ = v with the pins' velocities put in;
  /// right_side_ = M v + h f - A velocity_, zero at pins.
  template <Executor E>
  void build_system(const Body& body, Scalar h, E& executor) {
    const auto [mass_damping, stiffness_damping] = body.damping();
    const auto mass_factor = static_cast<Scalar>(1 + h * mass_damping);
    const auto stiffness_factor = static_cast<Scalar>(h * (h + stiffness_damping));
    assemble(body.law(), evaluation_, body.mass(), mass_factor, stiffness_factor, matrix_, executor);
    era_number_ =
        era_.of({double(mass_factor), double(stiffness_factor), body.material_revision(), body.pins().revision()});

    velocity_ = body.velocities();
    const auto& pinned = body.pins().vertices();
    for (std::size_t p = 0; p < pinned.size(); ++p)
      velocity_[at(pinned[p])] = (body.pins().targets()[p] - body.displacements()[at(pinned[p])]) / h;

    for_ranges(executor, body.vertex_count(), BlockMatrix<Scalar>::row_grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const Vec3<Scalar> force = evaluation_.vertex_force(*body.pattern(), i) + body.external_forces()[at(i)] +
                                   body.mass().row_sum(i) * body.gravity();
        // The rows of A sum to (1 + h a) times those of M, because those of K' sum to zero.
        Vec3<Scalar> product;
        matrix_.row_difference(i, velocity_).template store_part<3>(product.data());
        right_side_[at(i)] = body.mass().row_product(*body.pattern(), i, body.velocities()) -
                             mass_factor * body.mass().row_sum(i) * velocity_[at(i)] - product + h * force;
      }
    });
    for (const Index v : pinned) {
      right_side_[at(v)].setZero();
      matrix_.isolate(v);
    }
  }

  Solver solver_;
  typename Body::Law::Evaluation evaluation_;
  BlockMatrix<Scalar> matrix_;
  Field<Scalar> right_side_, change_, velocity_, displacement_;
  std::uint64_t revision_ = 0;  // of the state in evaluation_
  SystemEra era_;
  std::uint64_t era_number_ = 0;
};

}  // namespace corotet
