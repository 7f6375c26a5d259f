// Bad input: each row must be refused by name, with nothing left behind.
#include <string>
#include <vector>

#include "program_runner.hpp"

namespace scene_errors_test {
namespace {

using corotet::testing::Outcome;
using corotet::testing::ProgramTest;

class SceneErrors : public ProgramTest {
 protected:
  SceneErrors() { must("mesh beam --cells 2 1 1 -o beam.msh"); }

  void expect_refusal(const std::string& scene, const std::string& expected) {
    write("scene.json", scene);
    const Outcome outcome = corotet("run scene.json -o out");
    EXPECT_EQ(outcome.exit_code, 1) << scene;
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << scene << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find("scene.json"), std::string::npos) << "the file is not named\n" << outcome.err;
    EXPECT_FALSE(exists("out")) << scene;
  }
};

struct Row {
  const char* member;  // beside "mesh"
  const char* error;
};

TEST_F(SceneErrors, EachIsNamedByItsKeyAndNothingIsWritten) {
  const std::vector<Row> rows{
      {R"("colour": "red")", "colour: unknown key"},
      {R"("order": 3)", "order: must be >= 1 and <= 2, is 3"},
      {R"("order": 1.5)", "order: must be an integer"},
      {R"("order": "one")", "order: must be an integer"},
      {R"("order": 1e99)", "order: must be"},
      {R"("scalar": "half")", "scalar: must be one of: float, double"},
      {R"("scalar": 32)", "scalar: must be one of"},
      {R"("material": 5)", "material: must be an object"},
      {R"("material": {"young": 0})", "material.young: must be > 0, is 0"},
      {R"("material": {"young": "5e5"})", "material.young: must be a number"},
      {R"("material": {"young": -5e5})", "material.young: must be > 0"},
      {R"("material": {"poisson": 0.5})", "material.poisson: must be > -1 and < 0.5, is 0.5"},
      {R"("material": {"poisson": -1})", "material.poisson: must be"},
      {R"("material": {"density": 0})", "material.density: must be > 0"},
      {R"("material": {"colour": 1})", "material.colour: unknown key"},
      {R"("damping": {"mass": -1})", "damping.mass: must be >= 0"},
      {R"("damping": {"stiffness": -1})", "damping.stiffness: must be >= 0"},
      {R"("damping": {"air": 1})", "damping.air: unknown key"},
      {R"("pins": {"box": []})", "pins: must be a list"},
      {R"("pins": [5])", "pins[0]: must be an object"},
      {R"("pins": [{}])", "pins[0].box: is missing"},
      {R"("pins": [{"box": 5}])", "pins[0].box: must be a list"},
      {R"("pins": [{"box": [[0,0,0]]}])", "pins[0].box: must be two corners"},
      {R"("pins": [{"box": [[0,0,0],[1,1]]}])", "pins[0].box[1]: must be a list of 3 numbers"},
      {R"("pins": [{"box": [[0,0,0],[1,1,"x"]]}])", "pins[0].box[1]: must be a list of 3 numbers"},
      {R"("pins": [{"box": [[1,0,0],[0,1,1]]}])", "pins[0].box: its first corner"},
      {R"("pins": [{"box": [[0,0,0],[1,1,1]], "name": "a"}])", "pins[0].name: unknown key"},
      {R"("pins": [{"box": [[0,0,0],[0,1,1]]}, {"box": [[5,5,5],[6,6,6]]}])", "pins[1].box: no vertex lies in it"},
      {R"("pins": [{"box": [[0,0,0],[0,1,1]], "path": [[0,0,0]]}])", "pins[0].path[0]: must be a list of 4 numbers"},
      {R"("pins": [{"box": [[0,0,0],[0,1,1]], "path": [[1,0,0,0],[1,0,0,0]]}])", "pins[0].path[1]: times must ascend"},
      {R"("gravity": -9.81)", "gravity: must be a list of 3 numbers"},
      {R"("gravity": [0, 0])", "gravity: must be a list of 3 numbers"},
      {R"("gravity": [0, 0, null])", "gravity: must be a list of 3 numbers"},
      {R"("forces": [{"box": [[0,0,0],[0,1,1]]}])", "forces[0]: needs \"total\""},
      {R"("forces": [{"total": [0,0,1]}])", "forces[0].box: is missing"},
      {R"("forces": [{"box": [[5,5,5],[6,6,6]], "total": [0,0,1]}])", "forces[0].box: no vertex lies in it"},
      {R"("forces": [{"box": [[1,0,0],[1,0,0]], "torque": [1,0,0]}])", "forces[0].torque: all vertices in the box"},
      {R"("forces": [{"box": [[0,0,0],[1,1,1]], "torque": 5}])", "forces[0].torque: must be a list of 3 numbers"},
      {R"("forces": [{"box": [[0,0,0],[1,1,1]], "total": [0,0,1], "at": 1}])", "forces[0].at: unknown key"},
      {R"("mass": "heavy")", "mass: must be one of: lumped, consistent"},
      {R"("dilatation": "none")", "dilatation: must be one of: per_element, mean"},
      {R"("rotation": "qr")", "rotation: must be one of: identity, gram_schmidt, polar"},
      {R"("rotation_site": "vertex")", "rotation_site: must be one of: point, element"},
      {R"("integrator": {"name": "rk4"})", "integrator.name: must be one of: implicit_euler, bdf2"},
      {R"("integrator": {"dt": 0})", "integrator.dt: must be > 0"},
      {R"("integrator": {"dt": -0.01})", "integrator.dt: must be > 0"},
      {R"("integrator": {"newton": 0})", "integrator.newton: must be >= 1"},
      {R"("integrator": {"newton_tolerance": 1})", "integrator.newton_tolerance: must be > 0 and < 1"},
      {R"("integrator": {"tangent": "secant"})", "integrator.tangent: must be one of: plain, stretch_stable, exact"},
      {R"("integrator": {"untrusted": "retry"})", "integrator.untrusted: must be one of: accept, refuse, divide"},
      {R"("rotation": "gram_schmidt", "integrator": {"tangent": "exact"})",
       "integrator.tangent: exact is known only for"},
      {R"("integrator": {"step": 1})", "integrator.step: unknown key"},
      {R"("solver": {"name": "cholmod"})", "solver.name: \"cholmod\" is not in this version, which has: auto, pcg"},
      {R"("solver": {"name": "lu"})", "solver.name: must be one of: auto, pcg, cholesky"},
      {R"("solver": {"preconditioner": "ic0"})", "solver.preconditioner: \"ic0\" is not in this version"},
      {R"("solver": {"tolerance": -1})", "solver.tolerance: must be > 0 and < 1, is -1"},
      {R"("solver": {"tolerance": 0})", "solver.tolerance: must be > 0"},
      {R"("solver": {"max_iterations": 0})", "solver.max_iterations: must be >= 1"},
      {R"("solver": {"max_iterations": 3000000000})", "solver.max_iterations: must be <= 2147483647"},
      {R"("initial": {"positions": "nowhere.txt"})", "initial.positions: there is no file"},
      {R"("initial": {"positions": "short.txt"})", "initial.positions: short.txt: it has 1 lines of numbers"},
      {R"("initial": {"velocities": "ragged.txt"})", "initial.velocities: ragged.txt:2"},
      {R"("initial": {"velocities": "words.txt"})", "initial.velocities: words.txt:1"},
      {R"("initial": {"velocity": "words.txt"})", "initial.velocity: must be a list of 3 numbers"},
      {R"("initial": {"angular_velocity": [1, 2]})", "initial.angular_velocity: must be a list of 3 numbers"},
      {R"("initial": {"speed": 1})", "initial.speed: unknown key"},
      {R"("initial": {"velocities": "words.txt", "velocity": [0,0,1]})", "initial.velocity: velocities come from"},
      {R"("surface": "nowhere.obj")", "surface: there is no file"},
      {R"("surface": "words.txt")", "surface: words.txt"},
      {R"("surface": "")", "surface: must name a file"},
      {R"("surface": 5)", "surface: must be text"},
      {R"("probes": [{"farthest": [0,0,0]}])", "probes[0].farthest: unknown key"},
      {R"("probes": [{}])", "probes[0].nearest: is missing"},
      {R"("probes": [{"nearest": [0,0]}])", "probes[0].nearest: must be a list of 3 numbers"},
      {R"("steps": -1)", "steps: must be >= 0, is -1"},
      {R"("steps": 0.5)", "steps: must be an integer"},
      {R"("frames": {"every": -1})", "frames.every: must be >= 0"},
      {R"("frames": 1)", "frames: must be an object"},
      {R"("frames": {"each": 1})", "frames.each: unknown key"},
      {R"("mesh": "beam.msh")", "the key \"mesh\" stands twice"},
      {R"("steps": 1e999)", "JSON"},
  };
  write("short.txt", "0 0 0\n");
  write("ragged.txt", "0 0 0\n0 0\n");
  write("words.txt", "up up away\n");
  for (const Row& row : rows) expect_refusal(std::string(R"({"mesh": "beam.msh", )") + row.member + "}", row.error);
}

TEST_F(SceneErrors, OfContact) {
  const std::vector<Row> rows{
      {R"("contact": 5)", "contact: must be an object"},
      {R"("contact": {"points": "vertices"})", "contact.points: must be one of: boundary, surface, none"},
      {R"("contact": {"points": "surface"})",
       "contact.points: \"surface\" takes the vertices under the key \"surface\", which is missing"},
      {R"("contact": {"friction": -0.1})", "contact.friction: must be >= 0, is -0.1"},
      {R"("contact": {"margin": -1})", "contact.margin: must be >= 0"},
      {R"("contact": {"passes": 0})", "contact.passes: must be >= 1"},
      {R"("contact": {"max_depenetration": 0})", "contact.max_depenetration: must be > 0"},
      {R"("contact": {"max_contacts_per_point": 0})", "contact.max_contacts_per_point: must be >= 1"},
      {R"("contact": {"stiffness": 1})", "contact.stiffness: unknown key; known here: points, friction"},
      {R"("obstacles": {})", "obstacles: must be a list"},
      {R"("obstacles": [5])", "obstacles[0]: must be an object"},
      {R"("obstacles": [{}])", "obstacles[0]: needs a shape: half_space, sphere, box, capsule or mesh"},
      {R"("obstacles": [{"cone": {}}])", "obstacles[0].cone: unknown key"},
      {R"("obstacles": [{"sphere": {"radius": 1}, "box": {"half_extents": [1,1,1]}}])",
       "obstacles[0]: has 2 shapes, sphere and box"},
      {R"("obstacles": [{"half_space": 5}])", "obstacles[0].half_space: must be an object"},
      {R"("obstacles": [{"half_space": {"normal": [0,0,0]}}])", "obstacles[0].half_space.normal: must not be zero"},
      {R"("obstacles": [{"half_space": {"offset": "low"}}])", "obstacles[0].half_space.offset: must be a number"},
      {R"("obstacles": [{"half_space": {"up": 1}}])", "obstacles[0].half_space.up: unknown key"},
      {R"("obstacles": [{"sphere": {}}])", "obstacles[0].sphere.radius: is missing; it must be > 0, m"},
      {R"("obstacles": [{"sphere": {"radius": 0}}])", "obstacles[0].sphere.radius: must be > 0, is 0"},
      {R"("obstacles": [{"box": {}}])", "obstacles[0].box.half_extents: is missing"},
      {R"("obstacles": [{"box": {"half_extents": [1,0,1]}}])",
       "obstacles[0].box.half_extents: must be three numbers > 0, is [1, 0, 1]"},
      {R"("obstacles": [{"capsule": {"radius": 1}}])", "obstacles[0].capsule.half_height: is missing"},
      {R"("obstacles": [{"capsule": {"radius": 1, "half_height": -1}}])",
       "obstacles[0].capsule.half_height: must be >= 0"},
      {R"("obstacles": [{"mesh": 5}])", "obstacles[0].mesh: must be text"},
      {R"("obstacles": [{"mesh": "rock.obj"}])", "obstacles[0].mesh: there is no file rock.obj"},
      {R"("obstacles": [{"mesh": "words.txt"}])", "obstacles[0].mesh: words.txt"},
      {R"("obstacles": [{"half_space": {}}, {"mesh": "open.obj"}])", "obstacles[1].mesh: open.obj: triangle 0"},
      {R"("obstacles": [{"half_space": {}, "friction": -1}])", "obstacles[0].friction: must be >= 0"},
      {R"("obstacles": [{"half_space": {}}, {"half_space": {}, "mass": 1}])",
       "obstacles[1].mass: a half_space has no centre of mass"},
      {R"("obstacles": [{"sphere": {"radius": 1}, "mass": -1}])", "obstacles[0].mass: must be >= 0"},
      {R"("obstacles": [{"box": {"half_extents": [1e200,1,1]}, "mass": 1}])",
       "obstacles[0].mass: the moments of inertia"},
      {R"("obstacles": [{"sphere": {"radius": 1e-200}, "mass": 1}])", "obstacles[0].mass: the moments of inertia"},
      {R"("obstacles": [{"half_space": {}, "velocity": 1}])", "obstacles[0].velocity: must be a list of 3 numbers"},
      {R"("obstacles": [{"half_space": {}, "angular_velocity": 1}])", "obstacles[0].angular_velocity: must be a list"},
      {R"("obstacles": [{"half_space": {}, "pose": {"position": 1}}])", "obstacles[0].pose.position: must be a list"},
      {R"("obstacles": [{"half_space": {}, "pose": {"rotation": [1, 0, 0]}}])",
       "obstacles[0].pose.rotation: must be a list of 4 numbers"},
      {R"("obstacles": [{"half_space": {}, "pose": {"rotation": [0, 0, 0, 90]}}])",
       "obstacles[0].pose.rotation: must be a unit quaternion"},
      {R"("obstacles": [{"half_space": {}, "pose": {"angle": 1}}])", "obstacles[0].pose.angle: unknown key"},
      {R"("obstacles": [{"half_space": {}, "path": [[0,0,0]]}])", "obstacles[0].path[0]: must be a list of 4 numbers"},
      {R"("obstacles": [{"half_space": {}, "path": [[1,0,0,0],[0,0,0,0]]}])",
       "obstacles[0].path[1]: times must ascend, 0 follows 1"},
      {R"("obstacles": [{"half_space": {}, "path": [[1,0,0,0]], "velocity": [1,0,0]}])",
       "obstacles[0].velocity: the path leads the obstacle"},
      {R"("obstacles": [{"sphere": {"radius": 1}, "path": [[1,0,0,0]], "mass": 1}])",
       "obstacles[0].path: an obstacle with a mass moves freely"},
      {R"("obstacles": [{"half_space": {}, "colour": 1}])", "obstacles[0].colour: unknown key"},
      {R"("obstacles": [{"half_space": {}}], "integrator": {"untrusted": "divide"})",
       "integrator.untrusted: divide does not lead obstacles"},
      {R"("attachments": 5)", "attachments: must be a list"},
      {R"("attachments": [5])", "attachments[0]: must be an object"},
      {R"("attachments": [{}])", "attachments[0].nearest: is missing"},
      {R"("attachments": [{"nearest": 1}])", "attachments[0].nearest: must be a list of 3 numbers"},
      {R"("attachments": [{"nearest": [0,0,1e200]}])", "attachments[0].nearest: lies too far away"},
      {R"("attachments": [{"nearest": [0,0,0], "to": [0,0]}])", "attachments[0].to: must be a list of 3 numbers"},
      {R"("attachments": [{"nearest": [0,0,0], "stiffness": 0}])", "attachments[0].stiffness: must be > 0"},
      {R"("attachments": [{"nearest": [0,0,0], "damping": -1}])", "attachments[0].damping: must be >= 0"},
      {R"("attachments": [{"nearest": [0,0,0], "path": 5}])", "attachments[0].path: must be a list"},
      {R"("attachments": [{"nearest": [0,0,0], "box": 5}])", "attachments[0].box: unknown key"},
      {R"("attachments": [{"nearest": [0,0,0], "stiffness": 1e-300}])",
       "attachments[0].stiffness: 1e-300 is too small for float"},
      {R"("attachments": [{"nearest": [0,0,0], "damping": 1e300}])",
       "attachments[0].damping: 1e+300 is too large for float"},
  };
  write("words.txt", "up up away\n");
  write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const Row& row : rows) expect_refusal(std::string(R"({"mesh": "beam.msh", )") + row.member + "}", row.error);
}

// Keys of one of several bodies are named by where they stand: while the scene is read, and when it is matched to
// meshes.
TEST_F(SceneErrors, OfBodies) {
  const auto body = [](const std::string& second) {
    return R"({"bodies": [{"mesh": "beam.msh"}, )" + second + R"(], "steps": 1})";
  };
  const auto with = [&](const std::string& member) { return body(R"({"mesh": "beam.msh", )" + member + "}"); };
  expect_refusal(R"({"bodies": {}})", "bodies: must be a list");
  expect_refusal(R"({"bodies": []})", "bodies: must hold at least one body");
  expect_refusal(R"({"bodies": [{"mesh": "beam.msh"}], "mesh": "beam.msh"})", "mesh: unknown key; known here: gravity");
  expect_refusal(R"({"bodies": [{"mesh": "beam.msh"}], "pins": []})", "pins: unknown key");
  expect_refusal(body("5"), "bodies[1]: must be an object");
  expect_refusal(body("{}"), "bodies[1].mesh: is missing; every body needs one");
  expect_refusal(body(R"({"mesh": "nowhere.msh"})"), "bodies[1].mesh: there is no file nowhere.msh");
  expect_refusal(with(R"("gravity": [0,0,0])"), "bodies[1].gravity: unknown key; known here: name, mesh");
  expect_refusal(with(R"("material": {"young": 0})"), "bodies[1].material.young: must be > 0");
  expect_refusal(with(R"("pins": [{}])"), "bodies[1].pins[0].box: is missing");
  expect_refusal(with(R"("contact": {"points": "surface"})"), "bodies[1].contact.points: \"surface\"");
  expect_refusal(with(R"("attachments": [{}])"), "bodies[1].attachments[0].nearest: is missing");
  expect_refusal(with(R"("name": 5)"), "bodies[1].name: must be text");
  expect_refusal(with(R"("name": "")"), "bodies[1].name: must be letters, digits, - and _, is \"\"");
  expect_refusal(with(R"("name": "../x")"), "bodies[1].name: must be letters");
  expect_refusal(with(R"("name": "0")"), "bodies[1].name: another body is called \"0\"");
  // Found in the mesh, or in float.
  expect_refusal(with(R"("pins": [{"box": [[5,5,5],[6,6,6]]}])"), "bodies[1].pins[0].box: no vertex lies in it");
  expect_refusal(with(R"("material": {"young": 1e300})"), "bodies[1].material.young: 1e+300 is too large for float");
  expect_refusal(R"({"bodies": [{"mesh": "beam.msh"}], "gravity": [0, 0, 1e300]})", " gravity: 1e+300 is too large");
  write("bad.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 2\n");
  expect_refusal(body(R"({"mesh": "bad.msh"})"), "bodies[1].mesh: bad.msh:");

  write("scene.json", R"({"bodies": [{"mesh": "beam.msh"}]})");
  for (const char* command : {"report scene.json -o out", "tune scene.json --error 0.1 -o out.json"}) {
    const Outcome outcome = corotet(command);
    EXPECT_EQ(outcome.exit_code, 1) << command;
    EXPECT_NE(outcome.err.find("scene.json: bodies: only `corotet run` takes several"), std::string::npos)
        << outcome.err;
  }
}

TEST_F(SceneErrors, OfTheMeshItself) {
  write("bad.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 2\n");
  write("note.txt", "this is no mesh\n");
  expect_refusal(R"({})", "mesh: is missing");
  expect_refusal(R"({"mesh": "nowhere.msh"})", "mesh: there is no file nowhere.msh");
  expect_refusal(R"({"mesh": 5})", "mesh: must be text");
  expect_refusal(R"({"mesh": "bad.msh"})", "mesh: bad.msh:");
  expect_refusal(R"({"mesh": "note.txt"})", "mesh: note.txt: its content is none of");
  expect_refusal(R"({"mesh": "."})", "it is a directory");

  const auto mesh_of = [](const std::string& fifth, const std::string& tetrahedra) {
    return "MeshVersionFormatted 2\nDimension 3\nVertices 5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n" + fifth +
           " 0\nTetrahedra " + tetrahedra + "\nEnd\n";
  };
  write("spare.mesh", mesh_of("9 9 9", "1\n1 2 3 4 0"));
  expect_refusal(R"({"mesh": "spare.mesh"})", "mesh: spare.mesh: vertex 4");
  expect_refusal(R"({"mesh": "spare.mesh"})", "--clean");
  write("flat.mesh", mesh_of("1 1 0", "2\n1 2 3 4 0\n1 2 3 5 0"));
  expect_refusal(R"({"mesh": "flat.mesh"})", "mesh: flat.mesh: element 1: its volume is zero");
  write("range.mesh", mesh_of("1 1 1", "1\n1 2 3 6 0"));
  expect_refusal(R"({"mesh": "range.mesh", "order": 2})", "mesh: range.mesh:");
  write("far.mesh", mesh_of("1e300 0 0", "2\n1 2 3 4 0\n2 3 4 5 0"));
  expect_refusal(R"({"mesh": "far.mesh"})", "mesh: far.mesh:");
}

TEST_F(SceneErrors, OfNumbersTooLargeForFloat) {
  std::string huge;
  for (int v = 0; v < 12; ++v) huge += "0 0 1e300\n";
  write("huge.txt", huge);
  expect_refusal(R"({"mesh": "beam.msh", "initial": {"positions": "huge.txt"}})",
                 "initial.positions: displacements of");
  expect_refusal(R"({"mesh": "beam.msh", "initial": {"velocities": "huge.txt"}})", "initial.velocities: velocities of");
}

// Finite in the file, but 0 or infinite in the run's precision: found before an earlier run's results are replaced.
TEST_F(SceneErrors, OfSceneNumbersThatFloatCannotHold) {
  const std::vector<Row> rows{
      {R"("gravity": [0, 0, -1e300])", "gravity: -1e+300 is too large for float"},
      {R"("forces": [{"box": [[0,0,0],[1,1,1]], "total": [0, 1e39, 0]}])", "forces[0].total: 1e+39 is too large"},
      {R"("initial": {"angular_velocity": [0, 1e39, 0]})", "initial.angular_velocity: 1e+39 is too large"},
      {R"("gravity": [1e39, 0, 0])", "gravity: 1e+39 is too large for float"},
      {R"("integrator": {"dt": 1e-300})", "integrator.dt: 1e-300 is too small for float"},
      {R"("integrator": {"dt": 1e300})", "integrator.dt: 1e+300 is too large for float"},
      {R"("material": {"young": 1e300})", "material.young: 1e+300 is too large for float"},
      {R"("material": {"density": 1e-300})", "material.density: 1e-300 is too small for float"},
      {R"("damping": {"mass": 1e300})", "damping.mass: 1e+300 is too large for float"},
      {R"("damping": {"stiffness": 1e300})", "damping.stiffness: 1e+300 is too large for float"},
      {R"("pins": [{"box": [[0,0,0],[0,1,1]], "path": [[0, 0,0,0], [1, 0,1e300,0]]}])",
       "pins[0].path[1]: 1e+300 is too large for float"},
  };
  for (const Row& row : rows) expect_refusal(std::string(R"({"mesh": "beam.msh", )") + row.member + "}", row.error);
  // A box may well reach to the end of the numbers.
  write("scene.json",
        R"({"mesh": "beam.msh", "pins": [{"box": [[-1e300,-1e300,-1e300],[0,1e300,1e300]]}], "steps": 1})");
  must("run scene.json -o out");
}

TEST_F(SceneErrors, MalformedJsonIsNamedByItsLine) {
  expect_refusal("", "scene.json:1: not JSON");
  expect_refusal("[]", "must be an object, is a list");
  expect_refusal("{\n\"mesh\": \"beam.msh\",\n\"steps\": 6O\n}\n", "scene.json:3: not JSON");
  expect_refusal("{\n\"mesh\": \"beam.msh\",\n}\n", "scene.json:3: not JSON");
  expect_refusal("{\"mesh\": \"beam.msh\"", "scene.json:1: not JSON");
}

TEST_F(SceneErrors, AllAreListedAtOnce) {
  write("scene.json", R"({"mesh": "nowhere.msh", "steps": -1, "solver": {"tolerance": 2, "nme": 1}, "probes": 5})");
  const Outcome outcome = corotet("run scene.json -o out");
  EXPECT_EQ(outcome.exit_code, 1);
  for (const char* expected : {"5 problems", "mesh: there is no file", "steps: must be", "solver.tolerance: must be",
                               "solver.nme: unknown key", "probes: must be a list"})
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << expected << "\n" << outcome.err;
}

// Where earlier results are, a scene that cannot run leaves them alone.
TEST_F(SceneErrors, LeaveEarlierResultsAlone) {
  write("good.json", R"({"mesh": "beam.msh", "steps": 1})");
  must("run good.json -o out");
  const std::string before = read("out/final.txt") + read("out/summary.json");
  ASSERT_FALSE(before.empty());
  for (const char* bad : {R"("steps": -1)", R"("gravity": [0, 0, -1e300])", R"("integrator": {"dt": 1e-300})"}) {
    write("bad.json", std::string(R"({"mesh": "beam.msh", )") + bad + "}");
    EXPECT_EQ(corotet("run bad.json -o out").exit_code, 1) << bad;
    EXPECT_EQ(read("out/final.txt") + read("out/summary.json"), before) << bad;
  }
}

// A surface vertex so far away that its distance is no number, or its place none in float.
TEST_F(SceneErrors, OfASurfaceThatIsTooFarAway) {
  for (const char* far : {"1e45", "1e200"}) {
    write("far.obj", std::string("v 0 0 0\nv 1 0 0\nv ") + far + " 1 0\nf 1 2 3\n");
    expect_refusal(R"({"mesh": "beam.msh", "surface": "far.obj", "frames": {"every": 1}})", "surface vertex 2");
  }
}

TEST_F(SceneErrors, ThreadsThatTheSystemDoesNotGive) {
  const std::string one_gigabyte = "ulimit -v 1000000";
  if (corotet("--version", one_gigabyte).exit_code != 0)
    GTEST_SKIP() << "the program does not even start in so little address space: it is built with a sanitizer";
  write("good.json", R"({"mesh": "beam.msh", "steps": 1})");
  const Outcome outcome = corotet("run good.json -o out --threads 1000", one_gigabyte);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("--threads 1000"), std::string::npos) << outcome.err;
  EXPECT_FALSE(exists("out"));
}

TEST_F(SceneErrors, OfTheCommandLine) {
  write("good.json", R"({"mesh": "beam.msh", "steps": 1})");
  write("file", "");
  const std::vector<std::pair<const char*, int>> rows{
      {"", 2},
      {"dance", 2},
      {"run", 2},
      {"run good.json", 2},
      {"run good.json -o out --threads 0", 2},
      {"run good.json -o out --threads two", 2},
      {"run good.json -o out --steps -3", 2},
      {"run nowhere.json -o out", 1},
      {"run good.json -o file", 1},
      {"run good.json -o file/out", 1},
      {"mesh", 2},
      {"mesh sphere -o a.msh", 2},
      {"mesh beam", 2},
      {"mesh -o a.msh", 1},
      {"mesh beam --cells 0 1 1 -o a.msh", 1},
      {"mesh beam --cells 2 1 -o a.msh", 2},
      {"mesh beam --size 1 0 1 -o a.msh", 1},
      {"mesh beam --order 3 -o a.msh", 2},
      {"mesh beam --from beam.msh -o a.msh", 2},
      {"mesh beam -o a.stl", 1},
      {"mesh beam -o a", 1},
      {"mesh beam -o a.vtu --msh-version 2.2", 1},
      {"mesh beam -o a.obj --msh-version 4.1", 1},
      {"mesh beam -o a.obj --encoding ascii", 1},
      {"mesh beam -o nowhere/a.msh", 1},
      {"mesh --from nowhere.msh -o a.msh", 1},
      {"mesh --stuff nowhere.obj --cell 0.1 -o a.msh", 1},
      {"mesh --stuff file -o a.msh", 2},
      {"mesh beam --stuff file --cell 0.1 -o a.msh", 2},
      {"check", 2},
      {"check nowhere.msh", 1},
  };
  for (const auto& [arguments, exit_code] : rows) {
    const Outcome outcome = corotet(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << arguments;
    EXPECT_FALSE(outcome.err.empty()) << arguments;
    EXPECT_FALSE(exists("out") || exists("a.msh") || exists("a.stl") || exists("a") || exists("a.vtu") ||
                 exists("a.obj"))
        << arguments;
  }
}

}  // namespace
}  // namespace scene_errors_test
