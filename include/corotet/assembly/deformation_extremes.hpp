// The worst of a body's elements, and the sum of their energies.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/core/elementary.hpp>
#include <corotet/core/lanes.hpp>
#include <corotet/core/types.hpp>
#include <corotet/material/strain.hpp>

namespace corotet::inline v0_1 {

struct DeformationExtremes {
  Index inverted_elements = 0;      ///< elements with det F <= 0 at a quadrature point
  double largest_strain2 = 0;       ///< square of the largest |sym(R^T F) - I| (Frobenius)
  double least_rotation_trace = 3;  ///< least trace of R
  double largest_stress2 = 0;       ///< square of the largest stress (Frobenius) over mu
  double energy = 0;                ///< J

  void merge(const DeformationExtremes& other) {
    inverted_elements += other.inverted_elements;
    largest_strain2 = (std::max)(largest_strain2, other.largest_strain2);
    least_rotation_trace = (std::min)(least_rotation_trace, other.least_rotation_trace);
    largest_stress2 = (std::max)(largest_stress2, other.largest_stress2);
    energy += other.energy;
  }

  [[nodiscard]] double largest_strain() const { return std::sqrt(largest_strain2); }

  /// Angle of the element rotation farthest from the identity, rad, 0 ... pi.
  [[nodiscard]] double largest_rotation() const {
    const double cosine = std::clamp((least_rotation_trace - 1) / 2, -1.0, 1.0);
    return detail::arc_tangent(std::sqrt(1 - cosine * cosine), cosine);
  }
};

/// V (mu |e|^2 + mu volumetric tr(e) / 2) of each lane, J: `volumetric` is the stress p over mu that resists theta =
/// tr(e), `root_stiffness` sqrt(mu V).
template <std::floating_point Scalar>
[[nodiscard]] Lanes<Scalar> strain_energy(const StrainLanes<Scalar>& e, const Lanes<Scalar>& volumetric,
                                          const Lanes<Scalar>& root_stiffness) {
  return root_stiffness * root_stiffness * (e.squared_norm() + Lanes<Scalar>(Scalar(0.5)) * volumetric * e.trace());
}

/// Of the elements that each lane has held. Lanes beyond the last element are at rest.
template <std::floating_point Scalar>
struct DeformationExtremesLanes {
  using L = Lanes<Scalar>;
  L inverted = 0, largest_strain2 = 0, least_trace = 3, largest_stress2 = 0, energy = 0;

  /// The stress 2 e + volumetric I, over mu, at one point. A mean stress gives each of its elements its share.
  void add_stress(const StrainLanes<Scalar>& e, const L& volumetric, const L& root_stiffness) {
    largest_stress2 =
        lane_max(largest_stress2, L(4) * e.squared_norm() + volumetric * (L(4) * e.trace() + L(3) * volumetric));
    energy += strain_energy(e, volumetric, root_stiffness);
  }

  [[nodiscard]] DeformationExtremes of_all_lanes() const {
    DeformationExtremes all;
    for (int l = 0; l < lane_count<Scalar>; ++l)
      all.merge({.inverted_elements = static_cast<Index>(inverted[l]),
                 .largest_strain2 = double(largest_strain2[l]),
                 .least_rotation_trace = double(least_trace[l]),
                 .largest_stress2 = double(largest_stress2[l]),
                 .energy = double(energy[l])});
    return all;
  }
};

}  // namespace corotet::inline v0_1
