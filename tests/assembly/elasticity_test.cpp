// The laws of the elastic law: force from energy, tangent from force, rotations, affine states, the warped stiffness.
#include <corotet/detail/assembly/elasticity.hpp>
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/rotation/gram_schmidt.hpp>
#include <corotet/detail/rotation/identity.hpp>
#include <corotet/detail/rotation/per_element.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <utility>

#include "support/bodies.hpp"
#include "support/derivatives.hpp"
#include "support/elastic_rig.hpp"

namespace corotet::elasticity_test {
namespace {

using testing::block;
using testing::distorted_block;
using testing::Random;
using testing::Rig;
using testing::rubber;

constexpr std::array both_dilatations{VolumetricStrain::pointwise, VolumetricStrain::averaged};

const BlockOptions small_box{.size = {1, 0.7, 0.5}, .cells = {3, 2, 2}};

/// A material for each element, with Poisson's ratios from -0.2 to 0.45.
std::vector<Material> mixed_materials(Index elements) {
  std::vector<Material> materials(at(elements), rubber);
  for (std::size_t e = 0; e < materials.size(); ++e) {
    materials[e].poisson = -0.2 + 0.05 * double(e % 14);
    materials[e].young *= 1 + double(e % 5);
  }
  return materials;
}

double min_eigenvalue(const Eigen::MatrixXd& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

/// f . d against the central difference of W along random directions d.
template <class Element, class Rotation>
double force_error(double deformation, unsigned seed,
                   VolumetricStrain volumetric_strain = VolumetricStrain::pointwise) {
  const auto mesh = distorted_block<double, Element>(small_box, 0.2, seed);
  Rig<double, Element, Rotation> rig(mesh, mixed_materials(mesh.element_count()), volumetric_strain);
  const Field<double> u = testing::random_field<double>(rig.mesh.vertex_count(), deformation, seed);
  const Field<double> f = rig.force(u);
  const double h = 1e-6;
  double worst = 0;
  for (unsigned trial = 0; trial < 20; ++trial) {
    Field<double> d = testing::random_field<double>(rig.mesh.vertex_count(), 1, 100 + trial);
    Field<double> forward = u, backward = u;
    flat(forward) += h * flat(d);
    flat(backward) -= h * flat(d);
    const double difference = (rig.law.energy(forward) - rig.law.energy(backward)) / (2 * h);
    const double scale = flat(f).norm() * flat(d).norm() / std::sqrt(3.0 * rig.mesh.vertex_count());
    worst = std::max(worst, std::abs(flat(f).dot(flat(d)) + difference) / scale);
  }
  return worst;
}

TEST(ElasticForce, IsMinusTheGradientOfTheEnergy) {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const double deformation : {1e-3, 0.03}) {
      EXPECT_LT((force_error<Tet4, Polar>(deformation, seed)), 1e-6);
      EXPECT_LT((force_error<Tet10, Polar>(deformation, seed)), 1e-6);
      EXPECT_LT((force_error<Tet4, Polar>(deformation, seed, VolumetricStrain::averaged)), 1e-6);
      EXPECT_LT((force_error<Tet10, Polar>(deformation, seed, VolumetricStrain::averaged)), 1e-6);
      EXPECT_LT((force_error<Tet4, PerElement<Polar>>(deformation, seed)), 1e-6);
      EXPECT_LT((force_error<Tet4, Identity>(deformation, seed)), 1e-6);
      EXPECT_LT((force_error<Tet10, Identity>(deformation, seed, VolumetricStrain::averaged)), 1e-6);
    }
}

/// What an evaluation sums up of it on the way is the same.
TEST(ElasticEvaluation, SumsTheEnergyAndFindsTheLargestStress) {
  const auto compare = []<class Element>(Element, VolumetricStrain volumetric_strain) {
    const auto mesh = distorted_block<double, Element>(small_box, 0.2, 3);
    Rig<double, Element> rig(mesh, mixed_materials(mesh.element_count()), volumetric_strain);
    const Field<double> u = testing::random_field<double>(rig.mesh.vertex_count(), 0.03, 3);
    (void)rig.force(u);
    EXPECT_NEAR(rig.state.summary().energy, rig.law.energy(u), 1e-12 * rig.law.energy(u));
    // Of a stretch by 1.2 along x: e = diag(0.2, 0, 0), so stress / mu = 0.4 along x and (lambda / mu) 0.2 all round.
    Rig<double, Element> even(mesh, rubber, volumetric_strain);
    (void)even.force(
        testing::displacement_of(mesh, [](const Vec3<double>& x) { return Vec3<double>(1.2 * x.x(), x.y(), x.z()); }));
    const auto [lambda, mu] = lame(rubber);
    const double p = 0.2 * lambda / mu;
    EXPECT_NEAR(even.state.summary().max_stress2, (0.4 + p) * (0.4 + p) + 2 * p * p, 1e-10);
  };
  for (const VolumetricStrain volumetric_strain : both_dilatations) {
    compare(Tet4{}, volumetric_strain);
    compare(Tet10{}, volumetric_strain);
  }
}

/// Any executor, any order of the tasks: the same bits. The body has more tasks than one.
TEST(ElasticEnergy, IsTheSameBitsWithAnyExecutor) {
  const auto backwards = [](Index count, auto&& task) {
    for (Index i = count; i > 0; --i) task(i - 1);
  };
  const auto compare = [&]<class Element>(Element, VolumetricStrain volumetric_strain) {
    const auto mesh = distorted_block<float, Element>({.size = {4, 1, 1}, .cells = {24, 4, 4}}, 0.2, 3);
    Rig<float, Element> rig(mesh, mixed_materials(mesh.element_count()), volumetric_strain);
    const Field<float> u = testing::random_field<float>(rig.mesh.vertex_count(), 0.02, 3);
    std::vector<double> scratch(rig.law.mean_dilatation().scratch_size());
    const double alone = rig.law.energy(u);
    EXPECT_EQ(rig.law.energy(u, scratch), alone);
    EXPECT_EQ(rig.law.energy(u, scratch, backwards), alone);
    (void)rig.force(u);  // which sums the same in its own order
    EXPECT_NEAR(rig.state.summary().energy, alone, 1e-5 * alone);
  };
  for (const VolumetricStrain volumetric_strain : both_dilatations) {
    compare(Tet4{}, volumetric_strain);
    compare(Tet10{}, volumetric_strain);
  }
}

/// Not so for Gram-Schmidt, nor for one rotation in a Tet10 with varying strain: the documented defects are real.
TEST(ElasticForce, IsNotConservativeForGramSchmidtAndOneRotationATet10) {
  EXPECT_GT((force_error<Tet4, GramSchmidt>(0.03, 1)), 1e-3);
  EXPECT_GT((force_error<Tet10, PerElement<Polar>>(0.03, 1)), 1e-5);
}

/// The Hessian of W by differences of the exact force, against the warped stiffness plus the twist modes that it leaves
/// out at each quadrature point. The modes and their stiffness e_ij = 2 mu + 2 (p - 2 mu) / (s_i + s_j), with
/// p = lambda (tr S - 3) or what mean dilatation makes of it, come from the SVD of F; they act on dF along
/// U [axis] V^T / sqrt 2.
template <class Element>
void expect_warped_stiffness_is_the_hessian_without_twist(const MeshData& data, VolumetricStrain volumetric_strain,
                                                          unsigned seed) {
  Random random(seed);
  const auto [lambda, mu] = lame(rubber);
  Rig<double, Element> rig(testing::must(TetMesh<double, Element>::create(data)), rubber, volumetric_strain);
  const Index vertices = rig.mesh.vertex_count();
  const Mat3<double> affine = random.rotation() * (Mat3<double>::Identity() + random.matrix(0.15));
  Field<double> u = testing::displacement_of(rig.mesh, [&](const Vec3<double>& x) { return affine * x; });
  if (vertices > 4) flat(u) += flat(testing::random_field<double>(vertices, 0.02, seed));

  const Eigen::MatrixXd hessian = testing::difference_hessian(rig, u), warped = rig.dense_stiffness(u);
  Eigen::MatrixXd twist = Eigen::MatrixXd::Zero(3 * vertices, 3 * vertices);
  for (Index e = 0; e < rig.mesh.element_count(); ++e)
    for (std::size_t q = 0; q < Element::stiffness_points.size(); ++q) {
      const testing::PrincipalPoint point(rig, e, q, u);
      ASSERT_GT(point.f.determinant(), 0);
      const double pressure = mu * rig.state.volumetric_stress(q, e);
      if (volumetric_strain == VolumetricStrain::pointwise) {
        EXPECT_NEAR(pressure, lambda * (point.s.sum() - 3), 1e-9 * mu);
      }
      twist += point.twist([&](double sum) { return 2 * mu + 2 * (pressure - 2 * mu) / sum; });
    }
  ASSERT_LT((hessian - warped - twist).norm(), 1e-6 * hessian.norm());
  ASSERT_GT(twist.norm(), 1e-3 * hessian.norm()) << "the modes that are left out must matter here";
}

TEST(WarpedStiffness, IsTheHessianWithoutTheTwistModes) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    MeshData data;
    data.positions = {{0, 0, 0}, {1, 0.1, 0}, {0.2, 0.9, 0.1}, {0.1, 0.2, 1.1}};
    data.connectivity = {0, 1, 2, 3};
    MeshData curved = raise_order(data);
    for (std::size_t v = 4; v < 10; ++v) curved.positions[v] += random.vector(0.02);
    const MeshData two_patches =
        distorted_block<double, Tet4>({.size = {2, 1, 1}, .cells = {2, 1, 1}}, 0.2, seed).data();
    for (const VolumetricStrain volumetric_strain : both_dilatations) {
      expect_warped_stiffness_is_the_hessian_without_twist<Tet4>(data, volumetric_strain, seed);
      expect_warped_stiffness_is_the_hessian_without_twist<Tet4>(two_patches, volumetric_strain, seed);
      expect_warped_stiffness_is_the_hessian_without_twist<Tet10>(curved, volumetric_strain, seed);
    }
  }
}

template <class T>
class ElasticLaw : public ::testing::Test {};
TYPED_TEST_SUITE(ElasticLaw, testing::AllCases);

/// Rounding in F, times the stiffness: what a force of zero may differ by.
template <class Mesh>
double rounding_force(const Mesh& mesh, double size) {
  using Scalar = typename Mesh::scalar_type;
  double area = 0;
  for (const auto& x : mesh.positions()) area = std::max(area, double(x.squaredNorm()));
  return 200 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) * rubber.young * area * size;
}

TYPED_TEST(ElasticLaw, RigidMotionGivesNoForceAndNoEnergy) {
  using Scalar = typename TypeParam::Scalar;
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    Rig<Scalar, typename TypeParam::Element> rig(
        distorted_block<Scalar, typename TypeParam::Element>(small_box, 0.2, 3), rubber,
        both_dilatations[at(trial % 2)]);
    const Mat3<double> q = random.rotation();
    const Vec3<double> shift = random.vector();
    const auto u = testing::displacement_of(rig.mesh, [&](const Vec3<double>& x) { return q * x + shift; });
    double largest = 0;
    for (const auto& f : rig.force(u)) largest = std::max(largest, double(f.norm()));
    EXPECT_LT(largest, rounding_force(rig.mesh, 1 + shift.norm()));
    EXPECT_LT(rig.law.energy(u), rounding_force(rig.mesh, 1 + shift.norm()));
    EXPECT_NEAR(rig.state.summary().max_rotation(), Eigen::AngleAxisd(as_eigen(q)).angle(), 2e-3);
  }
}

/// Uniaxial tension with free sides, exact for this model at any strain: P = E (s - 1) along the axis, nothing across
/// it.
TYPED_TEST(ElasticLaw, UniaxialStressIsYoungTimesStretch) {
  using Scalar = typename TypeParam::Scalar;
  const BlockOptions options{.size = {2, 1, 0.5}, .cells = {2, 2, 1}};
  Random random(6);
  for (const double s : {0.6, 0.95, 1.001, 1.3, 2.0})
    for (const VolumetricStrain volumetric_strain : both_dilatations) {
      Rig<Scalar, typename TypeParam::Element> rig(block<Scalar, typename TypeParam::Element>(options), rubber,
                                                   volumetric_strain);
      const double side = 1 - rubber.poisson * (s - 1);
      const Mat3<double> q = random.rotation();
      const auto u = testing::displacement_of(
          rig.mesh, [&](const Vec3<double>& x) { return q * x.cwiseProduct(Vec3<double>(s, side, side)); });
      const Field<Scalar> force = rig.force(u);
      Vec3<double> pull = Vec3<double>::Zero();
      double sideways = 0;
      for (Index v = 0; v < rig.mesh.vertex_count(); ++v) {
        const Vec3<double> f = q.transpose() * force[at(v)].template cast<double>();
        if (rig.mesh.position(v).x() == 2) pull -= f;
        sideways = std::max({sideways, std::abs(f.y()), std::abs(f.z())});
      }
      const double area = 0.5, expected = rubber.young * (s - 1) * area;
      const double tolerance = rounding_force(rig.mesh, 1);
      EXPECT_NEAR(pull.x(), expected, tolerance);
      EXPECT_LT(sideways, tolerance);
      EXPECT_NEAR(rig.law.energy(u), 0.5 * rubber.young * (s - 1) * (s - 1), tolerance);
    }
}

/// Internal forces are in balance: no net force, and with Polar at the points no net torque about anything.
TYPED_TEST(ElasticLaw, ForcesAndTorquesBalance) {
  using Scalar = typename TypeParam::Scalar;
  for (const VolumetricStrain volumetric_strain : both_dilatations) {
    Rig<Scalar, typename TypeParam::Element> rig(
        distorted_block<Scalar, typename TypeParam::Element>(small_box, 0.2, 8), rubber, volumetric_strain);
    const auto u = testing::random_field<Scalar>(rig.mesh.vertex_count(), 0.05, 9);
    const Field<Scalar> force = rig.force(u);
    Vec3<double> net = Vec3<double>::Zero(), torque = net;
    double scale = 0;
    for (Index v = 0; v < rig.mesh.vertex_count(); ++v) {
      const Vec3<double> f = force[at(v)].template cast<double>();
      const Vec3<double> x = (rig.mesh.position(v) + u[at(v)]).template cast<double>();
      net += f;
      torque += x.cross(f);
      scale += f.norm();
    }
    const double tolerance = 20 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) * scale;
    EXPECT_LT(net.norm(), tolerance);
    EXPECT_LT(torque.norm(), tolerance);
  }
}

TYPED_TEST(ElasticLaw, StiffnessIsSymmetricSemiDefiniteAndBlindToTranslation) {
  using Scalar = typename TypeParam::Scalar;
  for (const VolumetricStrain volumetric_strain : both_dilatations) {
    Rig<Scalar, typename TypeParam::Element> rig(
        distorted_block<Scalar, typename TypeParam::Element>({.size = {1, 1, 1}, .cells = {2, 1, 1}}, 0.2, 8), rubber,
        volumetric_strain);
    const auto u = testing::random_field<Scalar>(rig.mesh.vertex_count(), 0.1, 10);
    const Index n = rig.mesh.vertex_count();
    const Eigen::MatrixXd dense = rig.dense_stiffness(u);
    EXPECT_EQ((dense - dense.transpose()).norm(), 0);
    const double tolerance = 50 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) * dense.norm();
    EXPECT_GT(min_eigenvalue(dense), -tolerance);
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::VectorXd shift = Eigen::VectorXd::Zero(3 * n);
      for (Index v = 0; v < n; ++v) shift[3 * v + axis] = 1;
      EXPECT_LT((dense * shift).norm(), tolerance);
    }
  }
}

/// A mean softens, and never below what is left without lambda: K(lambda = 0) <= K(mean) <= K(per element), as
/// quadratic forms. So there are no modes but rigid ones that cost nothing. (Of materials with the same mu.)
TYPED_TEST(ElasticLaw, MeanDilatationLiesBetweenNoneAndThatOfEachElement) {
  using Scalar = typename TypeParam::Scalar;
  const auto mesh =
      distorted_block<Scalar, typename TypeParam::Element>({.size = {1, 1, 1}, .cells = {2, 2, 2}}, 0.2, 8);
  const Material jelly{.young = 3e4 * 2.998 / 2.7, .poisson = 0.499}, cork{.young = 3e4 * 2 / 2.7, .poisson = 0};
  const Field<Scalar> rest(at(mesh.vertex_count()), Vec3<Scalar>::Zero());
  const auto stiffness = [&](const Material& material, VolumetricStrain volumetric_strain) {
    return Rig<Scalar, typename TypeParam::Element>(mesh, material, volumetric_strain).dense_stiffness(rest);
  };
  const Eigen::MatrixXd none = stiffness(cork, VolumetricStrain::pointwise),
                        mean = stiffness(jelly, VolumetricStrain::averaged),
                        own = stiffness(jelly, VolumetricStrain::pointwise);
  const double tolerance = 50 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) * own.norm();
  EXPECT_GT(min_eigenvalue(mean - none), -tolerance);
  EXPECT_GT(min_eigenvalue(own - mean), -tolerance);
  EXPECT_LT(mean.norm(), 0.8 * own.norm());
  EXPECT_GT(mean.norm(), 2 * none.norm());
}

/// Where the strain is uniform, so is its mean: any patches, any materials.
TYPED_TEST(ElasticLaw, UniformStrainIsTheSameWithMeanDilatation) {
  using Scalar = typename TypeParam::Scalar;
  const auto mesh = distorted_block<Scalar, typename TypeParam::Element>(small_box, 0.2, 8);
  const auto u = testing::displacement_of(mesh, [](const Vec3<double>& x) {
    return Vec3<double>(1.1 * x.x() + 0.1 * x.y(), 0.9 * x.y() + 0.2 * x.z(), 1.05 * x.z());
  });
  for (const Materials& materials : {Materials(rubber), Materials(mixed_materials(mesh.element_count()))}) {
    Rig<Scalar, typename TypeParam::Element> own(mesh, materials), mean(mesh, materials, VolumetricStrain::averaged);
    const Field<Scalar> expected = own.force(u), force = mean.force(u);
    const double tolerance = 50 * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
    EXPECT_LT((flat(force) - flat(expected)).norm(), tolerance * flat(expected).norm());
    EXPECT_NEAR(mean.law.energy(u), own.law.energy(u), tolerance * own.law.energy(u));
  }
}

/// Different materials in one body: each element answers with its own.
TYPED_TEST(ElasticLaw, EnergyIsTheSumOverElementsOfTheirOwnMaterial) {
  using Scalar = typename TypeParam::Scalar;
  const auto mesh = block<Scalar, typename TypeParam::Element>({.size = {1, 1, 1}, .cells = {2, 2, 2}});
  std::vector<Material> materials(at(mesh.element_count()), rubber);
  for (std::size_t e = 0; e < materials.size(); e += 2) materials[e].young *= 10;
  const Materials uniform(rubber), mixed(materials);
  Rig<Scalar, typename TypeParam::Element> one(mesh, uniform), ten(mesh, mixed);
  const auto stretch =
      testing::displacement_of(mesh, [](const Vec3<double>& x) { return x.cwiseProduct(Vec3<double>(1.1, 1.0, 1.0)); });
  double odd = 0, even = 0;
  for (Index e = 0; e < mesh.element_count(); ++e)
    (e % 2 == 0 ? even : odd) += detail::corner_volume(mesh.data().positions, mesh.element(e).data());
  const double density = one.law.energy(stretch);  // of a body of volume 1
  EXPECT_NEAR(ten.law.energy(stretch), density * (odd + 10 * even), 1e-4 * density * 10);
}

/// The assembled matrix is the sum of the elements' own blocks, with one Lamé ratio in the body and with several.
TYPED_TEST(ElasticLaw, TheMatrixIsTheSumOverElements) {
  using Scalar = typename TypeParam::Scalar;
  const auto mesh = distorted_block<Scalar, typename TypeParam::Element>(small_box, 0.2, 4);
  std::vector<Material> materials(at(mesh.element_count()), rubber);
  for (std::size_t e = 0; e < materials.size(); ++e) materials[e].poisson = 0.01 * double(e % 40);
  for (const bool several : {false, true}) {
    Rig<Scalar, typename TypeParam::Element> rig(mesh, several ? Materials(materials) : Materials(rubber));
    EXPECT_EQ(rig.law.common_lame_ratio().has_value(), !several);
    const auto u = testing::random_field<Scalar>(mesh.vertex_count(), 0.05, 8);
    testing::expect_sum_over_elements(rig, u);
  }
}

}  // namespace
}  // namespace corotet::elasticity_test
