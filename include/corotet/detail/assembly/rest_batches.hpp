// The rest geometry of a mesh in batches of elements.
#pragma once

#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/element_batch.hpp>
#include <corotet/detail/element/jacobian.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>

namespace corotet::inline v0_1::detail {

/// All elements of a mesh, in their order. Stiffnesses are zero; lanes beyond the last element have an identity
/// Jacobian.
template <std::floating_point Scalar, ReferenceElement Element>
[[nodiscard]] COROTET_COLD Buffer<ElementBatch<Scalar, Element>> rest_batches(const TetMesh<Scalar, Element>& mesh) {
  using Batch = ElementBatch<Scalar, Element>;
  Buffer<Batch> batches(at((mesh.element_count() + lane_count<Scalar> - 1) / lane_count<Scalar>));
  for (Index e = 0; e < size_of(batches) * lane_count<Scalar>; ++e) {
    Batch& batch = batches[at(e / lane_count<Scalar>)];
    const int l = e % lane_count<Scalar>;
    const bool exists = e < mesh.element_count();
    batch.lame_ratio.set(l, 0);
    for (std::size_t a = 0; a < Element::nodes; ++a) batch.vertex[a][at(l)] = exists ? mesh.element(e)[a] : 0;
    for (std::size_t q = 0; q < Batch::points; ++q) {
      Mat3<double> to_space = Mat3<double>::Identity();
      double weight = 0;
      if (exists) {
        to_space = jacobian(natural_gradients<Element>[q], mesh.node_positions(e));
        weight = Element::stiffness_points[q].weight;
      }
      batch.point[q].inverse_jacobian.set_lane(l, to_space.inverse().template cast<Scalar>());
      batch.point[q].volume.set(l, static_cast<Scalar>(weight * to_space.determinant()));
      batch.point[q].sqrt_mu_volume.set(l, 0);
    }
  }
  return batches;
}

}  // namespace corotet::inline v0_1::detail
