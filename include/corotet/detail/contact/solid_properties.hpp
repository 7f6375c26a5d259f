// Volume, centroid and moments of inertia of a closed surface.
#pragma once

#include <cmath>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/box.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/rotation/polar_robust.hpp>

namespace corotet::inline v0_1 {

/// Mass properties of a uniform solid.
struct SolidProperties {
  double volume = 0;                             ///< m^3
  Vec3<double> centroid = Vec3<double>::Zero();  ///< m
  Vec3<double> inertia = Vec3<double>::Zero();   ///< principal moments about the centroid, of 1 kg, m^2
  Mat3<double> axes = Mat3<double>::Identity();  ///< columns: the principal axes, right-handed, as the moments
};

/// Of what a closed surface of either winding encloses: integrals over signed tetrahedra, exact for the polyhedron
/// (Tonon 2004, "Explicit exact formulas for the 3-D tetrahedron inertia tensor"). All zero, with the identity, where
/// that is nothing. Indices must be in range, positions finite.
[[nodiscard]] COROTET_COLD inline SolidProperties solid_properties(const SurfaceMesh& surface) {
  SolidProperties out;
  Box box;
  for (const auto& triangle : surface.triangles)
    for (const Index v : triangle) box.add(surface.positions[at(v)]);
  if (surface.triangles.empty()) return out;
  // About the middle of the box, in units of its longest edge: no digits are lost.
  const Vec3<double> middle = box.low + 0.5 * (box.high - box.low);
  const double unit = (box.high - box.low).maxCoeff();
  if (!(unit > 0)) return out;
  double volume = 0;
  Vec3<double> first = Vec3<double>::Zero();   // integral of x
  Mat3<double> second = Mat3<double>::Zero();  // integral of x x^T
  for (const auto& triangle : surface.triangles) {
    Mat3<double> x;
    for (int i = 0; i < 3; ++i) x.set_col(i, (surface.positions[at(triangle[at(i)])] - middle) / unit);
    const double part = x.determinant() / 6;
    const Vec3<double> sum = x.col(0) + x.col(1) + x.col(2);
    volume += part;
    first += part / 4 * sum;
    second += part / 20 * (x * x.transpose() + sum * sum.transpose());
  }
  if (!(std::fabs(volume) > 0)) return out;
  const Vec3<double> centroid = first / volume;
  Matrix<double, 4, 4> spread = Matrix<double, 4, 4>::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) spread(i, j) = second(i, j) / volume - centroid[i] * centroid[j];
  const Matrix<double, 4, 4> vectors = detail::diagonalise(spread);
  const double trace = spread(0, 0) + spread(1, 1) + spread(2, 2);
  for (int k = 0; k < 3; ++k) {
    out.inertia[k] = unit * unit * (trace - spread(k, k));
    out.axes.set_col(k, {vectors(0, k), vectors(1, k), vectors(2, k)});
  }
  out.volume = std::fabs(volume) * unit * unit * unit;
  out.centroid = middle + unit * centroid;
  return out;
}

}  // namespace corotet::inline v0_1
