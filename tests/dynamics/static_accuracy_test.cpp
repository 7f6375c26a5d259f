// Static answers against theory: patch test, Timoshenko's beam, and a beam that bends far under its own weight.
#include <corotet/detail/dynamics/static_solve.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "support/bodies.hpp"

namespace corotet::static_accuracy_test {
namespace {

using testing::must;

template <class T>
class PatchTest : public ::testing::Test {};
TYPED_TEST_SUITE(PatchTest, testing::AllCases);

/// A distorted mesh whose boundary follows an affine map, inner vertices anywhere: the inside must follow, too.
TYPED_TEST(PatchTest, AffineBoundaryGivesTheAffineField) {
  using Scalar = typename TypeParam::Scalar;
  using Element = typename TypeParam::Element;
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
    auto body = must(SoftBody<Scalar, Element>::create(
        testing::distorted_block<Scalar, Element>({.size = {1, 1, 1}, .cells = {3, 3, 3}}, 0.2, 1),
        Material{.young = 1e5, .poisson = volumetric_strain == VolumetricStrain::averaged ? 0.45 : 0.3},
        {.mass = MassModel::lumped, .damping = {}, .volumetric_strain = volumetric_strain}));
    testing::Random random(2);
    // Larger in the mean: squeezed by as much, the law lets each point turn out of the way, and other fields are at
    // rest.
    const Mat3<double> rotation = random.rotation(), stretch = 1.1 * Mat3<double>::Identity() + random.matrix(0.1);
    const Mat3<double> affine = rotation * stretch;
    ASSERT_GT(affine.determinant(), 1);
    const auto exact = testing::displacement_of(body.mesh(), [&](const Vec3<double>& x) { return affine * x; });
    Field<Scalar> start = exact;
    Index inside = 0;
    for (Index v = 0; v < body.vertex_count(); ++v) {
      const auto& x = body.mesh().position(v);
      if (x.minCoeff() > 1e-5 && x.maxCoeff() < 1 - 1e-5) {
        start[at(v)] += random.vector(0.02).template cast<Scalar>();
        ++inside;
      } else {
        body.pins().pin(v, exact[at(v)]);
      }
    }
    ASSERT_GE(inside, 8);
    must(body.set_displacements(start));
    const double tolerance = sizeof(Scalar) == 4 ? 1e-5 : 1e-12;
    EXPECT_TRUE(solve_static(body, {.tolerance = tolerance, .solver = {.tolerance = 1e-6}}).converged);
    for (Index v = 0; v < body.vertex_count(); ++v)
      EXPECT_LT(double((body.displacements()[at(v)] - exact[at(v)]).norm()), 10 * tolerance);
  }
}

/// Tip deflection of a beam of length 4 and height 1, held at one end, under its own small weight.
template <class Element>
double small_deflection(Index cells_through, double poisson = 0,
                        VolumetricStrain volumetric_strain = VolumetricStrain::pointwise) {
  auto body = testing::cantilever<double, Element>(
      {.size = {4, 1, 1}, .cells = {4 * cells_through, cells_through, cells_through}},
      {.young = 1e4, .poisson = poisson, .density = 1}, 1e-4,
      {.mass = MassModel::lumped, .damping = {}, .volumetric_strain = volumetric_strain});
  EXPECT_TRUE(solve_static(body, {.tolerance = 1e-9}).converged);
  return -body.displacements()[at(body.mesh().nearest_vertex({4, 0.5, 0.5}))].z();
}

/// delta = q L^4 / 8 E I + q L^2 / 2 kappa G A, kappa = 10 (1 + nu) / (12 + 11 nu) (Timoshenko; Cowper 1966). The
/// energy error, and with it the error of a mean deflection, falls with the 2p-th power of the cell size for elements
/// of order p.
TEST(SmallDeflection, ConvergesToTimoshenkoAtTheOrderOfTheElement) {
  const double q = 1e-4, e = 1e4, inertia = 1.0 / 12, shear_modulus = e / 2, kappa = 10.0 / 12;
  const double timoshenko = q * 256 / (8 * e * inertia) + q * 16 / (2 * kappa * shear_modulus);

  const double t2 = small_deflection<Tet4>(2), t4 = small_deflection<Tet4>(4), t8 = small_deflection<Tet4>(8);
  const double s1 = small_deflection<Tet10>(1), s2 = small_deflection<Tet10>(2), s4 = small_deflection<Tet10>(4);
  const double tet4_order = std::log2((s4 - t4) / (s4 - t8)), tet10_order = std::log2((s2 - s1) / (s4 - s2));
  std::printf("of Timoshenko: Tet4 2/4/8 cells %.5f %.5f %.5f, Tet10 1/2/4 cells %.6f %.6f %.6f; orders %.2f %.2f\n",
              t2 / timoshenko, t4 / timoshenko, t8 / timoshenko, s1 / timoshenko, s2 / timoshenko, s4 / timoshenko,
              tet4_order, tet10_order);
  EXPECT_NEAR(s4, timoshenko, 0.01 * timoshenko);
  EXPECT_LT(std::abs(s4 - timoshenko), 0.1 * std::abs(t8 - timoshenko));
  EXPECT_GT(tet4_order, 1.7);
  EXPECT_LT(tet4_order, 2.3);
  EXPECT_GT(tet10_order, 3);  // 4 in theory, until the corners of the clamp show
}

/// Mean dilatation keeps the order of Tet4 at nu = .499, and leaves Tet10 as it is up to nu = 1/3.
TEST(SmallDeflection, ConvergesAtTheSameOrderWithMeanDilatation) {
  const auto mean = VolumetricStrain::averaged;
  const double t2 = small_deflection<Tet4>(2, 0.499, mean), t4 = small_deflection<Tet4>(4, 0.499, mean),
               t8 = small_deflection<Tet4>(8, 0.499, mean);
  const double s1 = small_deflection<Tet10>(1, 0.499, mean), s2 = small_deflection<Tet10>(2, 0.499, mean),
               s4 = small_deflection<Tet10>(4, 0.499, mean);
  const double order = std::log2((s4 - t4) / (s4 - t8));
  std::printf("of Tet10 with 4 cells at nu .499: Tet4 2/4/8 cells %.5f %.5f %.5f, order %.2f; Tet10 1/2 %.5f %.5f\n",
              t2 / s4, t4 / s4, t8 / s4, order, s1 / s4, s2 / s4);
  EXPECT_GT(order, 1.7);
  EXPECT_LT(order, 2.3);
  EXPECT_LT(std::abs(s2 - s4), 0.5 * std::abs(small_deflection<Tet10>(2, 0.499) - s4));
  const double same = small_deflection<Tet10>(2, 0.3);
  EXPECT_NEAR(small_deflection<Tet10>(2, 0.3, mean), same, 1e-9 * same);
}

/// The self-weight cantilever that bends by 0.12, 0.43 and 0.65 of its length: L/h = 10, nu = 0 and 0.3, against
/// converged solutions of the same continuous model by an independent program (dx/L, dy/L; +-5e-4).
TEST(LargeDeflection, Tet10WithTwoCellsThroughTheThicknessIsWithinOneAndAHalfPercent) {
  struct Row {
    double load, poisson, dx, dy;
  };
  for (const Row& row : {Row{1, 0, .00881, .12448}, Row{1, .3, .00868, .12356}, Row{4, 0, .11091, .42938},
                         Row{4, .3, .10959, .42709}, Row{8, 0, .27882, .64853}, Row{8, .3, .27661, .64665}}) {
    // q = q0 L^3 / E I with q0 = rho A g, A = h^2, I = h^4 / 12.
    auto body = testing::cantilever<double, Tet10>(
        {.corner = {0, -0.05, -0.05}, .size = {1, 0.1, 0.1}, .cells = {20, 2, 2}, .split = BlockSplit::kuhn6},
        {.young = 1e6, .poisson = row.poisson, .density = 1000}, row.load * 1e6 * (0.01 / 12) / 1000);
    EXPECT_TRUE(solve_static(body).converged) << "q = " << row.load;
    const auto tip = body.displacements()[at(body.mesh().nearest_vertex({1, 0, 0}))];
    std::printf("q %g nu %g: dx %.5f (%.5f) dy %.5f (%.5f)\n", row.load, row.poisson, -tip.x(), row.dx, -tip.z(),
                row.dy);
    EXPECT_NEAR(-tip.x(), row.dx, 0.015 * row.dx);
    EXPECT_NEAR(-tip.z(), row.dy, 0.015 * row.dy);
  }
}

/// Tip deflection over q L^4 / 8 E I of a beam of length 10 and height 1 under its own small weight, held at one end.
template <class Element>
double bending(Index cells_through, BlockSplit split, double poisson, VolumetricStrain volumetric_strain) {
  auto body = testing::cantilever<double, Element>(
      {.size = {10, 1, 1}, .cells = {10 * cells_through, cells_through, cells_through}, .split = split},
      {.young = 1e4, .poisson = poisson, .density = 1}, 1e-6,
      {.mass = MassModel::lumped, .damping = {}, .volumetric_strain = volumetric_strain});
  EXPECT_TRUE(solve_static(body, {.tolerance = 1e-9}).converged);
  return -body.displacements()[at(body.mesh().nearest_vertex({10, 0.5, 0.5}))].z() / (1e-6 * 1e4 * 12 / (8 * 1e4));
}

/// The same of the converged 3D solid, +-0.001: 10-node elements, 6 cells through the thickness, by the small-strain
/// program described in docs/benchmarks/elements.md. A clamp holds a solid that cannot shrink sideways more firmly.
constexpr double solid_45 = 0.9893, solid_499 = 0.9838;

/// Two cells through the thickness: with mean dilatation, the share of the true deflection that a mesh reaches at
/// nu = .499 is within 3 % of what it reaches at .45; without, 4-node elements lock.
TEST(NearlyIncompressible, BendsAsItDoesAtPointFourFive) {
  const auto drop = []<class Element>(BlockSplit split, VolumetricStrain volumetric_strain) {
    const double at_45 = bending<Element>(2, split, 0.45, volumetric_strain) / solid_45;
    const double at_499 = bending<Element>(2, split, 0.499, volumetric_strain) / solid_499;
    std::printf("order %d, %s, %s: of the solid's deflection %.4f at nu .45, %.4f at .499\n", Element::order,
                split == BlockSplit::kuhn6 ? "kuhn6" : "alternating5",
                volumetric_strain == VolumetricStrain::averaged ? "mean" : "per element", at_45, at_499);
    return std::pair{at_45, at_499};
  };
  for (const BlockSplit split : {BlockSplit::kuhn6, BlockSplit::alternating5}) {
    const auto [tet4_45, tet4_499] = drop.template operator()<Tet4>(split, VolumetricStrain::averaged);
    EXPECT_NEAR(tet4_499, tet4_45, 0.03 * tet4_45);
    EXPECT_GT(tet4_45, 0.6);
    const auto [tet10_45, tet10_499] = drop.template operator()<Tet10>(split, VolumetricStrain::averaged);
    EXPECT_NEAR(tet10_45, 1, 0.01);
    EXPECT_NEAR(tet10_499, 1, 0.01);
  }
  const auto [locked_45, locked_499] = drop.template operator()<Tet4>(BlockSplit::kuhn6, VolumetricStrain::pointwise);
  EXPECT_LT(locked_45, 0.35);
  EXPECT_LT(locked_499, 0.03);
}

}  // namespace
}  // namespace corotet::static_accuracy_test
