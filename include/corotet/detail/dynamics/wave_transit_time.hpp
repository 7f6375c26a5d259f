// How long sound takes through a body where it is thin.
#pragma once

#include <algorithm>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/element_batch.hpp>
#include <corotet/detail/element/jacobian.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstddef>
#include <limits>
#include <vector>

namespace corotet::inline v0_1::detail {

/// 4 V / A of the rest shape, m: the side of a long square bar, twice the thickness of a plate. A is the sum of the
/// vertices' area vectors' lengths, |sum V grad N| each: somewhat too small at edges.
template <std::floating_point Scalar, ReferenceElement Element>
[[nodiscard]] COROTET_COLD double hydraulic_diameter(const TetMesh<Scalar, Element>& mesh) {
  Field<double> area(at(mesh.vertex_count()), Vec3<double>::Zero());
  double volume = 0, surface = 0;
  for (Index e = 0; e < mesh.element_count(); ++e)
    for (std::size_t q = 0; q < Element::stiffness_points.size(); ++q) {
      const auto& gradient = natural_gradients<Element>[q];
      const Mat3<double> to_space = jacobian(gradient, mesh.node_positions(e));
      const double part = Element::stiffness_points[q].weight * to_space.determinant();
      volume += part;
      const Mat3<double> inverse = to_space.inverse();
      for (std::size_t a = 0; a < gradient.size(); ++a)
        area[at(mesh.element(e)[a])] += part * (inverse.transpose() * Vec3<double>::load(gradient[a].data()));
    }
  for (const Vec3<double>& a : area) surface += a.norm();
  return 4 * volume / surface;
}

/// `hydraulic_diameter` (m) over the speed sqrt(E / rho) of the fastest of the materials, s.
[[nodiscard]] inline double wave_transit_time(double hydraulic_diameter, const Materials& materials, Index elements) {
  double least = std::numeric_limits<double>::infinity();
  for (Index e = 0; e < elements; ++e) {
    const Material& m = materials.of_element(at(e));
    least = (std::min)(least, m.density / m.young);
  }
  return hydraulic_diameter * detail::square_root(least);
}

}  // namespace corotet::inline v0_1::detail
