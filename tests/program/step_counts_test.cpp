// What the program counts of steps, and how it watches their energy.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "step_counts.hpp"
#include "stress/energy_watch.hpp"

namespace step_counts_test {
namespace {

using namespace corotet;
using program::StepCounts;
using program::stress::EnergyWatch;

TEST(StepCounts, CountEachThingThatAReportSays) {
  const std::vector<std::pair<StepReport, Index StepCounts::*>> cases{
      {{.converged = false}, &StepCounts::unconverged},
      {{.solve = SolveStatus::iteration_limit}, &StepCounts::at_iteration_limit},
      {{.newton_converged = false}, &StepCounts::newton_unconverged},
      {{.inverted_elements = 3}, &StepCounts::inverted},
      {{.warning = StepWarning::strain}, &StepCounts::unreliable}};
  StepCounts all;
  for (const auto& [report, member] : cases) {
    StepCounts one;
    one.add(report);
    one.add(StepReport{.iterations = 7});
    for (const auto& [other, counted] : cases) EXPECT_EQ(one.*counted, counted == member ? 1 : 0);
    EXPECT_EQ(one.accepted, 2);
    EXPECT_EQ(one.max_iterations, 7);
    all.add(one);
  }
  for (const auto& [report, member] : cases) EXPECT_EQ(all.*member, 1);
  EXPECT_EQ(all.accepted, 10);
  EXPECT_EQ(all.max_iterations, 7);
}

/// Nothing else is known of them.
TEST(StepCounts, CountRefusedStepsAlone) {
  StepCounts counts;
  counts.add(StepReport{.error = StepError::overflow, .converged = false, .iterations = 9, .inverted_elements = 1});
  EXPECT_EQ(counts.refused, 1);
  EXPECT_EQ(counts.accepted + counts.unconverged + counts.inverted + counts.max_iterations, 0);
  StepCounts both = counts;
  both.add(counts);
  EXPECT_EQ(both.refused, 2);
}

TEST(EnergyWatch, SeesTheLargestRiseAboveTheLeastBefore) {
  EnergyWatch watch(5);
  EXPECT_EQ(watch.rise(), 0);
  for (const double energy : {4.0, 4.5, 2.0, 3.0, 2.5}) watch.see(energy);
  EXPECT_EQ(watch.rise(), 1);
  EXPECT_EQ(watch.least(), 2);
}

/// Else a run that ends in nothing but NaN would pass each limit.
TEST(EnergyWatch, NoLimitAllowsWhatIsNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity})
    for (const bool at_first : {true, false}) {
      EnergyWatch watch(at_first ? bad : 1);
      watch.see(at_first ? 1 : bad);
      watch.see(0.5);
      EXPECT_FALSE(watch.rise() <= 1e300) << bad << (at_first ? " at first" : " later");
    }
}

}  // namespace
}  // namespace step_counts_test
