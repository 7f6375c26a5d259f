#include <algorithm>
#include <cmath>
#include <string>

#include "program_runner.hpp"

namespace mesh_command_test {
namespace {

using corotet::testing::Outcome;
using corotet::testing::ProgramTest;

class MeshCommand : public ProgramTest {
 protected:
  Json check(const std::string& mesh, int exit_code = 0) {
    const Outcome outcome = corotet("check --json --worst 3 " + mesh);
    EXPECT_EQ(outcome.exit_code, exit_code) << mesh << "\n" << outcome.out << outcome.err;
    return Json::parse(outcome.out);
  }
};

TEST_F(MeshCommand, MakesWhatWasAskedFor) {
  for (const int order : {1, 2})
    for (const std::string split : {"kuhn6", "alternating5"}) {
      must("mesh block --size 2 3 4 --corner -1 -2 -3 --cells 3 2 1 --order " + std::to_string(order) + " --split " +
           split + " -o block.msh");
      const Json found = check("block.msh");
      EXPECT_EQ(found["elements"], 3 * 2 * (split == "kuhn6" ? 6 : 5));
      EXPECT_EQ(found["nodes_per_element"], order == 1 ? 4 : 10);
      EXPECT_NEAR(found["total_volume"].get<double>(), 24, 1e-12);
      EXPECT_EQ(found["box"], Json::parse("[[-1,-2,-3],[1,1,1]]"));
      EXPECT_EQ(found["flipped_elements"], 0);
      EXPECT_TRUE(found["usable_in_float"]);
    }
}

// Every variant of the file holds the same mesh: written once more in the first form it is the same file.
TEST_F(MeshCommand, FormatsConvertIntoEachOther) {
  must("mesh beam --order 2 -o a.msh");
  const std::string original = read("a.msh");
  for (const char* variant : {"--msh-version 2.2", "--msh-version 2.2 --encoding binary", "--encoding binary"}) {
    must(std::string("mesh --from a.msh -o b.msh ") + variant);
    EXPECT_NE(read("b.msh"), original) << variant;
    must("mesh --from b.msh -o c.msh");
    EXPECT_EQ(read("c.msh"), original) << variant;
  }
  must("mesh beam -o linear.msh");
  must("mesh --from linear.msh --order 2 -o raised.msh");
  EXPECT_EQ(read("raised.msh"), original);
  must("mesh --from a.msh --order 1 -o lowered.msh");
  EXPECT_EQ(read("lowered.msh"), read("linear.msh"));
  must("mesh --from a.msh -o a.vtu --encoding ascii");
  EXPECT_NE(read("a.vtu").find("UnstructuredGrid"), std::string::npos);
  must("mesh beam --cells 2 1 1 -o skin.obj");
  const std::string skin = read("skin.obj");
  EXPECT_EQ(std::count(skin.begin(), skin.end(), 'v'), 12);
  EXPECT_EQ(std::count(skin.begin(), skin.end(), 'f'), 2 * (2 * 4 + 2));
}

TEST_F(MeshCommand, StuffsAClosedSurface) {
  must("mesh block --cells 2 2 2 -o skin.obj");
  must("mesh --stuff skin.obj --cell 0.15 --order 2 -o stuffed.msh");
  const Json found = check("stuffed.msh");
  EXPECT_EQ(found["nodes_per_element"], 10);
  EXPECT_NEAR(found["total_volume"].get<double>(), 1, 0.05);   // corners and edges of the cube are cut off
  EXPECT_GT(found["quality"]["min_dihedral"]["least"], 10.7);  // the bounds of the method
  EXPECT_LT(found["quality"]["max_dihedral"]["most"], 164.8);
  for (const std::string cell : {"-1", "0", "1e-9", "5"}) {
    const Outcome outcome = corotet("mesh --stuff skin.obj --cell " + cell + " -o bad.msh");
    EXPECT_EQ(outcome.exit_code, 1) << cell;
    EXPECT_NE(outcome.err.find("skin.obj: size"), std::string::npos) << outcome.err;
    EXPECT_FALSE(exists("bad.msh")) << cell;
  }
}

constexpr const char* with_spare_vertex =
    "MeshVersionFormatted 2\nDimension 3\nVertices 5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n9 9 9 0\n"
    "Tetrahedra 1\n1 2 3 4 0\nEnd\n";

TEST_F(MeshCommand, CleanDropsVerticesWithoutAnElement) {
  write("spare.mesh", with_spare_vertex);
  const Json before = check("spare.mesh", 1);
  EXPECT_FALSE(before["usable"]);
  EXPECT_NE(before["reason"].get<std::string>().find("vertex 4"), std::string::npos) << before;
  const Outcome kept = corotet("mesh --from spare.mesh -o kept.msh");
  EXPECT_EQ(kept.exit_code, 0);
  EXPECT_NE(kept.err.find("--clean"), std::string::npos) << kept.err;
  must("mesh --from spare.mesh --clean -o clean.msh");
  EXPECT_EQ(check("clean.msh")["vertices"], 4);
}

TEST_F(MeshCommand, CheckSaysWhatIsWrong) {
  const auto mesh_of = [](const std::string& fourth, const std::string& nodes) {
    return "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n" + fourth +
           " 0\nTetrahedra 1\n" + nodes + " 0\nEnd\n";
  };
  write("turned.mesh", mesh_of("0 0 1", "1 3 2 4"));
  const Json turned = check("turned.mesh");
  EXPECT_EQ(turned["flipped_elements"], 1);
  const Outcome words = corotet("check turned.mesh");
  EXPECT_EQ(words.exit_code, 0);
  EXPECT_NE(words.out.find("1 elements are wound the other way round"), std::string::npos) << words.out;

  write("flat.mesh", mesh_of("1 1 0", "1 2 3 4"));
  const Json flat = check("flat.mesh", 1);
  EXPECT_FALSE(flat["usable"]);
  EXPECT_NE(flat["reason"].get<std::string>().find("element 0"), std::string::npos) << flat;
  EXPECT_EQ(flat["worst"][0]["element"], 0);
  EXPECT_EQ(flat["defects"]["flat"], 1);
  const Outcome flat_words = corotet("check flat.mesh");
  EXPECT_EQ(flat_words.exit_code, 1);
  EXPECT_NE(flat_words.out.find("not usable: element 0"), std::string::npos) << flat_words.out;

  write("thin.mesh", mesh_of("0.3 0.3 1e-12", "1 2 3 4"));
  const Json thin = check("thin.mesh");  // good enough for double alone
  EXPECT_TRUE(thin["usable"]);
  EXPECT_FALSE(thin["usable_in_float"]);
  EXPECT_NE(thin["reason_in_float"].get<std::string>().find("element 0"), std::string::npos) << thin;

  write("broken.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0\n");
  const Json broken = check("broken.mesh", 1);
  EXPECT_FALSE(broken["usable"]);
  EXPECT_EQ(broken["reason"].get<std::string>().find("broken.mesh:"), 0U) << broken;
}

// Found before the input is even read.
TEST_F(MeshCommand, AWrongOutputNameIsSaidFirst) {
  const Outcome outcome = corotet("mesh --from nowhere.msh -o a.stl");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("--output a.stl"), std::string::npos) << outcome.err;
}

TEST_F(MeshCommand, OutputThatCannotBeWrittenIsAnError) {
  must("mesh beam -o a.msh");
  for (const char* arguments : {"check --json a.msh", "check a.msh", "mesh beam -o b.msh", "--help", "--version"}) {
    const Outcome outcome = corotet(std::string(arguments) + " > /dev/full");
    EXPECT_EQ(outcome.exit_code, 1) << arguments;
    EXPECT_FALSE(outcome.err.empty()) << arguments;
  }
}

TEST_F(MeshCommand, HelpTeachesAndTheVersionIsTold) {
  for (const char* command : {"", "mesh ", "check ", "run "}) {
    const Outcome outcome = corotet(std::string(command) + "--help");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NE(outcome.out.find(std::string("  corotet ") + command), std::string::npos) << "no example for " << command;
  }
  const Outcome version = corotet("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.find("corotet "), 0U) << version.out;
}

}  // namespace
}  // namespace mesh_command_test
