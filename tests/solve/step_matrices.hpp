// Linear systems of real steps, for tests of solvers.
#pragma once

#include <Eigen/Core>
#include <corotet/detail/assembly/assemble.hpp>
#include <corotet/detail/assembly/mass.hpp>
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <corotet/detail/solve/step_system.hpp>
#include <cstdint>
#include <memory>
#include <vector>

#include "support/bodies.hpp"

namespace corotet::testing {

/// M + h^2 K' of a beam, deformed a little and turned by `rotation`, with the vertices at x = 0 isolated as pins are.
template <class Scalar, class Element>
struct BeamSystem {
  explicit BeamSystem(std::array<Index, 3> cells, double young = 5e5,
                      const Mat3<double>& rotation = Mat3<double>::Identity(), bool pins = true)
      : mesh(distorted_block<Scalar, Element>({.size = {1, 0.3, 0.3}, .cells = cells}, 0.2, 1)),
        right_side(random_field<Scalar>(mesh.vertex_count(), 1, 3)),
        displacement(random_field<Scalar>(mesh.vertex_count(), 0.1 / cells[0], 2)) {
    const Field<Scalar> turn = displacement_of(mesh, [&](const Vec3<double>& x) { return Vec3<double>(rotation * x); });
    for (std::size_t v = 0; v < turn.size(); ++v) displacement[v] = rotation.cast<Scalar>() * displacement[v] + turn[v];
    const Material material{.young = young, .poisson = 0.3, .density = 1000};
    const Elasticity<Scalar, Element> law(mesh, material);
    const auto pattern = std::make_shared<const BlockPattern>(BlockPattern::of(mesh.elements(), mesh.vertex_count()));
    detail::ElasticEvaluation<Scalar, Element> state(law);
    SerialExecutor serial;
    law.evaluate(displacement, state, serial);
    matrix = BlockMatrix<Scalar>(pattern);
    const Scalar h = Scalar(1) / 60;
    assemble(law, state, Mass<Scalar>(mesh, material, MassModel::lumped, *pattern), Scalar(1), h * h, matrix, serial);
    if (!pins) return;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.position(v).x() == 0) {
        matrix.isolate(v);
        right_side[at(v)].setZero();
        pinned.push_back(v);
      }
  }

  [[nodiscard]] StepSystem<Scalar> system() const { return {matrix, right_side, displacement, pinned, lag_key}; }
  [[nodiscard]] const Field<Scalar>& rest() const { return mesh.positions(); }

  TetMesh<Scalar, Element> mesh;
  BlockMatrix<Scalar> matrix;
  Field<Scalar> right_side, displacement;
  std::vector<Index> pinned;
  std::uint64_t lag_key = 1;
};

template <class Scalar>
Eigen::MatrixXd dense(const BlockMatrix<Scalar>& a) {
  const BlockPattern& p = a.pattern();
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(3 * a.rows(), 3 * a.rows());
  for (Index i = 0; i < a.rows(); ++i)
    for (Index s = p.row_start[at(i)]; s < p.row_start[at(i) + 1]; ++s)
      d.block<3, 3>(3 * i, 3 * p.column[at(s)]) = as_eigen(a.block(s)).template cast<double>();
  return d;
}

}  // namespace corotet::testing
