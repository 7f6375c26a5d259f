// Preconditioned conjugate gradients.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/initial_guess.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <cstddef>
#include <limits>

namespace corotet::inline v0_1 {

/// When conjugate gradients stop.
struct PcgOptions {
  /// Stop when the error of x is `tolerance` times x, both in the energy norm sqrt(x . A x), 0 < tolerance < 1: see
  /// Pcg for how the error is known. What float can reach depends on how stiff the body is against its inertia; a
  /// tolerance beyond that ends as `stagnated`, with the error that was reached.
  double tolerance = 1e-3;
  int max_iterations = 2000;  ///< >= 0; reaching it is reported, never silent
};

namespace detail {

/// Energy gained by the last `delay` iterations, of `capacity` at most; infinite until there are as many.
template <int capacity>
class RecentGains {
 public:
  explicit RecentGains(int delay) : delay_(delay) {}

  void add(double gain) {
    if (delay_ > 0) gain_[static_cast<std::size_t>(count_++ % delay_)] = gain;
  }
  [[nodiscard]] double sum() const {
    if (count_ < delay_) return std::numeric_limits<double>::infinity();
    double sum = 0;
    for (int i = 0; i < delay_; ++i) sum += gain_[static_cast<std::size_t>(i)];
    return sum;
  }

 private:
  std::array<double, std::size_t{capacity}> gain_{};
  int delay_, count_ = 0;
};

}  // namespace detail

/// Hestenes & Stiefel 1952, with a preconditioner P (Saad 2003, algorithm 9.1). Keeps its vectors, and the last
/// solutions as initial guesses, between solves.
///
/// The error is estimated in two ways, of which the larger counts: as sqrt(r . P r), exact where P is the inverse of A;
/// and by the energy that the last iterations have gained, which the error had when they began (Strakos & Tichy 2002,
/// section 4). The second is what keeps a weak preconditioner honest: P::estimator_delay says how many iterations.
template <std::floating_point Scalar>
class Pcg {
 public:
  Pcg() = default;
  /// Memory for systems of so many vertices.
  COROTET_COLD explicit Pcg(Index vertices)
      : x_(at(vertices)), r_(x_), z_(x_), p_(x_), guess_(vertices), sum_(vertices) {}

  /// Sets x to the solution. The residual that is reported is that of the x returned, measured; where rounding has made
  /// it larger than the iteration believed, the iteration starts again from x, as long as that helps.
  SolveReport solve(const StepSystem<Scalar>& system, detail::PreconditionerRef<Scalar> preconditioner,
                    Field<Scalar>& x, const PcgOptions& options, ExecutorRef executor) {
    SolveReport report;
    std::fill(x.begin(), x.end(), Vec3<Scalar>::Zero());
    if (!detail::is_tolerance(options.tolerance) || options.max_iterations < 0)
      return {SolveStatus::invalid_options, 0, 1.0};
    double energy = guess_.start(system, x_, r_, {&z_, &p_}, executor);
    double error2 = preconditioner.apply(r_, z_, executor);
    if (!std::isfinite(error2) || error2 < 0 || !std::isfinite(energy)) return {SolveStatus::breakdown, 0, 1.0};

    const double tolerance = (std::min)(options.tolerance * system.looseness, max_loose_tolerance);
    const double wanted = tolerance * tolerance;
    while (error2 > wanted * energy) {
      iterate(system, preconditioner, error2, wanted, options.max_iterations, energy, report, executor);
      const double before = error2;
      measure(system, executor);
      error2 = preconditioner.apply(r_, z_, executor);
      // P that rounding has made indefinite: what is left is not known.
      if (!std::isfinite(error2) || error2 < -wanted * energy) report.status = SolveStatus::breakdown;
      if (report.status != SolveStatus::converged) break;
      if (error2 > wanted * energy && error2 > before / 4) {  // half the error at least, or rounding has taken over
        report.status = SolveStatus::stagnated;
        break;
      }
    }
    if (report.status == SolveStatus::breakdown) {
      report.residual = 1;
      return report;
    }
    report.residual = energy > 0 ? detail::square_root(std::fabs(error2) / energy) : 0;
    for_ranges(executor, size_of(x), DeterministicSum::grain, [&](Index begin, Index end) {
      for (Index v = begin; v < end; ++v) x[at(v)] = x_[at(v)].vector();
    });
    guess_.remember(x_);
    return report;
  }

  /// For snapshots.
  void visit_state(detail::StateArchive& archive) { guess_.visit_state(archive); }

  /// Bytes of its own.
  [[nodiscard]] MemoryUse memory() const {
    return MemoryUse{4 * detail::bytes_of(x_), 0} + guess_.memory() + sum_.memory();
  }

 private:
  /// Conjugate gradients from x_, whose residual is r_ with z_ = P r_ and r_ . z_ = rz, until the error that the
  /// recursion follows is small enough. `energy` is that of x, and follows it.
  void iterate(const StepSystem<Scalar>& system, detail::PreconditionerRef<Scalar> preconditioner, double rz,
               double wanted, int max_iterations, double& energy, SolveReport& report, ExecutorRef executor) {
    detail::RecentGains<detail::PreconditionerRef<Scalar>::max_estimator_delay> gains(preconditioner.estimator_delay());
    // What the recursion has left below this is rounding: a small system is solved before the gains tell.
    constexpr auto rounding = static_cast<double>(std::numeric_limits<Scalar>::epsilon()) / 4;
    for_ranges(executor, size_of(r_), DeterministicSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) p_[at(i)] = z_[at(i)];
    });
    while ((std::max)(rz, gains.sum()) > wanted * energy && rz > rounding * rounding * energy) {
      if (report.iterations == max_iterations) {
        report.status = SolveStatus::iteration_limit;
        return;
      }
      PaddedField<Scalar>& q = z_;  // = A p_; the z_ of before is in p_
      double curvature = sum_(executor, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) q[at(i)].set(system.matrix.row_product(i, p_));
        return detail::range_dot(p_, q, begin, end);
      });
      if (system.coupling != nullptr) curvature = couple(*system.coupling, q, executor);
      ++report.iterations;
      if (!(curvature > 0) || !std::isfinite(curvature)) {
        report.status = SolveStatus::breakdown;
        return;
      }
      const auto alpha = static_cast<Scalar>(rz / curvature);
      for_ranges(executor, size_of(r_), DeterministicSum::grain, [&](Index begin, Index end) {
        detail::map_range(
            begin, end, x_, [=](auto x, auto p) { return x + alpha * p; }, x_, p_);
        detail::map_range(
            begin, end, r_, [=](auto r, auto ap) { return r - alpha * ap; }, r_, q);
      });
      const double gain = rz * (rz / curvature);
      energy += gain;
      gains.add(gain);
      const double rz_next = preconditioner.apply(r_, z_, executor);
      if (!std::isfinite(rz_next) || rz_next < 0) {
        report.status = SolveStatus::breakdown;
        return;
      }
      const auto beta = static_cast<Scalar>(rz_next / rz);
      for_ranges(executor, size_of(r_), DeterministicSum::grain, [&](Index begin, Index end) {
        detail::map_range(
            begin, end, p_, [=](auto z, auto p) { return z + beta * p; }, z_, p_);
      });
      rz = rz_next;
    }
  }

  /// r_ = b - A x_.
  void measure(const StepSystem<Scalar>& system, ExecutorRef executor) {
    for_ranges(executor, size_of(r_), DeterministicSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        r_[at(i)].set(system.right_side[at(i)]);
        r_[at(i)].set(r_[at(i)].vec4() - system.matrix.row_product(i, x_));
      }
    });
    if (system.coupling != nullptr) subtract_coupling(*system.coupling, executor);
  }

  /// Adds the coupling to the product q with p_. Returns p_ . q.
  [[nodiscard]] COROTET_COLD double couple(const MatrixFreeTerm<Scalar>& coupling, PaddedField<Scalar>& q,
                                           ExecutorRef executor) {
    coupling.add(p_, q);
    return sum_(executor, [&](Index begin, Index end) { return detail::range_dot(p_, q, begin, end); });
  }
  COROTET_COLD void subtract_coupling(const MatrixFreeTerm<Scalar>& coupling, ExecutorRef executor) {
    for (PaddedVector<Scalar>& z : z_) z = {};
    coupling.add(x_, z_);
    for_ranges(executor, size_of(r_), DeterministicSum::grain, [&](Index begin, Index end) {
      detail::map_range(
          begin, end, r_, [](auto r, auto z) { return r - z; }, r_, z_);
    });
  }

  static constexpr double max_loose_tolerance = 0.5;

  detail::Scratch<PaddedVector<Scalar>> x_, r_, z_, p_;
  detail::InitialGuess<Scalar> guess_;
  DeterministicSum sum_;
};

}  // namespace corotet::inline v0_1
