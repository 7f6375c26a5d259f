// An implicit integrator: a time scheme, the solve that all schemes share, and the pieces of a body.
#pragma once

#include <algorithm>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/fixed_array.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/pieces.hpp>
#include <corotet/detail/dynamics/step_context.hpp>
#include <corotet/detail/dynamics/step_options.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/dynamics/step_solver.hpp>
#include <corotet/detail/dynamics/time_scheme.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <cstdint>
#include <utility>

namespace corotet::inline v0_1 {

namespace detail {

/// Steps one piece of a body, or a body of one piece.
template <class Body, TimeScheme<Body> Scheme, class Solver>
class PieceIntegrator {
 public:
  using Scalar = typename Body::scalar_type;

  COROTET_COLD PieceIntegrator(const Body& body, const Solver& solver, const StepOptions& newton)
      : solver_(body, solver, newton), scheme_(body) {}

  [[nodiscard]] const Solver& solver() const { return solver_.solver(); }
  [[nodiscard]] double unbalanced_force2(const Body& body) const { return solver_.unbalanced_force2(body); }

  COROTET_COLD StepReport step(Body& body, Scalar h, const StepContext<Scalar>& context) {
    StepReport report = solver_.validate(body, h);
    if (!report.accepted()) return report;
    const bool first_order = solver_.begin(body, h, context);
    report = solver_.advance(
        body, first_order ? backward_euler(body, h) : scheme_.discretize(body, h, context.executor), context);
    if (report.accepted())
      scheme_.accept(body, h, report, solver_.previous_displacement(), solver_.previous_velocity());
    return report;
  }

  COROTET_COLD void visit_state(detail::StateArchive& archive, const Body& body) {
    solver_.visit_state(archive, body);
    if constexpr (requires { scheme_.visit_state(archive, body); }) scheme_.visit_state(archive, body);
  }
  [[nodiscard]] COROTET_COLD MemoryUse memory() const {
    MemoryUse use = solver_.memory();
    if constexpr (requires { scheme_.memory(); }) use += scheme_.memory();
    return use;
  }
  COROTET_COLD void reset(const Body& body) {
    solver_.reset(body);
    scheme_ = Scheme(body);
  }

 private:
  StepSolver<Body, Solver> solver_;
  Scheme scheme_;
};

}  // namespace detail

/// The integrator that ImplicitEuler and Bdf2 are made of, for a TimeScheme of your own.
///
/// Use it to try another time discretisation: solves, pins, terms, momenta and reports come with it. For backward Euler
/// and BDF2 use the two classes.
/// @snippet time_scheme.cpp scheme
/// @snippet time_scheme.cpp use
template <class Body, TimeScheme<Body> Scheme, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
class Integrator {
 public:
  using Scalar = typename Body::scalar_type;                    ///< of the body
  using Piece = detail::PieceIntegrator<Body, Scheme, Solver>;  ///< steps one piece of the body

  /// Symbolic work and memory for `body` and its copies.
  COROTET_COLD Integrator(const Body& body, const Solver& solver, const StepOptions& newton)
      : options_(newton), pieces_(body), integrators_(at((std::max)(pieces_.count(), Index{1}))) {
    if (pieces_.count() == 0) integrators_.emplace_back(body, solver, newton);
    for (Index p = 0; p < pieces_.count(); ++p) integrators_.emplace_back(pieces_.body(p), solver, newton);
    reports_ = detail::Buffer<StepReport>(at(pieces_.count()));
  }

  /// The options of the step's equation.
  [[nodiscard]] const StepOptions& newton() const { return options_; }
  /// Of the first piece.
  [[nodiscard]] const Solver& solver() const { return integrators_.front().solver(); }
  /// 1, or the number of pieces of the body that do not touch.
  [[nodiscard]] Index piece_count() const { return static_cast<Index>(integrators_.size()); }

  /// The body of a piece: `body` itself where there is but one.
  [[nodiscard]] const Body& piece_body(Index piece, const Body& body) const {
    return pieces_.count() == 0 ? body : pieces_.body(piece);
  }

  /// Advances `body` by `h` seconds, all pieces or none.
  StepReport step(Body& body, Scalar h, const StepContext<Scalar>& context) {
    return step_pieces(body, context, [h](Index, Piece& piece, Body& of_piece, const StepContext<Scalar>& inner) {
      return piece.step(of_piece, h, inner);
    });
  }

  /// The same where `step_piece(piece number, integrator, its body, context)` advances each: at once on the executor's
  /// threads, if nobody watches and the caller gave no terms.
  template <class StepPiece>
  StepReport step_pieces(Body& body, const StepContext<Scalar>& context, const StepPiece& step_piece) {
    if (pieces_.count() == 0) return step_piece(0, integrators_.front(), body, context);
    const StepReport error = detail::check_step(body, Scalar(1), options_);  // in the numbers of the whole body
    if (!error.accepted()) return error;
    pieces_.take_from(body);
    const auto step_one = [&](Index p, StepContext<Scalar> inner) {
      inner.piece = pieces_.vertices(p);
      reports_[at(p)] = step_piece(p, integrators_[at(p)], pieces_.body(p), inner);
    };
    const bool at_once = !context.observer && context.terms.empty() && pieces_.count() >= min_at_once;
    if (at_once)
      for_ranges(context.executor, pieces_.count(), 1, [&](Index p, Index) { step_one(p, {}); });
    else
      for (Index p = 0; p < pieces_.count(); ++p) step_one(p, context);
    return join(body);
  }

  /// Bytes that the integrator takes besides the body, and those that it shares with its copies.
  [[nodiscard]] COROTET_COLD MemoryUse memory() const {
    MemoryUse use = pieces_.memory();
    use.owned += integrators_.capacity() * sizeof(Piece) + detail::bytes_of(reports_);
    for (const Piece& integrator : integrators_) use += integrator.memory();
    return use;
  }

  /// For snapshots.
  COROTET_COLD void visit_state(detail::StateArchive& archive, const Body& body) {
    archive.expect(static_cast<std::uint64_t>(pieces_.count()));
    if (pieces_.count() == 0) return integrators_.front().visit_state(archive, body);
    pieces_.visit_state(archive, body);
    for (Index p = 0; p < pieces_.count(); ++p) integrators_[at(p)].visit_state(archive, pieces_.body(p));
  }

  /// As if it had just been made for the body.
  COROTET_COLD void reset(const Body& body) {
    pieces_.forget_motion();
    if (pieces_.count() == 0) return integrators_.front().reset(body);
    for (Index p = 0; p < pieces_.count(); ++p) integrators_[at(p)].reset(pieces_.body(p));
  }

  /// See StepSolver::unbalanced_force2.
  [[nodiscard]] COROTET_COLD double unbalanced_force2(const Body& body) const {
    if (pieces_.count() == 0) return integrators_.front().unbalanced_force2(body);
    double sum = 0;
    for (Index p = 0; p < pieces_.count(); ++p) sum += integrators_[at(p)].unbalanced_force2(pieces_.body(p));
    return sum;
  }

 private:
  static constexpr Index min_at_once = 4;  // fewer: threads share the work within each

  [[nodiscard]] COROTET_COLD StepReport join(Body& body) {
    StepReport all = reports_.front();
    for (std::size_t p = 1; p < reports_.size(); ++p) all = detail::worse_of(all, reports_[p]);
    for (std::size_t p = 0; p < reports_.size(); ++p)
      if (!reports_[p].accepted()) {
        if (reports_[p].vertex >= 0) all.vertex = pieces_.whole_vertex(static_cast<Index>(p), reports_[p].vertex);
        break;
      }
    if (all.accepted())
      pieces_.give_to(body);
    else
      pieces_.forget_motion();
    return all;
  }

  StepOptions options_;
  detail::Pieces<Body> pieces_;
  detail::FixedArray<Piece> integrators_;
  detail::Buffer<StepReport> reports_;  // of pieces
};

}  // namespace corotet::inline v0_1
