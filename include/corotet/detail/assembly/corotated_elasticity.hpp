// Corotational linear elasticity (Müller & Gross 2004, "Interactive Virtual Materials"): rotate the deformed element
// back, multiply by its constant stiffness, rotate the force forward.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/assembly/deformation_extremes.hpp>
#include <corotet/detail/assembly/elastic_evaluation.hpp>
#include <corotet/detail/assembly/element_rotations.hpp>
#include <corotet/detail/assembly/mean_dilatation.hpp>
#include <corotet/detail/assembly/rest_batches.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/ordered_sum.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/element_batch.hpp>
#include <corotet/detail/material/corotated.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/material/strain.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <corotet/detail/rotation/identity.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <corotet/detail/rotation/rotation_extractor.hpp>
#include <optional>
#include <span>

namespace corotet::inline v0_1::detail {

/// The elastic law of a body of the material Corotated<Rotation>, by kernels that use what this material's tangent is
/// made of. What depends on the displacement is written into an ElasticEvaluation, so that one law can serve several
/// bodies and threads.
///
/// With S = R^T F at a quadrature point, strain e = sym(S) - I and stress sigma = 2 mu e + lambda tr(e) I, the energy
/// is W = sum V (mu |e|^2 + lambda/2 tr(e)^2) and the force on node a is f_a = -sum V R sigma grad N_a: docs/theory.md,
/// equations 3 to 5. With Polar rotations at each quadrature point f is exactly -dW/dx (Chao, Pinkall, Sanan & Schröder
/// 2010, section 4.1), where it is clear which rotation is nearest (clear_choice). With VolumetricStrain::averaged,
/// tr(e) is a mean over several points instead: see MeanDilatation.
template <std::floating_point Scalar, ReferenceElement Element, RotationExtractor Rotation>
class CorotatedElasticity {
 public:
  using Model = Corotated<Rotation>;
  using element_type = Element;
  using Batch = ElementBatch<Scalar, Element>;
  using Evaluation = ElasticEvaluation<Scalar, Element>;
  static constexpr int nodes = Element::nodes;
  static constexpr std::size_t points = Batch::points;
  /// Whether R is the polar rotation of each point's F: only then are TwistModes those of the energy.
  static constexpr bool has_twist_modes = std::derived_from<Rotation, Polar> && (points == 1 || !Rotation::per_element);
  /// Whether an evaluation keeps the factors of a warped stiffness, and not the blocks of each element.
  static constexpr bool has_warped_stiffness = true;
  static constexpr bool has_mean_dilatation = true;
  static constexpr bool has_point_states = false;
  /// Whether the force is minus the gradient of the energy.
  static constexpr bool is_conservative = has_twist_modes || std::derived_from<Rotation, Identity>;

  /// `materials` must pass Materials::validate for this mesh.
  COROTET_COLD CorotatedElasticity(const TetMesh<Scalar, Element>& mesh, const Materials& materials,
                                   VolumetricStrain volumetric_strain = VolumetricStrain::pointwise)
      : elements_(mesh.element_count()), batches_(rest_batches(mesh)), mean_(mesh, volumetric_strain) {
    set_materials(materials);
  }

  /// New materials for the same mesh; they must pass Materials::validate. Takes effect at the next evaluation.
  COROTET_COLD void set_materials(const Materials& materials) {
    for (Index e = 0; e < elements_; ++e) {
      const auto [lambda, mu] = lame(materials.of_element(at(e)));
      Batch& batch = batches_[at(e / lane_count<Scalar>)];
      const int l = e % lane_count<Scalar>;
      const auto ratio = static_cast<Scalar>(mean_.pointwise(lambda / mu));
      mean_.set_ratio(e, lambda / mu - mean_.pointwise(lambda / mu));
      if (e == 0) common_lame_ratio_ = ratio;
      if (common_lame_ratio_ != ratio) common_lame_ratio_.reset();
      batch.lame_ratio.set(l, ratio);
      for (auto& point : batch.point)
        point.sqrt_mu_volume.set(l,
                                 static_cast<Scalar>(detail::square_root(mu * static_cast<double>(point.volume[l]))));
    }
    if (mean_.on()) mean_.update_weights(batches_);
  }

  [[nodiscard]] Index element_count() const { return elements_; }
  /// The lambda / mu that acts at quadrature points, if it is the same in all elements.
  [[nodiscard]] std::optional<Scalar> common_lame_ratio() const { return common_lame_ratio_; }
  [[nodiscard]] const Buffer<Batch>& batches() const { return batches_; }
  [[nodiscard]] const MeanDilatation<Scalar, Element>& mean_dilatation() const { return mean_; }
  /// Vertices that the matrix couples besides those of an element: for BlockPattern::of.
  [[nodiscard]] Stencils stencils() const { return mean_.stencils(); }

  /// Rotations, nodal forces and rotated gradients of every element at `displacement` (m, one a vertex).
  void evaluate(const Field<Scalar>& displacement, Evaluation& out, ExecutorRef executor) const {
    for_ranges(executor, size_of(batches_), batch_grain, [&](Index begin, Index end) {
      Extremes extremes;
      for (Index b = begin; b < end; ++b) evaluate_batch(displacement, b, out, extremes);
      out.extremes[at(begin / batch_grain)] = extremes.of_all_lanes();
    });
    if constexpr (Mean::over_patches)
      if (mean_.on()) {
        mean_.finish(out, executor);
        finish_batches(out, executor);
      }
  }

  /// W, J: summed in double, in an order that depends on the body alone.
  [[nodiscard]] double energy(const Field<Scalar>& displacement) const {
    Buffer<double> scratch(mean_.scratch_size());
    return energy(displacement, scratch);
  }
  /// The same without allocating: `scratch` has mean_dilatation().scratch_size() entries. The same bits with any
  /// executor.
  [[nodiscard]] double energy(const Field<Scalar>& displacement, std::span<double> scratch,
                              ExecutorRef executor = {}) const {
    double sum = ordered_sum(executor, size_of(batches_), batch_grain, [&](Index begin, Index end) {
      double part = 0;
      for (Index b = begin; b < end; ++b) part += batch_energy(displacement, b, scratch);
      return part;
    });
    if constexpr (Mean::over_patches)
      if (mean_.on()) sum += mean_.patches_energy(scratch, executor);
    return sum;
  }

  /// Block (a, b) of the warped stiffness R K_e R^T of an element, at the evaluated state, N/m: see StiffnessSum.
  /// Without what is a mean over a patch.
  [[nodiscard]] Mat3<Scalar> stiffness_block(const Evaluation& at_state, Index element, int a, int b) const {
    StiffnessSum<Scalar> sum;
    const std::size_t row = at(element * nodes + a), column = at(element * nodes + b);
    sum.add(at_state, row, column);
    if (mean_.on() && !Mean::over_patches) sum.add_mean(at_state.mean_gradient(row), at_state.mean_gradient(column));
    Mat3<Scalar> block, mirror;
    sum.write(1, block.data(), mirror.data());
    return block;
  }

  [[nodiscard]] std::size_t bytes() const { return bytes_of(batches_) + mean_.bytes(); }

  /// F and R at each quadrature point of batch `b`: for element_measures.
  void deformation(const Field<Scalar>& displacement, Index b, std::array<Mat3Lanes<Scalar>, points>& f,
                   std::array<Mat3Lanes<Scalar>, points>& r) const {
    deformation_of_batch<Rotation>(batches_[at(b)], displacement, f, r);
  }
  /// R of the mean of F over the points of each element.
  static void rotation_of(const Batch& batch, const std::array<Mat3Lanes<Scalar>, points>& f, Mat3Lanes<Scalar>& r) {
    extract_from_gradient<Rotation>(mean_of_points(batch, f), r);
  }

  /// Batches that one task works on.
  static constexpr Index batch_grain = 16;

 private:
  using Mean = MeanDilatation<Scalar, Element>;

  using Strain = StrainLanes<Scalar>;
  using Extremes = DeformationExtremesLanes<Scalar>;

  /// J, without what is a mean over a patch; then theta of each element goes to `scratch`.
  [[nodiscard]] double batch_energy(const Field<Scalar>& displacement, Index b, std::span<double> scratch) const {
    const Batch& batch = batches_[at(b)];
    std::array<Mat3Lanes<Scalar>, points> f, r;
    deformation_of_batch<Rotation>(batch, displacement, f, r);
    const typename Mean::OfBatch mean = mean_.of_batch(batch, b, f, r);
    double sum = 0;
    for (std::size_t q = 0; q < points; ++q) {
      const Strain e = corotational_strain(f[q], r[q]);
      const Lanes<Scalar> trace = e.trace();
      const Lanes<Scalar> each =
          strain_energy(e, batch.lame_ratio * trace + mean.tension, batch.point[q].sqrt_mu_volume);
      for (int l = 0; l < lane_count<Scalar>; ++l) sum += static_cast<double>(each[l]);
      if (mean_.on() && Mean::over_patches)
        for (int l = 0; l < lane_count<Scalar>; ++l) scratch[at(b * lane_count<Scalar> + l)] = double(trace[l]);
    }
    return sum;
  }

  void evaluate_batch(const Field<Scalar>& displacement, Index b, Evaluation& out, Extremes& extremes) const {
    using L = Lanes<Scalar>;
    const Batch& batch = batches_[at(b)];
    std::array<Mat3Lanes<Scalar>, points> f, r;
    const L min_determinant = deformation_of_batch<Rotation>(batch, displacement, f, r);

    const bool over_patches = mean_.on() && Mean::over_patches, own_mean = mean_.on() && !Mean::over_patches;
    const typename Mean::OfBatch mean = mean_.of_batch(batch, b, f, r);
    std::array<Vec3Lanes<Scalar>, std::size_t{nodes}> force, mean_gradient;
    for (Vec3Lanes<Scalar>& node : force)
      for (L& component : node) component = 0;
    const Index first = b * lane_count<Scalar>;
    const int used = static_cast<int>(std::min<Index>(lane_count<Scalar>, elements_ - first));

    for (std::size_t q = 0; q < points; ++q) {
      const Mat3Lanes<Scalar>&fq = f[q], &rq = r[q];
      const Strain e = corotational_strain(fq, rq);
      extremes.max_strain2 = lane_max(extremes.max_strain2, e.squared_norm());
      extremes.min_trace = lane_min(extremes.min_trace, rq(0, 0) + rq(1, 1) + rq(2, 2));

      const Mat3Lanes<Scalar>& inverse = batch.point[q].inverse_jacobian;
      Mat3Lanes<Scalar> stress, rotated, rotated_stress, natural_stress;
      const L theta = e.trace();
      const L volumetric = batch.lame_ratio * theta + mean.tension;
      scaled_stress(batch, q, e, volumetric, stress);
      if (over_patches) {  // until MeanDilatation::finish has found the stress
        out.volumetric_stress_of_batch(q, b) = theta;
        out.frame(b) = {rq, e};
      } else {
        out.volumetric_stress_of_batch(q, b) = volumetric;
        add_stress(batch, q, b, e, volumetric, rq, out, extremes);
      }
      // The rotated gradient of node a is R (dxi/dX)^T times its natural gradient, its force -V R s (dxi/dX)^T times
      // it.
      product_with_transpose(rq, inverse, rotated);
      product(rq, stress, rotated_stress);
      product_with_transpose(rotated_stress, inverse, natural_stress);
      for (auto& row : rotated.entry)
        for (L& entry : row) entry = entry * batch.point[q].sqrt_mu_volume;

      for (std::size_t a = 0; a < nodes; ++a) {
        const Vec3Lanes<Scalar> gradient = Batch::times_gradient(rotated, q, a);
        store_side_by_side(gradient[0], gradient[1], gradient[2], batch.lame_ratio,
                           out.gradient(q, at(first * nodes) + a).data(), Evaluation::stride, used);
        if (own_mean)
          for (std::size_t i = 0; i < 3; ++i)
            mean_gradient[a][i] = (q == 0 ? L(0) : mean_gradient[a][i]) + mean.factor[q] * gradient[i];
        const Vec3Lanes<Scalar> part = Batch::times_gradient(natural_stress, q, a);
        for (std::size_t i = 0; i < 3; ++i) force[a][i] += part[i];
      }
    }
    for (std::size_t a = 0; a < nodes; ++a)
      store_side_by_side(force[a][0], force[a][1], force[a][2], L(0), out.force(first, a), Evaluation::stride, used);
    if (own_mean)
      for (std::size_t a = 0; a < nodes; ++a)
        store_side_by_side(mean_gradient[a][0], mean_gradient[a][1], mean_gradient[a][2], L(0),
                           out.mean_gradient(at(first * nodes) + a), Evaluation::stride, used);
    extremes.inverted += select(min_determinant > 0, L(0), L(1));  // at most 16 batches: exact
  }

  /// What follows from the stress at a point besides forces.
  static void add_stress(const Batch& batch, std::size_t q, Index b, const Strain& e, const Lanes<Scalar>& volumetric,
                         const Mat3Lanes<Scalar>& r, Evaluation& out, Extremes& extremes) {
    extremes.add_stress(e, volumetric, batch.point[q].sqrt_mu_volume);
    if (has_twist_modes && out.twist.wanted()) out.twist.set(q, b, e, volumetric, r);
  }

  /// The same once MeanDilatation::finish has found the stress of each patch.
  void finish_batches(Evaluation& out, ExecutorRef executor) const {
    for_ranges(executor, size_of(batches_), batch_grain, [&](Index begin, Index end) {
      Extremes extremes;
      for (Index b = begin; b < end; ++b) {
        const typename Evaluation::Frame& frame = out.frame(b);
        add_stress(batches_[at(b)], 0, b, frame.strain, out.volumetric_stress_of_batch(0, b), frame.rotation, out,
                   extremes);
      }
      const DeformationExtremes found = extremes.of_all_lanes();
      out.extremes[at(begin / batch_grain)].max_stress2 = found.max_stress2;
      out.extremes[at(begin / batch_grain)].energy = found.energy;
    });
  }

  /// Minus the stress times the volume: -V (2 mu e + mu volumetric I).
  static void scaled_stress(const Batch& batch, std::size_t q, const Strain& e, const Lanes<Scalar>& volumetric,
                            Mat3Lanes<Scalar>& s) {
    const Lanes<Scalar> stiffness = batch.point[q].sqrt_mu_volume * batch.point[q].sqrt_mu_volume;
    const Lanes<Scalar> two_mu = Lanes<Scalar>(-2) * stiffness;
    const Lanes<Scalar> pressure = stiffness * volumetric;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      s(i, i) = two_mu * e[at(i)] - pressure;
      s(j, k) = s(k, j) = two_mu * e[at(3 + i)];
    }
  }

  Index elements_;
  Buffer<Batch> batches_;
  std::optional<Scalar> common_lame_ratio_;
  Mean mean_;
};

}  // namespace corotet::inline v0_1::detail
