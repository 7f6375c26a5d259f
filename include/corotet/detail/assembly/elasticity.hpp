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

/// The elastic law of a body: a model on the elements of a mesh, without a state.
///
/// Use it without a body for stiffness matrices, vibration modes and integrators of your own; a SoftBody has one
/// (SoftBody::law). A rotation law stands for the corotated model with it.
///
/// - `Elasticity(mesh, materials)`: materials must pass Materials::validate.
/// - `Evaluation(law)`: memory for one state; `evaluate` writes it, `assemble` reads it.
/// - `evaluate(displacement, evaluation, executor)`: displacement in m, one a vertex.
/// - `evaluation.vertex_force(pattern, vertex)`: the elastic force on a vertex, N.
/// - `energy(displacement)`: J.
/// - `stiffness_block(evaluation, element, a, b)`: the 3x3 block of two nodes of an element, N/m.
template <std::floating_point Scalar, ReferenceElement Element = Tet4, ElasticLaw Law = Polar>
using Elasticity = typename detail::ElasticityOf<Scalar, Element, detail::ElasticModelOf<Law>>::Type;

}  // namespace corotet::inline v0_1
