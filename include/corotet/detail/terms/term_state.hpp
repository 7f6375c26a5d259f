// A state of a body as the terms of a step see it, and where they write their forces and stiffnesses.
#pragma once

#include <concepts>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/assembly/mass.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <span>

namespace corotet::inline v0_1 {

/// A frame that turns with a body: x_space = pivot + rotation (x_frame - pivot), and velocities likewise about
/// `pivot_velocity`, plus angular_velocity x (x_space - pivot).
template <std::floating_point Scalar>
struct TurningPlacement {
  Mat3<Scalar> rotation = Mat3<Scalar>::Identity();      ///< from the frame to space
  Vec3<Scalar> pivot = Vec3<Scalar>::Zero();             ///< m
  Vec3<Scalar> pivot_velocity = Vec3<Scalar>::Zero();    ///< m/s
  Vec3<Scalar> angular_velocity = Vec3<Scalar>::Zero();  ///< rad/s
  bool turns = false;                                    ///< false: the frame is at rest in space
};

/// Which vertices of a body a piece of it has, and their places in the piece; by default all, each at its own.
struct PieceVertices {
  std::span<const Index> piece_of;  ///< each vertex of the body
  std::span<const Index> local;     ///< its place among the vertices of its piece
  Index piece = 0;                  ///< its number

  /// Whether the piece has `vertex` of the body.
  [[nodiscard]] bool contains(Index vertex) const { return local.empty() || piece_of[at(vertex)] == piece; }
  /// The place of `vertex` of the body in the piece's arrays.
  [[nodiscard]] std::size_t index(Index vertex) const { return local.empty() ? at(vertex) : at(local[at(vertex)]); }
};

/// A state of a body, for StepTerm. Positions are in space and relative to `origin`, velocities in space, also where
/// the step is solved in a frame that turns with the body.
///
/// A body of several pieces that do not touch is stepped piece by piece: a term then sees one piece at a time and skips
/// vertices that the state does not contain.
template <std::floating_point Scalar>
struct TermState {
  std::span<const Vec3<Scalar>> rest;          ///< m, one a vertex of the piece
  std::span<const Vec3<Scalar>> displacement;  ///< m, in the frame
  std::span<const Vec3<Scalar>> velocities;    ///< m/s, in the frame
  Vec3<double> origin = Vec3<double>::Zero();  ///< of all positions in the world, m: SoftBody::origin()
  TurningPlacement<Scalar> frame;              ///< in which displacement and velocities are given
  const Mass<Scalar>* mass = nullptr;          ///< of the piece
  PieceVertices piece;                         ///< which vertices it has
  Scalar h = 0;                                ///< length of the step, s
  Scalar gamma = 0;                            ///< of the time scheme, s: see TimeStep
  ExecutorRef executor;                        ///< the caller's threads

  /// Whether `vertex` of the body belongs to the piece that is stepped.
  [[nodiscard]] bool contains(Index vertex) const { return piece.contains(vertex); }

  /// m. The state must contain the vertex.
  [[nodiscard]] Vec3<Scalar> position(Index vertex) const {
    const std::size_t v = index(vertex);
    const Vec3<Scalar> x = rest[v] + displacement[v];
    return frame.turns ? Vec3<Scalar>(frame.pivot + frame.rotation * (x - frame.pivot)) : x;
  }

  /// m/s. The state must contain the vertex.
  [[nodiscard]] Vec3<Scalar> velocity(Index vertex) const {
    const Vec3<Scalar>& v = velocities[index(vertex)];
    if (!frame.turns) return v;
    return frame.pivot_velocity + frame.rotation * (v - frame.pivot_velocity) +
           frame.angular_velocity.cross(position(vertex) - frame.pivot);
  }

  /// A direction or velocity of the frame in space, and back.
  [[nodiscard]] Vec3<Scalar> to_space(const Vec3<Scalar>& v) const {
    return frame.turns ? Vec3<Scalar>(frame.rotation * v) : v;
  }
  /// A direction or velocity in space in the frame.
  [[nodiscard]] Vec3<Scalar> to_frame(const Vec3<Scalar>& v) const {
    return frame.turns ? Vec3<Scalar>(frame.rotation.transpose() * v) : v;
  }

  /// The place of a vertex of the body in the piece's arrays.
  [[nodiscard]] std::size_t index(Index vertex) const {
    COROTET_ASSERT(contains(vertex), "this vertex belongs to another piece of the body: ask contains() first");
    return piece.index(vertex);
  }
};

/// Forces on vertices, N: what StepTerm::add_force writes to.
template <std::floating_point Scalar>
class TermForces {
 public:
  /// For the library: forces of the state's piece, in its frame.
  TermForces(const TermState<Scalar>& state, Field<Scalar>& force) : state_(state), force_(force) {}

  /// Adds a force (N, in space) on a vertex.
  void add(Index vertex, const Vec3<Scalar>& force) { force_[state_.index(vertex)] += in_frame(force); }

  /// Adds force(v) on each vertex v of the piece; `force` may be called from several threads.
  template <std::regular_invocable<Index> Force>
  void add_each(const Force& force) {
    for_ranges(state_.executor, size_of(force_), BlockMatrix<Scalar>::row_grain, [&](Index begin, Index end) {
      for (Index v = begin; v < end; ++v) force_[at(v)] += in_frame(force(v));
    });
  }

 private:
  [[nodiscard]] Vec3<Scalar> in_frame(const Vec3<Scalar>& force) const {
    return state_.frame.turns ? Vec3<Scalar>(state_.frame.rotation.transpose() * force) : force;
  }

  const TermState<Scalar>& state_;
  Field<Scalar>& force_;
};

/// Derivatives of forces: what StepTerm::add_stiffness writes to. They go into the step's matrix, or are multiplied
/// with a change of the velocities to find the impulses of the solution.
template <std::floating_point Scalar>
class TermStiffness {
 public:
  /// Adds gamma^2 K + gamma D to `matrix`, and the sum of each of its rows to `row_sum`; and D v to `force_at_rest`, if
  /// there is one, which makes forces at the state's velocity v into those at velocity zero.
  TermStiffness(const TermState<Scalar>& state, BlockMatrix<Scalar>& matrix, detail::Buffer<Mat3<Scalar>>& row_sum,
                Field<Scalar>* force_at_rest)
      : state_(state), matrix_(&matrix), row_sum_(row_sum.data()), force_at_rest_(force_at_rest) {}

  /// Subtracts (gamma^2 K + gamma D) change (kg m/s) from `impulse`.
  TermStiffness(const TermState<Scalar>& state, const Field<Scalar>& change, Field<Scalar>& impulse)
      : state_(state), change_(&change), impulse_(&impulse) {}

  /// Adds `k`, N/m: the force on vertex i changes by -k times the displacement of vertex j, and that on j by -k^T times
  /// that of i. Once for a pair; for i = j, k is symmetric and positive semi-definite. The pair must be coupled by an
  /// element, or by BodyOptions::couplings.
  void add_stiffness(Index i, Index j, const Mat3<Scalar>& k) { add(i, j, state_.gamma * state_.gamma, k); }

  /// Adds the stiffness `k` (N/m, symmetric) of a pair of opposite forces that change with x_i - x_j: a spring between
  /// two vertices. Their impulses are opposite to the last bit.
  void add_relative_stiffness(Index i, Index j, const Mat3<Scalar>& k) {
    const std::size_t a = state_.index(i), b = state_.index(j);
    const Mat3<Scalar> g = state_.gamma * state_.gamma * in_frame(k);
    any_ = true;
    if (matrix_ != nullptr) {
      add_block(a, a, g);
      add_block(b, b, g);
      add_block(a, b, -g);
    } else {
      const Vec3<Scalar> impulse = g * ((*change_)[a] - (*change_)[b]);
      (*impulse_)[a] -= impulse;
      (*impulse_)[b] += impulse;
    }
  }

  /// The same as add_stiffness for a damping matrix, kg/s: forces change with velocities.
  void add_damping(Index i, Index j, const Mat3<Scalar>& d) {
    add(i, j, state_.gamma, d);
    if (force_at_rest_ == nullptr) return;
    const std::size_t a = state_.index(i), b = state_.index(j);
    const Mat3<Scalar> turned = in_frame(d);
    (*force_at_rest_)[a] += turned * state_.velocities[b];
    if (a != b) (*force_at_rest_)[b] += turned.transpose() * state_.velocities[a];
  }

  /// Whether a term has added one.
  [[nodiscard]] bool any() const { return any_; }

 private:
  void add(Index vertex_i, Index vertex_j, Scalar factor, const Mat3<Scalar>& k) {
    const std::size_t i = state_.index(vertex_i), j = state_.index(vertex_j);
    const Mat3<Scalar> g = factor * in_frame(k);
    any_ = true;
    if (matrix_ != nullptr) {
      add_block(i, j, g);
      row_sum_[i] += g;
      if (i != j) row_sum_[j] += g.transpose();
    } else {
      (*impulse_)[i] -= g * (*change_)[j];
      if (i != j) (*impulse_)[j] -= g.transpose() * (*change_)[i];
    }
  }

  void add_block(std::size_t i, std::size_t j, const Mat3<Scalar>& g) {
    const BlockPattern& pattern = matrix_->pattern();
    const auto row = static_cast<Index>(i), column = static_cast<Index>(j);
    COROTET_ASSERT(pattern.has(row, column), "vertices that no element couples: see BodyOptions::couplings");
    if (!pattern.has(row, column)) return;
    matrix_->block(pattern.slot(row, column)) += i == j ? Mat3<Scalar>((g + g.transpose()) / 2) : g;
    if (i != j) matrix_->block(pattern.slot(column, row)) += g.transpose();
  }

  [[nodiscard]] Mat3<Scalar> in_frame(const Mat3<Scalar>& k) const {
    const Mat3<Scalar>& q = state_.frame.rotation;
    return state_.frame.turns ? Mat3<Scalar>(q.transpose() * k * q) : k;
  }

  const TermState<Scalar>& state_;
  BlockMatrix<Scalar>* matrix_ = nullptr;
  Mat3<Scalar>* row_sum_ = nullptr;
  Field<Scalar>* force_at_rest_ = nullptr;
  const Field<Scalar>* change_ = nullptr;
  Field<Scalar>* impulse_ = nullptr;
  bool any_ = false;
};

}  // namespace corotet::inline v0_1
