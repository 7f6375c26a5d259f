// CHOLMOD as the solver of a step gives the steps that our own factorisation gives.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/solve/cholmod.hpp>
#include <gtest/gtest.h>
#include <memory>

#include "support/bodies.hpp"

namespace corotet {
namespace {

static_assert(LinearSolver<CholmodSolver<float>, float> && LinearSolver<CholmodSolver<double>, double>);

template <class T>
class Cholmod : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Cholmod, Scalars);

TYPED_TEST(Cholmod, StepsAsTheBuiltInFactorisationDoes) {
  auto body = testing::must(SoftBody<TypeParam>::create(
      testing::block<TypeParam, Tet4>({.size = {1, 0.2, 0.2}, .cells = {6, 2, 2}}), Material{.young = 5e5}));
  body.pin_where([](const Vec3<TypeParam>& x) { return x.x() == 0; });
  body.set_gravity({0, 0, TypeParam(-9.81)});
  auto other = body;
  const double tolerance = sizeof(TypeParam) == 4 ? 1e-5 : 1e-11;
  ImplicitEuler<SoftBody<TypeParam>, CholmodSolver<TypeParam>> cholmod(body, CholmodOptions{.tolerance = tolerance});
  ImplicitEuler builtin(other, SolverOptions{.method = SolverMethod::cholesky, .tolerance = tolerance});
  for (int step = 0; step < 20; ++step) {
    ASSERT_TRUE(cholmod.step(body, TypeParam(1.0 / 60)).ok());
    ASSERT_TRUE(builtin.step(other, TypeParam(1.0 / 60)).ok());
  }
  EXPECT_LT((flat(body.displacements()) - flat(other.displacements())).norm(), 100 * tolerance);
  EXPECT_GT(flat(body.displacements()).norm(), 0.1);
}

TYPED_TEST(Cholmod, ACopyStepsAsTheOriginal) {
  auto body = testing::must(SoftBody<TypeParam>::create(
      testing::block<TypeParam, Tet4>({.size = {1, 0.2, 0.2}, .cells = {6, 2, 2}}), Material{.young = 5e5}));
  body.pin_where([](const Vec3<TypeParam>& x) { return x.x() == 0; });
  body.set_gravity({0, 0, TypeParam(-9.81)});
  ImplicitEuler<SoftBody<TypeParam>, CholmodSolver<TypeParam>> cholmod(body);
  ASSERT_TRUE(cholmod.step(body, TypeParam(1.0 / 60)).accepted());
  auto copy = cholmod;
  auto other = body;
  ASSERT_TRUE(cholmod.step(body, TypeParam(1.0 / 60)).accepted());
  ASSERT_TRUE(copy.step(other, TypeParam(1.0 / 60)).accepted());
  EXPECT_EQ(flat(body.displacements()), flat(other.displacements()));
}

TYPED_TEST(Cholmod, ReportsAMatrixThatIsNotPositiveDefinite) {
  const auto mesh = testing::block<TypeParam, Tet4>({});
  BlockMatrix<TypeParam> a(
      std::make_shared<const BlockPattern>(BlockPattern::of(mesh.elements(), mesh.vertex_count())));
  for (Index i = 0; i < a.rows(); ++i) a.block(a.pattern().diagonal[at(i)]) = -Mat3<TypeParam>::Identity();
  CholmodSolver<TypeParam> solver;
  solver.analyze(a.shared_pattern(), mesh.positions());
  const Field<TypeParam> b = testing::random_field<TypeParam>(a.rows(), 1, 1);
  Field<TypeParam> x(b.size());
  SerialExecutor serial;
  const Field<TypeParam> still(b.size(), Vec3<TypeParam>::Zero());
  EXPECT_EQ(solver.solve({a, b, still, {}, 1}, x, serial).status, SolveStatus::breakdown);
}

}  // namespace
}  // namespace corotet
