// The sparsity pattern finds each pair of neighbours once, and mass is neither lost nor gained.
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/assembly/mass.hpp>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <map>
#include <numeric>
#include <set>

#include "support/bodies.hpp"
#include "support/random.hpp"

namespace corotet::pattern_and_mass_test {
namespace {

template <class T>
class Pattern : public ::testing::Test {};
TYPED_TEST_SUITE(Pattern, testing::AllCases);

TYPED_TEST(Pattern, HoldsEachPairOfNeighboursAndEachContributionOnce) {
  using Element = typename TypeParam::Element;
  constexpr Index n = Element::nodes;
  const auto mesh = testing::block<double, Element>({.cells = {3, 2, 1}});
  const BlockPattern p = BlockPattern::of(mesh.elements(), mesh.vertex_count());

  std::set<std::pair<Index, Index>> expected, found;
  std::map<std::pair<Index, Index>, std::multiset<Index>> contributions;
  for (Index e = 0; e < mesh.element_count(); ++e)
    for (Index a = 0; a < n; ++a)
      for (Index b = 0; b < n; ++b) {
        const std::pair pair{mesh.element(e)[at(a)], mesh.element(e)[at(b)]};
        expected.insert(pair);
        if (pair.first <= pair.second) contributions[pair].insert((e * n + a) * n + b);
      }
  ASSERT_EQ(p.rows(), mesh.vertex_count());
  for (Index i = 0; i < p.rows(); ++i) {
    for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k) {
      found.emplace(i, p.column[at(k)]);
      EXPECT_EQ(p.slot(i, p.column[at(k)]), k);
    }
    EXPECT_EQ(p.column[at(p.diagonal[at(i)])], i);
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(static_cast<std::size_t>(p.blocks()), expected.size());

  ASSERT_EQ(p.upper.size(), contributions.size());
  for (std::size_t u = 0; u < p.upper.size(); ++u) {
    const Index row = p.column[at(p.upper[u].mirror)], column = p.column[at(p.upper[u].slot)];
    EXPECT_LE(row, column);
    EXPECT_EQ(p.slot(row, column), p.upper[u].slot);
    EXPECT_EQ(p.slot(column, row), p.upper[u].mirror);
    const auto begin = p.contribution.begin() + p.contribution_start[u],
               end = p.contribution.begin() + p.contribution_start[u + 1];
    EXPECT_TRUE(std::is_sorted(begin, end)) << "the order of summation must be fixed";
    EXPECT_EQ(std::multiset<Index>(begin, end), (contributions[{row, column}]));
  }
}

template <class T>
class MassLaw : public ::testing::Test {};
TYPED_TEST_SUITE(MassLaw, testing::AllCases);

TYPED_TEST(MassLaw, TotalIsDensityTimesVolumeAndLumpsArePositive) {
  using Scalar = typename TypeParam::Scalar;
  const auto mesh =
      testing::distorted_block<Scalar, typename TypeParam::Element>({.size = {2, 1, 1}, .cells = {4, 2, 2}}, 0.2, 1);
  const BlockPattern p = BlockPattern::of(mesh.elements(), mesh.vertex_count());
  for (const MassModel model : {MassModel::lumped, MassModel::consistent}) {
    const Mass<Scalar> mass(mesh, Material{.density = 700}, model, p);
    EXPECT_NEAR(mass.total(), 1400, 1e-3);
    double sum = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      sum += double(mass.row_sum(v));
      EXPECT_TRUE(model == MassModel::consistent || mass.row_sum(v) > 0) << "vertex " << v;
    }
    EXPECT_NEAR(sum, 1400, 1e-2);
  }
}

/// Each element's mass is lumped in proportion to the diagonal of its consistent matrix: on corners of a Tet10 less
/// than on the middles of its edges.
TYPED_TEST(MassLaw, LumpsAreInProportionToTheConsistentDiagonal) {
  using Scalar = typename TypeParam::Scalar;
  MeshData data;
  data.positions = {{0, 0, 0}, {1, 0.1, 0}, {0.2, 0.9, 0.1}, {0.1, 0.2, 1.1}};
  data.connectivity = {0, 1, 2, 3};
  if (TypeParam::Element::order == 2) {
    data = raise_order(std::move(data));
    testing::Random random(1);
    for (std::size_t v = 4; v < 10; ++v) data.positions[v] += random.vector(0.02);  // no two nodes are alike
  }
  const auto mesh = testing::must(TetMesh<Scalar, typename TypeParam::Element>::create(std::move(data)));
  const BlockPattern p = BlockPattern::of(mesh.elements(), mesh.vertex_count());
  const Mass<Scalar> lumped(mesh, Material{.density = 700}, MassModel::lumped, p),
      consistent(mesh, Material{.density = 700}, MassModel::consistent, p);
  double trace = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) trace += double(consistent.factor(p, v, p.diagonal[at(v)]));
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const double share = double(consistent.factor(p, v, p.diagonal[at(v)])) / trace;
    EXPECT_NEAR(double(lumped.factor(p, v, p.diagonal[at(v)])), share * lumped.total(), 1e-6 * lumped.total());
    EXPECT_EQ(lumped.row_sum(v), lumped.factor(p, v, p.diagonal[at(v)]));
  }
}

/// The consistent matrix integrates products of shape functions: exact for the kinetic energy of any velocity field
/// that the element can represent. Here v = x e_y: energy rho/2 * integral of x^2 = rho/2 * 8/3 over a box of 2 x 1
/// x 1.
TYPED_TEST(MassLaw, ConsistentMassHasTheExactKineticEnergyOfALinearField) {
  using Scalar = typename TypeParam::Scalar;
  const auto mesh =
      testing::distorted_block<Scalar, typename TypeParam::Element>({.size = {2, 1, 1}, .cells = {4, 2, 2}}, 0.2, 1);
  const BlockPattern p = BlockPattern::of(mesh.elements(), mesh.vertex_count());
  const Mass<Scalar> mass(mesh, Material{.density = 700}, MassModel::consistent, p);
  Field<Scalar> v;
  for (const auto& x : mesh.positions()) v.emplace_back(0, x.x(), 0);
  double energy = 0;
  for (Index i = 0; i < mesh.vertex_count(); ++i) energy += 0.5 * double(v[at(i)].dot(mass.row_product(p, i, v)));
  EXPECT_NEAR(energy, 700 * 0.5 * 8 / 3, 0.01);
}

}  // namespace
}  // namespace corotet::pattern_and_mass_test
