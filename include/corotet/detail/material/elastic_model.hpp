// What an elastic law must offer: energy, stress and tangent of a quadrature point, in lanes.
#pragma once

#include <concepts>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/material/tangent_lanes.hpp>
#include <corotet/detail/rotation/rotation_extractor.hpp>
#include <string_view>
#include <type_traits>

namespace corotet::inline v0_1 {

/// The deformation at a quadrature point of each element in a batch.
template <std::floating_point Scalar>
struct DeformationLanes {
  const Mat3Lanes<Scalar>& gradient;  ///< F
  const Mat3Lanes<Scalar>&
      rotation;  ///< R of F by the model's rotation law; see extract_rotations for inverted elements
};

/// The state of a model that depends on the present deformation alone.
struct NoState {};

namespace detail {

template <class M, class Scalar>
concept ElasticModelIn =
    requires(const typename M::template Constants<Scalar>& constants, typename M::template Constants<Scalar>& to_set,
             const Material& material, const DeformationLanes<Scalar>& deformation,
             const typename M::template State<Scalar>& committed, typename M::template State<Scalar>& trial,
             Mat3Lanes<Scalar>& stress, TangentLanes<Scalar>& tangent) {
      to_set.set(int{}, material);
      { M::energy(constants, deformation, committed) } -> std::same_as<Lanes<Scalar>>;
      M::stress(constants, deformation, committed, trial, stress);
      M::tangent(constants, deformation, committed, bool{}, tangent);
      requires std::is_trivially_copyable_v<typename M::template State<Scalar>>;
    };

}  // namespace detail

/// A material law with these members, the functions static and templates over Scalar:
///   name              as in messages
///   is_conservative   whether the stress is the derivative of the energy at a given committed state
///   Rotation          the rotation law by which DeformationLanes::rotation is found
///   Constants         of the materials of a batch; `set(lane, material)` fills a lane
///   State             of a quadrature point of a batch, a plain struct of Lanes whose default is the state at rest;
///                     NoState for a model without memory, which then costs no byte and no instruction
///   energy            density, J/m^3, 0 at rest
///   stress            first Piola-Kirchhoff stress P = d energy/dF, Pa, and the trial state, both from the deformation
///                     and the committed state; the trial state is committed once a step is accepted
///   tangent           adds dP/dF to a tangent that is zero, or where asked for a positive semi-definite substitute
///                     that is equal to it where it is semi-definite itself
///
/// Laws: energy(Q F) = energy(F) and P(Q F) = Q P(F) for every rotation Q; all are finite for every finite F, flat and
/// inverted ones included, within the range of Scalar. docs/architecture.md shows how to add one.
template <class M>
concept ElasticModel = requires {
  requires std::same_as<decltype(M::name), const std::string_view>;
  requires std::same_as<decltype(M::is_conservative), const bool>;
  requires RotationExtractor<typename M::Rotation>;
  requires detail::ElasticModelIn<M, float>;
  requires detail::ElasticModelIn<M, double>;
};

namespace detail {

/// Whether a model remembers anything.
template <class M>
inline constexpr bool has_state = !std::is_empty_v<typename M::template State<double>>;

}  // namespace detail

}  // namespace corotet::inline v0_1
