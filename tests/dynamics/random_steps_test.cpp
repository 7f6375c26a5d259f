// Whole steps of random bodies: whatever the mesh, the materials, pins, kicks and settings, a step ends in a finite
// state that its report describes, or changes nothing; and it does the same again.
//
// COROTET_TEST_SEED=N runs seed N alone.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/substepping_integrator.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "support/bodies.hpp"
#include "support/random_mesh.hpp"
#include "support/seeds.hpp"

namespace corotet::random_steps_test {
namespace {

using testing::must;
using testing::Random;

template <class Scalar, class Element>
SoftBody<Scalar, Element> random_body(Random& random) {
  const auto logarithmic = [&](double low, double high) {
    return std::exp(random.uniform(std::log(low), std::log(high)));
  };
  const double size = logarithmic(0.01, 100);
  const Vec3<double> shape{size, size * random.uniform(0.2, 1), size * random.uniform(0.2, 1)};
  auto mesh = must(TetMesh<Scalar, Element>::create(testing::random_mesh(
      random, static_cast<Index>(random.uniform(8, Element::order == 1 ? 40 : 16)), shape, Element::order)));
  std::vector<Material> materials;
  const bool alike = random.uniform() < 0.5;
  const double young = logarithmic(1e4, 1e8), density = logarithmic(100, 10'000), poisson = random.uniform(-0.3, 0.499);
  for (Index e = 0; e < mesh.element_count(); ++e)
    materials.push_back(alike ? Material{.young = young, .poisson = poisson, .density = density}
                              : Material{.young = young * logarithmic(0.1, 10),
                                         .poisson = random.uniform(-0.3, 0.499),
                                         .density = density * logarithmic(0.1, 10)});
  BodyOptions options;
  options.mass = random.uniform() < 0.3 ? MassModel::consistent : MassModel::lumped;
  options.volumetric_strain = random.uniform() < 0.3 ? VolumetricStrain::averaged : VolumetricStrain::pointwise;
  if (random.uniform() < 0.5) options.damping = {.mass = random.uniform(0, 5), .stiffness = random.uniform(0, 0.01)};
  auto body = must(SoftBody<Scalar, Element>::create(std::move(mesh), materials, options));
  const double pinned = random.uniform(0, 0.3) - 0.1;  // a third of the bodies is free
  body.pin_where([&](const auto&) { return random.uniform() < pinned; });
  body.set_gravity(random.vector(5).cast<Scalar>());
  const double speed = random.uniform() < 0.5 ? size : 10 * size;  // m/s
  must(body.set_velocities(testing::random_field<Scalar>(body.vertex_count(), speed, 1)));
  if (random.uniform() < 0.3)  // crumpled
    must(body.set_displacements(testing::random_field<Scalar>(body.vertex_count(), 0.2 * size, 2)));
  return body;
}

/// What a report says of deformation, computed element by element in double.
struct Deformation {
  Index surely_inverted = 0, maybe_inverted = 0;  // the sign of det F may be that of rounding
  double max_strain = 0;
  bool pointwise = true;  // each point has the rotation of its own F: see extract_rotations
};

template <class Body>
Deformation deformation_of(const Body& body) {
  using Scalar = typename Body::scalar_type;
  using Element = typename Body::element_type;
  constexpr auto points = Element::stiffness_points.size();
  Deformation found;
  for (Index e = 0; e < body.mesh().element_count(); ++e) {
    double least = 1, rounding = 0;
    for (std::size_t q = 0; q < points; ++q) {
      const auto rest = detail::jacobian(detail::natural_gradients<Element>[q], body.mesh().node_positions(e));
      const Mat3<double> to_rest = rest.inverse();
      std::array<Vec3<double>, Element::nodes> u;
      for (std::size_t a = 0; a < u.size(); ++a)
        u[a] = body.displacements()[at(body.mesh().element(e)[a])].template cast<double>();
      const auto displaced = detail::jacobian(detail::natural_gradients<Element>[q], u);
      const Mat3<double> f = Mat3<double>::Identity() + displaced * to_rest;
      const double largest = f.norm();
      least = std::min(least, f.determinant());
      // Each entry of F is rounded as the terms that it is summed from.
      double terms = 1;
      for (std::size_t a = 0; a < Element::nodes; ++a)
        terms += body.displacements()[at(body.mesh().element(e)[a])].template cast<double>().norm() * to_rest.norm();
      rounding =
          std::max(rounding, 32 * double(std::numeric_limits<Scalar>::epsilon()) * terms * (1 + largest * largest));
      const Mat3<double> s = detail::polar_robust<double>(f).transpose() * f;
      found.max_strain = std::max(found.max_strain, ((s + s.transpose()) / 2 - Mat3<double>::Identity()).norm());
    }
    if (least < -rounding) ++found.surely_inverted;
    if (least < rounding) ++found.maybe_inverted;
    if (points > 1 && least < 0.3 + rounding) found.pointwise = false;
  }
  return found;
}

struct Trace {
  std::vector<double> numbers;
  void add(const StepReport& r) {
    numbers.insert(numbers.end(), {double(r.error), double(r.iterations), r.residual, r.newton_residual,
                                   double(r.inverted_elements), r.max_strain, r.max_rotation, double(r.sub_steps)});
  }
};

template <class Integrator, class Body>
Trace run(unsigned seed) {
  using Scalar = typename Body::scalar_type;
  Random random(seed);
  Body body = random_body<Scalar, typename Body::element_type>(random);
  StepOptions newton;
  if (random.uniform() < 0.3) newton = {.iterations = 8, .tangent = Tangent::consistent};
  SolverOptions solver{.max_iterations = 200};
  if (random.uniform() < 0.2) solver.method = SolverMethod::cholesky;
  if (random.uniform() < 0.3) solver.preconditioner = PreconditionerKind::block_jacobi;
  const SubsteppingOptions trust{.on_unreliable = static_cast<OnUnreliable>(seed % 3), .max_halvings = 2};
  SubsteppingIntegrator stepper(Integrator(body, solver, newton), body, trust);
  const double h = std::exp(random.uniform(std::log(1e-4), std::log(0.1)));
  const double lead = random.uniform() < 0.5 ? 0 : 0.3 * double(body.mesh().position(0).norm());
  Trace trace;
  for (int step = 0; step < 8; ++step) {
    Field<Scalar> targets = body.pins().targets();
    for (std::size_t p = 0; p < targets.size(); ++p) {
      targets[p] += random.vector(lead * h).template cast<Scalar>();
      body.pins().move(body.pins().vertices()[p], targets[p]);
    }
    const Body before = body;
    const StepReport report = stepper.step(body, Scalar(h));
    trace.add(report);
    EXPECT_TRUE(flat(body.displacements()).allFinite() && flat(body.velocities()).allFinite());
    EXPECT_EQ(flat(body.pins().targets()), flat(targets));
    if (!report.accepted()) {
      EXPECT_STRNE(report.advice(), "");
      EXPECT_EQ(flat(body.displacements()), flat(before.displacements()));
      EXPECT_EQ(flat(body.velocities()), flat(before.velocities()));
      continue;
    }
    for (std::size_t p = 0; p < targets.size(); ++p)
      EXPECT_EQ(body.displacements()[at(body.pins().vertices()[p])], targets[p]);
    EXPECT_TRUE(report.converged || report.solve != SolveStatus::converged);
    if (!report.ok()) {
      EXPECT_STRNE(report.advice(), "");
    }
    const Deformation found = deformation_of(body);
    EXPECT_GE(report.inverted_elements, found.surely_inverted);
    EXPECT_LE(report.inverted_elements, found.maybe_inverted);
    if (found.pointwise) {
      EXPECT_NEAR(report.max_strain, found.max_strain, 1e-3 * (1 + found.max_strain));
    }
    if (::testing::Test::HasFailure()) return trace;
  }
  for (const auto* field : {&body.displacements(), &body.velocities()})
    for (const Vec3<Scalar>& v : *field)
      for (const Scalar x : v) trace.numbers.push_back(double(x));
  return trace;
}

template <class S>
class RandomSteps : public ::testing::Test {};
template <class S, class E, template <class, class> class I>
struct Stepper {
  using Body = SoftBody<S, E>;
  using Integrator = I<Body, AutoSolver<S>>;
};
using Steppers = ::testing::Types<Stepper<float, Tet4, ImplicitEuler>, Stepper<double, Tet4, Bdf2>,
                                  Stepper<float, Tet10, ImplicitEuler>>;
TYPED_TEST_SUITE(RandomSteps, Steppers);

TYPED_TEST(RandomSteps, EndFiniteAsReportedAndTheSameAgain) {
  using Body = typename TypeParam::Body;
  testing::for_seeds(60, [](unsigned seed) {
    const Trace trace = run<typename TypeParam::Integrator, Body>(seed);
    EXPECT_EQ((run<typename TypeParam::Integrator, Body>(seed).numbers), trace.numbers);
  });
}

}  // namespace
}  // namespace corotet::random_steps_test
