// The state of a body of any elastic model: the part of its elasticity that changes from step to step.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/assembly/deformation_extremes.hpp>
#include <corotet/detail/assembly/elastic_evaluation.hpp>
#include <corotet/detail/assembly/twist_modes.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/material/elastic_model.hpp>
#include <corotet/detail/material/point_states.hpp>
#include <cstddef>

namespace corotet::inline v0_1::detail {

/// Which tangent a step asks of a model: the interface of TwistModes for models that have one tangent, not a warped
/// stiffness and modes beside it. `exact` asks for dP/dF until `project` asks for the semi-definite substitute; the
/// other tangents ask for that from the beginning.
template <std::floating_point Scalar>
class ModelTangent {
 public:
  ModelTangent() = default;
  explicit ModelTangent(Tangent tangent) : tangent_(tangent), projects_(tangent != Tangent::consistent) {}

  [[nodiscard]] Tangent tangent() const { return tangent_; }
  [[nodiscard]] bool projects() const { return projects_; }
  void project(bool on) { projects_ = on || tangent_ != Tangent::consistent; }

  /// Of no meaning here: there are no modes beside the tangent.
  void set_cap(double /*cap*/) {}
  [[nodiscard]] Scalar cap() const { return 0; }
  [[nodiscard]] double active_share() const { return 0; }

 private:
  Tangent tangent_ = Tangent::warped;
  bool projects_ = true;
};

/// The state that PointwiseElasticity::evaluate computes. Sized once: an evaluation allocates nothing. The base holds
/// the trial state of each quadrature point, and is empty for a model without state.
template <std::floating_point Scalar, ReferenceElement Element, ElasticModel Model>
class PointwiseEvaluation : private PointStates<Scalar, Model> {
 public:
  using States = PointStates<Scalar, Model>;
  static constexpr std::size_t points = Element::stiffness_points.size();
  static constexpr std::size_t nodes = Element::nodes;
  /// Pairs (a, b) of an element's nodes with a <= b.
  static constexpr std::size_t pairs = nodes * (nodes + 1) / 2;

  Buffer<DeformationExtremes> extremes;  ///< one a task
  ModelTangent<Scalar> twist;            ///< which tangent is evaluated

  PointwiseEvaluation() = default;
  template <class Law>
  COROTET_COLD explicit PointwiseEvaluation(const Law& law, Tangent tangent = Tangent::warped)
      : States(law.batches().size(), points),
        extremes((law.batches().size() + at(Law::batch_grain) - 1) / at(Law::batch_grain)),
        twist(tangent),
        force_(at(law.element_count()) * nodes),
        block_(at(law.element_count()) * pairs) {}

  [[nodiscard]] DeformationExtremes summary() const {
    DeformationExtremes all;
    for (const DeformationExtremes& part : extremes) all.merge(part);
    return all;
  }

  /// What the points' states become if this state is accepted.
  [[nodiscard]] States& trial() { return *this; }
  [[nodiscard]] const States& trial() const { return *this; }

  /// The force of an element on its node `a`, N.
  [[nodiscard]] Scalar* force(Index element, std::size_t a) { return force_[at(element) * nodes + a].data(); }

  /// Block (a, b), a <= b, of an element's tangent stiffness, N/m: three columns, each with a zero behind it.
  [[nodiscard]] Scalar* block(Index element, std::size_t a, std::size_t b) {
    return block_[at(element) * pairs + pair(a, b)].data();
  }
  [[nodiscard]] COROTET_ALWAYS_INLINE const Scalar* block(std::size_t element, std::size_t a, std::size_t b) const {
    return block_[element * pairs + pair(a, b)].data();
  }

  /// Numbers from an element's force or block to that of the next element.
  static constexpr std::size_t force_stride = 4 * nodes, block_stride = 12 * pairs;

  /// The elastic force on one vertex, N: the force that the body exerts on it.
  [[nodiscard]] Vec3<Scalar> vertex_force(const BlockPattern& pattern, Index vertex) const {
    return sum_of_nodes(pattern, force_, vertex);
  }

  [[nodiscard]] std::size_t bytes() const {
    return bytes_of(extremes) + trial().size() * sizeof(typename States::State) + bytes_of(force_) + bytes_of(block_);
  }

 private:
  struct alignas(4 * sizeof(Scalar)) Block : std::array<Scalar, 12> {};

  [[nodiscard]] static constexpr std::size_t pair(std::size_t a, std::size_t b) {
    return a * (2 * nodes - a - 1) / 2 + b;
  }

  Scratch<PaddedVector<Scalar>> force_;  // [element][node]
  Scratch<Block> block_;                 // [element][pair]
};

/// The sum of element contributions to one 3x3 block of a tangent stiffness.
template <std::floating_point Scalar>
class BlockSum {
 public:
  /// Adds block (a, b) of an element.
  template <class Evaluation>
  COROTET_ALWAYS_INLINE void add(const Evaluation& state, std::size_t element, std::size_t a, std::size_t b) {
    std::array<Q, 3>& sum = a <= b ? straight_ : mirrored_;
    const Scalar* block = a <= b ? state.block(element, a, b) : state.block(element, b, a);
    COROTET_UNROLL
    for (std::size_t c = 0; c < 3; ++c) sum[c] += Q::load(block + 4 * c);
  }

  /// As StiffnessSum::write.
  COROTET_ALWAYS_INLINE void write(Scalar factor, Scalar* block, Scalar* mirror) const {
    const std::array<Q, 3> straight_t = transposed(straight_[0], straight_[1], straight_[2]);
    const std::array<Q, 3> mirrored_t = transposed(mirrored_[0], mirrored_[1], mirrored_[2]);
    const Q scale(factor);
    std::array<Q, 3> k, k_t;
    COROTET_UNROLL
    for (std::size_t c = 0; c < 3; ++c) {
      k[c] = scale * (straight_[c] + mirrored_t[c]);
      k_t[c] = scale * (straight_t[c] + mirrored_[c]);
    }
    write_columns(k, block);
    write_columns(k_t, mirror);
  }

 private:
  using Q = Vec4<Scalar>;

  std::array<Q, 3> straight_{Q(Scalar(0)), Q(Scalar(0)), Q(Scalar(0))};
  std::array<Q, 3> mirrored_{Q(Scalar(0)), Q(Scalar(0)), Q(Scalar(0))};
};

}  // namespace corotet::inline v0_1::detail
