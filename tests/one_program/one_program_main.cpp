// One program of sources with different -m flags and NDEBUG, and of shared libraries: no hazard of layout, of functions
// that share a name, or of equal revisions.
#include <gtest/gtest.h>

#include <vector>

#include "one_program/layout.hpp"

corotet::Revision first_module_revision();
corotet::Revision second_module_revision();

namespace corotet::one_program {
namespace {

TEST(OneProgram, HasOneLayout) { EXPECT_EQ(layout(), layout_elsewhere()); }

TEST(OneProgram, PassesBodiesBetweenSourcesOfDifferentFlags) {
  const auto linear = make_bundle<Tet4>(), linear_there = linear_elsewhere();
  EXPECT_LT(step_elsewhere(*linear), 1e-12);
  EXPECT_LT(step_and_compare(*linear_there), 1e-12);
  const auto quadratic = make_bundle<Tet10>(), quadratic_there = quadratic_elsewhere();
  EXPECT_LT(step_elsewhere(*quadratic), 1e-12);
  EXPECT_LT(step_and_compare(*quadratic_there), 1e-12);
  // Fused multiply-add changes the last bits, no more.
  const Vec3<double> here = linear->body.displacements().back(), there = linear_there->body.displacements().back();
  EXPECT_LT((here - there).norm(), 1e-3 * here.norm());
}

TEST(OneProgram, HasNoTwoEqualRevisions) {
  std::vector<Revision> all;
  for (int k = 0; k < 5; ++k)
    for (const Revision& r : {detail::new_revision(), first_module_revision(), second_module_revision()})
      all.push_back(r);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(all[i] == all[j]);
  EXPECT_EQ(first_module_revision().number, second_module_revision().number) << "the case must tell";
}

}  // namespace
}  // namespace corotet::one_program
