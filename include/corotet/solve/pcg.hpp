// Preconditioned conjugate gradients.
#pragma once

#include <cmath>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/dot.hpp>
#include <corotet/solve/solver.hpp>

namespace corotet {

struct PcgOptions {
  /// Stop when |b - A x| <= tolerance * |b|, both in the norm sqrt(r . P r) of the preconditioner P, which measures
  /// every vertex against its own stiffness. 0 < tolerance < 1. What float can reach depends on how stiff the body is
  /// against its inertia; a tolerance beyond that ends as `stagnated`, with the residual that was reached.
  double tolerance = 1e-3;
  int max_iterations = 2000;  ///< >= 0; reaching it is reported, never silent
};

/// Hestenes & Stiefel 1952, with a preconditioner (Saad 2003, algorithm 9.1). Keeps its vectors between solves.
template <std::floating_point Scalar>
class Pcg {
 public:
  Pcg() = default;
  explicit Pcg(Index vertices)
      : r_(at(vertices)), z_(at(vertices)), p_(at(vertices)), q_(at(vertices)), dot_(vertices) {}

  /// Solves A x = b from x = 0. The residual that is reported is that of the x returned, measured; where rounding has
  /// made it larger than the iteration believed, the iteration starts again from x, as long as that helps.
  template <LinearOperator<Scalar> A, Preconditioner<Scalar> P, Executor E>
  SolveReport solve(const A& matrix, const P& preconditioner, const Field<Scalar>& b, Field<Scalar>& x,
                    const PcgOptions& options, E& executor) {
    flat(x).setZero();
    SolveReport report;
    if (!(options.tolerance > 0 && options.tolerance < 1) || options.max_iterations < 0)
      return {SolveStatus::invalid_options, 0, 1.0};
    r_ = b;
    preconditioner.apply(r_, z_, executor);
    const double start = dot_(r_, z_, executor);
    if (!std::isfinite(start) || start < 0) return {SolveStatus::breakdown, 0, 1.0};
    if (start == 0) return report;

    const double target = options.tolerance * options.tolerance * start;
    for (double before = start;;) {
      iterate(matrix, preconditioner, x, before, target, options.max_iterations, report, executor);
      matrix.apply(x, q_, executor);
      update(executor, [&](auto s) { s(flat(r_)) = s(flat(b)) - s(flat(q_)); });
      preconditioner.apply(r_, z_, executor);
      const double measured = dot_(r_, z_, executor);
      if (!std::isfinite(measured)) report.status = SolveStatus::breakdown;
      report.residual = std::sqrt(measured / start);
      if (measured <= target || report.status != SolveStatus::converged) return report;
      if (measured > before / 4) {  // half the residual at least, or rounding has taken over
        report.status = SolveStatus::stagnated;
        return report;
      }
      before = measured;
    }
  }

 private:
  /// Conjugate gradients from x, whose residual is r_ with z_ = P r_ and r_ . z_ = rz, until the residual that the
  /// recursion follows has reached the target.
  template <class A, class P, Executor E>
  void iterate(const A& matrix, const P& preconditioner, Field<Scalar>& x, double rz, double target, int max_iterations,
               SolveReport& report, E& executor) {
    p_ = z_;
    while (rz > target) {
      if (report.iterations == max_iterations) {
        report.status = SolveStatus::iteration_limit;
        return;
      }
      matrix.apply(p_, q_, executor);
      ++report.iterations;
      const double curvature = dot_(p_, q_, executor);
      if (!(curvature > 0) || !std::isfinite(curvature)) {
        report.status = SolveStatus::breakdown;
        return;
      }
      const auto alpha = static_cast<Scalar>(rz / curvature);
      update(executor, [&](auto s) {
        s(flat(x)) += alpha * s(flat(p_));
        s(flat(r_)) -= alpha * s(flat(q_));
      });
      preconditioner.apply(r_, z_, executor);
      const double rz_next = dot_(r_, z_, executor);
      if (!std::isfinite(rz_next) || rz_next < 0) {
        report.status = SolveStatus::breakdown;
        return;
      }
      const auto beta = static_cast<Scalar>(rz_next / rz);
      update(executor, [&](auto s) { s(flat(p_)) = s(flat(z_)) + beta * s(flat(p_)); });
      rz = rz_next;
    }
  }

  /// Calls `body(s)` for each range of vertices, where s(v) is that range of a flat vector.
  template <Executor E, class Body>
  void update(E& executor, Body&& body) {
    for_ranges(executor, size_of(r_), DotProduct::grain, [&](Index begin, Index end) {
      body([begin, end](auto&& v) { return v.segment(Eigen::Index{3} * begin, Eigen::Index{3} * (end - begin)); });
    });
  }

  Field<Scalar> r_, z_, p_, q_;
  DotProduct dot_;
};

}  // namespace corotet
