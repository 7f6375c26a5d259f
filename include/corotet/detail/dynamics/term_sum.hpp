// The sum of all terms of a step: forces, what they add to its matrix, and the impulses of its solution.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/terms/piecewise_term.hpp>
#include <corotet/detail/terms/step_term.hpp>

namespace corotet::inline v0_1::detail {

/// A body's own terms, and those that the caller of a step gave. Memory for impulses and stiffnesses is there from the
/// first step on in which the caller gives terms.
template <std::floating_point Scalar>
class TermSum {
 public:
  TermSum() = default;
  explicit TermSum(Index vertices) { working_.force = Field<Scalar>(at(vertices), Vec3<Scalar>::Zero()); }

  /// The terms of the step that begins. `own` lives as long as the step.
  void begin(const std::array<StepTerm<Scalar>*, 3>& own, const Terms<Scalar>& given, const PieceVertices& piece) {
    own_ = own;
    given_ = given;
    piece_ = piece;
    implicit_ = false;
    piecewise_ = nullptr;
    damping_ = {};
    for_each([&](StepTerm<Scalar>& term, bool) {
      const RayleighDamping more = term.proportional_damping();
      damping_.mass += more.mass;
      damping_.stiffness += more.stiffness;
    });
    if (!given_.empty()) begin_given();
  }

  /// To which all calls of `state` in this step refer: the frame is at rest until it is set.
  void set_frame(const TurningPlacement<Scalar>& frame) { frame_ = frame; }
  [[nodiscard]] const TurningPlacement<Scalar>& frame() const { return frame_; }

  COROTET_COLD void begin_step(const TermState<Scalar>& start) {
    for (std::size_t t = 0; t < given_.size(); ++t) given_[t].begin_step(seen(start, true));
  }
  COROTET_COLD void end_step(const TermState<Scalar>& end) {
    for (std::size_t t = 0; t < given_.size(); ++t) given_[t].end_step(seen(end, true));
  }

  /// Whether a term wants the step that has begun to be of backward Euler.
  [[nodiscard]] COROTET_COLD bool needs_first_order() const {
    for (std::size_t t = 0; t < given_.size(); ++t)
      if (given_[t].needs_first_order()) return true;
    return false;
  }

  /// `state` with its frame and piece.
  [[nodiscard]] TermState<Scalar> seen_by_given(const TermState<Scalar>& state) const { return seen(state, true); }

  /// Whether some terms are solved for in passes.
  [[nodiscard]] bool has_piecewise() const { return piecewise_ != nullptr; }
  [[nodiscard]] COROTET_COLD SolveReport solve_in_passes(PassSystem<Scalar>& system) {
    const SolveReport report = piecewise_->solve_in_passes(system, given_);
    for (std::size_t t = 0; t < given_.size(); ++t)
      if (const PiecewiseTerm<Scalar>* term = given_[t].piecewise()) implicit_ = implicit_ || term->acts();
    return report;
  }

  /// Forces of all terms at this state.
  void evaluate(const TermState<Scalar>& state) {
    for (Field<Scalar>* force : {&working_.force, &conservative_.force})
      for_ranges(state.executor, size_of(*force), BlockMatrix<Scalar>::row_grain, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) (*force)[at(i)].setZero();
      });
    for_each([&](StepTerm<Scalar>& term, bool is_given) {
      const TermState<Scalar> here = seen(state, is_given);
      TermForces<Scalar> out(here, part_of(term, is_given).force);
      term.add_force(here, out);
    });
  }

  /// Adds gamma^2 K + gamma D of the terms at the state of the last `evaluate`. `at_rest`: forces become those at
  /// velocity zero.
  COROTET_COLD void add_to_matrix(const TermState<Scalar>& state, bool at_rest, BlockMatrix<Scalar>& matrix) {
    implicit_ = false;
    for (Mat3<Scalar>& sum : row_sum_) sum.setZero();
    const TermState<Scalar> here = seen(state, true);
    for (std::size_t t = 0; t < given_.size(); ++t) {
      TermStiffness<Scalar> out(here, matrix, row_sum_, at_rest ? &part_of(given_[t], true).force : nullptr);
      given_[t].add_stiffness(here, out);
      implicit_ = implicit_ || out.any();
    }
  }

  /// Of the solution that changes velocities by `change` (and `more`, if it is not null) from where the terms are
  /// linearised: impulses in this step.
  COROTET_COLD void find_impulses(const TermState<Scalar>& state, const Field<Scalar>& change,
                                  const Field<Scalar>* more) {
    for (Part* part : {&working_, &conservative_})
      for (std::size_t i = 0; i < part->force.size(); ++i) part->impulse[i] = state.gamma * part->force[i];
    const TermState<Scalar> here = seen(state, true);
    for (std::size_t t = 0; t < given_.size(); ++t) {
      for (const Field<Scalar>* part : {&change, more})
        if (part != nullptr) {
          TermStiffness<Scalar> out(here, *part, part_of(given_[t], true).impulse);
          given_[t].add_stiffness(here, out);
        }
      if (PiecewiseTerm<Scalar>* term = given_[t].piecewise()) {
        term->fix_impulses();
        term->add_impulses(here, part_of(given_[t], true).impulse);
      }
    }
  }

  /// Product of gamma^2 K + gamma D of the caller's terms with a field of velocities, `field(vertex)`, in a scratch: N
  /// s.
  template <class FieldValue>
  [[nodiscard]] COROTET_COLD const Field<Scalar>& stiffness_product(const TermState<Scalar>& state,
                                                                    const FieldValue& field) {
    for (std::size_t i = 0; i < scratch_.size(); ++i) {
      scratch_[i] = field(static_cast<Index>(i));
      product_[i].setZero();
    }
    const TermState<Scalar> here = seen(state, true);
    for (std::size_t t = 0; t < given_.size(); ++t) {
      TermStiffness<Scalar> out(here, scratch_, product_);
      given_[t].add_stiffness(here, out);
      if (const PiecewiseTerm<Scalar>* term = given_[t].piecewise()) term->subtract_product(here, scratch_, product_);
    }
    for (Vec3<Scalar>& p : product_) p = -p;
    return product_;
  }

  /// Impulses of piecewise terms alone, N s, in a scratch.
  [[nodiscard]] COROTET_COLD const Field<Scalar>& piecewise_impulses(const TermState<Scalar>& state) {
    for (Vec3<Scalar>& p : product_) p.setZero();
    for (std::size_t t = 0; t < given_.size(); ++t)
      if (const PiecewiseTerm<Scalar>* term = given_[t].piecewise()) term->add_impulses(seen(state, true), product_);
    return product_;
  }

  /// Changes the impulses of the caller's terms by what they are after another change of velocities, which it returns
  /// in a scratch.
  template <class FieldValue>
  COROTET_COLD const Field<Scalar>& move(const TermState<Scalar>& state, const FieldValue& field) {
    for (std::size_t i = 0; i < scratch_.size(); ++i) scratch_[i] = field(static_cast<Index>(i));
    const TermState<Scalar> here = seen(state, true);
    for (std::size_t t = 0; t < given_.size(); ++t) {
      Field<Scalar>& impulse = part_of(given_[t], true).impulse;
      TermStiffness<Scalar> out(here, scratch_, impulse);
      given_[t].add_stiffness(here, out);
      if (PiecewiseTerm<Scalar>* term = given_[t].piecewise()) {
        term->subtract_product(here, scratch_, impulse);
        term->move(scratch_);
      }
    }
    return scratch_;
  }

  /// Energy of the terms that have one, J.
  [[nodiscard]] COROTET_COLD double energy(const TermState<Scalar>& state) {
    double sum = 0;
    const TermState<Scalar> here = seen(state, true);
    for (std::size_t t = 0; t < given_.size(); ++t)
      if (given_[t].has_energy()) sum += given_[t].energy(here);
    return sum;
  }

  /// The largest fraction of the way from one state to another that all terms allow, 0 ... 1.
  [[nodiscard]] COROTET_COLD double max_safe_fraction(const TermState<Scalar>& from, const TermState<Scalar>& to) {
    double fraction = 1;
    for (std::size_t t = 0; t < given_.size(); ++t)
      fraction = (std::min)(fraction, given_[t].max_safe_fraction(seen(from, true), seen(to, true)));
    return fraction;
  }

  /// Whether a term given by the caller changed the step's matrix.
  [[nodiscard]] bool is_implicit() const { return implicit_; }
  [[nodiscard]] bool has_given() const { return !given_.empty(); }

  /// One vector a vertex, for whoever asks; only where has_given(), two of them.
  [[nodiscard]] Field<Scalar>& scratch() { return scratch_; }
  [[nodiscard]] Field<Scalar>& product() { return product_; }

  /// All terms' damping together.
  [[nodiscard]] const RayleighDamping& damping() const { return damping_; }

  /// Of all terms on a vertex, as seen from the frame, N.
  [[nodiscard]] Vec3<Scalar> force(Index i) const {
    return given_.empty() ? working_.force[at(i)] : Vec3<Scalar>(working_.force[at(i)] + conservative_.force[at(i)]);
  }
  /// Of those that have an energy; only where has_given().
  [[nodiscard]] const Vec3<Scalar>& conservative_force(Index i) const { return conservative_.force[at(i)]; }

  /// Of all terms in the step as it was solved, N s.
  [[nodiscard]] Vec3<Scalar> impulse(Index i, Scalar gamma) const {
    return given_.empty() ? Vec3<Scalar>(gamma * working_.force[at(i)])
                          : Vec3<Scalar>(working_.impulse[at(i)] + conservative_.impulse[at(i)]);
  }
  /// Of those that have no energy.
  [[nodiscard]] Vec3<Scalar> working_impulse(Index i, Scalar gamma) const {
    return given_.empty() ? Vec3<Scalar>(gamma * working_.force[at(i)]) : working_.impulse[at(i)];
  }

  /// Row i of gamma^2 K + gamma D, summed, kg; only where is_implicit().
  [[nodiscard]] const Mat3<Scalar>& row_sum(Index i) const { return row_sum_[at(i)]; }

  [[nodiscard]] MemoryUse memory() const {
    return {bytes_of(working_.force) + bytes_of(working_.impulse) + bytes_of(conservative_.force) +
                bytes_of(conservative_.impulse) + bytes_of(scratch_) + bytes_of(product_) + bytes_of(row_sum_),
            0};
  }

 private:
  /// Forces (N) as seen from the frame and impulses (N s), one a vertex.
  struct Part {
    Field<Scalar> force, impulse;
  };

  COROTET_COLD void begin_given() {
    for (std::size_t t = 0; t < given_.size(); ++t)
      if (PiecewiseTerm<Scalar>* term = given_[t].piecewise())
        if (piecewise_ == nullptr || term->joins_bodies()) piecewise_ = term;
    if (conservative_.force.empty()) {
      working_.impulse = conservative_.force = conservative_.impulse = scratch_ = product_ = working_.force;
      row_sum_.assign(working_.force.size(), Mat3<Scalar>::Zero());
    }
  }

  [[nodiscard]] Part& part_of(const StepTerm<Scalar>& term, bool is_given) {
    return is_given && term.has_energy() ? conservative_ : working_;
  }

  [[nodiscard]] TermState<Scalar> seen(TermState<Scalar> state, bool by_given) const {
    state.frame = frame_;
    if (by_given) state.piece = piece_;
    return state;
  }

  template <class Visit>
  void for_each(const Visit& visit) {
    for (StepTerm<Scalar>* term : own_) visit(*term, false);
    for (std::size_t t = 0; t < given_.size(); ++t) visit(given_[t], true);
  }

  std::array<StepTerm<Scalar>*, 3> own_{};
  Terms<Scalar> given_;
  PieceVertices piece_;
  TurningPlacement<Scalar> frame_;
  RayleighDamping damping_;
  Part working_, conservative_;                 // without and with an energy
  PiecewiseTerm<Scalar>* piecewise_ = nullptr;  // which drives the passes
  Field<Scalar> scratch_, product_;
  detail::Buffer<Mat3<Scalar>> row_sum_;
  bool implicit_ = false;
};

}  // namespace corotet::inline v0_1::detail
