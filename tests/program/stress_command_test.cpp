#include <string>
#include <utility>

#include "program_runner.hpp"

namespace stress_command_test {
namespace {

using corotet::testing::Outcome;
using corotet::testing::ProgramTest;

class StressCommand : public ProgramTest {};

/// What the default configuration passes stays passed; docs/benchmarks/hard_cases.md holds the whole table.
TEST_F(StressCommand, TheDefaultsPassCasesThatBreakOthers) {
  const Outcome outcome = corotet(
      "stress flat line stretch hang-.1 spin-.1-1 bad-step bad-file far step-.1 step-1 "
      "sliver "
      "cap wedge needle --quick --only euler -o out");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_NE(read("out/stress.md").find("| stretch-8 | pass |"), std::string::npos);
}

/// The same of contact.
TEST_F(StressCommand, TheDefaultsPassHardContact) {
  const Outcome outcome =
      corotet("stress contact-corner contact-plate contact-deep contact-slide contact-led --quick --only euler tet4");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

/// A stretched bar buzzes with the plain tangent.
TEST_F(StressCommand, FailuresAreShownAsFailures) {
  const Outcome stretch = corotet("stress stretch-4 --quick --only tet4 euler --tangent plain -o out");
  EXPECT_EQ(stretch.exit_code, 1);
  EXPECT_NE(stretch.out.find("FAIL1/1"), std::string::npos) << stretch.out;
  EXPECT_NE(read("out/stress.csv").find("stretch-4,tet4,float,euler,auto,nu=.3,0,"), std::string::npos);
  EXPECT_NE(stretch.out.find("speed, m/s"), std::string::npos) << stretch.out;
}

TEST_F(StressCommand, ListsItsCasesAndNamesWhatItDoesNotKnow) {
  const Outcome list = corotet("stress --list");
  EXPECT_EQ(list.exit_code, 0);
  for (const char* name : {"flat-60", "random", "twist-1", "ratio-heavy", "incompressible", "long-rest", "bad-body"})
    EXPECT_NE(list.out.find(name), std::string::npos) << name;
  for (const auto& [arguments, expected] :
       {std::pair{"stress flattened", "flattened"}, std::pair{"stress flat --only tet5", "--only"},
        std::pair{"stress flat --quick --full", "--full"}, std::pair{"stress flat --tangent best", "--tangent"}}) {
    const Outcome outcome = corotet(arguments);
    EXPECT_NE(outcome.exit_code, 0) << arguments;
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << arguments << "\n" << outcome.err;
  }
}

}  // namespace
}  // namespace stress_command_test
