#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "program_runner.hpp"

namespace tune_command_test {
namespace {

using corotet::testing::Outcome;
using corotet::testing::ProgramTest;

class TuneCommand : public ProgramTest {
 protected:
  TuneCommand() {
    std::filesystem::create_directories(file("scenes"));
    must("mesh beam --cells 4 2 2 --size 1 0.25 0.25 -o scenes/beam.msh");
    must("mesh beam --cells 4 2 2 --size 1 0.25 0.25 -o scenes/skin.obj");
    write("scenes/beam.json", R"({"mesh": "beam.msh", "pins": [{"box": [[0,0,0],[0,1,1]]}], "surface": "skin.obj",
      "material": {"young": 2e5}, "probes": [{"nearest": [1,0.125,0.125]}], "steps": 12, "frames": {"every": 3}})");
  }

  /// How far the probe has gone at the end, z.
  [[nodiscard]] double drop(const std::string& scene) const {
    must("run " + scene + " -o out");
    const auto rows = read_probes("out/probes.csv");
    EXPECT_GE(rows.size(), 2U);
    return rows.size() < 2 ? 0 : rows.back().z - rows.front().z;
  }

  /// The number behind `word` in what tune printed.
  static double printed(const Outcome& outcome, const std::string& word) {
    const std::size_t at = outcome.out.find(word);
    EXPECT_NE(at, std::string::npos) << outcome.out;
    return at == std::string::npos ? -1 : std::atof(outcome.out.c_str() + at + word.size());
  }
};

TEST_F(TuneCommand, WritesASceneThatRunsAndIsAsAccurateAsAsked) {
  const Outcome outcome = corotet("tune scenes/beam.json --error 0.05 -o tuned.json --quick --minutes 5");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_LE(printed(outcome, "measured"), 5);
  EXPECT_GT(printed(outcome, "predicted"), 0);
  EXPECT_LT(printed(outcome, "predicted"), 10);
  EXPECT_GT(printed(outcome, "the scene"), 10) << "too easy: the scene was good enough as it was";

  const Json tuned = read_json("tuned.json");
  EXPECT_EQ(tuned["surface"], "scenes/skin.obj") << "relative to the new file";
  EXPECT_NEAR(tuned["steps"].get<int>() * tuned["integrator"]["dt"].get<double>(), 12 / 60., 1e-9);
  EXPECT_EQ(tuned["material"]["young"], 2e5) << "what was not tuned stays";

  // By other means: the tip's fall against that of a finer mesh with shorter steps.
  must("mesh beam --cells 8 2 2 --size 1 0.25 0.25 -o fine.msh");
  write("fine.json", R"({"mesh": "fine.msh", "order": 2, "scalar": "double", "pins": [{"box": [[0,0,0],[0,1,1]]}],
    "material": {"young": 2e5}, "probes": [{"nearest": [1,0.125,0.125]}], "steps": 192,
    "integrator": {"dt": 0.0010416666666666667}, "solver": {"tolerance": 1e-8}})");
  const double fine = drop("fine.json"), reached = drop("tuned.json");
  EXPECT_LT(std::abs(reached / fine - 1), 0.06);
}

TEST_F(TuneCommand, StaysWithinABudget) {
  const Outcome outcome = corotet("tune scenes/beam.json --budget-ms 1000 -o tuned.json --quick --minutes 5");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_LT(printed(outcome, "measured"), printed(outcome, "the scene")) << "with so much time it can do better";
  must("run tuned.json -o out");
  // No step takes a nanosecond: nothing is written.
  std::filesystem::remove(file("tuned.json"));
  const Outcome missed = corotet("tune scenes/beam.json --budget-ms 1e-6 -o tuned.json --quick --minutes 5");
  EXPECT_EQ(missed.exit_code, 1);
  EXPECT_NE(missed.err.find("a step within 1e-06 ms is not reached; the nearest: "), std::string::npos) << missed.err;
  EXPECT_FALSE(exists("tuned.json"));
}

TEST_F(TuneCommand, SaysWhatItCannotDo) {
  for (const auto& [arguments, expected] :
       {std::pair{"tune scenes/beam.json -o tuned.json", "--error and --budget-ms"},
        std::pair{"tune scenes/beam.json --error 0.1 --budget-ms 1 -o tuned.json", "--error"},
        std::pair{"tune scenes/beam.json --error 0.1", "--output"},
        std::pair{"tune scenes/beam.json --error 0.1 -o tuned.txt", "must end with .json"},
        std::pair{"tune scenes/beam.json --error 0.1 -o scenes/beam.json", "replace the scene itself"},
        std::pair{"tune nothing.json --error 0.1 -o tuned.json", "nothing.json"},
        std::pair{"tune scenes/beam.json --error 1e-9 -o tuned.json --quick --minutes 5",
                  "is not reached; the nearest: "}}) {
    const Outcome outcome = corotet(arguments);
    EXPECT_NE(outcome.exit_code, 0) << arguments;
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << arguments << "\n" << outcome.err;
    EXPECT_FALSE(exists("tuned.json") || exists("tuned.msh")) << arguments;
  }
}

}  // namespace
}  // namespace tune_command_test
