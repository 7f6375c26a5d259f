// Input that makes no sense must be refused by name, and leave the body as it was.
#include <fmt/core.h>

#include <cmath>
#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

#include "../failure.hpp"
#include "case.hpp"
#include "test_body.hpp"

namespace corotet::program::stress {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

/// Whether a body is refused, in words that hold `name`.
void expect_no_body(const Scene& scene, const MeshData& mesh, const std::string& name, CaseResult& verdict) {
  try {
    (void)make_simulation(scene, mesh);
    verdict.expect(false, fmt::format("\"{}\": taken", name));
  } catch (const Failure& failure) {
    const std::string said = failure.what();
    verdict.expect(said.find(name) != std::string::npos, fmt::format("\"{}\": only says {}", name, said));
  }
}

CaseResult bad_body(const Configuration& configuration) {
  CaseResult verdict;
  const MeshData good = block(configuration.order);
  const auto with_material = [&](double Material::*member, const char* name, std::initializer_list<double> values) {
    for (const double value : values) {
      Scene scene = configuration.scene();
      scene.material.*member = value;
      expect_no_body(scene, good, name, verdict);
    }
  };
  with_material(&Material::young, "young", {0, -1, nan, inf});
  with_material(&Material::poisson, "poisson", {0.5, 0.7, -1, -3, nan});
  with_material(&Material::density, "density", {0, -1, nan, inf});

  const auto with_mesh = [&](const char* name, auto&& spoil) {
    MeshData mesh = good;
    spoil(mesh);
    expect_no_body(configuration.scene(), mesh, name, verdict);
  };
  with_mesh("vertex 7", [](MeshData& m) { m.positions[7].y() = nan; });
  with_mesh("vertex 7", [](MeshData& m) { m.positions[7].y() = inf; });
  with_mesh("element 3", [](MeshData& m) { m.connectivity[at(3 * m.nodes_per_element)] = m.vertex_count(); });
  with_mesh("element 3", [](MeshData& m) { m.connectivity[at(3 * m.nodes_per_element)] = -1; });
  with_mesh("vertex", [](MeshData& m) { m.positions.emplace_back(3, 3, 3); });
  with_mesh("no vertices", [](MeshData& m) { m = {}; });
  with_mesh("elements", [](MeshData& m) { m.connectivity.clear(); });
  with_mesh("element", [](MeshData& m) {
    for (Vec3<double>& x : m.positions) x.z() = 0;
  });
  with_mesh("element 3", [](MeshData& m) {
    m.connectivity[at(3 * m.nodes_per_element)] = m.connectivity[at(3 * m.nodes_per_element) + 1];
  });
  if (!configuration.in_double()) {
    Scene scene = configuration.scene();  // no mass is left of it in float
    scene.material.density = 1e-60;
    expect_no_body(scene, good, "density", verdict);
  }
  return verdict;
}

/// What a step leaves behind where it is refused: everything as it was.
CaseResult bad_step(const Configuration& configuration) {
  CaseResult verdict;
  Scene scene = configuration.scene();
  scene.gravity = {0, 0, -9.81};
  TestBody trial(scene, block(configuration.order));
  const auto pinned = trial.pin(at_left_end);
  trial.run(5);
  Simulation& body = trial.body();
  ThreadPool pool(1);
  PhaseClock clock;
  const auto state = [&] {
    std::vector<double> numbers;
    for (Index v = 0; v < trial.vertices(); ++v)
      for (const Vec3<double>& x : {body.displacement(v), body.velocity(v)})
        numbers.insert(numbers.end(), x.begin(), x.end());
    return numbers;
  };
  const std::vector<double> before = state();
  const auto expect_refusal = [&](const char* what, StepError error, double h, Index vertex = -1) {
    const StepReport report = body.step(h, pool, clock);
    verdict.expect(report.error == error && (vertex < 0 || report.vertex == vertex),
                   fmt::format("{}: not refused by name", what));
    verdict.expect(state() == before, fmt::format("{}: the state has changed", what));
  };
  for (const double h : {0.0, -0.01, nan, inf}) expect_refusal("h", StepError::time_step, h);
  Field<double> forces(at(trial.vertices()), Vec3<double>::Zero());
  for (const double bad : {nan, inf}) {
    forces[11].x() = bad;
    body.set_forces(forces);
    expect_refusal("force", StepError::external_force, scene.dt, 11);
  }
  forces[11].setZero();
  body.set_forces(forces);
  for (const double bad : {nan, inf}) {
    body.move_pin(pinned.front(), {0, bad, 0});
    expect_refusal("pin", StepError::pin_target, scene.dt, pinned.front());
  }
  body.move_pin(pinned.front(), Vec3<double>::Zero());
  for (const double bad : {nan, inf}) {
    Field<double> field(at(trial.vertices()), Vec3<double>::Zero());
    field[13].z() = bad;
    for (const Result<void>& status : {body.set_positions(field), body.set_velocities(field)})
      verdict.expect(!status.ok() && status.error().message().find("13") != std::string::npos,
                     "a state that is not finite: not refused by name");
    verdict.expect(state() == before, "a refused state: the state has changed");
  }
  verdict.expect(trial.run(5), "no step is possible after refusals");
  trial.report_to(verdict);
  return verdict;
}

/// Beginnings of a mesh file, and numbers in it that promise too much.
CaseResult bad_file() {
  CaseResult verdict;
  namespace fs = std::filesystem;
  const fs::path path =
      fs::temp_directory_path() / fmt::format("corotet-stress-{}.msh", static_cast<const void*>(&verdict));
  const std::string whole =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
      "$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";
  const auto read = [&](const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return read_mesh(path.string());
  };
  verdict.expect(read(whole).ok(), "the whole file is refused");
  const std::size_t last_node = whole.find("4 0 0 1"), end = whole.find("$EndElements");
  for (std::size_t length = 0; length + 1 < end; ++length) {
    const auto mesh = read(whole.substr(0, length));
    verdict.expect(!mesh.ok() && !mesh.error().message().empty(), fmt::format("cut after {} bytes: taken", length));
  }
  for (const char* count : {"4000000000", "-1", "99999999999999999999", "1e9", "nan"}) {
    std::string hostile = whole;
    hostile.replace(hostile.find("\n4\n") + 1, 1, count);
    verdict.expect(!read(hostile).ok(), fmt::format("{} nodes: taken", count));
  }
  std::string hostile = whole;
  hostile.replace(last_node, 7, "4 0 0 nan");
  const auto mesh = read(hostile);
  verdict.expect(!mesh.ok(), "a coordinate that is not a number: taken");
  std::error_code ignored;
  fs::remove(path, ignored);
  return verdict;
}

}  // namespace

void add_input_cases(std::vector<Case>& cases) {
  const std::vector<Ratio> one{{"nu=.3", 0.3, VolumetricStrain::pointwise}};
  cases.push_back({"bad-body",
                   "NaN, Inf and values out of range for material and positions; flat, empty and broken meshes",
                   "an error that names what is wrong", Solvers::two, one,
                   [](const Configuration& c, const Effort&) { return bad_body(c); }});
  cases.push_back({"bad-step", "NaN, Inf, zero and negative h; NaN and Inf in a force, a pin, a state",
                   "refused by name, the state untouched to the bit, the next step works", Solvers::all, one,
                   [](const Configuration& c, const Effort&) { return bad_step(c); }});
  cases.push_back({"bad-file", "a mesh file cut after each of its bytes, or with hostile counts", "an error each time",
                   Solvers::two, one, [](const Configuration&, const Effort&) { return bad_file(); }});
}

}  // namespace corotet::program::stress
