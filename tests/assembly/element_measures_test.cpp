#include <corotet/detail/assembly/element_measures.hpp>
#include <corotet/detail/rotation/gram_schmidt.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "support/bodies.hpp"
#include "support/elastic_rig.hpp"
#include "support/random.hpp"

namespace corotet {
namespace {

using testing::Random;
using testing::Rig;

template <class T>
class ElementMeasure : public ::testing::Test {
 protected:
  using S = typename T::Scalar;
  using E = typename T::Element;
  static constexpr double epsilon = std::numeric_limits<S>::epsilon();

  static TetMesh<S, E> mesh() {
    return testing::distorted_block<S, E>({.size = {1, 0.7, 0.5}, .cells = {4, 3, 3}}, 0.2, 3);
  }
  /// Each element its own, some of them nearly incompressible, one auxetic.
  static Materials materials(Index elements) {
    Random random(9);
    std::vector<Material> all;
    for (Index e = 0; e < elements; ++e)
      all.push_back({.young = random.uniform(1e4, 1e5), .poisson = e == 5 ? -0.3 : random.uniform(0.1, 0.49)});
    return all;
  }
  template <class Law>
  static std::vector<ElementMeasures<S>> measure(const Law& law, const Field<S>& u) {
    std::vector<ElementMeasures<S>> out(at(law.element_count()));
    element_measures(law, u, std::span(out));
    return out;
  }
};
TYPED_TEST_SUITE(ElementMeasure, testing::AllCases);

template <class Scalar>
double sum_of_energies(const std::vector<ElementMeasures<Scalar>>& measures) {
  double sum = 0;
  for (const auto& m : measures) sum += double(m.energy_density) * double(m.volume);
  return sum;
}

TYPED_TEST(ElementMeasure, EnergiesSumToThatOfTheBody) {
  using Scalar = typename TypeParam::Scalar;
  const auto check = [&]<class Rotation>(Rotation, VolumetricStrain volumetric_strain) {
    const auto mesh = this->mesh();
    const Rig<Scalar, typename TypeParam::Element, Rotation> rig(mesh, this->materials(mesh.element_count()),
                                                                 volumetric_strain);
    for (const double size : {1e-3, 0.02, 0.2}) {  // the last with inverted elements
      const auto u = testing::random_field<Scalar>(mesh.vertex_count(), size, 5);
      const double energy = rig.law.energy(u);
      EXPECT_NEAR(sum_of_energies(this->measure(rig.law, u)), energy, 1e3 * this->epsilon * energy) << size;
    }
  };
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
    check(Polar(), volumetric_strain);
    check(GramSchmidt(), volumetric_strain);
    check(Identity(), volumetric_strain);
  }
}

// A uniform strain in a body of one material: each element has the same state, known in closed form.
TYPED_TEST(ElementMeasure, AUniformStrainHasTheStressOfTheMaterial) {
  using Scalar = typename TypeParam::Scalar;
  Random random(2);
  const auto mesh = this->mesh();
  const Material material{.young = 3e4, .poisson = 0.42};
  const auto [lambda, mu] = lame(material);
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
    const Rig<Scalar, typename TypeParam::Element> rig(mesh, material, volumetric_strain);
    for (int i = 0; i < 5; ++i) {
      const Mat3<double> r = random.rotation(), a = random.matrix(0.1), e = (a + a.transpose()) / 2;
      const Mat3<double> f = r * (Mat3<double>::Identity() + e), strain = r * e * r.transpose();
      const auto u = testing::displacement_of(mesh, [&](const Vec3<double>& x) { return Vec3<double>(f * x); });
      const Mat3<double> stress = 2 * mu * strain + lambda * strain.trace() * Mat3<double>::Identity();
      const double density = mu * strain.squaredNorm() + lambda / 2 * strain.trace() * strain.trace();
      for (const ElementMeasures<Scalar>& m : this->measure(rig.law, u)) {
        const double tolerance = 500 * this->epsilon;
        EXPECT_LE((m.deformation_gradient.template cast<double>() - f).norm(), tolerance);
        EXPECT_LE((m.rotation.template cast<double>() - r).norm(), tolerance);
        EXPECT_LE((m.strain.template cast<double>() - strain).norm(), tolerance);
        EXPECT_LE((m.stress.template cast<double>() - stress).norm(), tolerance * (lambda + mu));
        EXPECT_NEAR(double(m.energy_density), density, tolerance * (lambda + mu));
        EXPECT_NEAR(double(m.volume_ratio), f.determinant(), tolerance);
        EXPECT_NEAR(double(m.von_mises), von_mises_stress(stress), tolerance * (lambda + mu));
        const Mat3<double> cauchy = stress * r * f.transpose() / f.determinant();
        EXPECT_LE((m.cauchy_stress().template cast<double>() - cauchy).norm(), tolerance * (lambda + mu));
        EXPECT_LE((cauchy - cauchy.transpose()).norm(), 1e-12 * (lambda + mu));
      }
    }
  }
}

TYPED_TEST(ElementMeasure, RigidMotionHasNone) {
  using Scalar = typename TypeParam::Scalar;
  Random random(4);
  const auto mesh = this->mesh();
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
    const Rig<Scalar, typename TypeParam::Element> rig(mesh, Material{.young = 1e4, .poisson = 0.3}, volumetric_strain);
    const Mat3<double> r = random.rotation();
    const auto u = testing::displacement_of(
        mesh, [&](const Vec3<double>& x) { return Vec3<double>(r * x + Vec3<double>(1, -2, 0.5)); });
    for (const ElementMeasures<Scalar>& m : this->measure(rig.law, u)) {
      EXPECT_LE(double(m.strain.norm()), 500 * this->epsilon);
      EXPECT_LE(double(m.stress.norm()), 500 * this->epsilon * 3e4);
      EXPECT_LE(double(m.von_mises), 500 * this->epsilon * 3e4);
      EXPECT_LE(std::fabs(double(m.energy_density)), 500 * this->epsilon * this->epsilon * 500 * 3e4);
      EXPECT_NEAR(double(m.volume_ratio), 1, 500 * this->epsilon);
      EXPECT_LE((m.rotation.template cast<double>() - r).norm(), 500 * this->epsilon);
    }
  }
}

TYPED_TEST(ElementMeasure, VolumesAreThoseOfTheBody) {
  using Scalar = typename TypeParam::Scalar;
  const auto mesh = this->mesh();
  const Rig<Scalar, typename TypeParam::Element> rig(mesh);
  double rest = 0, now = 0;
  for (const ElementMeasures<Scalar>& m : this->measure(
           rig.law, testing::displacement_of(mesh, [](const Vec3<double>& x) { return Vec3<double>(2 * x); }))) {
    rest += double(m.volume);
    now += double(m.volume) * double(m.volume_ratio);
  }
  EXPECT_NEAR(rest, 1 * 0.7 * 0.5, 100 * this->epsilon);
  EXPECT_NEAR(now, 8 * rest, 800 * this->epsilon);
}

TYPED_TEST(ElementMeasure, SameBitsOnAnyExecutor) {
  using Scalar = typename TypeParam::Scalar;
  const auto mesh = testing::block<Scalar, typename TypeParam::Element>({.size = {1, 1, 1}, .cells = {9, 9, 9}});
  const Rig<Scalar, typename TypeParam::Element> rig(mesh, testing::rubber, VolumetricStrain::averaged);
  const auto u = testing::random_field<Scalar>(mesh.vertex_count(), 0.01, 8);
  const auto expected = this->measure(rig.law, u);
  auto backwards = expected;
  std::memset(static_cast<void*>(backwards.data()), 0, backwards.size() * sizeof(backwards[0]));
  element_measures(rig.law, u, std::span(backwards), [](Index count, TaskRef task) {
    for (Index i = count; i-- > 0;) task(i);
  });
  EXPECT_EQ(std::memcmp(expected.data(), backwards.data(), expected.size() * sizeof(expected[0])), 0);
}

/// Finite differences need double.
template <class Element>
class ElementMeasureGradient : public ::testing::Test {};
using Elements = ::testing::Types<Tet4, Tet10>;
TYPED_TEST_SUITE(ElementMeasureGradient, Elements);

// The stress is what the energy of a uniformly strained body changes by: dW = V (s R) : dF, and of the deformed body
// V det F sigma : dF F^-1 with the Cauchy stress.
TYPED_TEST(ElementMeasureGradient, StressIsTheChangeOfEnergy) {
  Random random(7);
  const auto mesh = testing::distorted_block<double, TypeParam>({.size = {1, 0.7, 0.5}, .cells = {2, 2, 2}}, 0.2, 3);
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged})
    for (const double poisson : {-0.2, 0.3, 0.48}) {
      const Rig<double, TypeParam> rig(mesh, Material{.young = 1, .poisson = poisson}, volumetric_strain);
      const auto stretched = [&](const Mat3<double>& f) {
        return testing::displacement_of(mesh, [&](const Vec3<double>& x) { return Vec3<double>(f * x); });
      };
      const Mat3<double> f = random.rotation() * (Mat3<double>::Identity() + random.matrix(0.1));
      std::vector<ElementMeasures<double>> measures(at(mesh.element_count()));
      element_measures(rig.law, stretched(f), std::span(measures));
      for (int k = 0; k < 9; ++k) {
        constexpr double h = 1e-5;
        Mat3<double> df = Mat3<double>::Zero();
        df[k] = 1;
        const double expected =
            (rig.law.energy(stretched(f + h * df)) - rig.law.energy(stretched(f - h * df))) / (2 * h);
        double first = 0, cauchy = 0;
        for (const auto& m : measures) {
          first += m.volume * (m.stress * m.rotation).dot(df);
          cauchy += m.volume * m.volume_ratio * m.cauchy_stress().dot(df * f.inverse());
        }
        EXPECT_NEAR(first, expected, 1e-9);
        EXPECT_NEAR(cauchy, expected, 1e-9);
      }
    }
}

}  // namespace
}  // namespace corotet
