// The laws of ReferenceElement.
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/element/tet10.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <gtest/gtest.h>

#include <cmath>

#include "support/random.hpp"

namespace corotet {
namespace {

template <class Element>
std::array<NaturalCoordinates, Element::nodes> node_coordinates() {
  constexpr std::array<NaturalCoordinates, 4> corner{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::array<NaturalCoordinates, Element::nodes> xi{};
  for (std::size_t c = 0; c < 4; ++c) xi[c] = corner[c];
  if constexpr (Element::order == 2)
    for (std::size_t e = 0; e < 6; ++e)
      for (std::size_t i = 0; i < 3; ++i) xi[4 + e][i] = (corner[tet_edges[e].a][i] + corner[tet_edges[e].b][i]) / 2;
  return xi;
}

template <class Element>
class ShapeFunctions : public ::testing::Test {};
using Elements = ::testing::Types<Tet4, Tet10>;
TYPED_TEST_SUITE(ShapeFunctions, Elements);

TYPED_TEST(ShapeFunctions, AreOneAtTheirNodeAndZeroAtTheOthers) {
  const auto xi = node_coordinates<TypeParam>();
  for (std::size_t b = 0; b < xi.size(); ++b) {
    const auto n = TypeParam::shape(xi[b]);
    for (std::size_t a = 0; a < xi.size(); ++a) EXPECT_NEAR(n[a], a == b ? 1 : 0, 1e-15);
  }
}

/// Of any polynomial up to the element's order, hence of constants (the sum is 1) and of positions.
TYPED_TEST(ShapeFunctions, ReproducePolynomialsOfTheirOrderWithTheirGradients) {
  testing::Random random(1);
  const Vec3<double> linear = random.vector();
  const Mat3<double> quadratic = TypeParam::order == 2 ? random.matrix() : Mat3<double>::Zero();
  const auto value = [&](const Vec3<double>& x) { return 0.7 + linear.dot(x) + x.dot(quadratic * x); };
  const auto nodes = node_coordinates<TypeParam>();
  for (int trial = 0; trial < 100; ++trial) {
    const NaturalCoordinates xi{random.uniform(), random.uniform(), random.uniform()};
    const Vec3<double> x = Vec3<double>::load(xi.data());
    const auto n = TypeParam::shape(xi);
    const auto g = TypeParam::gradient(xi);
    double sum = 0;
    Vec3<double> gradient = Vec3<double>::Zero();
    for (std::size_t a = 0; a < n.size(); ++a) {
      const double nodal = value(Vec3<double>::load(nodes[a].data()));
      sum += n[a] * nodal;
      gradient += Vec3<double>::load(g[a].data()) * nodal;
    }
    EXPECT_NEAR(sum, value(x), 1e-13);
    EXPECT_LT((gradient - linear - (quadratic + quadratic.transpose()) * x).norm(), 1e-12);
  }
}

/// Integral of x^i y^j z^k over the reference tetrahedron: i! j! k! / (i+j+k+3)!.
template <class Rule>
void expect_exact(const Rule& rule, int degree) {
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j)
      for (int k = 0; i + j + k <= degree; ++k) {
        double sum = 0;
        for (const QuadraturePoint& p : rule)
          sum += p.weight * std::pow(p.xi[0], i) * std::pow(p.xi[1], j) * std::pow(p.xi[2], k);
        EXPECT_NEAR(sum, factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3), 1e-15)
            << "x^" << i << " y^" << j << " z^" << k;
      }
}

TEST(Quadrature, IntegratesPolynomialsOfItsDegree) {
  expect_exact(quadrature::degree1, 1);
  expect_exact(quadrature::degree2, 2);
  expect_exact(quadrature::degree5, 5);
}

TEST(TetFaces, TurnOutward) {
  const auto x = node_coordinates<Tet4>();
  const auto point = [&](std::size_t c) -> Vec3<double> { return Vec3<double>::load(x[c].data()); };
  for (std::size_t f = 0; f < 4; ++f) {
    const auto [a, b, c] = tet_faces[f];
    EXPECT_LT((point(b) - point(a)).cross(point(c) - point(a)).dot(point(f) - point(a)), 0) << "face " << f;
  }
}

}  // namespace
}  // namespace corotet
