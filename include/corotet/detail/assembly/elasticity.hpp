// The elastic law of a body: a material model on the elements of a mesh.
#pragma once

#include <concepts>
#include <corotet/detail/assembly/corotated_elasticity.hpp>
#include <corotet/detail/assembly/pointwise_elasticity.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <corotet/detail/material/corotated.hpp>
#include <corotet/detail/rotation/polar.hpp>

namespace corotet::inline v0_1 {

namespace detail {

template <class Scalar, class Element, class Model>
struct ElasticityOf {
  using Type = PointwiseElasticity<Scalar, Element, Model>;
};
template <class Scalar, class Element, class Rotation>
struct ElasticityOf<Scalar, Element, Corotated<Rotation>> {
  using Type = CorotatedElasticity<Scalar, Element, Rotation>;
};

}  // namespace detail

/// A model, or a rotation law for the corotated model with it, on the elements of a mesh: CorotatedElasticity for
/// Corotated, PointwiseElasticity for every other ElasticModel. Both offer the same to a step.
template <std::floating_point Scalar, ReferenceElement Element = Tet4, ElasticLaw Law = Polar>
using Elasticity = typename detail::ElasticityOf<Scalar, Element, detail::ElasticModelOf<Law>>::Type;

}  // namespace corotet::inline v0_1
