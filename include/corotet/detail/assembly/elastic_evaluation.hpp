// What the elastic law says of one state of a body: the part of elasticity that changes from step to step.
#pragma once

#include <array>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/assembly/deformation_extremes.hpp>
#include <corotet/detail/assembly/twist_modes.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/element_batch.hpp>
#include <corotet/detail/material/strain.hpp>

namespace corotet::inline v0_1::detail {

/// The sum over the elements of what they have stored for a vertex.
template <std::floating_point Scalar>
[[nodiscard]] Vec3<Scalar> sum_of_nodes(const BlockPattern& pattern, const PaddedField<Scalar>& of_node, Index vertex) {
  Vec4<Scalar> sum(Scalar(0));
  for (Index k = pattern.incidence_start[at(vertex)]; k < pattern.incidence_start[at(vertex) + 1]; ++k)
    sum += of_node[at(pattern.incidence[at(k)])].vec4();
  Vec3<Scalar> out;
  sum.template store_part<3>(out.data());
  return out;
}

/// The nine numbers of a block, by columns.
template <std::floating_point Scalar>
COROTET_ALWAYS_INLINE void write_columns(const std::array<Vec4<Scalar>, 3>& column, Scalar* out) {
  column[0].store(out);  // what is written behind a column is overwritten by the next
  column[1].store(out + 3);
  column[2].template store_part<3>(out + 6);
}

/// sqrt(mu V) R grad N of an element's node at a quadrature point, and the lambda / mu that acts there: what a
/// stiffness block needs of one node, in one load.
template <std::floating_point Scalar>
struct alignas(4 * sizeof(Scalar)) NodeGradient : std::array<Scalar, 4> {
  [[nodiscard]] COROTET_ALWAYS_INLINE Scalar lame_ratio() const { return (*this)[3]; }
};

/// The state of a corotated body that Elasticity::evaluate computes. Sized once: an evaluation allocates nothing.
/// Copies must be evaluated anew. Each vector is followed by one number, so that assembly loads it as a Vec4.
template <std::floating_point Scalar, ReferenceElement Element>
class ElasticEvaluation {
 public:
  static constexpr std::size_t points = Element::stiffness_points.size();
  static constexpr std::size_t nodes = Element::nodes;

  Buffer<DeformationExtremes> extremes;  ///< one a task
  TwistModes<Scalar> twist;              ///< what the tangent has besides the warped stiffness

  ElasticEvaluation() = default;

  /// `tangent`: plain is all there is where the rotation is not Polar at each point, see Elasticity::has_twist_modes.
  template <class Law>
  COROTET_COLD explicit ElasticEvaluation(const Law& law, Tangent tangent = Tangent::warped)
      : extremes((law.batches().size() + at(Law::batch_grain) - 1) / at(Law::batch_grain)),
        twist(Law::has_twist_modes ? tangent : Tangent::warped, law.batches().size(), points),
        force_(at(law.element_count()) * nodes),
        volumetric_stress_(law.batches().size() * points),
        gradient_(at(law.element_count()) * points * nodes),
        mean_gradient_(law.mean_dilatation().gradient_count(law.element_count())),
        frame_(law.mean_dilatation().needs_frames() ? law.batches().size() : 0),
        elements_(at(law.element_count())) {}

  [[nodiscard]] DeformationExtremes summary() const {
    DeformationExtremes all;
    for (const DeformationExtremes& part : extremes) all.merge(part);
    return all;
  }

  /// The force of an element on its node `a`, N.
  [[nodiscard]] Scalar* force(Index element, std::size_t a) { return force_[at(element) * nodes + a].data(); }

  /// The stress over mu that resists the change of volume at point q of each element in a batch: lambda theta / mu
  /// with theta = tr(R^T F) - 3; with mean dilatation, that of the part at the point and of the mean together. The
  /// factor of all second derivatives of theta (the twist modes).
  [[nodiscard]] Lanes<Scalar>& volumetric_stress_of_batch(std::size_t q, Index batch) {
    return volumetric_stress_[at(batch) * points + q];
  }
  /// The same of one element.
  [[nodiscard]] Scalar volumetric_stress(std::size_t q, Index element) const {
    return volumetric_stress_[at(element / lane_count<Scalar>) * points + q][element % lane_count<Scalar>];
  }
  void set_volumetric_stress(std::size_t q, Index element, Scalar value) {
    volumetric_stress_of_batch(q, element / lane_count<Scalar>).set(element % lane_count<Scalar>, value);
  }

  /// At quadrature point q, of the node that is number `element * nodes + a`.
  [[nodiscard]] NodeGradient<Scalar>& gradient(std::size_t q, std::size_t element_node) {
    return gradient_[q * elements_ * nodes + element_node];
  }
  [[nodiscard]] COROTET_ALWAYS_INLINE const NodeGradient<Scalar>& gradient(std::size_t q,
                                                                           std::size_t element_node) const {
    return gradient_[q * elements_ * nodes + element_node];
  }

  /// g of MeanDilatation, sqrt(N/m): of each vertex of each patch, or of the node that is number `element * nodes + a`.
  /// There are none unless the law asks for them.
  [[nodiscard]] Scalar* mean_gradient(std::size_t i) { return mean_gradient_[i].data(); }
  [[nodiscard]] COROTET_ALWAYS_INLINE const Scalar* mean_gradient(std::size_t i) const {
    return mean_gradient_[i].data();
  }

  /// Rotation and strain of the elements of a batch with one quadrature point. Kept only where the stress is known
  /// after all elements have been evaluated: MeanDilatation::needs_frames.
  struct Frame {
    Mat3Lanes<Scalar> rotation;
    StrainLanes<Scalar> strain;
  };
  [[nodiscard]] Frame& frame(Index batch) { return frame_[at(batch)]; }

  /// Numbers from an element's force or gradient to that of the next element.
  static constexpr std::size_t stride = 4 * nodes;

  /// The elastic force on one vertex, N: the force that the body exerts on it.
  [[nodiscard]] Vec3<Scalar> vertex_force(const BlockPattern& pattern, Index vertex) const {
    return sum_of_nodes(pattern, force_, vertex);
  }

  [[nodiscard]] std::size_t bytes() const {
    return bytes_of(extremes) + twist.bytes() + bytes_of(force_) + bytes_of(volumetric_stress_) + bytes_of(gradient_) +
           bytes_of(mean_gradient_) + bytes_of(frame_);
  }

 private:
  Scratch<PaddedVector<Scalar>> force_;       // [element][node]
  Scratch<Lanes<Scalar>> volumetric_stress_;  // [batch][point]
  Scratch<NodeGradient<Scalar>> gradient_;    // [point][element][node]
  Scratch<PaddedVector<Scalar>> mean_gradient_;
  Scratch<Frame> frame_;  // [batch]
  std::size_t elements_ = 0;
};

/// The sum of element contributions to one 3x3 block of the warped stiffness. With `same_ratio`, lambda / mu is that of
/// the first element in all of them, which halves the work.
template <std::floating_point Scalar, bool same_ratio = false>
class StiffnessSum {
 public:
  /// Adds block (a, b) of an element. With g = R grad N it is
  /// sum V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I).
  /// `row` and `column`: element * nodes + a, and + b.
  template <class Evaluation>
  COROTET_ALWAYS_INLINE void add(const Evaluation& state, std::size_t row, std::size_t column) {
    for (std::size_t q = 0; q < Evaluation::points; ++q) {
      const NodeGradient<Scalar>& gb = state.gradient(q, column);
      const Q ga = Q::load(state.gradient(q, row).data());
      COROTET_UNROLL
      for (std::size_t c = 0; c < 3; ++c) mu_[c] += ga * Q(gb[c]);
      if constexpr (!same_ratio) {
        const Q lambda_ga = ga * Q(gb.lame_ratio());
        COROTET_UNROLL
        for (std::size_t c = 0; c < 3; ++c) lambda_[c] += lambda_ga * Q(gb[c]);
      }
    }
  }

  /// Where the ratio is the same everywhere: called once, after the last `add` and before `add_mean`.
  COROTET_ALWAYS_INLINE void set_ratio(Scalar lame_ratio)
    requires same_ratio
  {
    COROTET_UNROLL
    for (std::size_t c = 0; c < 3; ++c) lambda_[c] = Q(lame_ratio) * mu_[c];
  }

  /// Adds row_g column_g^T: see MeanDilatation.
  COROTET_ALWAYS_INLINE void add_mean(const Scalar* row_g, const Scalar* column_g) {
    const Q g = Q::load(row_g);
    COROTET_UNROLL
    for (std::size_t c = 0; c < 3; ++c) lambda_[c] += g * Q(column_g[c]);
  }

  /// Writes the sum times `factor` (whose units are those of the result per N/m) to the nine numbers at `block`, and
  /// its transpose, the same numbers, to those at `mirror`.
  COROTET_ALWAYS_INLINE void write(Scalar factor, Scalar* block, Scalar* mirror) const {
    const std::array<Q, 3> lambda_t = transposed(lambda_[0], lambda_[1], lambda_[2]);
    const std::array<Q, 3> mu_t = transposed(mu_[0], mu_[1], mu_[2]);
    const Q trace = diagonal_sum();
    std::array<Q, 3> k, k_t;
    COROTET_UNROLL
    for (std::size_t c = 0; c < 3; ++c) {
      const Q isotropic = trace * unit(c), scale(factor);
      k[c] = scale * (lambda_[c] + mu_t[c] + isotropic);
      k_t[c] = scale * (mu_[c] + lambda_t[c] + isotropic);
    }
    write_columns(k, block);
    write_columns(k_t, mirror);
  }

 private:
  using Q = Vec4<Scalar>;

  [[nodiscard]] COROTET_ALWAYS_INLINE static Q unit(std::size_t c) {
    std::array<Scalar, 4> e{};
    e[c] = 1;
    return Q::load(e.data());
  }
  [[nodiscard]] COROTET_ALWAYS_INLINE Q diagonal_sum() const {
    std::array<std::array<Scalar, 4>, 3> m;
    COROTET_UNROLL
    for (std::size_t c = 0; c < 3; ++c) mu_[c].store(m[c].data());
    return Q(m[0][0] + m[1][1] + m[2][2]);
  }

  // Columns of sum lambda V g_a g_b^T and of sum mu V g_a g_b^T.
  std::array<Q, 3> lambda_{Q(Scalar(0)), Q(Scalar(0)), Q(Scalar(0))}, mu_{Q(Scalar(0)), Q(Scalar(0)), Q(Scalar(0))};
};

}  // namespace corotet::inline v0_1::detail
