// A cure for volumetric locking: the change of volume counts as a mean over several quadrature points.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/assembly/dilatation_patches.hpp>
#include <corotet/detail/assembly/elastic_evaluation.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/ordered_sum.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/element_batch.hpp>
#include <corotet/detail/material/strain.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstdint>
#include <span>
#include <type_traits>

namespace corotet::inline v0_1 {

/// What resists a change of volume, theta = tr(R^T F) - 3.
enum class VolumetricStrain {
  /// theta at each quadrature point: W = sum V lambda/2 theta^2. Locks as Poisson's ratio nears 1/2.
  pointwise,
  /// The mean of theta over a patch of elements (Tet4) or over the element (Tet10): see MeanDilatation.
  averaged
};

namespace detail {

/// Mean dilatation (Nagtegaal, Parks & Rice 1974; Hughes 1980; over patches of linear tetrahedra: de Souza Neto,
/// Andrade Pires & Owen 2005): docs/theory.md, equation 10. Lamé's lambda is split in two. `pointwise` of it acts at
/// each quadrature point. The remainder m = lambda - pointwise >= 0 acts on the mean: with weights w = m V,
///   W = sum over patches (sum w) theta_P^2 / 2, theta_P = (sum w theta) / (sum w).
/// Where m differs within a patch, the stiffer points count for more. A uniform theta has the energy that it has
/// without the mean. The force on a node is -sum w theta_P R grad N_a, minus the gradient of W. The warped stiffness is
/// one rank-one matrix b b^T a patch with b_a = (sum w R grad N_a) / sqrt(sum w).
///
/// Tet4: all of lambda >= 0 acts on the mean over a patch, see DilatationPatches; the vertices of a patch are coupled
/// with each other. Tet10: what exceeds 2 mu acts on the mean over the element, so that up to nu = 1/3 nothing changes
/// and the order of the element is kept; the matrix has no more blocks than without.
template <std::floating_point Scalar, ReferenceElement Element>
class MeanDilatation {
 public:
  using Batch = ElementBatch<Scalar, Element>;
  using Evaluation = ElasticEvaluation<Scalar, Element>;
  using L = Lanes<Scalar>;

  /// True for linear tetrahedra, whose patches are found by their faces; false for elements with several points.
  static constexpr bool over_patches = LinearTetrahedron<Element>;

  /// Off: every element for itself.
  MeanDilatation() = default;

  MeanDilatation(const TetMesh<Scalar, Element>& mesh, VolumetricStrain kind)
      : on_(kind == VolumetricStrain::averaged) {
    if (!on_) return;
    ratio_.assign(at((mesh.element_count() + lane_count<Scalar> - 1) / lane_count<Scalar>), L(0));
    if constexpr (over_patches) {
      patches_ = dilatation_patches(mesh);
      find_local_vertices(mesh);
      weight_ = Buffer<Weight>(patches_.element.size());
    }
  }

  [[nodiscard]] bool on() const { return on_; }

  [[nodiscard]] const DilatationPatches& patches() const
    requires over_patches
  {
    return patches_;
  }
  /// The vertices of each patch; none for Tet10.
  [[nodiscard]] Stencils stencils() const {
    if constexpr (over_patches)
      return patches_.vertices;
    else
      return {};
  }

  /// Of lambda / mu, the part that acts at each quadrature point.
  [[nodiscard]] double pointwise(double lame_ratio) const {
    constexpr double most = over_patches ? 0 : 2;
    return on_ ? (std::min)(lame_ratio, most) : lame_ratio;
  }

  /// The rest of an element's lambda / mu. Call `update_weights` after the last one.
  void set_ratio(Index element, double rest) {
    if (on_) ratio_[at(element / lane_count<Scalar>)].set(element % lane_count<Scalar>, static_cast<Scalar>(rest));
  }

  void update_weights(const Buffer<Batch>& batches) {
    if constexpr (over_patches)
      for (Index p = 0; p < patches_.count(); ++p) {
        double sum = 0;  // of w, J
        const auto for_each = [&](auto&& visit) {
          for (Index k = patches_.start[at(p)]; k < patches_.start[at(p) + 1]; ++k) {
            const Index e = patches_.element[at(k)], b = e / lane_count<Scalar>;
            const int l = e % lane_count<Scalar>;
            const auto root = static_cast<double>(batches[at(b)].point[0].sqrt_mu_volume[l]);
            visit(weight_[at(k)], static_cast<double>(ratio_[at(b)][l]), root);
          }
        };
        for_each([&](Weight&, double m, double root) { sum += m * root * root; });
        const double scale = sum > 0 ? 1 / detail::square_root(sum) : 0;
        for_each([&](Weight& weight, double m, double root) {
          weight = {static_cast<Scalar>(m * root * scale), static_cast<Scalar>(m * root * root * scale),
                    static_cast<Scalar>(m)};
        });
      }
  }

  /// Of elements whose mean is their own (nothing of others): m theta_P / mu of each element in a batch, and what to
  /// multiply sqrt(mu V) R grad N with at each point for its share of g.
  struct OfBatch {
    L tension = 0;
    std::array<L, Batch::points> factor;
  };
  [[nodiscard]] OfBatch of_batch(const Batch& batch, Index b, const std::array<Mat3Lanes<Scalar>, Batch::points>& f,
                                 const std::array<Mat3Lanes<Scalar>, Batch::points>& r) const {
    OfBatch out;
    if constexpr (!over_patches)
      if (on_) find_own(batch, ratio_[at(b)], f, r, out);
    return out;
  }

  /// For patches: finishes an evaluation in which the elements' volumetric stress is still theta: adds the mean part to
  /// the forces, writes g, and the volumetric stress that acts.
  void finish(Evaluation& state, ExecutorRef executor) const {
    for_ranges(executor, patches_.count(), patch_grain, [&](Index begin, Index end) {
      for (Index p = begin; p < end; ++p) finish_patch(p, state);
    });
  }

  /// Energy of the mean parts of all patches, J, with `theta` of each element.
  [[nodiscard]] double patches_energy(std::span<const double> theta, ExecutorRef executor) const {
    return ordered_sum(executor, patches_.count(), patch_grain, [&](Index begin, Index end) {
      double energy = 0;
      for (Index p = begin; p < end; ++p) {
        double sum = 0;
        for (Index k = patches_.start[at(p)]; k < patches_.start[at(p) + 1]; ++k)
          sum += static_cast<double>(weight_[at(k)].trace) * theta[at(patches_.element[at(k)])];
        energy += sum * sum / 2;
      }
      return energy;
    });
  }

  /// For patches: visit(element, m theta_P / mu) for each element of patch p, with theta(e) of its elements.
  template <class Theta, class Visit>
  void for_each_tension(Index p, const Theta& theta, const Visit& visit) const {
    Scalar total = 0, sum = 0;
    for (Index k = patches_.start[at(p)]; k < patches_.start[at(p) + 1]; ++k) {
      total += weight_[at(k)].trace;
      sum += weight_[at(k)].trace * theta(patches_.element[at(k)]);
    }
    const Scalar mean = total > 0 ? sum / total : Scalar(0);
    for (Index k = patches_.start[at(p)]; k < patches_.start[at(p) + 1]; ++k)
      visit(patches_.element[at(k)], weight_[at(k)].ratio * mean);
  }

  /// Numbers that Elasticity::energy keeps while it works: theta of each element, where patches need it.
  [[nodiscard]] std::size_t scratch_size() const { return over_patches ? ratio_.size() * at(lane_count<Scalar>) : 0; }

  /// Whether an evaluation keeps rotations and strains until `finish` has found the stress.
  [[nodiscard]] bool needs_frames() const { return on_ && over_patches; }

  /// Vectors g that an evaluation keeps.
  [[nodiscard]] std::size_t gradient_count(Index elements) const {
    if (!on_) return 0;
    if constexpr (over_patches)
      return patches_.vertices.vertex.size();
    else
      return at(elements) * Element::nodes;
  }

  [[nodiscard]] std::size_t bytes() const {
    std::size_t bytes = bytes_of(ratio_);
    if constexpr (over_patches)
      bytes += bytes_of(weight_) + bytes_of(local_) + bytes_of(patches_.start) + bytes_of(patches_.element) +
               bytes_of(patches_.vertices.start) + bytes_of(patches_.vertices.vertex);
    return bytes;
  }

 private:
  static constexpr Index patch_grain = 64;

  /// Of an element in its patch, with W = (sum trace theta)^2 / 2.
  struct Weight {
    Scalar gradient;  // w / sqrt(sum w) / sqrt(mu V): of sqrt(mu V) R grad N in g
    Scalar trace;     // w / sqrt(sum w): of theta, sqrt(J)
    Scalar ratio;     // m / mu
  };

  static void find_own(const Batch& batch, const L& ratio, const std::array<Mat3Lanes<Scalar>, Batch::points>& f,
                       const std::array<Mat3Lanes<Scalar>, Batch::points>& r, OfBatch& out) {
    L stiffness = 0, sum = 0;
    for (std::size_t q = 0; q < Batch::points; ++q) {
      const L root = batch.point[q].sqrt_mu_volume;
      stiffness += root * root;
      sum += root * root * corotational_strain(f[q], r[q]).trace();
    }
    stiffness = select(stiffness > 0, stiffness, L(1));  // lanes without an element
    out.tension = ratio * sum / stiffness;
    const L scale = sqrt(ratio / stiffness);
    for (std::size_t q = 0; q < Batch::points; ++q) out.factor[q] = scale * batch.point[q].sqrt_mu_volume;
  }

  void find_local_vertices(const TetMesh<Scalar, Element>& mesh) {
    local_ = Buffer<std::array<std::uint8_t, Element::nodes>>(patches_.element.size());
    for (Index p = 0; p < patches_.count(); ++p) {
      const auto& [start, vertex] = patches_.vertices;
      const auto first = vertex.begin() + start[at(p)], last = vertex.begin() + start[at(p) + 1];
      for (Index k = patches_.start[at(p)]; k < patches_.start[at(p) + 1]; ++k)
        for (std::size_t a = 0; a < Element::nodes; ++a) {
          const Index v = mesh.element(patches_.element[at(k)])[a];
          local_[at(k)][a] = static_cast<std::uint8_t>(std::lower_bound(first, last, v) - first);
        }
    }
  }

  void finish_patch(Index p, Evaluation& state) const {
    using Q = Vec4<Scalar>;
    const Index begin = patches_.start[at(p)], end = patches_.start[at(p) + 1];
    const Index first = patches_.vertices.start[at(p)], count = patches_.vertices.start[at(p) + 1] - first;
    Scalar total = 0, sum = 0;  // of the traces' weights, sqrt(J), and with theta
    for (Index k = begin; k < end; ++k) {
      total += weight_[at(k)].trace;
      sum += weight_[at(k)].trace * state.volumetric_stress(0, patches_.element[at(k)]);
    }
    const Scalar theta = total > 0 ? sum / total : Scalar(0);
    std::array<Q, std::size_t{Stencils::max_vertices}> g;
    for (Index i = 0; i < count; ++i) g[at(i)] = Q(Scalar(0));
    for (Index k = begin; k < end; ++k) {
      const Index e = patches_.element[at(k)];
      const Weight& weight = weight_[at(k)];
      const Scalar own = state.volumetric_stress(0, e);
      const Scalar pointwise_ratio = state.gradient(0, at(e) * Element::nodes).lame_ratio();
      for (std::size_t a = 0; a < Element::nodes; ++a) {
        const Q share =
            (Q(weight.gradient) * Q::load(state.gradient(0, at(e) * Element::nodes + a).data())).first_three();
        g[local_[at(k)][a]] += share;
        (Q::load(state.force(e, a)) - Q(sum) * share).store(state.force(e, a));
      }
      state.set_volumetric_stress(0, e, pointwise_ratio * own + weight.ratio * theta);
    }
    for (Index i = 0; i < count; ++i) g[at(i)].store(state.mean_gradient(at(first + i)));
  }

  struct NoPatches {};
  template <class T>
  using OfPatches = std::conditional_t<over_patches, T, NoPatches>;

  bool on_ = false;
  Buffer<L> ratio_;  // m / mu, one a batch
  OfPatches<DilatationPatches> patches_;
  OfPatches<Buffer<Weight>> weight_;                                   // one an element, in their order
  OfPatches<Buffer<std::array<std::uint8_t, Element::nodes>>> local_;  // of its nodes in the patch's vertices
};

}  // namespace detail

}  // namespace corotet::inline v0_1
