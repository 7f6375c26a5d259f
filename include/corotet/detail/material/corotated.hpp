// Corotational linear elasticity as a material law.
#pragma once

#include <concepts>
#include <corotet/detail/core/eigen_lanes.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/material/elastic_model.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/material/strain.hpp>
#include <corotet/detail/material/tangent_lanes.hpp>
#include <corotet/detail/rotation/identity.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <corotet/detail/rotation/rotation_extractor.hpp>
#include <string_view>

namespace corotet::inline v0_1 {

/// Linear elasticity in a rotated frame: with e = sym(R^T F) - I the energy density is mu |e|^2 + lambda/2 tr(e)^2 and
/// P = R (2 mu e + lambda tr(e) I) (Müller & Gross 2004; with polar R: Chao, Pinkall, Sanan & Schröder 2010).
///
/// CorotatedElasticity evaluates this law by kernels of its own, which use that the tangent has two parameters. What
/// stands here is the same law for PointwiseElasticity: their results agree.
template <RotationExtractor RotationLaw = Polar>
struct Corotated {
  static constexpr std::string_view name = "corotated";  ///< as in messages
  using Rotation = RotationLaw;                          ///< how R is found from F
  /// With one rotation for several points the force has no energy: `Rotation::per_element` matters to Tet10.
  static constexpr bool is_conservative =
      (std::derived_from<Rotation, Polar> && !Rotation::per_element) || std::derived_from<Rotation, Identity>;

  template <std::floating_point Scalar>
  using State = NoState;  ///< it has no memory

  template <std::floating_point Scalar>
  struct Constants {
    Lanes<Scalar> mu, lambda;  ///< Pa

    void set(int lane, const Material& material) {
      const Lame parameters = lame(material);
      mu.set(lane, static_cast<Scalar>(parameters.mu));
      lambda.set(lane, static_cast<Scalar>(parameters.lambda));
    }
  };

  /// W of each element, J/m^3.
  template <std::floating_point Scalar>
  [[nodiscard]] static Lanes<Scalar> energy(const Constants<Scalar>& constants,
                                            const DeformationLanes<Scalar>& deformation, const NoState& /*committed*/) {
    const detail::StrainLanes<Scalar> e = detail::corotational_strain(deformation.gradient, deformation.rotation);
    const Lanes<Scalar> theta = e.trace();
    return constants.mu * e.squared_norm() + Lanes<Scalar>(Scalar(0.5)) * constants.lambda * theta * theta;
  }

  /// P of each element, Pa.
  template <std::floating_point Scalar>
  static void stress(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                     const NoState& /*committed*/, NoState& /*trial*/, Mat3Lanes<Scalar>& p) {
    const detail::StrainLanes<Scalar> e = detail::corotational_strain(deformation.gradient, deformation.rotation);
    const Lanes<Scalar> two_mu = constants.mu + constants.mu, pressure = constants.lambda * e.trace();
    Mat3Lanes<Scalar> s;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      s(i, i) = two_mu * e[at(i)] + pressure;
      s(j, k) = s(k, j) = two_mu * e[at(3 + i)];
    }
    product(deformation.rotation, s, p);
  }

  /// The warped stiffness mu (dF + R dF^T R) + lambda R (R : dF), and with Polar the twist modes: see TwistModes.
  template <std::floating_point Scalar>
  static void tangent(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                      const NoState& /*committed*/, bool semi_definite, TangentLanes<Scalar>& c) {
    const Mat3Lanes<Scalar>& r = deformation.rotation;
    c.add_identity(constants.mu);
    c.add_outer(constants.lambda, r);
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t l = j; l < 3; ++l)
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t k = 0; k < 3; ++k) c.block(j, l).entry[i][k] += constants.mu * r.entry[i][l] * r.entry[k][j];
    if constexpr (std::derived_from<Rotation, Polar>) add_twist(constants, deformation, semi_definite, c);
  }

 private:
  /// The modes R [n_k]x / sqrt 2 with the eigenvalues 2 mu + (2 lambda tr(e) - 4 mu) / (s_i + s_j).
  template <std::floating_point Scalar>
  static void add_twist(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                        bool semi_definite, TangentLanes<Scalar>& c) {
    using L = Lanes<Scalar>;
    const detail::StrainLanes<Scalar> strain = detail::corotational_strain(deformation.gradient, deformation.rotation);
    Mat3Lanes<Scalar> e, n;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      e(i, i) = strain[at(i)];
      e(j, k) = e(k, j) = strain[at(3 + i)];
    }
    detail::diagonalise_lanes(e, n);
    const L trace = strain.trace(), pressure = constants.lambda * trace;
    const L least = L(Scalar(1e-3)) * (L(1) + lane_abs(trace + L(3)));  // of s_i + s_j: see TwistModes
    for (int k = 0; k < 3; ++k) {
      const L sum = lane_max(L(2) + trace - e(k, k), least);
      L stiffness = L(2) * constants.mu + (L(2) * pressure - L(4) * constants.mu) / sum;
      if (semi_definite) stiffness = lane_max(stiffness, L(0));
      Mat3Lanes<Scalar> spin, mode;  // [n_k]x, and R times it
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        spin(i, i) = L(0);
        spin(l, j) = n(i, k);
        spin(j, l) = -n(i, k);
      }
      product(deformation.rotation, spin, mode);
      c.add_outer(L(Scalar(0.5)) * stiffness, mode);
    }
  }
};

static_assert(ElasticModel<Corotated<Polar>>);

/// What SoftBody and Elasticity take: a model, or a rotation law, which stands for the corotated model with it.
template <class Law>
concept ElasticLaw = RotationExtractor<Law> || ElasticModel<Law>;

namespace detail {

template <class Law>
struct ModelOfLaw {
  using Type = Law;
};
template <RotationExtractor Rotation>
struct ModelOfLaw<Rotation> {
  using Type = Corotated<Rotation>;
};

/// The model that an ElasticLaw stands for.
template <ElasticLaw Law>
using ElasticModelOf = typename ModelOfLaw<Law>::Type;

}  // namespace detail

}  // namespace corotet::inline v0_1
