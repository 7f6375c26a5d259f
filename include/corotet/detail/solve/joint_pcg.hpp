// Conjugate gradients over the systems of several bodies that are coupled.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/prepared_preconditioner.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <limits>
#include <span>

namespace corotet::inline v0_1::detail {

/// Vectors of one body's part of the system, kept between solves.
template <std::floating_point Scalar>
struct JointPcgFields {
  Scratch<PaddedVector<Scalar>> x, r, z, p;
  DeterministicSum sum;

  /// For so many vertices. Allocates where that is another number than before.
  void resize(std::size_t vertices) {
    if (x.size() == vertices) return;
    x = r = z = p = Scratch<PaddedVector<Scalar>>(vertices);
    sum = DeterministicSum(static_cast<Index>(vertices));
  }
};

/// One body's part of the system.
template <std::floating_point Scalar>
struct JointPcgPart {
  const BlockMatrix<Scalar>* matrix;
  const Field<Scalar>* right_side;
  Field<Scalar>* solution;  ///< starts as a guess
  PreparedPreconditioner<Scalar> prepared;
  JointPcgFields<Scalar>* fields;
  ExecutorRef executor;
};

/// Solves (A + C) x = b, with A of one block for each part and C a matrix that couples them: Hestenes & Stiefel 1952,
/// with each part's own preconditioner. `couple(field)` adds C f(k) to g(k) for the parts k, of fields named by members
/// of JointPcgFields: couple(&Fields::p, &Fields::z). To the least tolerance of the parts, in the energy norm, times
/// `looseness`. Where rounding has made the residual larger than the iteration believed, it starts again.
template <std::floating_point Scalar>
class JointPcg {
 public:
  using Part = JointPcgPart<Scalar>;
  using Fields = JointPcgFields<Scalar>;
  using Member = Scratch<PaddedVector<Scalar>> Fields::*;

  explicit JointPcg(std::span<Part> parts) : parts_(parts) {}

  template <class Couple>
  [[nodiscard]] COROTET_COLD SolveReport solve(double looseness, const Couple& couple) {
    SolveReport report;
    double tolerance = 0.5;
    int max_iterations = 0;
    for (Part& part : parts_) {
      if (!is_tolerance(part.prepared.tolerance) || part.prepared.max_iterations < 0)
        return {SolveStatus::invalid_options, 0, 1.0};
      tolerance = (std::min)(tolerance, part.prepared.tolerance * looseness);
      max_iterations = (std::max)(max_iterations, part.prepared.max_iterations);
      part.fields->resize(part.solution->size());
      for (std::size_t i = 0; i < part.solution->size(); ++i) part.fields->x[i].set((*part.solution)[i]);
    }
    const double wanted = tolerance * tolerance;
    measure(couple);
    // x . A x = x . (b - r)
    double energy = sum([](const Part& part, Index i) { return inner(part.fields->x, *part.right_side, i); }) -
                    sum([](const Part& part, Index i) { return inner(part.fields->x, part.fields->r, i); });
    double error2 = precondition();
    if (!std::isfinite(error2) || error2 < 0 || !std::isfinite(energy)) return {SolveStatus::breakdown, 0, 1.0};
    energy = (std::max)(energy, 0.0);
    while (error2 > wanted * energy) {
      iterate(couple, error2, wanted, max_iterations, energy, report);
      const double before = error2;
      measure(couple);
      error2 = precondition();
      if (!std::isfinite(error2) || error2 < -wanted * energy) report.status = SolveStatus::breakdown;
      if (report.status != SolveStatus::converged) break;
      if (error2 > wanted * energy && error2 > before / 4) {
        report.status = SolveStatus::stagnated;
        break;
      }
    }
    if (report.status == SolveStatus::breakdown) {
      report.residual = 1;
      return report;
    }
    report.residual = energy > 0 ? square_root(std::fabs(error2) / energy) : 0;
    for (Part& part : parts_)
      for (std::size_t i = 0; i < part.solution->size(); ++i) (*part.solution)[i] = part.fields->x[i].vector();
    return report;
  }

 private:
  template <class Couple>
  void iterate(const Couple& couple, double rz, double wanted, int max_iterations, double& energy,
               SolveReport& report) {
    constexpr auto rounding = static_cast<double>(std::numeric_limits<Scalar>::epsilon()) / 4;
    each([](Fields& f, std::size_t i) { f.p[i] = f.z[i]; });
    while (rz > wanted * energy && rz > rounding * rounding * energy) {
      if (report.iterations == max_iterations) {
        report.status = SolveStatus::iteration_limit;
        return;
      }
      multiply(&Fields::p, &Fields::z);
      couple(&Fields::p, &Fields::z);
      const double curvature = sum([](const Part& part, Index i) { return inner(part.fields->p, part.fields->z, i); });
      ++report.iterations;
      if (!(curvature > 0) || !std::isfinite(curvature)) {
        report.status = SolveStatus::breakdown;
        return;
      }
      const auto alpha = static_cast<Scalar>(rz / curvature);
      each([alpha](Fields& f, std::size_t i) {
        f.x[i].set(Vec3<Scalar>(f.x[i].vector() + alpha * f.p[i].vector()));
        f.r[i].set(Vec3<Scalar>(f.r[i].vector() - alpha * f.z[i].vector()));
      });
      energy += rz * (rz / curvature);
      const double next = precondition();
      if (!std::isfinite(next) || next < 0) {
        report.status = SolveStatus::breakdown;
        return;
      }
      const auto beta = static_cast<Scalar>(next / rz);
      each([beta](Fields& f, std::size_t i) { f.p[i].set(Vec3<Scalar>(f.z[i].vector() + beta * f.p[i].vector())); });
      rz = next;
    }
  }

  /// r = b - (A + C) x.
  template <class Couple>
  void measure(const Couple& couple) {
    multiply(&Fields::x, &Fields::z);
    couple(&Fields::x, &Fields::z);
    for (Part& part : parts_)
      for (std::size_t i = 0; i < part.solution->size(); ++i)
        part.fields->r[i].set(Vec3<Scalar>((*part.right_side)[i] - part.fields->z[i].vector()));
  }

  void multiply(Member x, Member y) {
    for (Part& part : parts_)
      for_ranges(part.executor, size_of(*part.solution), BlockMatrix<Scalar>::row_grain, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) (part.fields->*y)[at(i)].set(part.matrix->row_product(i, part.fields->*x));
      });
  }

  /// z = P r. Returns r . z.
  [[nodiscard]] double precondition() {
    double all = 0;
    for (Part& part : parts_) all += part.prepared.preconditioner.apply(part.fields->r, part.fields->z, part.executor);
    return all;
  }

  template <class Visit>
  void each(const Visit& visit) {
    for (Part& part : parts_)
      for_ranges(part.executor, size_of(*part.solution), DeterministicSum::grain, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) visit(*part.fields, at(i));
      });
  }

  template <class Term>
  [[nodiscard]] double sum(const Term& term) {
    double all = 0;
    for (Part& part : parts_)
      all += part.fields->sum(part.executor, [&](Index begin, Index end) {
        double here = 0;
        for (Index i = begin; i < end; ++i) here += term(part, i);
        return here;
      });
    return all;
  }

  template <class A, class B>
  [[nodiscard]] static double inner(const A& a, const B& b, Index i) {
    double product = 0;
    for (std::size_t k = 0; k < 3; ++k)
      product += static_cast<double>(a[at(i)][k]) * static_cast<double>(component(b[at(i)], k));
    return product;
  }
  [[nodiscard]] static Scalar component(const PaddedVector<Scalar>& v, std::size_t k) { return v[k]; }
  [[nodiscard]] static Scalar component(const Vec3<Scalar>& v, std::size_t k) { return v[static_cast<int>(k)]; }

  std::span<Part> parts_;
};

}  // namespace corotet::inline v0_1::detail
