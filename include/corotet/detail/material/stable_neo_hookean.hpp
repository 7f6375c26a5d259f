// A rubber-like law that is finite and smooth for every deformation, inverted ones included.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/core/elementary.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/material/elastic_model.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/material/principal_tangent.hpp>
#include <corotet/detail/material/strain.hpp>
#include <corotet/detail/material/tangent_lanes.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <string_view>

namespace corotet::inline v0_1 {

/// Stable neo-Hookean elasticity (Smith, de Goes & Kim 2018, "Stable Neo-Hookean Flesh Simulation", eq. 14): with
/// I = |F|^2 and J = det F the energy density is
///   mu/2 (I - 3 - log((I + 1) / 4)) + lambda/2 ((J - a)^2 - (1 - a)^2), a = 1 + 3 mu / (4 lambda).
/// The rest configuration is stress-free. Its mu and lambda are 4/3 of Lamé's mu and Lamé's lambda + 5/6 of Lamé's mu
/// (eq. 16), so that small strains have the energy of the given Young's modulus and Poisson's ratio.
///
/// At F = 0 stress and tangent are zero: a body that starts in a point unfolds only from where it is held or pulled.
///
/// Energy and stress are computed of R^T F - I, which has the digits of small strains under large rotations.
struct StableNeoHookean {
  static constexpr std::string_view name = "stable_neo_hookean";  ///< as in messages
  static constexpr bool is_conservative = true;                   ///< the stress is the derivative of the energy
  using Rotation = Polar;  ///< it asks for none, so that this one costs nothing more

  template <std::floating_point Scalar>
  using State = NoState;  ///< it has no memory

  template <std::floating_point Scalar>
  struct Constants {
    Lanes<Scalar> mu, lambda;  ///< Pa, of the energy above

    void set(int lane, const Material& material) {
      const Lame parameters = lame(material);
      mu.set(lane, static_cast<Scalar>(4 * parameters.mu / 3));
      lambda.set(lane, static_cast<Scalar>(parameters.lambda + 5 * parameters.mu / 6));
    }
  };

  /// 3/4 mu ((I - 3)/2 - (J - 1)) + mu/2 (x - log(1 + x)) + lambda/2 (J - 1)^2 with x = (I - 3) / 4: the sum above in
  /// terms that are of second order in the strain.
  template <std::floating_point Scalar>
  [[nodiscard]] static Lanes<Scalar> energy(const Constants<Scalar>& constants,
                                            const DeformationLanes<Scalar>& deformation, const NoState& /*committed*/) {
    using L = Lanes<Scalar>;
    const Invariants<Scalar> of(deformation);
    L excess;
    for (int l = 0; l < lane_count<Scalar>; ++l)
      excess.set(l, static_cast<Scalar>(detail::excess_over_logarithm(static_cast<double>(of.x[l]))));
    const L half(Scalar(0.5));
    return constants.mu * (L(Scalar(0.75)) * (half * of.square - of.minors - of.determinant) + half * excess) +
           half * constants.lambda * of.growth * of.growth;
  }

  /// P = mu (1 - 1/(I + 1)) F + lambda (J - a) cof F.
  template <std::floating_point Scalar>
  static void stress(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                     const NoState& /*committed*/, NoState& /*trial*/, Mat3Lanes<Scalar>& p) {
    using L = Lanes<Scalar>;
    const Invariants<Scalar> of(deformation);
    const L at_rest = L(Scalar(0.75)) * constants.mu;  // of both terms, where they cancel
    const L shear = constants.mu * of.x / (L(4) * (L(1) + of.x)), volumetric = constants.lambda * of.growth;
    Mat3Lanes<Scalar> rotated;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const L one(i == j ? Scalar(1) : Scalar(0));
        // F - cof F and cof F of F = 1 + h.
        const L difference = of.h(i, j) + of.h(j, i) - one * of.trace - of.cofactor(i, j);
        const L cofactor = one * (L(1) + of.trace) - of.h(j, i) + of.cofactor(i, j);
        rotated(i, j) = at_rest * difference + shear * (one + of.h(i, j)) + volumetric * cofactor;
      }
    product(deformation.rotation, rotated, p);
  }

  /// mu (1 - 1/(I + 1)) dF + 2 mu/(I + 1)^2 F (F : dF) + lambda cof F (cof F : dF) + lambda (J - a) d(cof F).
  /// Semi-definite: with the absolute values of its eigenvalues, see add_principal_tangent.
  template <std::floating_point Scalar>
  static void tangent(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                      const NoState& /*committed*/, bool semi_definite, TangentLanes<Scalar>& c) {
    using L = Lanes<Scalar>;
    const Invariants<Scalar> of(deformation);
    const L inverse = L(Scalar(0.25)) / (L(1) + of.x);  // 1 / (I + 1)
    const L shear = constants.mu * (L(1) - inverse), stretching = (constants.mu + constants.mu) * inverse * inverse;
    const L pressure = constants.lambda * of.growth - L(Scalar(0.75)) * constants.mu;
    if (!semi_definite) {
      Mat3Lanes<Scalar> cofactor;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
          cofactor(i, j) = deformation.gradient(i1, j1) * deformation.gradient(i2, j2) -
                           deformation.gradient(i1, j2) * deformation.gradient(i2, j1);
        }
      c.add_identity(shear);
      c.add_outer(stretching, deformation.gradient);
      c.add_outer(constants.lambda, cofactor);
      c.add_cofactor_derivative(pressure, deformation.gradient);
      return;
    }
    const PrincipalFrame<Scalar> frame(deformation);
    const Vec3Lanes<Scalar>& s = frame.stretch;
    Vec3Lanes<Scalar> twist, flip;
    Mat3Lanes<Scalar> scaling;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      twist[k] = shear + pressure * s[k];
      flip[k] = shear - pressure * s[k];
      const L area = s[i] * s[j];
      scaling.entry[k][k] = shear + stretching * s[k] * s[k] + constants.lambda * area * area;
      scaling.entry[i][j] = scaling.entry[j][i] =
          stretching * s[i] * s[j] + constants.lambda * s[k] * s[k] * area + pressure * s[k];
    }
    add_principal_tangent(frame, twist, flip, scaling, true, c);
  }

 private:
  /// Of h = R^T F - 1, without cancellation where it is not large.
  template <std::floating_point Scalar>
  struct Invariants {
    using L = Lanes<Scalar>;
    Mat3Lanes<Scalar> h, cofactor;
    L trace, square, minors, determinant;  // tr h, |h|^2, the sum of principal 2x2 minors, det h
    L growth;                              // J - 1
    L x;                                   // (I - 3) / 4

    explicit Invariants(const DeformationLanes<Scalar>& deformation) {
      detail::rotated_gradient(deformation.gradient, deformation.rotation, h);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
          cofactor(i, j) = h(i1, j1) * h(i2, j2) - h(i1, j2) * h(i2, j1);
        }
      trace = h(0, 0) + h(1, 1) + h(2, 2);
      square = h(0, 0) * h(0, 0);
      for (int k = 1; k < 9; ++k) square += h(k / 3, k % 3) * h(k / 3, k % 3);
      minors = cofactor(0, 0) + cofactor(1, 1) + cofactor(2, 2);
      determinant = h(0, 0) * cofactor(0, 0) + h(0, 1) * cofactor(0, 1) + h(0, 2) * cofactor(0, 2);
      growth = trace + minors + determinant;
      // I + 1 >= 1, which rounding of h could hide only where I is nearly 0.
      x = lane_max(L(Scalar(0.25)) * (trace + trace + square), L(Scalar(-0.75)));
    }
  };
};

static_assert(ElasticModel<StableNeoHookean>);

}  // namespace corotet::inline v0_1
