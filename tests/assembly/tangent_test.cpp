// Tangents of the elastic force: what each adds to the warped stiffness, against differences of the force.
#include <corotet/detail/assembly/twist_modes.hpp>
#include <corotet/detail/core/eigen.hpp>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "support/bodies.hpp"
#include "support/derivatives.hpp"
#include "support/elastic_rig.hpp"
#include "support/matrices.hpp"

namespace corotet::tangent_test {
namespace {

using testing::Random;
using testing::rubber;

/// An element in some state, for tests of its tangent.
template <class Element>
struct OneElement {
  static constexpr int dofs = 3 * Element::nodes;
  using Matrix = Eigen::Matrix<double, dofs, dofs>;
  using Rigged = testing::Rig<double, Element>;

  TetMesh<double, Element> mesh;
  Field<double> u;

  /// F is about `stretch`, turned, and not the same everywhere in a Tet10, whose edges are curved.
  OneElement(const Mat3<double>& stretch, double variation, unsigned seed) : mesh(make(seed)) {
    Random random(seed);
    const Mat3<double> affine = random.rotation() * stretch;
    u = testing::displacement_of(mesh, [&](const Vec3<double>& x) { return affine * x; });
    if (Element::order == 2) flat(u) += flat(testing::random_field<double>(10, variation, seed));
  }

  static TetMesh<double, Element> make(unsigned seed) {
    MeshData data;
    data.positions = {{0, 0, 0}, {1, 0.1, 0}, {0.2, 0.9, 0.1}, {0.1, 0.2, 1.1}};
    data.connectivity = {0, 1, 2, 3};
    if (Element::order == 2) {
      Random random(seed + 100);
      data = raise_order(data);
      for (std::size_t v = 4; v < 10; ++v) data.positions[v] += random.vector(0.02);
    }
    return testing::must(TetMesh<double, Element>::create(data));
  }

  /// By differences of the force.
  [[nodiscard]] Matrix hessian() const {
    Rigged rig(mesh);
    return testing::difference_hessian(rig, u);
  }

  /// As the library assembles it.
  [[nodiscard]] Matrix tangent(Tangent kind, bool project = false) const {
    Rigged rig(mesh, rubber, VolumetricStrain::pointwise, kind);
    rig.state.twist.project(project);
    return rig.dense_stiffness(u);
  }

  /// The sum over quadrature points of V f(e_ij) (mode)(mode)^T, with e_ij = 2 mu + 2 (lambda (tr S - 3) - 2 mu)/
  /// (s_i + s_j) from the SVD of F; modes act on dF along U [axis] V^T / sqrt 2.
  template <class Function>
  [[nodiscard]] Matrix twist(Function&& function) const {
    const auto [lambda, mu] = lame(rubber);
    const Rigged rig(mesh);
    Matrix sum = Matrix::Zero();
    for (std::size_t q = 0; q < Element::stiffness_points.size(); ++q) {
      const testing::PrincipalPoint point(rig, 0, q, u);
      const double pressure = lambda * (point.s.sum() - 3);
      sum += point.twist([&](double s) { return function(2 * mu + 2 * (pressure - 2 * mu) / s); });
    }
    return sum;
  }
};

/// The warped stiffness is the Hessian of W without the twist modes; the library's twist modes are the rest of it.
template <class Element>
void expect_tangents_of_the_hessian(const Mat3<double>& stretch, unsigned seed) {
  const double mu = lame(rubber).mu;
  const OneElement<Element> element(stretch, 0.02, seed);
  const auto warped = element.tangent(Tangent::warped), hessian = element.hessian();
  const auto twist = element.twist([](double e) { return e; });
  ASSERT_LT((hessian - warped - twist).norm(), 1e-6 * hessian.norm());
  ASSERT_GT(twist.norm(), 1e-3 * hessian.norm()) << "the modes that are left out must matter here";

  const double tolerance = 1e-9 * hessian.norm();
  EXPECT_LT((element.tangent(Tangent::consistent) - warped - twist).norm(), tolerance);
  const auto positive = element.twist([](double e) { return std::max(e, 0.0); });
  EXPECT_LT((element.tangent(Tangent::consistent, true) - warped - positive).norm(), tolerance);
  const auto excess = element.twist([mu](double e) { return std::max(e - mu / 2, 0.0); });
  EXPECT_LT((element.tangent(Tangent::stabilized) - warped - excess).norm(), tolerance);
}

TEST(Tangents, AreTheHessianAndWhatTheyLeaveOutIsKnown) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    for (const double size : {0.8, 1.0, 1.5, 3.0}) {  // squeezed, strained, stretched so that all modes are stiff
      const Mat3<double> stretch = size * Mat3<double>::Identity() + random.matrix(0.15);
      expect_tangents_of_the_hessian<Tet4>(stretch, seed);
      expect_tangents_of_the_hessian<Tet10>(stretch, seed);
    }
  }
}

/// Something is computed where a mode exceeds what stretch_stable leaves, and only there.
class StretchStable : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Left, StretchStable, ::testing::Values(0.5, 0.4));
TEST_P(StretchStable, IsActiveWhereItMustBe) {
  const auto is_active = [](const Vec3<double>& s) {
    const OneElement<Tet4> element(testing::diagonal(s), 0, 1);
    testing::Rig<double, Tet4> rig(element.mesh, rubber, VolumetricStrain::pointwise, Tangent::stabilized);
    rig.state.twist.set_cap(GetParam());
    rig.law.evaluate(element.u, rig.state, rig.serial);
    return rig.state.twist.active_share() > 0;
  };
  const auto [lambda, mu] = lame(rubber);
  Random random(3);
  int active = 0, needless = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3<double> s = Vec3<double>::Ones() + random.vector(0.3);
    if (s.minCoeff() < 0.05) continue;
    double stiffest = 0;
    for (int i = 0; i < 3; ++i)
      stiffest = std::max(stiffest, 2 * mu + 2 * (lambda * (s.sum() - 3) - 2 * mu) / (s.sum() - s[i]));
    if (stiffest > GetParam() * mu) {
      ++active;
      EXPECT_TRUE(is_active(s)) << as_eigen(s).transpose();
    } else {
      needless += is_active(s) ? 1 : 0;
    }
  }
  EXPECT_GT(active, 200);
  EXPECT_EQ(needless, 0);
  EXPECT_FALSE(is_active({1 + 0.4 * GetParam(), 1 - 0.14 * GetParam(), 1 - 0.14 * GetParam()}));  // a bar pulled
}

/// Whatever the element is squeezed or turned inside out to, tangents are finite, and semi-definite where they claim
/// it.
TEST(Tangents, AreFiniteForDegenerateElements) {
  for (const Vec3<double>& s : {Vec3<double>(1, 1, 0), Vec3<double>(1, 0, 0), Vec3<double>(0, 0, 0),
                                Vec3<double>(1, 1, -1), Vec3<double>(2, 1, -1), Vec3<double>(5, 0.1, -0.1),
                                Vec3<double>(1e-9, 1e-9, -1e-9), Vec3<double>(100, 100, 100)}) {
    const OneElement<Tet4> element(testing::diagonal(s), 0, 2);
    for (const Tangent kind : {Tangent::stabilized, Tangent::consistent}) {
      const auto k = element.tangent(kind, true);
      ASSERT_TRUE(k.allFinite()) << as_eigen(s).transpose();
      EXPECT_EQ((k - k.transpose()).norm(), 0);
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues()[0],
                -1e-12 * k.norm());
      EXPECT_TRUE(element.tangent(kind).allFinite());
    }
  }
}

/// A few elements with mean dilatation or without: exact is the derivative of the force.
template <class Element>
void expect_exact_is_the_hessian(VolumetricStrain volumetric_strain, unsigned seed) {
  const auto mesh = testing::distorted_block<double, Element>({.size = {1, 0.7, 0.5}, .cells = {1, 1, 1}}, 0.2, seed);
  const Mat3<double> affine = Random(seed).rotation() * testing::diagonal({1.2, 0.9, 1.1});
  Field<double> u = testing::displacement_of(mesh, [&](const Vec3<double>& x) { return affine * x; });
  flat(u) += flat(testing::random_field<double>(mesh.vertex_count(), 0.02, seed));
  testing::Rig<double, Element> rig(mesh, rubber, volumetric_strain, Tangent::consistent);
  const Eigen::MatrixXd hessian = testing::difference_hessian(rig, u);
  EXPECT_LT((rig.dense_stiffness(u) - hessian).norm(), 1e-6 * hessian.norm());
}

TEST(Tangents, ExactIsTheHessianWithMeanDilatationToo) {
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
    expect_exact_is_the_hessian<Tet4>(volumetric_strain, 1);
    expect_exact_is_the_hessian<Tet10>(volumetric_strain, 2);
  }
}

}  // namespace
}  // namespace corotet::tangent_test
