// The elastic law of a body of any material model, by the model's energy, stress and tangent at each quadrature point.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/assembly/deformation_extremes.hpp>
#include <corotet/detail/assembly/element_rotations.hpp>
#include <corotet/detail/assembly/mean_dilatation.hpp>
#include <corotet/detail/assembly/pointwise_evaluation.hpp>
#include <corotet/detail/assembly/rest_batches.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/ordered_sum.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/element_batch.hpp>
#include <corotet/detail/material/elastic_model.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/material/point_states.hpp>
#include <corotet/detail/material/strain.hpp>
#include <corotet/detail/material/tangent_lanes.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <span>

namespace corotet::inline v0_1::detail {

/// With the energy density psi of the model: W = sum V psi(F), the force on node a is f_a = -sum V P grad N_a with
/// P = d psi/dF, and block (a, b) of the tangent stiffness is sum V (grad N_a)^T dP/dF (grad N_b), over quadrature
/// points. The interface is that of CorotatedElasticity; there is no mean dilatation. The states of the points are the
/// caller's: they are read, and trial states are written into the evaluation.
template <std::floating_point Scalar, ReferenceElement Element, ElasticModel ModelType>
class PointwiseElasticity {
 public:
  using Model = ModelType;
  using element_type = Element;
  using Batch = ElementBatch<Scalar, Element>;
  using Evaluation = PointwiseEvaluation<Scalar, Element, Model>;
  using States = PointStates<Scalar, Model>;
  static constexpr int nodes = Element::nodes;
  static constexpr std::size_t points = Batch::points;
  static constexpr bool has_twist_modes = false;  ///< beside the model's tangent
  /// Whether an evaluation keeps the factors of a warped stiffness, and not the blocks of each element.
  static constexpr bool has_warped_stiffness = false;
  static constexpr bool has_mean_dilatation = false;
  static constexpr bool has_point_states = has_state<Model>;
  static constexpr bool is_conservative = Model::is_conservative;

  /// `materials` must pass Materials::validate for this mesh. `volumetric_strain` must be pointwise.
  COROTET_COLD PointwiseElasticity(const TetMesh<Scalar, Element>& mesh, const Materials& materials,
                                   [[maybe_unused]] VolumetricStrain volumetric_strain = VolumetricStrain::pointwise)
      : elements_(mesh.element_count()),
        batches_(rest_batches(mesh)),
        constants_(batches_.size()),
        inverse_mu_(batches_.size()) {
    COROTET_ASSERT(volumetric_strain == VolumetricStrain::pointwise, "only the corotated model has a mean dilatation");
    set_materials(materials);
  }

  /// New materials for the same mesh; they must pass Materials::validate. Takes effect at the next evaluation.
  COROTET_COLD void set_materials(const Materials& materials) {
    for (Index e = 0; e < size_of(batches_) * lane_count<Scalar>; ++e) {
      const Index batch = e / lane_count<Scalar>;
      const int lane = e % lane_count<Scalar>;
      const Material& material = materials.of_element(at((std::min)(e, elements_ - 1)));
      constants_[at(batch)].set(lane, material);
      inverse_mu_[at(batch)].set(lane, static_cast<Scalar>(1 / lame(material).mu));
    }
  }

  [[nodiscard]] Index element_count() const { return elements_; }
  [[nodiscard]] const Buffer<Batch>& batches() const { return batches_; }
  /// Off.
  [[nodiscard]] const MeanDilatation<Scalar, Element>& mean_dilatation() const { return no_mean_; }
  /// None: the matrix couples the vertices of an element alone.
  [[nodiscard]] Stencils stencils() const { return {}; }

  /// The states of all quadrature points at rest.
  [[nodiscard]] States states_at_rest() const { return States(batches_.size(), points); }

  /// Forces, tangents and trial states of every element at `displacement` (m, one a vertex), from the states committed
  /// last.
  void evaluate(const Field<Scalar>& displacement, const States& committed, Evaluation& out,
                ExecutorRef executor) const {
    for_ranges(executor, size_of(batches_), batch_grain, [&](Index begin, Index end) {
      Extremes extremes;
      for (Index b = begin; b < end; ++b) evaluate_batch(displacement, b, committed, out, extremes);
      out.extremes[at(begin / batch_grain)] = extremes.of_all_lanes();
    });
  }
  void evaluate(const Field<Scalar>& displacement, Evaluation& out, ExecutorRef executor) const
    requires(!has_state<Model>)
  {
    evaluate(displacement, States(), out, executor);
  }

  /// W, J: summed in double, in an order that depends on the body alone; the same bits with any executor.
  [[nodiscard]] double energy(const Field<Scalar>& displacement, const States& committed,
                              ExecutorRef executor = {}) const {
    return ordered_sum(executor, size_of(batches_), batch_grain, [&](Index begin, Index end) {
      double part = 0;
      for (Index b = begin; b < end; ++b) part += batch_energy(displacement, b, committed);
      return part;
    });
  }
  [[nodiscard]] double energy(const Field<Scalar>& displacement) const
    requires(!has_state<Model>)
  {
    return energy(displacement, States());
  }
  /// `scratch` is not used.
  [[nodiscard]] double energy(const Field<Scalar>& displacement, std::span<double> /*scratch*/,
                              ExecutorRef executor = {}) const
    requires(!has_state<Model>)
  {
    return energy(displacement, States(), executor);
  }

  /// Block (a, b) of an element's tangent stiffness at the evaluated state, N/m.
  [[nodiscard]] Mat3<Scalar> stiffness_block(const Evaluation& at_state, Index element, int a, int b) const {
    BlockSum<Scalar> sum;
    sum.add(at_state, at(element), at(a), at(b));
    Mat3<Scalar> block, mirror;
    sum.write(1, block.data(), mirror.data());
    return block;
  }

  [[nodiscard]] std::size_t bytes() const { return bytes_of(batches_) + bytes_of(constants_) + bytes_of(inverse_mu_); }

  /// Batches that one task works on.
  static constexpr Index batch_grain = 16;

 private:
  using L = Lanes<Scalar>;
  using Extremes = DeformationExtremesLanes<Scalar>;
  using Matrices = std::array<Mat3Lanes<Scalar>, points>;
  /// (natural coordinate, natural coordinate) of a tangent, by 3x3 blocks.
  using NaturalTangent = std::array<std::array<Mat3Lanes<Scalar>, 3>, 3>;

  [[nodiscard]] double batch_energy(const Field<Scalar>& displacement, Index b, const States& committed) const {
    const Batch& batch = batches_[at(b)];
    Matrices f, r;
    deformation_of_batch<typename Model::Rotation>(batch, displacement, f, r);
    double sum = 0;
    for (std::size_t q = 0; q < points; ++q) {
      const DeformationLanes<Scalar> deformation{f[q], r[q]};
      const L each = batch.point[q].volume * Model::energy(constants_[at(b)], deformation, committed.get(q, b));
      for (int l = 0; l < lane_count<Scalar>; ++l) sum += static_cast<double>(each[l]);
    }
    return sum;
  }

  void evaluate_batch(const Field<Scalar>& displacement, Index b, const States& committed, Evaluation& out,
                      Extremes& extremes) const {
    const Batch& batch = batches_[at(b)];
    const typename Model::template Constants<Scalar>& constants = constants_[at(b)];
    Matrices f, r;
    const L min_determinant = deformation_of_batch<typename Model::Rotation>(batch, displacement, f, r);
    extremes.inverted += select(min_determinant > 0, L(0), L(1));  // at most 16 batches: exact

    std::array<Vec3Lanes<Scalar>, std::size_t{nodes}> force;
    for (Vec3Lanes<Scalar>& node : force) node.fill(L(0));
    std::array<NaturalTangent, points> tangent;
    for (std::size_t q = 0; q < points; ++q) {
      const DeformationLanes<Scalar> deformation{f[q], r[q]};
      const typename States::State& before = committed.get(q, b);
      typename States::State trial{};
      Mat3Lanes<Scalar> stress, natural_stress;
      Model::stress(constants, deformation, before, trial, stress);
      out.trial().set(q, b, trial);

      const L& volume = batch.point[q].volume;
      extremes.max_strain2 = lane_max(extremes.max_strain2, corotational_strain(f[q], r[q]).squared_norm());
      extremes.min_trace = lane_min(extremes.min_trace, r[q](0, 0) + r[q](1, 1) + r[q](2, 2));
      extremes.max_stress2 =
          lane_max(extremes.max_stress2, squared_norm_of(stress) * inverse_mu_[at(b)] * inverse_mu_[at(b)]);
      extremes.energy += volume * Model::energy(constants, deformation, before);

      product_with_transpose(stress, batch.point[q].inverse_jacobian, natural_stress);
      for (auto& row : natural_stress.entry)
        for (L& entry : row) entry = -volume * entry;
      for (std::size_t a = 0; a < nodes; ++a) {
        const Vec3Lanes<Scalar> part = Batch::times_gradient(natural_stress, q, a);
        for (std::size_t i = 0; i < 3; ++i) force[a][i] += part[i];
      }

      TangentLanes<Scalar> c;
      Model::tangent(constants, deformation, before, out.twist.projects(), c);
      set_natural(c, batch.point[q], tangent[q]);
    }
    const Index first = b * lane_count<Scalar>;
    const int used = static_cast<int>((std::min)(Index{lane_count<Scalar>}, elements_ - first));
    for (std::size_t a = 0; a < nodes; ++a)
      store_side_by_side(force[a][0], force[a][1], force[a][2], L(0), out.force(first, a), Evaluation::force_stride,
                         used);
    store_blocks(tangent, first, used, out);
  }

  /// V (dxi_c/dX_j)(dxi_d/dX_l) times block (j, l) of the tangent, summed over j and l: for all c and d.
  static void set_natural(const TangentLanes<Scalar>& c, const typename Batch::Point& point, NaturalTangent& natural) {
    const Mat3Lanes<Scalar>& inverse = point.inverse_jacobian;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        Mat3Lanes<Scalar> half, both;  // (c, l): one of the two sums; (c, d): both
        for (std::size_t l = 0; l < 3; ++l)
          for (std::size_t n = 0; n < 3; ++n)
            half.entry[n][l] =
                point.volume * (inverse.entry[n][0] * c.entry(i, 0, k, l) + inverse.entry[n][1] * c.entry(i, 1, k, l) +
                                inverse.entry[n][2] * c.entry(i, 2, k, l));
        product_with_transpose(half, inverse, both);
        for (std::size_t n = 0; n < 3; ++n)
          for (std::size_t m = 0; m < 3; ++m) natural[n][m].entry[i][k] = both.entry[n][m];
      }
  }

  /// Block (a, b) is the sum over points of dN_a/dxi_c dN_b/dxi_d times block (c, d) of the natural tangent.
  static void store_blocks(const std::array<NaturalTangent, points>& tangent, Index first, int used, Evaluation& out) {
    for (std::size_t a = 0; a < nodes; ++a) {
      std::array<std::array<Mat3Lanes<Scalar>, 3>, points> row;  // [point][d]: the sum over c
      for (std::size_t q = 0; q < points; ++q)
        for (std::size_t d = 0; d < 3; ++d) {
          set_zero(row[q][d]);
          for (std::size_t c = 0; c < 3; ++c)
            add_scaled(natural_gradients<Element>[q][a][c], tangent[q][c][d], row[q][d]);
        }
      for (std::size_t b = a; b < nodes; ++b) {
        Mat3Lanes<Scalar> k;
        set_zero(k);
        for (std::size_t q = 0; q < points; ++q)
          for (std::size_t d = 0; d < 3; ++d) add_scaled(natural_gradients<Element>[q][b][d], row[q][d], k);
        Scalar* const block = out.block(first, a, b);
        for (int column = 0; column < 3; ++column)
          store_side_by_side(k(0, column), k(1, column), k(2, column), L(0), block + 4 * column,
                             Evaluation::block_stride, used);
      }
    }
  }

  static void set_zero(Mat3Lanes<Scalar>& m) {
    for (auto& row : m.entry) row.fill(L(0));
  }
  static void add_scaled(double factor, const Mat3Lanes<Scalar>& m, Mat3Lanes<Scalar>& sum) {
    if (is_zero(factor)) return;
    const L scale(static_cast<Scalar>(factor));
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) sum.entry[i][j] += scale * m.entry[i][j];
  }
  [[nodiscard]] static L squared_norm_of(const Mat3Lanes<Scalar>& m) {
    L sum = m(0, 0) * m(0, 0);
    for (int k = 1; k < 9; ++k) sum += m(k / 3, k % 3) * m(k / 3, k % 3);
    return sum;
  }

  Index elements_;
  Buffer<Batch> batches_;
  Buffer<typename Model::template Constants<Scalar>> constants_;  // one a batch
  Buffer<Lanes<Scalar>> inverse_mu_;                              // 1/Pa, one a batch
  MeanDilatation<Scalar, Element> no_mean_;
};

}  // namespace corotet::inline v0_1::detail
