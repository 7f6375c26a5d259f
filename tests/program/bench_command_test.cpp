#include <cstdlib>
#include <string>
#include <utility>

#include "program_runner.hpp"

namespace bench_command_test {
namespace {

using corotet::testing::Outcome;
using corotet::testing::ProgramTest;

class BenchCommand : public ProgramTest {};

/// No times are tested, only that they are there; errors are, for they do not depend on the machine.
TEST_F(BenchCommand, PrintsCostsWithTheirErrors) {
  must("mesh block --cells 3 2 2 -o block.msh");
  const Outcome outcome = corotet("bench XS block.msh --steps 8 --csv table.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("rigid_aggregates"), std::string::npos) << outcome.out;  // what auto begins with
  const auto rows = read_csv("table.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("elements"), "240");
  EXPECT_EQ(rows[1].at("mesh"), "block.msh");
  for (const auto& row : rows) {
    for (const char* column :
         {"SpMV_us", "step_ms", "step_SpMV", "evaluate_SpMV", "assemble_SpMV", "solve_SpMV", "predicted_SpMV"})
      EXPECT_GT(std::atof(row.at(column).c_str()), 0) << column;
    EXPECT_GT(std::atof(row.at("error").c_str()), 0);
    EXPECT_LT(std::atof(row.at("error").c_str()), 1.5e-3);
  }
}

/// Each situation has its row, contacts only where there is a floor in reach.
TEST_F(BenchCommand, SetsContactBesideStepsWithoutIt) {
  must("bench --contact XS --steps 8 --csv table.csv");
  const auto rows = read_csv("table.csv");
  ASSERT_EQ(rows.size(), 5U);
  for (const auto& row : rows) {
    EXPECT_GT(std::atof(row.at("ratio").c_str()), 0);
    EXPECT_GE(std::atof(row.at("worst_ms").c_str()), std::atof(row.at("step_ms").c_str()));
    if (row.at("situation") == "out of reach")
      EXPECT_EQ(row.at("contacts"), "0");
    else
      EXPECT_NE(row.at("contacts"), "0") << row.at("situation");
    if (row.at("situation") == "rest") {
      EXPECT_EQ(row.at("contacts"), "33");
    }
  }
}

TEST_F(BenchCommand, TighterTolerancesGiveSmallerErrors) {
  const auto error = [&](const std::string& options) {
    must("bench XS --steps 8 --csv table.csv " + options);
    return std::atof(read_csv("table.csv").at(0).at("error").c_str());
  };
  for (const std::string order : {"--order 1", "--order 2"})
    EXPECT_LT(error(order + " --tolerance 1e-4"), 0.3 * error(order + " --tolerance 1e-2"));
}

TEST_F(BenchCommand, SaysWhatItCannotDo) {
  for (const auto& [arguments, expected] :
       {std::pair{"bench nothing.msh", "nothing.msh"}, std::pair{"bench XS --tolerance 2", "--tolerance"},
        std::pair{"bench XS --steps 8 --csv no/such/folder.csv", "no/such/folder.csv"},
        std::pair{"bench XS --preconditioner best", "--preconditioner"}}) {
    const Outcome outcome = corotet(arguments);
    EXPECT_NE(outcome.exit_code, 0) << arguments;
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << arguments << "\n" << outcome.err;
  }
}

}  // namespace
}  // namespace bench_command_test
