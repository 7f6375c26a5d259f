// Strain, stress and energy of each element: for drawing, for plasticity, for what breaks.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/assembly/deformation_extremes.hpp>
#include <corotet/detail/assembly/element_rotations.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/material/strain.hpp>
#include <cstddef>
#include <span>

namespace corotet::inline v0_1 {

/// The state of an element. Tensors are in space, not in the element's frame, and means over its quadrature points by
/// rest volume, as are scalars; with one point (Tet4) they are the values there.
template <std::floating_point Scalar>
struct ElementMeasures {
  Mat3<Scalar> deformation_gradient;  ///< F
  Mat3<Scalar> rotation;              ///< R of the mean F, by the law's rotation extractor
  Mat3<Scalar> strain;                ///< R e R^T, e = sym(R^T F) - I
  /// R sigma R^T, Pa, with the Biot stress sigma = 2 mu e + lambda tr(e) I: sigma : de is the change of energy density.
  /// Equals the Cauchy stress to first order in the strain. With mean dilatation, its pressure is that of the mean.
  Mat3<Scalar> stress;
  Scalar volume;          ///< at rest, m^3
  Scalar volume_ratio;    ///< det F: present volume over volume at rest; <= 0 where inverted
  Scalar energy_density;  ///< J per m^3 at rest; with mean dilatation over patches, with the element's share of that
  Scalar von_mises;       ///< of `stress`, Pa

  /// P F^T / det F with P = R sigma, Pa: the force on an area of the deformed body. Needs volume_ratio > 0.
  [[nodiscard]] Mat3<Scalar> cauchy_stress() const {
    return stress * rotation * deformation_gradient.transpose() / volume_ratio;
  }
};

/// sqrt(3/2) |dev s|: the pull that a bar would need for the same distortion, Pa.
template <std::floating_point Scalar>
[[nodiscard]] Scalar von_mises_stress(const Mat3<Scalar>& s) {
  const Mat3<Scalar> deviator = s - s.trace() / 3 * Mat3<Scalar>::Identity();
  return detail::square_root(Scalar(1.5)) * deviator.norm();
}

namespace detail {

/// Of one batch, without what is a mean over a patch. `out`: of all elements.
template <class Law, std::floating_point Scalar>
void measure_batch(const Law& law, const Field<Scalar>& displacement, Index b, std::span<ElementMeasures<Scalar>> out) {
  using L = Lanes<Scalar>;
  constexpr std::size_t points = Law::points;
  const typename Law::Batch& batch = law.batches()[at(b)];
  std::array<Mat3Lanes<Scalar>, points> f, r;
  law.deformation(displacement, b, f, r);
  const auto mean = law.mean_dilatation().of_batch(batch, b, f, r);

  L volume = 0, determinants = 0, volumetric = 0, energy = 0;
  Mat3Lanes<Scalar> strain, gradient;
  for (int k = 0; k < 9; ++k) strain(k / 3, k % 3) = gradient(k / 3, k % 3) = L(0);
  for (std::size_t q = 0; q < points; ++q) {
    const L v = batch.point[q].volume;
    const StrainLanes<Scalar> e = corotational_strain(f[q], r[q]);
    const L p = batch.lame_ratio * e.trace() + mean.tension;  // over mu
    volume += v;
    determinants += v * determinant(f[q]);
    volumetric += v * p;
    energy += strain_energy(e, p, batch.point[q].sqrt_mu_volume);
    Mat3Lanes<Scalar> local, half, turned;
    for (int i = 0; i < 3; ++i) {
      local(i, i) = e[at(i)];
      local((i + 1) % 3, (i + 2) % 3) = local((i + 2) % 3, (i + 1) % 3) = e[at(3 + i)];
    }
    product(r[q], local, half);
    product_with_transpose(half, r[q], turned);
    for (int k = 0; k < 9; ++k) {
      strain(k / 3, k % 3) += v * turned(k / 3, k % 3);
      gradient(k / 3, k % 3) += v * f[q](k / 3, k % 3);
    }
  }
  Mat3Lanes<Scalar> rotation = r[0];
  if constexpr (points > 1) law.rotation_of(batch, f, rotation);
  const L root = batch.point[0].sqrt_mu_volume;
  const Index first = b * lane_count<Scalar>;
  const int used = (std::min)(lane_count<Scalar>, static_cast<int>(law.element_count() - first));
  for (int l = 0; l < used; ++l) {
    ElementMeasures<Scalar>& m = out[at(first + l)];
    const Scalar all = volume[l], mu = root[l] * (root[l] / batch.point[0].volume[l]);
    m.deformation_gradient = gradient.lane(l) / all;
    m.rotation = rotation.lane(l);
    const Mat3<Scalar> sum = strain.lane(l);
    m.strain = (sum + sum.transpose()) / (2 * all);
    m.stress = mu * (Scalar(2) * m.strain + volumetric[l] / all * Mat3<Scalar>::Identity());
    m.volume = all;
    m.volume_ratio = determinants[l] / all;
    m.energy_density = energy[l] / all;
    m.von_mises = von_mises_stress(m.stress);
  }
}

}  // namespace detail

/// Of the corotated model: measures each element at `displacement`, m, one a vertex; `out` has one entry an element.
/// Costs about what the elastic forces do, allocates nothing, and gives the same bits on any executor. Law: energy
/// densities times volumes sum to the energy, to rounding.
template <class Law, std::floating_point Scalar>
void element_measures(const Law& law, const Field<Scalar>& displacement, std::span<ElementMeasures<Scalar>> out,
                      ExecutorRef executor = {}) {
  static_assert(
      requires { law.mean_dilatation(); }, "measures are of the corotated model");
  COROTET_ASSERT(size_of(out) == law.element_count(), "measures need one entry per element");
  for_ranges(executor, size_of(law.batches()), Law::batch_grain, [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b) detail::measure_batch(law, displacement, b, out);
  });
  if constexpr (requires { law.mean_dilatation().patches(); }) {
    constexpr Index patch_grain = 64;
    for_ranges(executor, law.mean_dilatation().patches().count(), patch_grain, [&](Index begin, Index end) {
      for (Index p = begin; p < end; ++p)
        law.mean_dilatation().for_each_tension(
            p, [&](Index e) { return out[at(e)].strain.trace(); },
            [&](Index e, Scalar tension) {
              const auto& point = law.batches()[at(e / lane_count<Scalar>)].point[0];
              const int l = e % lane_count<Scalar>;
              const Scalar pressure = point.sqrt_mu_volume[l] * (point.sqrt_mu_volume[l] / point.volume[l]) * tension;
              out[at(e)].stress += pressure * Mat3<Scalar>::Identity();
              out[at(e)].energy_density += pressure * out[at(e)].strain.trace() / 2;
            });
    });
  }
}

}  // namespace corotet::inline v0_1
