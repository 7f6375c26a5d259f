// Contact, obstacles and attachments of `corotet run`: laws of mechanics in the numbers that it writes.
#include <array>
#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "program_runner.hpp"

namespace contact_run_test {
namespace {

using corotet::at;
using corotet::Index;
using corotet::testing::Outcome;
using corotet::testing::ProgramTest;
using V = corotet::Vec3<double>;

constexpr double g = 9.81, h = 1.0 / 60;

/// A row of obstacles.csv.
struct ObstacleRow {
  double t;
  V place;
  std::array<double, 4> rotation;  // w, x, y, z
  V force, torque;
};
/// A row of attachments.csv.
struct AttachmentRow {
  double t;
  V place, force;
};

/// An array of a .vtu whose data are appended.
template <class T>
std::vector<T> vtu_array(const std::string& file, const std::string& name) {
  const std::size_t attribute = file.find("offset=\"", file.find("Name=\"" + name + "\""));
  const std::size_t offset = std::stoul(file.substr(attribute + 8));
  const std::size_t begin = file.find("_", file.find("<AppendedData")) + 1 + offset;
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, file.data() + begin, sizeof bytes);
  std::vector<T> values(bytes / sizeof(T));
  std::memcpy(values.data(), file.data() + begin + sizeof bytes, bytes);
  return values;
}

class ContactRun : public ProgramTest {
 protected:
  ContactRun() {
    must("mesh block --size 0.4 0.4 0.4 --corner 0 0 0.01 --cells 3 3 3 -o block.msh");
    must("mesh block --size 0.4 0.4 0.4 --corner 0 0 0.01 --cells 2 2 2 --order 2 -o block10.msh");
  }

  /// Runs `scene` into `folder` and returns its summary.
  Json run(const Json& scene, const std::string& options = "", const std::string& folder = "out") const {
    write("scene.json", scene.dump());
    const Outcome outcome = corotet("run scene.json -o " + folder + " " + options);
    EXPECT_EQ(outcome.exit_code, 0) << scene << "\n" << outcome.err;
    return outcome.exit_code == 0 ? read_json(folder + "/summary.json") : Json();
  }

  /// A block of 0.4 m that falls on the plane z = 0; `more` replaces keys.
  static Json block(const Json& more = Json::object()) {
    Json scene = Json::parse(R"({"mesh": "block.msh", "obstacles": [{"half_space": {}}], "steps": 150,
      "contact": {"friction": 0.5}})");
    scene.update(more);
    return scene;
  }

  std::vector<ObstacleRow> obstacle_rows(int number, const std::string& folder = "out") const {
    std::vector<ObstacleRow> rows;
    for (const auto& cells : read_csv(folder + "/obstacles.csv")) {
      const auto value = [&](const char* column) { return std::stod(cells.at(column)); };
      if (std::stoi(cells.at("obstacle")) != number) continue;
      rows.push_back({value("t"),
                      {value("x"), value("y"), value("z")},
                      {value("qw"), value("qx"), value("qy"), value("qz")},
                      {value("fx"), value("fy"), value("fz")},
                      {value("tx"), value("ty"), value("tz")}});
    }
    return rows;
  }
  std::vector<AttachmentRow> attachment(int number) const {
    std::vector<AttachmentRow> rows;
    for (const auto& cells : read_csv("out/attachments.csv")) {
      const auto value = [&](const char* column) { return std::stod(cells.at(column)); };
      if (std::stoi(cells.at("attachment")) != number) continue;
      rows.push_back({value("t"), {value("x"), value("y"), value("z")}, {value("fx"), value("fy"), value("fz")}});
    }
    return rows;
  }
};

TEST_F(ContactRun, AFloorCarriesTheWeightOfABlockAtRest) {
  for (const char* mesh : {"block.msh", "block10.msh"})
    for (const char* scalar : {"float", "double"})
      for (const char* integrator : {"implicit_euler", "bdf2"}) {
        const Json summary = run(block({{"mesh", mesh}, {"scalar", scalar}, {"integrator", {{"name", integrator}}}}));
        const Json& contact = summary["contact"];
        const double weight = summary["body_mass"].get<double>() * g;
        const std::string what = std::string(mesh) + ", " + scalar + ", " + integrator + summary.dump();
        EXPECT_NEAR(contact["normal_force"], weight, 1e-3 * weight) << what;
        EXPECT_GT(contact["touching"], 3) << what;
        EXPECT_LT(contact["touching"], contact["points"]) << what;
        EXPECT_EQ(contact["dropped"], 0) << what;
        EXPECT_EQ(contact["unsettled"], 0) << what;
        EXPECT_GE(contact["passes"]["mean"], 1) << what;
        EXPECT_GE(contact["passes"]["max"], contact["passes"]["mean"]) << what;
        EXPECT_GE(contact["deepest"], 0) << what;
        EXPECT_LT(contact["deepest"], 0.01) << what;

        const auto floor = obstacle_rows(0);
        ASSERT_EQ(floor.size(), 151U) << what;
        EXPECT_EQ(floor[0].force, V::Zero()) << what;
        const ObstacleRow& last = floor.back();
        EXPECT_NEAR(last.t, 150 * h, 1e-12) << what;
        EXPECT_EQ(last.place, V::Zero()) << what;
        EXPECT_NEAR(last.force.z(), -weight, 1e-3 * weight) << what;
        EXPECT_NEAR(std::hypot(last.force.x(), last.force.y()), 0, 1e-3 * weight) << what;
        // The weight acts at the block's middle, (0.2, 0.2).
        EXPECT_NEAR(last.torque.x(), -0.2 * weight, 2e-3 * weight) << what;
        EXPECT_NEAR(last.torque.y(), 0.2 * weight, 2e-3 * weight) << what;
      }
}

// On a slope of 20 degrees a block rests if tan 20 = 0.36 is below the friction; otherwise it slides as g (sin - mu
// cos).
TEST_F(ContactRun, FrictionIsThatOfTheObstacleOrElseOfTheBody) {
  const double slope = 20 * std::numbers::pi / 180, mu = 0.1;
  const auto slid = [&](double of_body, double of_obstacle) {
    Json scene = block({{"gravity", {g * std::sin(slope), 0, -g * std::cos(slope)}}, {"steps", 60}});
    scene["material"]["young"] = 1e7;
    scene["mesh"] = "low.msh";
    scene["contact"]["friction"] = of_body;
    if (of_obstacle >= 0) scene["obstacles"][0]["friction"] = of_obstacle;
    scene["probes"] = Json::parse(R"([{"nearest": [0, 0, 0]}])");
    const Json summary = run(scene);
    const auto rows = read_probes("out/probes.csv");
    EXPECT_GT(rows.size(), 60U);
    EXPECT_EQ(summary["contact"]["sliding"] > 0, of_obstacle == mu || (of_obstacle < 0 && of_body == mu)) << summary;
    return rows.size() < 61 ? 0 : rows[60].x - rows[0].x;
  };
  must("mesh block --size 0.4 0.4 0.1 --cells 4 4 1 -o low.msh");
  const double goes = g * (std::sin(slope) - mu * std::cos(slope)) * h * h * 60 * 61 / 2;
  EXPECT_NEAR(slid(0.5, -1), 0, 1e-3);
  EXPECT_NEAR(slid(mu, -1), goes, 0.03 * goes);
  EXPECT_NEAR(slid(0.5, mu), goes, 0.03 * goes);
  EXPECT_NEAR(slid(mu, 0.5), 0, 1e-3);
}

// Of a free obstacle m (v' - v) = (F + m g) h in each step, v its displacement in a step over h; F is what the block
// does to it, and the floor carries both.
TEST_F(ContactRun, MomentumOfAFreeCrateIsBalancedInEachStep) {
  const double mass = 20;
  const auto crate = Json::parse(R"({"box": {"half_extents": [0.25, 0.25, 0.1]}, "mass": 20, "velocity": [0.1, 0, -0.5],
    "pose": {"position": [0.2, 0.2, 0.6]}})");
  const Json summary = run(block({{"obstacles", {Json::parse(R"({"half_space": {}})"), crate}}}));
  const auto rows = obstacle_rows(1);
  ASSERT_EQ(rows.size(), 151U);
  V before(0.1, 0, -0.5);
  double largest = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const V velocity = (rows[i].place - rows[i - 1].place) / h;
    const V imbalance = mass * (velocity - before) - h * (rows[i].force + mass * V(0, 0, -g));
    EXPECT_NEAR(imbalance.norm(), 0, 1e-9 * mass) << "step " << i;
    largest = std::fmax(largest, rows[i].force.norm());
    before = velocity;
  }
  EXPECT_GT(largest, 2 * mass * g) << "there was an impact";
  EXPECT_NEAR(rows.back().force.z(), mass * g, 0.02 * mass * g) << "the block carries it";
  EXPECT_NEAR(before.norm(), 0, 1e-2);
  EXPECT_NEAR(rows.back().place.z(), 0.5, 0.05) << "on the block";
  const double all = (summary["body_mass"].get<double>() + mass) * g;
  EXPECT_NEAR(obstacle_rows(0).back().force.z(), -all, 0.02 * all);
}

TEST_F(ContactRun, ObstaclesThatNothingTouchesMoveAsTheSceneSays) {
  const Json scene = block(
      {{"contact", {{"points", "none"}}}, {"steps", 40}, {"integrator", {{"dt", 0.025}}}, {"obstacles", Json::parse(R"([
      {"sphere": {"radius": 0.3}, "mass": 2, "velocity": [1, 0, 0], "pose": {"position": [0, 0, 5]}},
      {"capsule": {"radius": 0.1, "half_height": 0.2}, "pose": {"position": [3, 0, 0]},
       "path": [[0.25, 0, 0, 1], [0.75, 0, 2, 1]]},
      {"box": {"half_extents": [1, 1, 1]}, "velocity": [0, 0.5, 0], "angular_velocity": [0, 0, 0.5]}])")}});
  const Json summary = run(scene);
  EXPECT_FALSE(summary.contains("contact"));
  const auto ball = obstacle_rows(0), led = obstacle_rows(1), turned = obstacle_rows(2);
  ASSERT_EQ(ball.size(), 41U);
  for (int i = 0; i <= 40; ++i) {
    const double t = 0.025 * i;
    EXPECT_NEAR((ball[at(i)].place - V(t, 0, 5 - g * 0.025 * 0.025 * i * (i + 1) / 2)).norm(), 0, 1e-12) << i;
    const double part = std::fmin(1, std::fmax(0, (t - 0.25) / 0.5));
    EXPECT_NEAR((led[at(i)].place - V(3, 2 * part, 1)).norm(), 0, 1e-12) << i;
    EXPECT_NEAR((turned[at(i)].place - V(0, 0.5 * t, 0)).norm(), 0, 1e-12) << i;
    EXPECT_NEAR(turned[at(i)].rotation[0], std::cos(0.25 * t), 1e-12) << i;
    EXPECT_NEAR(turned[at(i)].rotation[3], std::sin(0.25 * t), 1e-12) << i;
  }
}

// A wall that is led pushes a block without friction; what it exerts is the rate of the block's momentum.
TEST_F(ContactRun, AWallThatIsLedPushesTheBlock) {
  Json scene = block({{"obstacles", Json::parse(R"([{"half_space": {}, "friction": 0},
    {"box": {"half_extents": [0.1, 1, 1]}, "pose": {"position": [-0.15, 0.2, 0]}, "path": [[0, 0, 0, 0], [2, 1, 0, 0]]}])")}});
  scene["probes"] = Json::parse(R"([{"nearest": [0, 0.2, 0.2]}])");
  scene["steps"] = 110;
  scene["damping"]["mass"] = 2;  // 1/s: at the wall's speed v the force is 2 M v
  const Json summary = run(scene);
  const double mass = summary["body_mass"];
  const auto wall = obstacle_rows(1);
  ASSERT_EQ(wall.size(), 111U);
  V impulse = V::Zero();
  for (std::size_t i = 61; i <= 110; ++i) impulse += h * wall[i].force;
  EXPECT_NEAR(impulse.x(), -2 * mass * 0.5 * 50 * h, 0.03 * mass * 50 * h);
  EXPECT_NEAR(read_probes("out/probes.csv")[110].x, wall[110].place.x() + 0.1, 2e-3) << "the block's side is at it";
}

TEST_F(ContactRun, AnAttachmentHoldsTheWeightAndIsLed) {
  Json scene = block();
  scene.erase("obstacles");
  scene["steps"] = 300;
  scene["damping"]["mass"] = 5;
  scene["attachments"] = Json::parse(R"([{"nearest": [0.2, 0.2, 0.9], "to": [0.2, 0.2, 0.41], "stiffness": 2e4,
    "damping": 100, "path": [[1, 0, 0, 0], [1.5, 0, 0, 0.3]]}])");
  const Json summary = run(scene);
  EXPECT_FALSE(summary.contains("contact"));
  EXPECT_FALSE(exists("out/obstacles.csv"));
  const double weight = summary["body_mass"].get<double>() * g;
  const auto rows = attachment(0);
  ASSERT_EQ(rows.size(), 301U);
  EXPECT_NEAR((rows[0].place - V(0.2, 0.2, 0.41)).norm(), 0, 1e-6) << "the nearest point of the block";
  EXPECT_EQ(rows[0].force, V::Zero());
  const AttachmentRow& last = rows.back();
  EXPECT_NEAR((last.force - V(0, 0, weight)).norm(), 0, 0.01 * weight);
  EXPECT_NEAR((last.place - V(0.2, 0.2, 0.71 - weight / 2e4)).norm(), 0, 2e-3);
  // The spring's law in each step.
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double part = std::fmin(1, std::fmax(0, (rows[i].t - 1) / 0.5)),
                 part_before = std::fmin(1, std::fmax(0, (rows[i].t - h - 1) / 0.5));
    const V target(0.2, 0.2, 0.41 + 0.3 * part);
    const V speed = V(0, 0, 0.3 * (part - part_before) / h) - (rows[i].place - rows[i - 1].place) / h;
    EXPECT_NEAR((rows[i].force - (2e4 * (target - rows[i].place) + 100 * speed)).norm(), 0, 1e-2 * weight) << i;
  }
  const Json& entry = summary["attachments"][0];
  EXPECT_NEAR(entry["rest"][2], 0.41, 1e-6);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(entry["force"][at(i)], last.force[i]);
}

// A skin that is larger than the mesh by 0.1 m keeps the mesh 0.1 m above the floor.
TEST_F(ContactRun, ThePointsMayBeThoseOfTheSurface) {
  must("mesh block --size 0.6 0.6 0.6 --corner -0.1 -0.1 -0.09 --cells 6 6 6 -o skin.obj");
  Json scene = block({{"surface", "skin.obj"}, {"contact", {{"points", "surface"}}}});
  scene["material"]["young"] = 1e8;
  scene["obstacles"][0]["half_space"]["offset"] = -0.2;
  scene["probes"] = Json::parse(R"([{"nearest": [0.2, 0.2, 0]}])");
  const Json summary = run(scene);
  EXPECT_EQ(summary["contact"]["points"], 6 * 36 + 2) << "vertices of the skin";
  const auto rows = read_probes("out/probes.csv");
  EXPECT_NEAR(rows.back().z, -0.1, 2e-3);
  const double weight = summary["body_mass"].get<double>() * g;
  EXPECT_NEAR(summary["contact"]["normal_force"], weight, 1e-3 * weight);
}

TEST_F(ContactRun, WithoutContactTheBytesAreTheSame) {
  Json scene = Json::parse(R"({"mesh": "block.msh", "steps": 20, "frames": {"every": 10},
    "probes": [{"nearest": [0, 0, 0]}], "pins": [{"box": [[0,0,0],[0,1,1]]}]})");
  const auto files = [&](const std::string& folder) {
    std::string all;
    for (const char* name : {"final.txt", "probes.csv", "volume.pvd", "frames/volume_000002.vtu"})
      all += read(folder + "/" + name);
    return all;
  };
  const Json plain = run(scene, "", "plain");
  ASSERT_GT(files("plain").size(), 1000U);
  for (const char* name : {"obstacles.csv", "obstacles.pvd", "attachments.csv", "frames/obstacles_000000.vtu"})
    EXPECT_FALSE(exists(std::string("plain/") + name)) << name;
  EXPECT_FALSE(plain.contains("contact") || plain.contains("attachments")) << plain;

  scene["contact"] = Json::parse(R"({"friction": 0.5})");
  EXPECT_FALSE(run(scene, "", "options").contains("contact"));
  EXPECT_EQ(files("options"), files("plain")) << "no obstacle";
  scene["obstacles"] = Json::parse(R"([{"half_space": {"offset": -50}}, {"sphere": {"radius": 1}, "mass": 1,
    "pose": {"position": [90, 0, 0]}}])");
  EXPECT_EQ(run(scene, "", "far")["contact"]["touching"], 0);
  EXPECT_EQ(files("far"), files("plain")) << "obstacles out of reach";
  scene["obstacles"] = Json::parse(R"([{"half_space": {"offset": 0.2}}])");
  scene["contact"]["points"] = "none";
  run(scene, "", "none");
  EXPECT_EQ(files("none"), files("plain")) << "no points";
  scene["contact"]["points"] = "boundary";
  run(scene, "", "touching");
  EXPECT_NE(files("touching"), files("plain")) << "contact does something";
}

TEST_F(ContactRun, SameBytesWithAnyNumberOfThreads) {
  must("mesh block --size 1 0.4 0.4 --corner 0 0 0.01 --cells 20 8 8 -o long.msh");
  Json scene = block({{"mesh", "long.msh"}, {"steps", 8}});
  scene["obstacles"].push_back(
      Json::parse(R"({"box": {"half_extents": [0.3, 0.3, 0.1]}, "mass": 20, "pose": {"position": [0.5, 0.2, 0.52]}})"));
  scene["attachments"] = Json::parse(R"([{"nearest": [0, 0, 0], "to": [0, 0, 0.3]}])");
  run(scene, "", "first");
  for (const char* threads : {"2", "4"}) {
    run(scene, std::string("--threads ") + threads, "again");
    for (const char* name : {"final.txt", "obstacles.csv", "attachments.csv"}) {
      EXPECT_FALSE(read(std::string("first/") + name).empty()) << name;
      EXPECT_EQ(read(std::string("again/") + name), read(std::string("first/") + name)) << name << ", " << threads;
    }
  }
}

// Closed surfaces, the right side out: by the divergence theorem their volume is that of the shape, to the error of the
// triangles; and they are where obstacles.csv says.
TEST_F(ContactRun, FramesShowObstacles) {
  const Json scene = block({{"steps", 4},
                            {"frames", {{"every", 2}}},
                            {"contact", {{"points", "none"}}},
                            {"obstacles", Json::parse(R"([{"half_space": {"normal": [0, 0, 2], "offset": -3}},
      {"sphere": {"radius": 0.5}, "pose": {"position": [2, 0, 2], "rotation": [0.6, 0, 0.8, 0]}, "mass": 1},
      {"box": {"half_extents": [0.2, 0.3, 0.4]}, "pose": {"position": [0, 0, 1]}, "angular_velocity": [1, 2, 3]},
      {"capsule": {"radius": 0.1, "half_height": 0.4}, "path": [[0, 1, 0, 0], [1, 1, 1, 0]]}])")}});
  run(scene);
  const std::string list = read("out/obstacles.pvd");
  for (const char* name : {"frames/obstacles_000000.vtu", "frames/obstacles_000001.vtu", "frames/obstacles_000002.vtu"})
    EXPECT_NE(list.find(std::string("\"") + name + "\""), std::string::npos) << name;
  EXPECT_FALSE(exists("out/frames/obstacles_000003.vtu"));

  const double pi = std::numbers::pi;
  const double volumes[] = {0, 4 * pi * 0.125 / 3, 8 * 0.2 * 0.3 * 0.4, pi * 0.01 * 0.8 + 4 * pi * 0.001 / 3};
  for (const int frame : {0, 2}) {
    const std::string file = read("out/frames/obstacles_00000" + std::to_string(frame) + ".vtu");
    const auto points = vtu_array<double>(file, "Points");
    const auto corners = vtu_array<Index>(file, "connectivity"), number = vtu_array<Index>(file, "obstacle");
    ASSERT_EQ(corners.size(), 3 * number.size());
    std::array<double, 4> volume{};
    std::array<V, 4> first_moment{};
    for (std::size_t t = 0; t < number.size(); ++t) {
      const auto x = [&](std::size_t k) { return V::load(points.data() + 3 * at(corners[3 * t + k])); };
      const double part = x(0).dot(x(1).cross(x(2))) / 6;
      volume[at(number[t])] += part;
      first_moment[at(number[t])] += part * (x(0) + x(1) + x(2)) / 4;
      if (number[t] != 0) continue;
      EXPECT_NEAR(x(0).z(), -3, 1e-12);
      EXPECT_GT((x(1) - x(0)).cross(x(2) - x(0)).z(), 0) << "the normal of the half-space";
    }
    for (int o = 1; o < 4; ++o) {
      EXPECT_NEAR(volume[at(o)], volumes[o], (o == 2 ? 1e-9 : 0.03) * volumes[o]) << o;
      EXPECT_NEAR((first_moment[at(o)] / volume[at(o)] - obstacle_rows(o)[at(2 * frame)].place).norm(), 0, 1e-9) << o;
    }
  }
  // A run without obstacles leaves nothing of them.
  run(block({{"obstacles", Json::array()}, {"steps", 1}}));
  for (const char* name : {"obstacles.csv", "obstacles.pvd", "frames/obstacles_000000.vtu"})
    EXPECT_FALSE(exists(std::string("out/") + name)) << name;
}

// A box by its triangles is the box: led and free, its mesh far from its centre of mass, wound either way.
TEST_F(ContactRun, AMeshIsTheSolidThatItEncloses) {
  must("mesh block --size 0.4 0.4 0.1 --corner 1 2 3 --cells 2 2 1 -o plate.obj");
  std::string turned = read("plate.obj");
  for (std::size_t line = turned.find("\nf "); line != std::string::npos; line = turned.find("\nf ", line + 1)) {
    std::istringstream corners(turned.substr(line + 3, turned.find('\n', line + 1) - line - 3));
    std::string a, b, c;
    corners >> a >> b >> c;
    turned.replace(line + 3, turned.find('\n', line + 1) - line - 3, a + " " + c + " " + b);
  }
  write("turned.obj", turned);
  const Json box = Json::parse(R"({"box": {"half_extents": [0.2, 0.2, 0.05]}, "pose": {"position": [0.2, 0.2, 0.6]}})");
  for (const double mass : {0.0, 5.0}) {
    Json scene = block({{"steps", 40}, {"frames", {{"every", 40}}}});
    const auto run_with = [&](Json obstacle, const std::string& folder) {
      obstacle["mass"] = mass;
      if (mass == 0) obstacle["path"] = Json::parse("[[0, 0, 0, 0], [0.5, 0, 0, -0.3]]");
      scene["obstacles"] = {obstacle};
      scene["gravity"] = {0, 0, mass > 0 ? -g : 0};
      if (mass > 0) scene["obstacles"].push_back(Json::parse(R"({"half_space": {}})"));
      run(scene, "", folder);
      return obstacle_rows(0, folder);
    };
    const auto expected = run_with(box, "box");
    for (const char* file : {"plate.obj", "turned.obj"}) {
      const auto rows = run_with({{"mesh", file}, {"pose", {{"position", {-1, -2, 0.6 - 3.05}}}}}, "mesh");
      ASSERT_EQ(rows.size(), expected.size());
      double largest = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        // The pose is that of the file's frame: the plate's centre is at (1.2, 2.2, 3.05) there.
        const auto& [w, x, y, z] = rows[i].rotation;
        const V centre = rows[i].place + corotet::rotation_of<double>({w, x, y, z}) * V(1.2, 2.2, 3.05);
        EXPECT_NEAR((centre - expected[i].place).norm(), 0, 1e-4) << file << ", step " << i;
        EXPECT_NEAR((rows[i].force - expected[i].force).norm(), 0, 1e-2 * 5 * g) << file << ", step " << i;
        largest = std::fmax(largest, rows[i].force.norm());
      }
      EXPECT_GT(largest, 10) << "they touched";
      const std::string frame = read("mesh/frames/obstacles_000001.vtu");
      const auto points = vtu_array<double>(frame, "Points");
      const auto corners = vtu_array<Index>(frame, "connectivity"), number = vtu_array<Index>(frame, "obstacle");
      double volume = 0;
      for (std::size_t t = 0; t < number.size(); ++t) {
        const auto x = [&](std::size_t k) { return V::load(points.data() + 3 * at(corners[3 * t + k])); };
        if (number[t] == 0) volume += x(0).dot(x(1).cross(x(2))) / 6;
      }
      EXPECT_NEAR(volume, 0.4 * 0.4 * 0.1, 1e-6) << file;
    }
  }
}

TEST_F(ContactRun, ContactsWithoutMemoryAndUnsettledOnesAreWarnedOf) {
  const auto errors_of = [&](const Json& scene) {
    write("scene.json", scene.dump());
    const Outcome outcome = corotet("run scene.json -o out");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.err;
  };
  must("mesh block --size 0.4 0.4 0.4 --cells 1 1 1 -o cube.msh");
  Json crowded = block({{"mesh", "cube.msh"}, {"steps", 3}});
  for (int i = 0; i < 4; ++i) crowded["obstacles"].push_back(crowded["obstacles"][0]);
  EXPECT_EQ(errors_of(crowded), "");
  crowded["contact"]["max_contacts_per_point"] = 1;  // 8 places for 4 points on 5 floors
  EXPECT_NE(errors_of(crowded).find("contact.max_contacts_per_point"), std::string::npos);
  EXPECT_GT(read_json("out/summary.json")["contact"]["dropped"], 0);

  Json hasty = block({{"steps", 20}});
  hasty["contact"]["passes"] = 1;
  EXPECT_NE(errors_of(hasty).find("contact.passes"), std::string::npos);
  EXPECT_GT(read_json("out/summary.json")["contact"]["unsettled"], 0);
}

// Bodies that share no free obstacle move as each does alone, in the same bytes.
TEST_F(ContactRun, SeveralBodiesMoveAsEachDoesAlone) {
  must("mesh beam --cells 6 2 2 -o beam.msh");
  const Json shared = Json::parse(R"({"steps": 30, "frames": {"every": 30}, "obstacles": [{"half_space": {}},
    {"sphere": {"radius": 0.1}, "pose": {"position": [0.2, 0.2, 0.7]}, "path": [[0, 0, 0, 0], [0.5, 0, 0, -0.3]]}]})");
  const std::vector<Json> bodies{
      Json::parse(R"({"mesh": "block.msh", "contact": {"friction": 0.3}, "probes": [{"nearest": [0, 0, 0]}]})"),
      Json::parse(R"({"mesh": "block10.msh", "name": "stiff", "scalar": "double", "material": {"young": 1e7},
        "attachments": [{"nearest": [0, 0, 0.4], "to": [0, 0, 0.6]}]})"),
      Json::parse(R"({"mesh": "beam.msh", "pins": [{"box": [[0,0,0],[0,1,1]]}], "contact": {"points": "none"}})")};
  Json together = shared;
  for (const Json& body : bodies) together["bodies"].push_back(body);
  const Json summary = run(together, "", "all");
  EXPECT_EQ(summary["completed"], true);
  ASSERT_EQ(summary["bodies"].size(), 3U);
  EXPECT_FALSE(exists("all/final.txt") || exists("all/probes.csv") || exists("all/volume.pvd"));
  std::vector<V> force(31, V::Zero());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Json alone = shared;
    alone.update(bodies[b]);
    alone.erase("name");
    Json expected = run(alone, "", "alone");
    const std::string name = b == 1 ? "stiff" : std::to_string(b), folder = "all/body_" + name + "/";
    for (const char* file : {"final.txt", "probes.csv", "volume.pvd", "frames/volume_000001.vtu"}) {
      EXPECT_GT(read(folder + file).size(), 10U) << folder << file;
      EXPECT_EQ(read(folder + file), read(std::string("alone/") + file)) << folder << file;
    }
    EXPECT_EQ(exists(folder + "attachments.csv"), b == 1);
    EXPECT_EQ(read(folder + "attachments.csv"), read("alone/attachments.csv"));
    const Json& entry = summary["bodies"][b];
    EXPECT_EQ(entry["name"], name);
    for (const char* key : {"vertices", "body_mass", "solver", "contact", "attachments", "probes", "status"})
      EXPECT_EQ(entry.value(key, Json()), expected.value(key, Json())) << name << ", " << key;
    const auto rows = obstacle_rows(1, "alone");
    for (std::size_t i = 0; i < rows.size(); ++i) force[i] += rows[i].force;
  }
  const auto rows = obstacle_rows(1, "all");
  ASSERT_EQ(rows.size(), 31U);
  double largest = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR((rows[i].force - force[i]).norm(), 0, 1e-9 * (1 + force[i].norm())) << "obstacles.csv has the sum";
    largest = std::fmax(largest, force[i].norm());
  }
  EXPECT_GT(largest, 10) << "the ball touched";
  // One body later on leaves nothing of them.
  run(block({{"steps", 1}}), "", "all");
  EXPECT_FALSE(exists("all/body_0/final.txt") || exists("all/body_stiff/frames/volume_000000.vtu"));
}

TEST_F(ContactRun, TwoBlocksCarryOneCrate) {
  must("mesh block --size 0.4 0.4 0.4 --corner 0.6 0 0.01 --cells 3 3 3 -o right.msh");
  const double mass = 20;
  const Json summary = run(Json::parse(R"({"bodies": [{"mesh": "block.msh", "name": "left"}, {"mesh": "right.msh"}],
    "steps": 150, "obstacles": [{"half_space": {}, "friction": 0.5}, {"box": {"half_extents": [0.4, 0.15, 0.05]}, "mass": 20,
    "pose": {"position": [0.5, 0.2, 0.5]}, "friction": 0.5}]})"));
  const auto crate = obstacle_rows(1), floor = obstacle_rows(0);
  ASSERT_EQ(crate.size(), 151U);
  V before = V::Zero();
  for (std::size_t i = 1; i < crate.size(); ++i) {
    const V velocity = (crate[i].place - crate[i - 1].place) / h;
    const V imbalance = mass * (velocity - before) - h * (crate[i].force + mass * V(0, 0, -g));
    EXPECT_NEAR(imbalance.norm(), 0, 1e-9 * mass) << "step " << i;
    before = velocity;
  }
  EXPECT_NEAR(crate.back().force.z(), mass * g, 0.02 * mass * g);
  EXPECT_NEAR(crate.back().place.x(), 0.5, 1e-3);
  EXPECT_NEAR(before.norm(), 0, 1e-4) << "it rests";
  double weight = mass * g, normal = -mass * g;  // the crate's counts for blocks and for the floor
  for (const Json& body : summary["bodies"]) {
    weight += body["body_mass"].get<double>() * g;
    normal += body["contact"]["normal_force"].get<double>();
    EXPECT_GT(body["contact"]["touching"], 6) << "floor and crate";
  }
  EXPECT_NEAR(-floor.back().force.z(), weight, 0.02 * weight);
  EXPECT_NEAR(normal, weight, 0.02 * weight);
}

TEST_F(ContactRun, TheSceneOfTheDataFolderRuns) {
  must("run '" COROTET_SCENES "/contact.json' -o out");
  const Json summary = read_json("out/summary.json");
  EXPECT_EQ(summary["contact"]["dropped"], 0);
  EXPECT_GT(summary["contact"]["touching"], 0);
  EXPECT_GT(summary["attachments"][0]["force"][2], 10) << "the grab pulls upwards";
  EXPECT_NEAR(obstacle_rows(1).back().place.z(), 0.27, 0.06) << "the crate is on the block";
}

TEST_F(ContactRun, StudiesRefuseContactByName) {
  write("scene.json", block().dump());
  for (const char* command : {"report scene.json -o report", "tune scene.json --error 0.1 -o tuned.json"}) {
    const Outcome outcome = corotet(command);
    EXPECT_EQ(outcome.exit_code, 1) << command;
    EXPECT_NE(outcome.err.find("scene.json: obstacles: "), std::string::npos) << outcome.err;
    EXPECT_FALSE(exists("report") || exists("tuned.json"));
  }
}

}  // namespace
}  // namespace contact_run_test
