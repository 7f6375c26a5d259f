// The worst of a body's elements, and the sum of their energies.
#pragma once

#include <algorithm>
#include <corotet/detail/core/elementary.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/material/strain.hpp>

namespace corotet::inline v0_1::detail {

struct DeformationExtremes {
  Index inverted_elements = 0;    ///< elements with det F <= 0 at a quadrature point
  double max_strain2 = 0;         ///< square of the largest |sym(R^T F) - I| (Frobenius)
  double min_rotation_trace = 3;  ///< least trace of R
  double max_stress2 = 0;         ///< square of the largest stress (Frobenius) over mu
  double energy = 0;              ///< J

  void merge(const DeformationExtremes& other) {
    inverted_elements += other.inverted_elements;
    max_strain2 = (std::max)(max_strain2, other.max_strain2);
    min_rotation_trace = (std::min)(min_rotation_trace, other.min_rotation_trace);
    max_stress2 = (std::max)(max_stress2, other.max_stress2);
    energy += other.energy;
  }

  [[nodiscard]] double max_strain() const { return detail::square_root(max_strain2); }

  /// Angle of the element rotation farthest from the identity, rad, 0 ... pi.
  [[nodiscard]] double max_rotation() const {
    const double cosine = std::clamp((min_rotation_trace - 1) / 2, -1.0, 1.0);
    return arc_tangent(square_root(1 - cosine * cosine), cosine);
  }
};

/// V (mu |e|^2 + mu volumetric tr(e) / 2) of each lane, J: `volumetric` is the stress p over mu that resists theta =
/// tr(e), `sqrt_mu_volume` sqrt(mu V).
template <std::floating_point Scalar>
[[nodiscard]] Lanes<Scalar> strain_energy(const StrainLanes<Scalar>& e, const Lanes<Scalar>& volumetric,
                                          const Lanes<Scalar>& sqrt_mu_volume) {
  return sqrt_mu_volume * sqrt_mu_volume * (e.squared_norm() + Lanes<Scalar>(Scalar(0.5)) * volumetric * e.trace());
}

/// Of the elements that each lane has held. Lanes beyond the last element are at rest.
template <std::floating_point Scalar>
struct DeformationExtremesLanes {
  using L = Lanes<Scalar>;
  L inverted = 0, max_strain2 = 0, min_trace = 3, max_stress2 = 0, energy = 0;

  /// The stress 2 e + volumetric I, over mu, at one point. A mean stress gives each of its elements its share.
  void add_stress(const StrainLanes<Scalar>& e, const L& volumetric, const L& sqrt_mu_volume) {
    max_stress2 = lane_max(max_stress2, L(4) * e.squared_norm() + volumetric * (L(4) * e.trace() + L(3) * volumetric));
    energy += strain_energy(e, volumetric, sqrt_mu_volume);
  }

  [[nodiscard]] DeformationExtremes of_all_lanes() const {
    DeformationExtremes all;
    for (int l = 0; l < lane_count<Scalar>; ++l)
      all.merge({.inverted_elements = static_cast<Index>(inverted[l]),
                 .max_strain2 = double(max_strain2[l]),
                 .min_rotation_trace = double(min_trace[l]),
                 .max_stress2 = double(max_stress2[l]),
                 .energy = double(energy[l])});
    return all;
  }
};

}  // namespace corotet::inline v0_1::detail
