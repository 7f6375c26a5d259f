// A point that moves with a mesh: the vertices that carry it and their weights.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <cstddef>

namespace corotet::inline v0_1 {
namespace detail {

/// N_a(xi) + dN_a/dxi . step: the weights of the linear extension from xi. They sum to 1.
template <ReferenceElement Element>
[[nodiscard]] std::array<double, std::size_t{Element::nodes}> extended_weights(const Vec3<double>& xi,
                                                                               const Vec3<double>& step) {
  const NaturalCoordinates natural{xi[0], xi[1], xi[2]};
  std::array<double, std::size_t{Element::nodes}> w = Element::shape(natural);
  const auto gradient = Element::gradient(natural);
  for (std::size_t a = 0; a < w.size(); ++a)
    for (int i = 0; i < 3; ++i) w[a] += gradient[a][at(i)] * step[i];
  return w;
}

}  // namespace detail

/// A point of an element. A field of the mesh has the value sum_a weights[a] field[vertices[a]] there. Weights sum
/// to 1.
template <ReferenceElement Element>
struct BodyPoint {
  static constexpr std::size_t nodes = std::size_t{Element::nodes};  ///< of the element

  std::array<Index, nodes> vertices{};  ///< of the element
  std::array<double, nodes> weights{};  ///< shape functions of these at the point; their sum is 1

  /// The value of a field of vectors, `field(vertex)`, summed in double.
  template <std::invocable<Index> FieldValue>
  [[nodiscard]] Vec3<double> interpolate(const FieldValue& field) const {
    Vec3<double> sum = Vec3<double>::Zero();
    for (std::size_t a = 0; a < nodes; ++a) sum += weights[a] * field(vertices[a]).template cast<double>();
    return sum;
  }
};

}  // namespace corotet::inline v0_1
