#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "program_runner.hpp"
#include "stress/pairwise.hpp"

namespace run_command_test {
namespace {

using corotet::testing::Outcome;
using corotet::testing::ProgramTest;

class RunCommand : public ProgramTest {
 protected:
  /// Runs `scene` into `folder` and returns its summary.
  Json run(const std::string& scene, const std::string& options = "", const std::string& folder = "out") {
    write("scene.json", scene);
    const Outcome outcome = corotet("run scene.json -o " + folder + " " + options);
    EXPECT_EQ(outcome.exit_code, 0) << scene << "\n" << outcome.err;
    return outcome.exit_code == 0 ? read_json(folder + "/summary.json") : Json();
  }
};

// The beam that the peers were measured on (mesh S): one warped solve a step, lumped mass, tight tolerance. The
// displacements come from an independent numpy program.
TEST_F(RunCommand, MeshSReachesTheReferenceTipDisplacements) {
  must("mesh beam --cells 20 4 4 --split kuhn6 -o beam.msh");
  const Json summary = run(R"({"mesh": "beam.msh", "scalar": "double", "pins": [{"box": [[-1e-6,-1,-1],[1e-6,1,1]]}],
    "solver": {"name": "cholesky", "tolerance": 1e-12}, "probes": [{"nearest": [1, 0.1, 0.1]}], "steps": 60})");
  EXPECT_EQ(summary["vertices"], 525);
  EXPECT_EQ(summary["elements"], 1920);
  EXPECT_EQ(summary["pinned_vertices"], 25);
  const auto rows = read_probes("out/probes.csv");
  ASSERT_EQ(rows.size(), 61U);
  EXPECT_NEAR(rows[15].z - rows[0].z, -0.395640, 1e-5);
  EXPECT_NEAR(rows[30].z - rows[0].z, -0.774105, 1e-5);
  EXPECT_NEAR(rows[60].z - rows[0].z, -0.205312, 1e-5);
}

TEST_F(RunCommand, WritesEveryFileAndKey) {
  must("mesh beam --cells 4 1 1 --order 2 -o beam.msh");
  must("mesh beam --cells 8 2 2 -o skin.obj");
  const Json summary = run(R"({"mesh": "beam.msh", "pins": [{"box": [[0,0,0],[0,1,1]]}], "surface": "skin.obj",
    "probes": [{"nearest": [1,0,0]}, {"nearest": [0,0,0]}], "steps": 5, "frames": {"every": 2}})");
  for (const char* key : {"vertices", "elements", "setup_ms", "cpu_ms_per_step", "assembly_ms", "solve_ms", "residual",
                          "inverted_elements", "peak_rss_mb", "spmv_us"})
    EXPECT_TRUE(summary[key].is_number()) << key;
  for (const char* key : {"median", "min", "p99"}) EXPECT_TRUE(summary["step_ms"][key].is_number()) << key;
  for (const char* key : {"mean", "max"}) EXPECT_TRUE(summary["iterations"][key].is_number()) << key;
  EXPECT_LE(summary["step_ms"]["min"], summary["step_ms"]["median"]);
  EXPECT_LE(summary["step_ms"]["median"], summary["step_ms"]["p99"]);
  for (const char* key : {"setup_ms", "assembly_ms", "solve_ms", "peak_rss_mb", "spmv_us"})
    EXPECT_GT(summary[key], 0) << key;
  EXPECT_EQ(
      summary["status"],
      Json::parse(
          R"({"converged":5,"unconverged":0,"newton_unconverged":0,"untrusted":0,"with_inverted_elements":0,"refused":0})"));
  EXPECT_EQ(summary["completed"], true);
  EXPECT_EQ(summary["steps"], 5);
  EXPECT_EQ(summary["order"], 2);
  EXPECT_EQ(summary["surface"]["vertices_outside"], 0);

  const auto rows = read_probes("out/probes.csv");
  ASSERT_EQ(rows.size(), 2U * 6);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_DOUBLE_EQ(rows[i].t, static_cast<double>(i / 2) / 60);
    EXPECT_EQ(rows[i].probe, static_cast<double>(i % 2));
    if (i % 2 == 1) {
      EXPECT_EQ(std::abs(rows[i].x) + std::abs(rows[i].y) + std::abs(rows[i].z), 0) << "pinned";
    }
  }
  EXPECT_LT(rows[10].z, -0.001) << "the tip sinks";

  const std::vector<double> last = read_numbers("out/final.txt");
  ASSERT_EQ(last.size(), 3 * summary["vertices"].get<std::size_t>());
  const auto tip = 3 * summary["probes"][0]["vertex"].get<std::size_t>();
  EXPECT_EQ(last[tip + 2], rows[10].z) << "the same number in both files";

  for (const char* series : {"volume", "surface"}) {
    const std::string list = read(std::string("out/") + series + ".pvd");
    for (const char* frame : {"_000000", "_000001", "_000002"}) {  // steps 0, 2 and 4
      const std::string name = std::string("frames/") + series + frame + ".vtu";
      EXPECT_NE(list.find('"' + name + '"'), std::string::npos) << name;
      EXPECT_TRUE(exists("out/" + name)) << name;
    }
    EXPECT_FALSE(exists(std::string("out/frames/") + series + "_000003.vtu"));
  }
  EXPECT_NE(read("out/frames/surface_000001.vtu").find("\"normal\""), std::string::npos);

  // A second run into the same folder leaves nothing of the first.
  run(R"({"mesh": "beam.msh", "steps": 1})");
  EXPECT_FALSE(exists("out/volume.pvd") || exists("out/frames/volume_000000.vtu"));
  EXPECT_EQ(read("out/probes.csv"), "t,probe,x,y,z\n");
}

TEST_F(RunCommand, SameBytesAgainAndWithAnyNumberOfThreads) {
  must("mesh beam --cells 20 8 8 -o beam.msh");  // enough for several tasks in each loop
  for (const std::string method : {"pcg", "cholesky"}) {
    const std::string scene = R"({"mesh": "beam.msh", "pins": [{"box": [[0,0,0],[0,1,1]]}], "steps": 3,
      "solver": {"name": ")" + method +
                              R"("}, "damping": {"stiffness": 0.001}})";
    run(scene, "", "first");
    const std::string first = read("first/final.txt");
    ASSERT_FALSE(first.empty());
    for (const char* threads : {"1", "2", "4"}) {
      run(scene, std::string("--threads ") + threads, "again");
      EXPECT_EQ(read("again/final.txt"), first) << method << ", " << threads << " threads";
    }
  }
}

/// Each two values of any two settings in a scene.
TEST_F(RunCommand, EveryChoiceRuns) {
  must("mesh beam --cells 4 1 1 -o beam.msh");
  struct Setting {
    const char* key;
    std::vector<const char*> values;
  };
  const std::vector<Setting> settings{
      {"scalar", {"float", "double"}},
      {"order", {"1", "2"}},
      {"rotation", {"polar", "gram_schmidt", "identity"}},
      {"rotation_site", {"point", "element"}},
      {"mass", {"lumped", "consistent"}},
      {"preconditioner", {"auto", "jacobi", "block_jacobi", "rigid_aggregates", "warped_cholesky"}}};
  std::vector<std::size_t> levels;
  for (const Setting& setting : settings) levels.push_back(setting.values.size());
  for (const auto& choice : corotet::program::stress::pairwise(levels, 1)) {
    Json scene = Json::parse(R"({"mesh": "beam.msh", "steps": 3, "pins": [{"box": [[0,0,0],[0,1,1]]}],
                                 "solver": {"name": "pcg"}})");
    for (std::size_t s = 0; s < settings.size(); ++s) {
      const std::string key = settings[s].key, value = settings[s].values[choice[s]];
      if (key == "preconditioner")
        scene["solver"][key] = value;
      else if (key == "order")
        scene[key] = std::stoi(value);
      else
        scene[key] = value;
    }
    const Json summary = run(scene.dump());
    for (const char* key : {"scalar", "order", "rotation", "rotation_site", "mass"})
      EXPECT_EQ(summary[key], scene[key]) << scene;
    EXPECT_EQ(summary["solver"]["name"], "pcg") << scene;
    const Json asked = scene["solver"]["preconditioner"], used = summary["solver"]["preconditioner"];
    EXPECT_TRUE(asked == "auto" ? used != "auto" : used == asked) << scene << summary["solver"];
  }
  for (const char* order : {"1", "2"}) {
    const Json summary = run(std::string(R"({"mesh": "beam.msh", "steps": 3, "pins": [{"box": [[0,0,0],[0,1,1]]}],
        "material": {"poisson": 0.45}, "dilatation": "mean", "order": )") +
                             order + "}");
    EXPECT_EQ(summary["dilatation"], "mean");
    EXPECT_EQ(summary["status"]["converged"], 3);
  }
}

// A free body under gravity: backward Euler falls by g h^2 n (n + 1) / 2 from rest, whatever the body.
TEST_F(RunCommand, InitialStateIsTakenAndGravityPulls) {
  must("mesh block --cells 1 1 1 -o block.msh");
  std::string positions, velocities;
  for (const int z : {0, 1})
    for (const int y : {0, 1})
      for (const int x : {0, 1}) {
        positions += std::to_string(x + 5) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
        velocities += "0 3 0\n";
      }
  write("x0.txt", positions);
  write("v0.txt", velocities);
  run(R"({"mesh": "block.msh", "scalar": "double", "gravity": [0, 0, -10], "steps": 10,
    "integrator": {"name": "implicit_euler", "dt": 0.01, "newton": 1}, "solver": {"name": "cholesky"},
    "initial": {"positions": "x0.txt", "velocities": "v0.txt"}, "probes": [{"nearest": [0, 0, 0]}]})");
  const auto rows = read_probes("out/probes.csv");
  ASSERT_EQ(rows.size(), 11U);
  EXPECT_DOUBLE_EQ(rows[0].x, 5);
  EXPECT_NEAR(rows[10].x, 5, 1e-9);
  EXPECT_NEAR(rows[10].y, 3 * 0.1, 1e-9);
  EXPECT_NEAR(rows[10].z, -10 * 0.01 * 0.01 * 10 * 11 / 2, 1e-9);
}

// A free stiff block, pushed and turned: Newton's laws for it as a whole. Backward Euler from rest goes F/m h^2 n (n +
// 1) / 2 far, and turns by T/I of the same; I = m a^2 / 6 of a cube.
TEST_F(RunCommand, ForcesAndTorquesMoveAFreeBlock) {
  must("mesh block --cells 4 4 4 --corner -0.5 -0.5 -0.5 -o block.msh");
  for (const int order : {1, 2}) {
    run(R"({"mesh": "block.msh", "order": )" + std::to_string(order) +
        R"(, "scalar": "double", "mass": "consistent", "gravity": [0,0,0], "steps": 10, "material": {"young": 1e9, "density": 1000},
      "integrator": {"dt": 0.01}, "solver": {"tolerance": 1e-10}, "forces": [{"box": [[-1,-1,-1],[1,1,1]],
      "total": [1000, 0, 0], "torque": [0, 0, 500]}], "probes": [{"nearest": [0,0,0]}, {"nearest": [0.5,0,0]}]})");
    const auto rows = read_probes("out/probes.csv");
    ASSERT_EQ(rows.size(), 22U);
    const double far = 0.01 * 0.01 * 10 * 11 / 2;
    EXPECT_NEAR(rows[20].x, 1000 / 1000. * far, 1e-6) << order;
    EXPECT_NEAR(rows[20].y, 0, 1e-6) << order;
    EXPECT_NEAR((rows[21].y - rows[20].y) / 0.5, 500 / (1000 / 6.) * far, 1e-5) << order;
  }
}

TEST_F(RunCommand, InitialMotionIsThatOfARigidBody) {
  must("mesh block --cells 1 1 1 --corner 4.5 -0.5 -0.5 -o block.msh");
  run(R"({"mesh": "block.msh", "gravity": [0,0,0], "steps": 1, "integrator": {"dt": 0.001},
    "initial": {"velocity": [1, 0, 0], "angular_velocity": [0, 0, 2]}, "probes": [{"nearest": [5.5, 0.5, 0.5]}]})");
  const auto rows = read_probes("out/probes.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_NEAR((rows[1].x - rows[0].x) / 0.001, 1 - 2 * 0.5, 2e-2);
  EXPECT_NEAR((rows[1].y - rows[0].y) / 0.001, 2 * 0.5, 2e-2);
}

TEST_F(RunCommand, PinsFollowTheirPath) {
  must("mesh beam --cells 4 1 1 -o beam.msh");
  run(R"({"mesh": "beam.msh", "gravity": [0,0,0], "steps": 4, "integrator": {"dt": 0.25}, "probes": [{"nearest": [0,0,0]}],
    "pins": [{"box": [[0,0,0],[0,1,1]], "path": [[0, 0,0,0], [0.5, 0,0,0.125], [0.75, 0.5,0,0]]}]})");
  const auto rows = read_probes("out/probes.csv");
  ASSERT_EQ(rows.size(), 5U);
  const double x[] = {0, 0, 0, 0.5, 0.5}, z[] = {0, 0.0625, 0.125, 0, 0};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(rows[i].x, x[i], 1e-7) << i;
    EXPECT_NEAR(rows[i].z, z[i], 1e-7) << i;
  }
}

// In float, the same displacements at 1e6 m as at the origin: to float rounding of the displacement, not of the
// position (0.06 m there). The offset is a power of two, so that the file's doubles are exact.
TEST_F(RunCommand, FloatKeepsItsDigitsFarFromTheOrigin) {
  must("mesh beam --cells 4 1 1 --size 1 0.25 0.25 -o near.msh");
  must("mesh beam --cells 4 1 1 --size 1 0.25 0.25 --corner 1048576 0 0 -o far.msh");
  const std::string rest = R"("pins": [{"box": [[X,0,0],[X,1,1]]}], "probes": [{"nearest": [1048577,0,0]}], "steps": 20,
    "solver": {"name": "cholesky"}})";
  const auto with_x = [&](const std::string& x) {
    std::string text = rest;
    for (std::size_t at; (at = text.find('X')) != std::string::npos;) text.replace(at, 1, x);
    return text;
  };
  run(R"({"mesh": "near.msh", )" + with_x("0"), "", "near");
  run(R"({"mesh": "far.msh", )" + with_x("1048576"), "", "far");
  const auto near_rows = read_probes("near/probes.csv"), far_rows = read_probes("far/probes.csv");
  ASSERT_EQ(near_rows.size(), 21U);
  ASSERT_EQ(far_rows.size(), 21U);
  EXPECT_LT(near_rows[20].z, -0.02);
  for (std::size_t i = 0; i < 21; ++i) {
    EXPECT_NEAR(far_rows[i].z, near_rows[i].z, 1e-5) << i;
    EXPECT_NEAR(far_rows[i].x - 1048576, near_rows[i].x, 1e-5) << i;
  }
}

TEST_F(RunCommand, RefusedStepEndsTheRunAndSaysWhy) {
  must("mesh beam --cells 2 1 1 -o beam.msh");
  run(R"({"mesh": "beam.msh", "steps": 1})");
  write("scene.json",
        R"({"mesh": "beam.msh", "gravity": [0, 0, -3e38], "steps": 3})");  // its force is infinite in float
  const Outcome outcome = corotet("run scene.json -o out");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("step 1 of 3 was refused: "), std::string::npos) << outcome.err;
  EXPECT_FALSE(exists("out/final.txt")) << "nor is that of the run before left";
  const Json summary = read_json("out/summary.json");
  EXPECT_EQ(summary["completed"], false);
  EXPECT_EQ(summary["status"]["refused"], 1);
  EXPECT_EQ(summary["steps"], 0);
}

// BDF2 with Newton's method: what was asked for is in the summary, and what it came to; too few solves are warned of.
TEST_F(RunCommand, NewtonIsReported) {
  must("mesh beam --cells 8 2 2 -o beam.msh");
  const auto scene = [](const std::string& integrator) {
    return R"({"mesh": "beam.msh", "pins": [{"box": [[0,0,0],[0,1,1]]}], "steps": 5, "integrator": {)" + integrator +
           "}}";
  };
  run(scene(R"("name": "bdf2", "newton": 9, "newton_tolerance": 0.01, "tangent": "exact")"));
  Json summary = read_json("out/summary.json");
  EXPECT_EQ(summary["integrator"]["name"], "bdf2");
  EXPECT_EQ(summary["integrator"]["newton"], 9);
  EXPECT_EQ(summary["integrator"]["newton_tolerance"], 0.01);
  EXPECT_EQ(summary["integrator"]["tangent"], "exact");
  EXPECT_EQ(summary["status"]["newton_unconverged"], 0);
  EXPECT_GE(summary["newton"]["iterations"]["mean"], 1);
  EXPECT_LE(summary["newton"]["iterations"]["max"], 5);
  EXPECT_GT(summary["newton"]["residual"], 0);
  EXPECT_LE(summary["newton"]["residual"], 0.01);

  write("scene.json", scene(R"("newton": 2, "newton_tolerance": 1e-7, "tangent": "plain")"));
  const Outcome outcome = corotet("run scene.json -o out");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("Newton's method stopped before its tolerance in "), std::string::npos) << outcome.err;
  summary = read_json("out/summary.json");
  EXPECT_GT(summary["status"]["newton_unconverged"], 0);
  EXPECT_EQ(summary["newton"]["iterations"]["max"], 2);
}

// The held end is pushed into the body within one step, faster than sound in it: kept and warned of, the end of the
// run, or gone through in smaller steps.
TEST_F(RunCommand, TheSceneChoosesWhatBecomesOfUntrustedSteps) {
  must("mesh beam --cells 8 2 2 -o beam.msh");
  const auto scene = [](const std::string& untrusted) {
    return R"({"mesh": "beam.msh", "steps": 3, "integrator": {"dt": 0.02, "untrusted": ")" + untrusted +
           R"("}, "pins": [{"box": [[0,0,0],[0,1,1]], "path": [[0.02,0,0,0],[0.04,0.5,0,0]]}]})";
  };
  const auto outcome_of = [&](const std::string& untrusted) {
    write("scene.json", scene(untrusted));
    return corotet("run scene.json -o out");
  };
  const Outcome accepted = outcome_of("accept");
  EXPECT_EQ(accepted.exit_code, 0);
  EXPECT_NE(accepted.err.find("of 3 steps cannot be trusted"), std::string::npos) << accepted.err;
  Json summary = read_json("out/summary.json");
  EXPECT_EQ(summary["integrator"]["untrusted"], "accept");
  EXPECT_GT(summary["status"]["untrusted"], 0);
  EXPECT_EQ(summary["sub_steps"]["max"], 1);

  const Outcome refused = outcome_of("refuse");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("step 2 of 3 was refused: "), std::string::npos) << refused.err;

  EXPECT_EQ(outcome_of("divide").exit_code, 0);
  summary = read_json("out/summary.json");
  EXPECT_GT(summary["sub_steps"]["max"], 1);
  EXPECT_LE(summary["sub_steps"]["max"], 16);
}

TEST_F(RunCommand, UnconvergedStepsAreCountedAndWarnedOf) {
  must("mesh beam --cells 8 2 2 -o beam.msh");
  const std::string scene = R"({"mesh": "beam.msh", "pins": [{"box": [[0,0,0],[0,1,1]]}], "steps": 3,
    "solver": {"name": "pcg", "preconditioner": "block_jacobi", "max_iterations": 2}})";
  write("scene.json", scene);
  const Outcome outcome = corotet("run scene.json -o out");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("in 3 of 3 steps"), std::string::npos) << outcome.err;
  const Json summary = read_json("out/summary.json");
  EXPECT_EQ(summary["status"]["unconverged"], 3);
  EXPECT_EQ(summary["iterations"]["max"], 2);
  EXPECT_GT(summary["residual"], 1e-3);
}

TEST_F(RunCommand, PathsAreRelativeToTheSceneAndOptionsOverrideIt) {
  std::filesystem::create_directories(file("scenes/meshes"));
  must("mesh beam --cells 2 1 1 -o scenes/meshes/beam.msh");
  write("scenes/scene.json", R"({"mesh": "meshes/beam.msh", "steps": 1000000})");
  must("run scenes/scene.json -o deep/out --steps 2 --frames-every 1");
  EXPECT_EQ(read_json("deep/out/summary.json")["steps"], 2);
  EXPECT_TRUE(exists("deep/out/frames/volume_000002.vtu"));
  must("run scenes/scene.json -o deep/out --steps 0");
  EXPECT_TRUE(read_json("deep/out/summary.json")["step_ms"]["median"].is_null());
}

TEST_F(RunCommand, TheSceneOfTheDemoRuns) {
  must("run '" COROTET_SCENES "/beam.json' -o out --steps 2 --frames-every 1");
  EXPECT_TRUE(exists("out/frames/surface_000002.vtu"));
  EXPECT_EQ(read_json("out/summary.json")["status"]["converged"], 2);
}

}  // namespace
}  // namespace run_command_test
