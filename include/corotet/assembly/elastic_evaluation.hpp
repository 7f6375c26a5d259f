// What the elastic law says of one state of a body: the part of elasticity that changes from step to step.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/assembly/block_pattern.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <corotet/element/element_batch.hpp>
#include <vector>

namespace corotet {

/// The worst of a body's elements.
struct DeformationExtremes {
  Index inverted_elements = 0;      ///< elements with det F <= 0 at a quadrature point
  double largest_strain2 = 0;       ///< square of the largest |sym(R^T F) - I| (Frobenius)
  double least_rotation_trace = 3;  ///< least trace of R

  void merge(const DeformationExtremes& other) {
    inverted_elements += other.inverted_elements;
    largest_strain2 = std::max(largest_strain2, other.largest_strain2);
    least_rotation_trace = std::min(least_rotation_trace, other.least_rotation_trace);
  }

  [[nodiscard]] double largest_strain() const { return std::sqrt(largest_strain2); }

  /// Angle of the element rotation farthest from the identity, rad, 0 ... pi.
  [[nodiscard]] double largest_rotation() const {
    return std::acos(std::clamp((least_rotation_trace - 1) / 2, -1.0, 1.0));
  }
};

/// Scratch that Elasticity::evaluate fills. Sized once; evaluating allocates nothing.
template <std::floating_point Scalar, ReferenceElement Element>
struct ElasticEvaluation {
  static constexpr std::size_t points = Element::stiffness_points.size();
  using ElementForce = std::array<Vec3<Scalar>, Element::nodes>;
  using ElementGradient = std::array<std::array<Vec3<Scalar>, Element::nodes>, points>;

  std::vector<ElementForce> force;            ///< of each element on its nodes, N
  std::vector<ElementGradient> gradient;      ///< R grad N at [element][point][node], 1/m
  std::vector<DeformationExtremes> extremes;  ///< one a task

  ElasticEvaluation() = default;

  template <class Law>
  explicit ElasticEvaluation(const Law& law)
      : force(at(law.element_count())),
        gradient(at(law.element_count())),
        extremes((law.batches().size() + at(Law::batch_grain) - 1) / at(Law::batch_grain)) {}

  [[nodiscard]] DeformationExtremes worst() const {
    DeformationExtremes all;
    for (const DeformationExtremes& part : extremes) all.merge(part);
    return all;
  }

  /// The elastic force on one vertex, N: the force that the body exerts on it.
  [[nodiscard]] Vec3<Scalar> vertex_force(const BlockPattern& pattern, Index vertex) const {
    Vec3<Scalar> sum = Vec3<Scalar>::Zero();
    for (Index k = pattern.incidence_start[at(vertex)]; k < pattern.incidence_start[at(vertex) + 1]; ++k) {
      const Index incidence = pattern.incidence[at(k)];
      sum += force[at(incidence / Element::nodes)][at(incidence % Element::nodes)];
    }
    return sum;
  }
};

}  // namespace corotet
