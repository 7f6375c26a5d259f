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
  /// every vertex against its own stiffness. > 0; below about 1e-6 in float rounding takes over.
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

  /// Solves A x = b from x = 0.
  template <LinearOperator<Scalar> A, Preconditioner<Scalar> P, Executor E>
  SolveReport solve(const A& matrix, const P& preconditioner, const Field<Scalar>& b, Field<Scalar>& x,
                    const PcgOptions& options, E& executor) {
    flat(x).setZero();
    r_ = b;
    preconditioner.apply(r_, z_, executor);
    double rz = dot_(r_, z_, executor);
    const double start = rz;
    SolveReport report;
    if (!std::isfinite(start) || start < 0) return {SolveStatus::breakdown, 0, 1.0};
    if (start == 0) return report;
    p_ = z_;

    const double target = options.tolerance * options.tolerance * start;
    while (rz > target) {
      if (report.iterations == options.max_iterations) {
        report.status = SolveStatus::iteration_limit;
        break;
      }
      matrix.apply(p_, q_, executor);
      ++report.iterations;
      const double curvature = dot_(p_, q_, executor);
      if (!(curvature > 0) || !std::isfinite(curvature)) {
        report.status = SolveStatus::breakdown;
        break;
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
        break;
      }
      const auto beta = static_cast<Scalar>(rz_next / rz);
      update(executor, [&](auto s) { s(flat(p_)) = s(flat(z_)) + beta * s(flat(p_)); });
      rz = rz_next;
    }
    report.residual = std::sqrt(rz / start);
    return report;
  }

 private:
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
