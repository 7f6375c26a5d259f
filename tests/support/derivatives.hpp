// Forces, matrices and their derivatives by other means, for tests of elastic laws.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <utility>

#include "support/elastic_rig.hpp"

namespace corotet::testing {

/// The Hessian of W by central differences of the force.
template <class Rig>
Eigen::MatrixXd difference_hessian(Rig& rig, const Field<double>& u) {
  const double h = 1e-6;
  const Index dofs = 3 * rig.mesh.vertex_count();
  Eigen::MatrixXd hessian(dofs, dofs);
  for (int c = 0; c < dofs; ++c) {
    Field<double> forward = u, backward = u;
    flat(forward)[c] += h;
    flat(backward)[c] -= h;
    hessian.col(c) = -(flat(rig.force(forward)) - flat(rig.force(backward))) / (2 * h);
  }
  return hessian;
}

/// The force is minus the gradient of the energy, the assembled matrix the Hessian, each to `tolerance`.
template <class Rig>
void expect_derivatives(Rig& rig, const Field<double>& u, double tolerance) {
  const double h = 1e-6;
  const Field<double> force = rig.force(u);
  for (Eigen::Index c = 0; c < flat(u).size(); ++c) {
    Field<double> forward = u, backward = u;
    flat(forward)[c] += h;
    flat(backward)[c] -= h;
    EXPECT_NEAR(flat(force)[c], -(rig.law.energy(forward) - rig.law.energy(backward)) / (2 * h),
                tolerance * flat(force).norm());
  }
  const Eigen::MatrixXd matrix = rig.dense_stiffness(u), hessian = difference_hessian(rig, u);
  for (Eigen::Index c = 0; c < matrix.cols(); ++c)
    EXPECT_LT((matrix.col(c) - hessian.col(c)).norm(), tolerance * matrix.norm()) << "column " << c;
}

/// The assembled matrix is the sum of the elements' own blocks, relative to its largest block.
template <class Rig, class Scalar>
void expect_sum_over_elements(Rig& rig, const Field<Scalar>& u) {
  BlockMatrix<Scalar> k = rig.stiffness(u);
  double largest = 0;
  for (Index s = 0; s < rig.pattern->blocks(); ++s)
    largest = std::max(largest, double(std::as_const(k).block(s).norm()));
  EXPECT_GT(largest, 0);
  for (Index e = 0; e < rig.mesh.element_count(); ++e)
    for (int a = 0; a < rig.law.nodes; ++a)
      for (int b = 0; b < rig.law.nodes; ++b)
        k.block(rig.pattern->slot(rig.mesh.element(e)[at(a)], rig.mesh.element(e)[at(b)])) -=
            rig.law.stiffness_block(rig.state, e, a, b);
  for (Index s = 0; s < rig.pattern->blocks(); ++s)
    EXPECT_LT(double(std::as_const(k).block(s).norm()), (sizeof(Scalar) == 4 ? 1e-5 : 1e-13) * largest);
}

/// A quadrature point of a deformed element in its principal frame: F = U diag(s) V^T with rotations U V^T, s[2] < 0
/// where it is inverted.
struct PrincipalPoint {
  Eigen::MatrixXd gradient;  ///< of the shape functions in space, one a vertex of the mesh
  Mat3<double> f = Mat3<double>::Identity();
  Eigen::Matrix3d u, v;
  Vec3<double> s;
  double volume = 0;

  template <class Scalar, class Element, class Law>
  PrincipalPoint(const Rig<Scalar, Element, Law>& rig, Index e, std::size_t q, const Field<Scalar>& displacement)
      : gradient(Eigen::MatrixXd::Zero(3, rig.mesh.vertex_count())) {
    const auto& point = rig.law.batches()[at(e / lane_count<Scalar>)].point[q];
    const int lane = e % lane_count<Scalar>;
    volume = point.volume[lane];
    const Mat3<double> inverse = point.inverse_jacobian.lane(lane);
    for (std::size_t a = 0; a < Element::nodes; ++a) {
      const Index vertex = rig.mesh.element(e)[a];
      const Vec3<double> of_vertex =
          inverse.transpose() * Vec3<double>::load(corotet::detail::natural_gradients<Element>[q][a].data());
      gradient.col(vertex) = as_eigen(of_vertex);
      f += displacement[at(vertex)] * of_vertex.transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(as_eigen(f), Eigen::ComputeFullU | Eigen::ComputeFullV);
    u = svd.matrixU();
    v = svd.matrixV();
    s = svd.singularValues();
    if (f.determinant() < 0) {
      u.col(2) *= -1;
      s[2] *= -1;
    }
  }

  /// V e (mode)(mode)^T summed over the twist modes, which act on dF along U [axis] V^T / sqrt 2; e = stiffness(s_i +
  /// s_j).
  template <class Stiffness>
  [[nodiscard]] Eigen::MatrixXd twist(const Stiffness& stiffness) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(gradient.size(), gradient.size());
    for (int axis = 0; axis < 3; ++axis) {
      const int i = (axis + 1) % 3, j = (axis + 2) % 3;
      Eigen::Matrix3d spin = Eigen::Matrix3d::Zero();
      spin(i, j) = -std::sqrt(0.5);
      spin(j, i) = std::sqrt(0.5);
      const Eigen::MatrixXd mode = u * spin * v.transpose() * gradient;  // mode : dF/dx
      const Eigen::Map<const Eigen::VectorXd> nodal(mode.data(), mode.size());
      sum += volume * stiffness(s[i] + s[j]) * nodal * nodal.transpose();
    }
    return sum;
  }
};

}  // namespace corotet::testing
