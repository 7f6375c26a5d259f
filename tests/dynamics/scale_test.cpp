// No step knows how large a metre is: tolerances are relative, and nothing changes far from the origin.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "support/bodies.hpp"

namespace corotet::scale_test {
namespace {

using testing::must;

/// Units in which the same body is described: one metre, second and kilogram of it in SI.
struct Units {
  double length = 1, time = 1, mass = 1;
};

struct Run {
  Eigen::VectorXd displacement;  // in its own units
  StepReport report;
};

constexpr StepOptions one_solve{}, newton{.iterations = 10, .tangent = Tangent::consistent};
constexpr SolverOptions default_solver{}, direct{.method = SolverMethod::cholesky};

/// A beam of 1 x 0.2 x 0.2 lengths that swings under its weight with damping, its least corner `far` from the origin in
/// each direction.
template <class Integrator, class Scalar, class Element>
Run swing(const Units& unit, const StepOptions& options, const SolverOptions& solver, double far = 0, int steps = 20) {
  BlockOptions shape{.corner = Vec3<double>(far, far - 0.1, far - 0.1) * unit.length,
                     .size = Vec3<double>(1, 0.2, 0.2) * unit.length,
                     .cells = Element::order == 1 ? std::array<Index, 3>{10, 2, 2} : std::array<Index, 3>{5, 1, 1},
                     .order = Element::order};
  const Vec3<double> origin = Vec3<double>::Constant(far * unit.length);
  auto mesh = must(TetMesh<Scalar, Element>::create(must(make_block(shape)), origin));
  const double stress = unit.mass / (unit.length * unit.time * unit.time);
  const Material material{
      .young = 5e5 * stress, .poisson = 0.3, .density = 1000 * unit.mass / std::pow(unit.length, 3)};
  auto body = must(SoftBody<Scalar, Element>::create(
      std::move(mesh), material, {.damping = {.mass = 0.5 / unit.time, .stiffness = 0.002 * unit.time}}));
  body.pin_where([&](const auto& x) { return double(x.x()) < 1e-6 * unit.length; });
  body.set_gravity({0, 0, static_cast<Scalar>(-9.75 * unit.length / (unit.time * unit.time))});
  Integrator integrator(body, solver, options);
  Run run;
  for (int step = 0; step < steps; ++step) {
    run.report = integrator.step(body, static_cast<Scalar>(unit.time / 64));
    EXPECT_TRUE(run.report.ok()) << run.report.advice() << " at step " << step;
    if (!run.report.accepted()) break;
  }
  run.displacement = flat(body.displacements()).template cast<double>() / unit.length;
  return run;
}

/// The same beam in units that differ by powers of two: 1 mm to 1 km, E from 1e2 to 1e12, densities from 1e-1 to 1e5.
/// Every number is a power of two times what it was, and so its digits are the same, square roots of odd powers aside.
template <class Integrator>
void expect_the_same_in_any_units(const StepOptions& options, const SolverOptions& solver) {
  using Body = typename Integrator::BodyType;
  using Scalar = typename Body::scalar_type;
  using Element = typename Body::element_type;
  const Run here = swing<typename Integrator::Type, Scalar, Element>({}, options, solver);
  EXPECT_GT(here.displacement.cwiseAbs().maxCoeff(), 0.1);
  for (const double length : {0x1p-10, 1.0, 0x1p10})
    for (const double young : {0x1p-12, 0x1p22})       // of 5e5: 122 Pa, 2e12 Pa
      for (const double density : {0x1p-14, 0x1p8}) {  // of 1000: 0.06, 256,000 kg/m3
        const Units unit{length, std::sqrt(density * length * length / young), density * length * length * length};
        const Run there = swing<typename Integrator::Type, Scalar, Element>(unit, options, solver);
        EXPECT_EQ(there.displacement, here.displacement)
            << "length " << length << " young " << young << " density " << density;
        EXPECT_EQ(there.report.iterations, here.report.iterations);
      }
}

template <class S, class E, template <class, class> class I>
struct Stepper {
  using BodyType = SoftBody<S, E>;
  using Type = I<BodyType, AutoSolver<S>>;
};

template <class T>
class Scale : public ::testing::Test {};
using Cases = ::testing::Types<testing::Case<float, Tet4>, testing::Case<float, Tet10>>;
TYPED_TEST_SUITE(Scale, Cases);

TEST(ScaleLaws, StepsAreTheSameInAnyUnits) {
  using Euler4 = Stepper<float, Tet4, ImplicitEuler>;
  expect_the_same_in_any_units<Euler4>(one_solve, default_solver);
  expect_the_same_in_any_units<Euler4>(newton, default_solver);
  expect_the_same_in_any_units<Euler4>(one_solve, direct);
  using Euler10 = Stepper<float, Tet10, ImplicitEuler>;
  expect_the_same_in_any_units<Euler10>(newton, default_solver);
  expect_the_same_in_any_units<Stepper<float, Tet4, Bdf2>>(one_solve, default_solver);
}

/// The same beam at 10 km and 1,000 km, in float: only the last digits of the coordinates given may differ.
TYPED_TEST(Scale, NothingChangesFarFromTheOrigin) {
  using Scalar = typename TypeParam::Scalar;
  using Body = SoftBody<Scalar, typename TypeParam::Element>;
  for (const StepOptions& options : {one_solve, newton}) {
    const auto at_distance = [&](double far) {
      return swing<ImplicitEuler<Body>, Scalar, typename TypeParam::Element>({}, options, default_solver, far)
          .displacement;
    };
    const Eigen::VectorXd here = at_distance(0);
    for (const double far : {1e4, 1e6})
      EXPECT_LT((at_distance(far) - here).norm(), 1e-5 * here.norm()) << "m from the origin: " << far;
  }
}

/// Bodies as far from each other as they come, stepped at one sixtieth of a second whatever their own periods are: the
/// matrix may be all mass or all stiffness. Finite, and nothing wrong is passed over.
TYPED_TEST(Scale, ExtremeBodiesStepOrSayWhyNot) {
  using Scalar = typename TypeParam::Scalar;
  using Element = typename TypeParam::Element;
  for (const double size : {1e-3, 1.0, 1e3})
    for (const double young : {1e2, 1e12})
      for (const double density : {1e-1, 1e5})
        for (const auto& [solver, options] :
             {std::pair(default_solver, one_solve), std::pair(direct, one_solve), std::pair(default_solver, newton)}) {
          auto body = must(SoftBody<Scalar, Element>::create(
              testing::block<Scalar, Element>({.size = Vec3<double>(1, 0.3, 0.3) * size, .cells = {4, 1, 1}}),
              Material{.young = young, .poisson = 0.3, .density = density}));
          body.pin_where([](const auto& x) { return x.x() == 0; });
          body.set_gravity({0, 0, Scalar(-9.81)});
          ImplicitEuler euler(body, solver, options);
          for (int step = 0; step < 30; ++step) {
            const StepReport report = euler.step(body, Scalar(1.0 / 60));
            ASSERT_TRUE(report.accepted())
                << report.advice() << " size " << size << " E " << young << " rho " << density;
            ASSERT_TRUE(flat(body.displacements()).allFinite() && flat(body.velocities()).allFinite());
            EXPECT_TRUE(report.converged) << "size " << size << " E " << young << " density " << density;
          }
          EXPECT_GT(testing::max_displacement(body), 0) << "size " << size << " E " << young << " density " << density;
        }
}

}  // namespace
}  // namespace corotet::scale_test
