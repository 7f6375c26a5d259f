// The rest geometry of a batch of elements: all that the elastic force needs to know of the mesh, computed once.
#pragma once

#include <array>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/element/reference_element.hpp>

namespace corotet::inline v0_1::detail {

/// Structure of arrays over `lane_count` elements. Lanes beyond the last element have zero volume and name vertex 0.
template <std::floating_point Scalar, ReferenceElement Element>
struct ElementBatch {
  static constexpr std::size_t points = Element::stiffness_points.size();

  struct Point {
    Mat3Lanes<Scalar> inverse_jacobian;  ///< dxi/dX: (natural coordinate, space), 1/m
    Lanes<Scalar> volume;                ///< quadrature weight times det J, m^3
    Lanes<Scalar> sqrt_mu_volume;        ///< sqrt(mu volume), sqrt(J)
  };

  std::array<std::array<Index, lane_count<Scalar>>, Element::nodes> vertex;
  std::array<Point, points> point;
  Lanes<Scalar> lame_ratio;  ///< lambda / mu

  /// Gathers the displacements of the nodes: [node].
  void gather(const Vec3<Scalar>* displacement, std::array<Vec3Lanes<Scalar>, Element::nodes>& u) const {
    for (std::size_t a = 0; a < Element::nodes; ++a)
      for (std::size_t l = 0; l < lane_count<Scalar>; ++l) {
        const Vec3<Scalar>& d = displacement[vertex[a][l]];
        for (int i = 0; i < 3; ++i) u[a][at(i)].set(static_cast<int>(l), d[i]);
      }
  }

  /// F - I at quadrature point `q`: sum over nodes of u (x) grad N.
  void displacement_gradient(std::size_t q, const std::array<Vec3Lanes<Scalar>, Element::nodes>& u,
                             Mat3Lanes<Scalar>& h) const {
    Mat3Lanes<Scalar> natural;  // du/dxi
    if constexpr (has_unit_gradients<Element>) {
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t c = 0; c < 3; ++c) natural.entry[i][c] = u[c + 1][i] - u[0][i];
    } else {
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t c = 0; c < 3; ++c) natural.entry[i][c] = 0;
      for (std::size_t a = 0; a < Element::nodes; ++a)
        for (std::size_t c = 0; c < 3; ++c) {
          const auto gradient = static_cast<Scalar>(natural_gradients<Element>[q][a][c]);
          if (is_zero(gradient)) continue;
          for (std::size_t i = 0; i < 3; ++i) natural.entry[i][c] += Lanes<Scalar>(gradient) * u[a][i];
        }
    }
    const Mat3Lanes<Scalar>& inverse = point[q].inverse_jacobian;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        h(i, j) = natural(i, 0) * inverse(0, j) + natural(i, 1) * inverse(1, j) + natural(i, 2) * inverse(2, j);
  }

  /// The sum over c of column c of `m` times dN_a/dxi_c at point q.
  [[nodiscard]] COROTET_ALWAYS_INLINE static Vec3Lanes<Scalar> times_gradient(const Mat3Lanes<Scalar>& m, std::size_t q,
                                                                              std::size_t a) {
    Vec3Lanes<Scalar> sum;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& row = m.entry[i];
      if constexpr (has_unit_gradients<Element>) {
        sum[i] = a == 0 ? -(row[0] + row[1] + row[2]) : row[a - 1];
      } else {
        sum[i] = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const auto gradient = static_cast<Scalar>(natural_gradients<Element>[q][a][c]);
          if (!is_zero(gradient)) sum[i] += Lanes<Scalar>(gradient) * row[c];
        }
      }
    }
    return sum;
  }
};

}  // namespace corotet::inline v0_1::detail
