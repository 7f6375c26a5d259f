// An elastic model with a state.
#pragma once

#include <concepts>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/material/corotated.hpp>
#include <corotet/detail/material/elastic_model.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <string_view>

namespace corotet::testing {

/// A material that remembers: it loses stiffness where its energy density has been high. With the density psi of
/// Corotated and kappa, the largest psi so far, its stiffness is the share share(kappa) of that of Corotated. From a
/// committed kappa the energy is the integral of the share over psi, so that the stress is its derivative.
struct Softening {
  using Elastic = Corotated<Polar>;
  using Rotation = Polar;
  static constexpr std::string_view name = "softening";
  static constexpr bool is_conservative = true;

  template <std::floating_point Scalar>
  struct State {
    Lanes<Scalar> kappa = Lanes<Scalar>(0);  // J/m^3
  };
  template <std::floating_point Scalar>
  struct Constants : Elastic::Constants<Scalar> {};

  static constexpr double half_way = 400;  // J/m^3: kappa at which a quarter of the stiffness is left

  template <std::floating_point Scalar>
  [[nodiscard]] static Lanes<Scalar> share(const Lanes<Scalar>& kappa) {
    const Lanes<Scalar> root = Lanes<Scalar>(Scalar(half_way)) / (kappa + Lanes<Scalar>(Scalar(half_way)));
    return root * root;
  }
  template <std::floating_point Scalar>
  [[nodiscard]] static Lanes<Scalar> energy(const Constants<Scalar>& constants,
                                            const DeformationLanes<Scalar>& deformation,
                                            const State<Scalar>& committed) {
    using L = Lanes<Scalar>;
    const L psi = Elastic::energy(constants, deformation, NoState{}), half = Scalar(half_way), before = committed.kappa;
    const L beyond = half * half * (L(1) / (before + half) - L(1) / (psi + half));
    return select(psi > before, share(before) * before + beyond, share(before) * psi);
  }
  template <std::floating_point Scalar>
  static void stress(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                     const State<Scalar>& committed, State<Scalar>& trial, Mat3Lanes<Scalar>& p) {
    NoState none;
    Elastic::stress(constants, deformation, none, none, p);
    trial.kappa = lane_max(committed.kappa, Elastic::energy(constants, deformation, none));
    for (auto& row : p.entry)
      for (Lanes<Scalar>& entry : row) entry = share(trial.kappa) * entry;
  }
  template <std::floating_point Scalar>
  static void tangent(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                      const State<Scalar>& committed, bool semi_definite, TangentLanes<Scalar>& c) {
    using L = Lanes<Scalar>;
    NoState none;
    Elastic::tangent(constants, deformation, none, semi_definite, c);
    const L psi = Elastic::energy(constants, deformation, none), kappa = lane_max(committed.kappa, psi);
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t l = j; l < 3; ++l)
        for (auto& row : c.block(j, l).entry)
          for (L& entry : row) entry = share(kappa) * entry;
    if (semi_definite) return;
    Mat3Lanes<Scalar> p;
    Elastic::stress(constants, deformation, none, none, p);
    const L slope = L(-2) * share(kappa) / (kappa + L(Scalar(half_way)));
    c.add_outer(select(psi > committed.kappa, slope, L(0)), p);
  }
};

}  // namespace corotet::testing
