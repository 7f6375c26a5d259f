// The laws of ElasticModel: stress from energy, tangent from stress, frames, semi-definite parts, states.
#include <corotet/detail/assembly/elasticity.hpp>
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/material/corotated.hpp>
#include <corotet/detail/material/principal_tangent.hpp>
#include <corotet/detail/material/stable_neo_hookean.hpp>
#include <corotet/detail/rotation/gram_schmidt.hpp>
#include <corotet/detail/rotation/identity.hpp>
#include <corotet/detail/rotation/per_element.hpp>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "support/bodies.hpp"
#include "support/derivatives.hpp"
#include "support/elastic_rig.hpp"
#include "support/matrices.hpp"
#include "support/softening_model.hpp"

namespace corotet::elastic_model_test {
namespace {

using testing::must;
using testing::Random;
using testing::Rig;
using testing::rubber;
using testing::Softening;

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// A model at one deformation gradient, the same in all lanes.
template <class Model, class Scalar = double>
struct Point {
  Mat3Lanes<Scalar> f, r;
  typename Model::template Constants<Scalar> constants;
  typename Model::template State<Scalar> committed{};

  explicit Point(const Mat3<double>& gradient, const Material& material = rubber) {
    for (int l = 0; l < lane_count<Scalar>; ++l) {
      f.set_lane(l, gradient.template cast<Scalar>());
      constants.set(l, material);
    }
    detail::extract_from_gradient<typename Model::Rotation>(f, r);
  }

  [[nodiscard]] double energy() const {
    return static_cast<double>(Model::energy(constants, DeformationLanes<Scalar>{f, r}, committed)[lane]);
  }
  [[nodiscard]] Mat3<double> stress() const {
    Mat3Lanes<Scalar> p;
    typename Model::template State<Scalar> trial{};
    Model::stress(constants, DeformationLanes<Scalar>{f, r}, committed, trial, p);
    return p.lane(lane).template cast<double>();
  }
  [[nodiscard]] Matrix9 tangent(bool semi_definite = false) const {
    Tangent c;
    Model::tangent(constants, DeformationLanes<Scalar>{f, r}, committed, semi_definite, c);
    return flat(c);
  }

  using Tangent = TangentLanes<Scalar>;
  [[nodiscard]] static Matrix9 flat(const Tangent& c) {
    Matrix9 m;
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t l = 0; l < 3; ++l)
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t k = 0; k < 3; ++k)
            m(Eigen::Index(3 * j + i), Eigen::Index(3 * l + k)) = static_cast<double>(c.entry(i, j, k, l)[lane]);
    return m;
  }

  static constexpr int lane = 3;
};

Vector9 flat_of(const Mat3<double>& m) { return Eigen::Map<const Vector9>(m.data()); }

/// Central difference of a function of F along each entry.
template <class Function>
auto difference(const Mat3<double>& f, int entry, Function&& function) {
  constexpr double h = 1e-6;
  Mat3<double> forward = f, backward = f;
  forward(entry % 3, entry / 3) += h;
  backward(entry % 3, entry / 3) -= h;
  return (function(forward) - function(backward)) / (2 * h);
}

/// Stretched, squeezed, nearly flat, mirrored, far from rest, each turned.
std::vector<Mat3<double>> deformations(unsigned seed) {
  Random random(seed);
  std::vector<Mat3<double>> all;
  for (const Vec3<double>& s : {Vec3<double>(1, 1, 1), Vec3<double>(1.5, 0.8, 1.1), Vec3<double>(0.3, 0.4, 0.6),
                                Vec3<double>(1.1, 0.9, 0.05), Vec3<double>(1.2, 0.9, -0.4), Vec3<double>(4, 3, 2)})
    all.push_back(random.rotation() * (testing::diagonal(s) + random.matrix(0.02)) * random.rotation());
  return all;
}

template <class Model>
class ModelLaw : public ::testing::Test {};
using Models = ::testing::Types<Corotated<Polar>, Corotated<Identity>, StableNeoHookean>;
TYPED_TEST_SUITE(ModelLaw, Models);

TYPED_TEST(ModelLaw, StressIsTheDerivativeOfTheEnergyAndTheTangentThatOfTheStress) {
  const double mu = lame(rubber).mu;
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const Mat3<double>& f : deformations(seed)) {
      const Point<TypeParam> point(f);
      const Mat3<double> stress = point.stress();
      const Matrix9 tangent = point.tangent();
      const double size = mu * (1 + f.squaredNorm() * f.norm());
      EXPECT_LT((tangent - tangent.transpose()).norm(), 1e-14 * tangent.norm());
      for (int entry = 0; entry < 9; ++entry) {
        const double slope = difference(f, entry, [](const Mat3<double>& at) { return Point<TypeParam>(at).energy(); });
        EXPECT_NEAR(stress(entry % 3, entry / 3), slope, 1e-8 * size);
        const Mat3<double> change =
            difference(f, entry, [](const Mat3<double>& at) -> Mat3<double> { return Point<TypeParam>(at).stress(); });
        EXPECT_LT((tangent.col(entry) - flat_of(change)).norm(), 1e-7 * tangent.norm()) << as_eigen(f);
      }
    }
}

/// Float computes what double does, to its rounding.
TYPED_TEST(ModelLaw, FloatAgreesWithDouble) {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const Mat3<double>& exact : deformations(seed)) {
      const Mat3<double> f = exact.cast<float>().cast<double>();
      const Point<TypeParam, double> d(f);
      const Point<TypeParam, float> s(f);
      EXPECT_LT((s.stress() - d.stress()).norm(), 2e-6 * d.tangent().norm() * (1 + f.norm()));
      EXPECT_NEAR(s.energy(), d.energy(), 2e-6 * d.tangent().norm() * (1 + f.squaredNorm()));
      for (const bool semi_definite : {false, true}) {
        // Twist modes divide by sums of stretches, which a nearly unresolved rotation makes inexact.
        EXPECT_LT((s.tangent(semi_definite) - d.tangent(semi_definite)).norm(), 2e-4 * d.tangent().norm())
            << as_eigen(f);
      }
    }
}

/// What replaces an indefinite tangent has its eigenvectors. Negative eigenvalues become zero, or positive.
TYPED_TEST(ModelLaw, TheSemiDefiniteTangentDiffersInNegativeEigenvaluesAlone) {
  constexpr bool absolute = std::is_same_v<TypeParam, StableNeoHookean>;
  int indefinite = 0;
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const Mat3<double>& f : deformations(seed)) {
      const Point<TypeParam> point(f);
      const Matrix9 tangent = point.tangent();
      const Eigen::SelfAdjointEigenSolver<Matrix9> modes(tangent);
      if (modes.eigenvalues()[0] < -1e-6 * tangent.norm()) ++indefinite;
      const Vector9 values =
          absolute ? Vector9(modes.eigenvalues().cwiseAbs()) : Vector9(modes.eigenvalues().cwiseMax(0));
      const Matrix9 expected = modes.eigenvectors() * values.asDiagonal() * modes.eigenvectors().transpose();
      EXPECT_LT((point.tangent(true) - expected).norm(), 1e-9 * tangent.norm()) << as_eigen(f);
    }
  if (!std::is_same_v<TypeParam, Corotated<Identity>>) {
    EXPECT_GT(indefinite, 5) << "the cases must tell";
  }
}

template <class Model>
class ObjectiveModel : public ::testing::Test {};
using ObjectiveModels = ::testing::Types<Corotated<Polar>, StableNeoHookean>;
TYPED_TEST_SUITE(ObjectiveModel, ObjectiveModels);

TYPED_TEST(ObjectiveModel, TurnsWithTheFrame) {
  Random random(3);
  for (const Mat3<double>& f : deformations(7)) {
    const Mat3<double> q = random.rotation();
    const Point<TypeParam> here(f), turned(q * f);
    EXPECT_NEAR(turned.energy(), here.energy(), 1e-12 * here.tangent().norm() * (1 + f.squaredNorm()));
    EXPECT_LT((turned.stress() - q * here.stress()).norm(), 1e-12 * here.tangent().norm() * (1 + f.norm()));
  }
}

/// Whatever the element is squeezed or turned inside out to, everything is finite, and the tangent semi-definite where
/// that is asked for.
TYPED_TEST(ObjectiveModel, IsFiniteForDegenerateDeformations) {
  const auto expect_finite = []<class Scalar>(Scalar, const Mat3<double>& f) {
    for (const double poisson : {-0.5, 0.0, 0.3, 0.499}) {
      const Point<TypeParam, Scalar> point(f, {.young = 3e4, .poisson = poisson, .density = 900});
      EXPECT_TRUE(std::isfinite(point.energy()));
      EXPECT_TRUE(point.stress().allFinite());
      EXPECT_TRUE(point.tangent().allFinite());
      const Matrix9 part = point.tangent(true);
      ASSERT_TRUE(part.allFinite());
      const auto epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
      EXPECT_GE(Eigen::SelfAdjointEigenSolver<Matrix9>(part, Eigen::EigenvaluesOnly).eigenvalues()[0],
                -20 * epsilon * part.norm());
    }
  };
  for (const Vec3<double>& s : {Vec3<double>(1, 1, 0), Vec3<double>(1, 0, 0), Vec3<double>(0, 0, 0),
                                Vec3<double>(1, 1, -1), Vec3<double>(2, 1, -1), Vec3<double>(5, 0.1, -0.1),
                                Vec3<double>(1e-9, 1e-9, -1e-9), Vec3<double>(100, 100, 100)}) {
    expect_finite(0.0, testing::diagonal(s));
    expect_finite(0.0F, testing::diagonal(s));
  }
}

/// The eigenvalues in the principal frame, as they are, give the derivative of the stress.
TEST(PrincipalTangent, IsTheTangentWhoseEigenvaluesItIsGiven) {
  const Lame parameters = lame(rubber);
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const Mat3<double>& f : deformations(seed)) {
      const Point<Corotated<Polar>> point(f);
      const PrincipalFrame<double> frame(DeformationLanes<double>{point.f, point.r});
      using L = Lanes<double>;
      const L two_mu = 2 * parameters.mu, sum = frame.stretch[0] + frame.stretch[1] + frame.stretch[2];
      Vec3Lanes<double> twist, flip;
      Mat3Lanes<double> scaling;
      for (int k = 0; k < 3; ++k) {
        twist[at(k)] =
            two_mu + (L(2 * parameters.lambda) * (sum - L(3)) - two_mu - two_mu) / (sum - frame.stretch[at(k)]);
        flip[at(k)] = two_mu;
        for (int j = 0; j < 3; ++j) scaling(k, j) = L(parameters.lambda) + (j == k ? two_mu : L(0));
      }
      Point<Corotated<Polar>>::Tangent c;
      add_principal_tangent(frame, twist, flip, scaling, false, c);
      EXPECT_LT((Point<Corotated<Polar>>::flat(c) - point.tangent()).norm(), 1e-9 * point.tangent().norm())
          << as_eigen(f);
    }
}

TEST(StableNeoHookean, HasTheEnergyOfThePaper) {
  const auto [lame_lambda, lame_mu] = lame(rubber);
  const double mu = 4 * lame_mu / 3, lambda = lame_lambda + 5 * lame_mu / 6, rest = 1 + 3 * mu / (4 * lambda);
  const auto paper = [&](const Mat3<double>& f) {
    const double square = f.squaredNorm(), growth = f.determinant() - rest;
    return mu / 2 * (square - 3 - std::log(square + 1)) + lambda / 2 * growth * growth;
  };
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const Mat3<double>& f : deformations(seed))
      EXPECT_NEAR(Point<StableNeoHookean>(f).energy(), paper(f) - paper(Mat3<double>::Identity()),
                  1e-13 * mu * (1 + std::pow(f.norm(), 6)));
}

/// Small strains, also of turned bodies, cost what they cost in linear elasticity: to the third order.
TEST(StableNeoHookean, IsLinearElasticityForSmallStrains) {
  Random random(4);
  for (const double poisson : {-0.3, 0.0, 0.3, 0.49}) {
    const Material material{.young = 3e4, .poisson = poisson, .density = 900};
    const Mat3<double> direction = random.matrix(), turn = random.rotation();
    double before = 0;
    for (const double size : {1e-2, 1e-3, 1e-4, 1e-5}) {
      const Mat3<double> f = turn * (Mat3<double>::Identity() + size * direction);
      const double linear = Point<Corotated<Polar>>(f, material).energy();
      const double off = std::abs(Point<StableNeoHookean>(f, material).energy() / linear - 1);
      EXPECT_LT(off, std::max(200 * size, 1e-10)) << poisson;
      if (before > 1e-6) {
        EXPECT_LT(off, before / 5) << "falls with the strain";
      }
      before = off;
    }
  }
}

/// The same model by the kernels of any model and by those that are made for it.
template <class Scalar, class Element, class Rotation>
void expect_the_same_by_both_kernels(double deformation, bool random_start) {
  using General = detail::PointwiseElasticity<Scalar, Element, Corotated<Rotation>>;
  const auto mesh = testing::distorted_block<Scalar, Element>({.size = {1, 0.7, 0.5}, .cells = {3, 2, 2}}, 0.2, 5);
  std::vector<Material> materials(at(mesh.element_count()), rubber);
  for (std::size_t e = 0; e < materials.size(); ++e) materials[e].poisson = -0.2 + 0.05 * double(e % 14);
  Field<Scalar> u = testing::random_field<Scalar>(mesh.vertex_count(), deformation, 6);
  if (random_start)
    for (Index v = 0; v < mesh.vertex_count(); ++v) u[at(v)] -= Scalar(0.8) * mesh.position(v);
  const auto epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  for (const bool project : {false, true}) {
    Rig<Scalar, Element, Rotation> made(mesh, materials, VolumetricStrain::pointwise, Tangent::consistent);
    Rig<Scalar, Element, General> general(mesh, materials, VolumetricStrain::pointwise, Tangent::consistent);
    made.state.twist.project(project);
    general.state.twist.project(project);
    const Eigen::MatrixXd k = made.dense_stiffness(u), k_general = general.dense_stiffness(u);
    EXPECT_LT((k - k_general).norm(), 1e3 * epsilon * k.norm());
    const Field<Scalar> f = made.force(u), f_general = general.force(u);
    EXPECT_LT(double((flat(f) - flat(f_general)).norm()), 100 * epsilon * (k.norm() + double(flat(f).norm())));
    EXPECT_NEAR(made.law.energy(u), general.law.energy(u), 100 * epsilon * made.law.energy(u));
    const detail::DeformationExtremes a = made.state.summary(), b = general.state.summary();
    EXPECT_EQ(a.inverted_elements, b.inverted_elements);
    EXPECT_EQ(a.inverted_elements > 0, random_start);
    EXPECT_NEAR(a.max_strain(), b.max_strain(), 100 * epsilon * a.max_strain());
    EXPECT_NEAR(a.max_rotation(), b.max_rotation(), 1e-3);
    EXPECT_NEAR(a.max_stress2, b.max_stress2, 1e3 * epsilon * a.max_stress2);
    EXPECT_NEAR(a.energy, b.energy, 100 * epsilon * a.energy);
  }
}

TEST(PointwiseElasticity, AgreesWithTheKernelsOfTheCorotatedModel) {
  expect_the_same_by_both_kernels<double, Tet4, Polar>(0.03, false);
  expect_the_same_by_both_kernels<double, Tet10, Polar>(0.02, false);
  expect_the_same_by_both_kernels<double, Tet4, Polar>(0.5, true);
  expect_the_same_by_both_kernels<double, Tet10, Polar>(0.5, true);
  expect_the_same_by_both_kernels<float, Tet4, Polar>(0.03, false);
  expect_the_same_by_both_kernels<float, Tet10, Polar>(0.02, false);
  expect_the_same_by_both_kernels<double, Tet4, Identity>(0.03, false);
  expect_the_same_by_both_kernels<double, Tet10, GramSchmidt>(0.02, false);
}

/// Forces of a mesh are minus the gradient of its energy, the assembled matrix minus that of its forces.
template <class Element>
void expect_derivatives_of_a_body(unsigned seed) {
  const auto mesh = testing::distorted_block<double, Element>({.size = {1, 0.7, 0.5}, .cells = {1, 1, 1}}, 0.2, seed);
  Rig<double, Element, StableNeoHookean> rig(mesh, rubber, VolumetricStrain::pointwise, Tangent::consistent);
  const Mat3<double> affine = Random(seed).rotation() * testing::diagonal({1.4, 0.7, 1.1});
  Field<double> u = testing::displacement_of(mesh, [&](const Vec3<double>& x) { return affine * x; });
  flat(u) += flat(testing::random_field<double>(mesh.vertex_count(), 0.05, seed));
  testing::expect_derivatives(rig, u, 1e-7);
  (void)rig.force(u);
  EXPECT_NEAR(rig.state.summary().energy, rig.law.energy(u), 1e-12 * rig.law.energy(u));
}

TEST(PointwiseElasticity, ForcesAndMatrixAreDerivatives) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    expect_derivatives_of_a_body<Tet4>(seed);
    expect_derivatives_of_a_body<Tet10>(seed);
  }
}

/// The matrix is the sum of the elements' own blocks, and as symmetric as its bits.
TEST(PointwiseElasticity, TheMatrixIsTheSumOverElements) {
  const auto mesh = testing::distorted_block<float, Tet10>({.size = {1, 0.7, 0.5}, .cells = {3, 2, 2}}, 0.2, 4);
  Rig<float, Tet10, StableNeoHookean> rig(mesh);
  const auto u = testing::random_field<float>(mesh.vertex_count(), 0.02F, 8);
  testing::expect_sum_over_elements(rig, u);
  const Eigen::MatrixXd dense = rig.dense_stiffness(u);
  EXPECT_EQ((dense - dense.transpose()).norm(), 0);
}

static_assert(ElasticModel<Softening> && detail::has_state<Softening>);

// A model without state costs no byte, in an evaluation and in a body.
static_assert(std::is_empty_v<PointStates<float, Corotated<Polar>>> &&
              std::is_empty_v<PointStates<double, StableNeoHookean>>);
static_assert(sizeof(detail::PointwiseEvaluation<float, Tet4, Softening>) ==
              sizeof(detail::PointwiseEvaluation<float, Tet4, StableNeoHookean>) +
                  sizeof(PointStates<float, Softening>));
static_assert(sizeof(SoftBody<float, Tet4, Softening>) ==
              sizeof(SoftBody<float, Tet4>) + sizeof(PointStates<float, Softening>));

template <class Body>
Field<double> forces(const Body& body, const typename Body::Law::Evaluation& state) {
  Field<double> f;
  for (Index v = 0; v < body.vertex_count(); ++v) f.push_back(state.vertex_force(*body.pattern(), v));
  return f;
}

template <class Element>
class StatefulBody : public ::testing::Test {};
using Elements = ::testing::Types<Tet4, Tet10>;
TYPED_TEST_SUITE(StatefulBody, Elements);

template <class Element>
SoftBody<double, Element, Softening> softening_body() {
  return must(SoftBody<double, Element, Softening>::create(
      testing::distorted_block<double, Element>({.size = {1, 0.7, 0.5}, .cells = {2, 2, 1}}, 0.2, 3), rubber));
}

/// An evaluation alone changes nothing, however far it goes; what is committed stays, and can be put back.
TYPED_TEST(StatefulBody, RemembersWhatIsCommittedAndNothingElse) {
  auto body = softening_body<TypeParam>();
  typename decltype(body)::Law::Evaluation state(body.law());
  const auto stretched = [&](double s) {
    return testing::displacement_of(body.mesh(),
                                    [&](const Vec3<double>& x) { return Vec3<double>(s * x.x(), x.y(), x.z()); });
  };
  SerialExecutor serial;
  std::vector<double> scratch;
  const auto force_at = [&](double s) {
    body.evaluate(stretched(s), state, serial);
    return forces(body, state);
  };
  const auto at_rest = body.point_states();
  const Field<double> fresh = force_at(1.05);
  const double energy = body.elastic_energy(stretched(1.05), scratch, serial);
  (void)force_at(1.4);
  EXPECT_EQ(flat(force_at(1.05)), flat(fresh)) << "a trial is no commitment";

  const Revision before = body.revision();
  (void)force_at(1.4);
  const Field<double> far_out = force_at(1.4);
  body.commit(state);
  EXPECT_FALSE(body.revision() == before) << "forces are others now";
  const Field<double> soft = force_at(1.05);
  EXPECT_LT((flat(force_at(1.4)) - flat(far_out)).norm(), 1e-12 * flat(far_out).norm()) << "where it was committed";
  // Uniform strain: all points have the same kappa, psi = (mu + lambda / 2) 0.4^2.
  const auto [lambda, mu] = lame(rubber);
  const auto share = [&](double s) {
    const double root = Softening::half_way / (Softening::half_way + (mu + lambda / 2) * (s - 1) * (s - 1));
    return root * root;
  };
  EXPECT_LT((flat(soft) - share(1.4) / share(1.05) * flat(fresh)).norm(), 1e-10 * flat(fresh).norm());
  EXPECT_LT(share(1.4), 0.8 * share(1.05)) << "the case must tell";
  EXPECT_LT(body.elastic_energy(stretched(1.05), scratch, serial), 0.9 * energy);

  const auto copy = body;
  body.set_point_states(at_rest);
  EXPECT_EQ(flat(force_at(1.05)), flat(fresh));
  copy.evaluate(stretched(1.05), state, serial);
  EXPECT_EQ(flat(forces(copy, state)), flat(soft)) << "a copy has states of its own";
}

/// The states are part of what a snapshot holds, and of what a reset sets back.
TYPED_TEST(StatefulBody, SnapshotsHoldThePointStates) {
  auto body = softening_body<TypeParam>();
  typename decltype(body)::Law::Evaluation state(body.law());
  SerialExecutor serial;
  const Field<double> u = testing::random_field<double>(body.vertex_count(), 0.05, 1);
  const auto energy = [&] {
    std::vector<double> scratch;
    return body.elastic_energy(u, scratch, serial);
  };
  const double fresh = energy();
  body.evaluate(u, state, serial);
  body.commit(state);
  const double softened = energy();
  EXPECT_LT(softened, fresh);

  detail::StateArchive measure;
  body.visit_state(measure);
  std::vector<std::byte> bytes(measure.size());
  detail::StateArchive write{std::span<std::byte>(bytes)};
  body.visit_state(write);
  body.reset();
  EXPECT_EQ(energy(), fresh);
  detail::StateArchive read(std::span<const std::byte>(bytes), detail::StateArchive::Mode::read);
  body.visit_state(read);
  EXPECT_TRUE(write.ok() && read.ok());
  EXPECT_EQ(energy(), softened);
}

/// Force from energy and matrix from force at a committed state, where points load and unload.
TYPED_TEST(StatefulBody, DerivativesAreThoseAtTheCommittedState) {
  auto body = softening_body<TypeParam>();
  using Evaluation = typename decltype(body)::Law::Evaluation;
  SerialExecutor serial;
  Evaluation state(body.law(), Tangent::consistent);
  body.evaluate(testing::random_field<double>(body.vertex_count(), 0.05, 1), state, serial);
  body.commit(state);
  const Field<double> u = testing::random_field<double>(body.vertex_count(), 0.05, 2);
  body.evaluate(u, state, serial);
  const Field<double> f = forces(body, state);
  BlockMatrix<double> k(body.pattern());
  assemble(body.law(), state, body.mass(), 0.0, 1.0, k, serial);
  std::vector<double> scratch;
  const double h = 1e-7;
  for (unsigned trial = 0; trial < 10; ++trial) {
    const Field<double> d = testing::random_field<double>(body.vertex_count(), 1, 100 + trial);
    Field<double> forward = u, backward = u, product = u;
    flat(forward) += h * flat(d);
    flat(backward) -= h * flat(d);
    const double slope =
        (body.elastic_energy(forward, scratch, serial) - body.elastic_energy(backward, scratch, serial)) / (2 * h);
    EXPECT_NEAR(flat(f).dot(flat(d)), -slope, 1e-6 * flat(f).norm() * flat(d).norm());
    body.evaluate(forward, state, serial);
    const Field<double> f_forward = forces(body, state);
    body.evaluate(backward, state, serial);
    const Field<double> f_backward = forces(body, state);
    k.apply(d, product, serial);
    EXPECT_LT((flat(product) + (flat(f_forward) - flat(f_backward)) / (2 * h)).norm(), 1e-5 * flat(product).norm());
  }
}

TEST(ElasticLaws, WithoutStateCommitNothing) {
  auto body = must(SoftBody<double, Tet4, StableNeoHookean>::create(
      testing::block<double, Tet4>({.size = {1, 1, 1}, .cells = {1, 1, 1}}), rubber));
  typename decltype(body)::Law::Evaluation state(body.law());
  const Revision before = body.revision();
  body.commit(state);
  EXPECT_TRUE(body.revision() == before);
}

/// A mean dilatation is part of the corotated kernels: another model says so, and names itself.
TEST(ElasticLaws, RefuseAMeanDilatationThatTheyDoNotHave) {
  const auto body = SoftBody<float, Tet4, StableNeoHookean>::create(
      testing::block<float, Tet4>({.size = {1, 1, 1}, .cells = {1, 1, 1}}), rubber,
      {.mass = MassModel::lumped, .damping = {}, .volumetric_strain = VolumetricStrain::averaged});
  ASSERT_FALSE(body.ok());
  EXPECT_EQ(body.error().code, ErrorCode::unsupported);
  EXPECT_NE(body.error().message().find("stable_neo_hookean"), std::string::npos);
}

/// A rotation law and the corotated model with it are the same body.
static_assert(std::is_same_v<SoftBody<float, Tet4>::Law, Elasticity<float, Tet4, Corotated<Polar>>>);
static_assert(std::is_same_v<Elasticity<float, Tet4, GramSchmidt>, Elasticity<float, Tet4, Corotated<GramSchmidt>>>);

}  // namespace
}  // namespace corotet::elastic_model_test
