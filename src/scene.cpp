#include "scene.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <filesystem>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "failure.hpp"
#include "file_key.hpp"
#include "json_file.hpp"
#include "object_reader.hpp"
#include "problems.hpp"

namespace corotet::program {
namespace {

namespace fs = std::filesystem;

/// The two corners under "box"; nothing, after noting a problem, if they are not there.
std::optional<std::pair<Vec3<double>, Vec3<double>>> read_box(ObjectReader& in, const Json& value) {
  std::vector<Vec3<double>> corners;
  in.list("box", [&](const Json& corner, const std::string& where) {
    if (const auto numbers = read_numbers(corner, 3, where, in.problems()))
      corners.emplace_back(Vec3<double>::load(numbers->data()));
  });
  if (corners.size() == 2) {
    if (corners[0].cwiseMin(corners[1]) != corners[0])
      in.problems().add(in.path_of("box"), "its first corner must not lie above its second along any axis");
    return std::pair(corners[0], corners[1]);
  }
  if (!value.is_object() || !value.contains("box"))
    in.problems().add(in.path_of("box"), "is missing: [[x, y, z], [x, y, z]], the least and the greatest corner");
  else if (value["box"].is_array() && value["box"].size() != 2)
    in.problems().add(in.path_of("box"), "must be two corners: [[x, y, z], [x, y, z]]");
  return std::nullopt;
}

void read_pin(const Json& value, const std::string& path, Problems& problems, std::vector<PinBox>& pins) {
  ObjectReader in(value, path, problems);
  const auto box = read_box(in, value);
  std::vector<PathPoint> led = read_path_points(in);
  if (box) pins.push_back({box->first, box->second, std::move(led)});
  in.refuse_others();
}

void read_force(const Json& value, const std::string& path, Problems& problems, std::vector<ForceBox>& forces) {
  ObjectReader in(value, path, problems);
  ForceBox force;
  if (value.is_object() && !in.has("total") && !in.has("torque"))
    problems.add(path, "needs \"total\": [x, y, z] (N) or \"torque\": [x, y, z] (N m)");
  in.vector("total", force.total);
  in.vector("torque", force.torque);
  if (const auto box = read_box(in, value)) {
    std::tie(force.least, force.most) = *box;
    forces.push_back(force);
  }
  in.refuse_others();
}

void read_probe(const Json& value, const std::string& path, Problems& problems, std::vector<Vec3<double>>& probes) {
  ObjectReader in(value, path, problems);
  Vec3<double> point = Vec3<double>::Zero();
  if (value.is_object() && !in.has("nearest")) problems.add(in.path_of("nearest"), "is missing: [x, y, z]");
  in.vector("nearest", point);
  in.refuse_others();
  probes.push_back(point);
}

void read_integrator(ObjectReader& in, Scene& scene) {
  in.choice("name", scene.integrator,
            {{"implicit_euler", IntegratorKind::implicit_euler}, {"bdf2", IntegratorKind::bdf2}});
  in.number("dt", scene.dt, Range::above(0));
  in.integer("newton", scene.newton.iterations, 1);
  in.number("newton_tolerance", scene.newton.tolerance, Range::between(0, 1));
  in.choice("tangent", scene.newton.tangent,
            {{"plain", Tangent::warped}, {"stretch_stable", Tangent::stabilized}, {"exact", Tangent::consistent}});
  in.choice("energy", scene.newton.bounds_energy, {{"bounded", true}, {"as_integrated", false}});
  in.choice("spin", scene.newton.keeps_angular_momentum, {{"kept", true}, {"as_integrated", false}});
  in.choice("untrusted", scene.untrusted,
            {{"accept", OnUnreliable::accept}, {"refuse", OnUnreliable::refuse}, {"divide", OnUnreliable::divide}});
}

/// What the integrator asks of other keys.
void check_integrator(const Scene& scene, Problems& problems) {
  const bool polar = scene.rotation == RotationKind::polar && scene.rotation_site == RotationSite::point;
  if (scene.newton.tangent == Tangent::consistent && !polar)
    problems.add("integrator.tangent", "exact is known only for \"rotation\": \"polar\" at each point");
  if (scene.untrusted == OnUnreliable::divide && scene.touches_obstacles())
    problems.add("integrator.untrusted",
                 "divide does not lead obstacles through parts of a step: take accept or refuse, or a smaller "
                 "integrator.dt");
}

void read_solver(ObjectReader& in, SolverOptions& solver) {
  in.choice("name", solver.method,
            {{"auto", SolverMethod::automatic}, {"pcg", SolverMethod::pcg}, {"cholesky", SolverMethod::cholesky}},
            {"cholmod"});
  in.choice("preconditioner", solver.preconditioner,
            {{"auto", PreconditionerKind::automatic},
             {"jacobi", PreconditionerKind::jacobi},
             {"block_jacobi", PreconditionerKind::block_jacobi},
             {"rigid_aggregates", PreconditionerKind::rigid_aggregates},
             {"warped_cholesky", PreconditionerKind::warped_cholesky}},
            {"ic0"});
  in.number("tolerance", solver.tolerance, Range::between(0, 1));
  in.integer("max_iterations", solver.max_iterations, 1);
}

/// In float, a number may become 0 or infinite that is neither as it was written; a step would be refused for it.
void check_float_range(const Scene& scene, Problems& problems) {
  constexpr auto least = static_cast<double>(std::numeric_limits<float>::min());
  constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  std::string prefix;
  const auto refuse = [&](const std::string& key, double value, const char* what) {
    problems.add(prefix + key, fmt::format("{} is too {} for float; \"scalar\": \"double\" can hold it", value, what));
  };
  const auto check = [&](const std::string& key, double value) {
    if (std::abs(value) > most) refuse(key, value, "large");
  };
  const auto check_positive = [&](const std::string& key, double value) {
    check(key, value);
    if (value < least) refuse(key, value, "small");
  };
  const auto check_vector = [&](const std::string& key, const Vec3<double>& v) {
    check(key, *std::max_element(v.begin(), v.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
  };
  check_positive("integrator.dt", scene.dt);
  check_vector("gravity", scene.gravity);
  prefix = scene.key_prefix;
  check_positive("material.young", scene.material.young);
  check_positive("material.density", scene.material.density);
  check("damping.mass", scene.damping.mass);
  check("damping.stiffness", scene.damping.stiffness);
  if (scene.initial_velocity) check_vector("initial.velocity", *scene.initial_velocity);
  if (scene.initial_angular_velocity) check_vector("initial.angular_velocity", *scene.initial_angular_velocity);
  for (std::size_t i = 0; i < scene.forces.size(); ++i) {
    check_vector(fmt::format("forces[{}].total", i), scene.forces[i].total);
    check_vector(fmt::format("forces[{}].torque", i), scene.forces[i].torque);
  }
  for (std::size_t i = 0; i < scene.contact.attachments.size(); ++i) {  // the rest of contact is in double
    check_positive(fmt::format("attachments[{}].stiffness", i), scene.contact.attachments[i].options.stiffness);
    check(fmt::format("attachments[{}].damping", i), scene.contact.attachments[i].options.damping);
  }
  for (std::size_t i = 0; i < scene.pins.size(); ++i)  // boxes are compared in double
    for (std::size_t k = 0; k < scene.pins[i].path.size(); ++k)
      check_vector(fmt::format("pins[{}].path[{}]", i, k), scene.pins[i].path[k].displacement);
}

void read_initial(ObjectReader& in, const fs::path& folder, Scene& scene) {
  scene.initial_positions = read_file_key(in, "positions", folder);
  scene.initial_velocities = read_file_key(in, "velocities", folder);
  const auto read_motion = [&](const char* key, std::optional<Vec3<double>>& motion) {
    if (!in.has(key)) return;
    in.vector(key, motion.emplace(Vec3<double>::Zero()));
    if (in.has("velocities"))
      in.problems().add(in.path_of(key), "velocities come from a file already: initial.velocities");
  };
  read_motion("velocity", scene.initial_velocity);
  read_motion("angular_velocity", scene.initial_angular_velocity);
}

/// The keys of a body; `value`: the object that holds them.
void read_body(ObjectReader& in, const Json& value, const fs::path& folder, Scene& scene) {
  Problems& problems = in.problems();
  if (value.is_object() && !in.has("mesh")) problems.add(in.path_of("mesh"), "is missing; every body needs one");
  scene.mesh = read_file_key(in, "mesh", folder).value_or("");
  in.integer("order", scene.order, 1, 2);
  in.choice("scalar", scene.scalar,
            {{"float", ScalarKind::single_precision}, {"double", ScalarKind::double_precision}});
  in.object("material", [&](ObjectReader& material) {
    material.number("young", scene.material.young, Range::above(0));
    material.number("poisson", scene.material.poisson, Range::between(-1, 0.5));
    material.number("density", scene.material.density, Range::above(0));
  });
  in.object("damping", [&](ObjectReader& damping) {
    damping.number("mass", scene.damping.mass, Range::from(0));
    damping.number("stiffness", scene.damping.stiffness, Range::from(0));
  });
  in.list("pins", [&](const Json& pin, const std::string& where) { read_pin(pin, where, problems, scene.pins); });
  in.list("forces",
          [&](const Json& force, const std::string& where) { read_force(force, where, problems, scene.forces); });
  in.choice("mass", scene.mass, {{"lumped", MassModel::lumped}, {"consistent", MassModel::consistent}});
  in.choice("dilatation", scene.volumetric_strain,
            {{"per_element", VolumetricStrain::pointwise}, {"mean", VolumetricStrain::averaged}});
  in.choice("rotation", scene.rotation,
            {{"identity", RotationKind::identity},
             {"gram_schmidt", RotationKind::gram_schmidt},
             {"polar", RotationKind::polar}});
  in.choice("rotation_site", scene.rotation_site, {{"point", RotationSite::point}, {"element", RotationSite::element}});
  in.object("initial", [&](ObjectReader& initial) { read_initial(initial, folder, scene); });
  scene.surface = read_file_key(in, "surface", folder);
  read_contact(in, scene.contact);
  in.list("probes",
          [&](const Json& probe, const std::string& where) { read_probe(probe, where, problems, scene.probes); });
}

/// The keys that all bodies share.
void read_shared(ObjectReader& in, const fs::path& folder, Scene& scene) {
  in.vector("gravity", scene.gravity);
  in.object("integrator", [&](ObjectReader& integrator) { read_integrator(integrator, scene); });
  in.object("solver", [&](ObjectReader& solver) { read_solver(solver, scene.solver); });
  read_obstacles(in, folder, scene.obstacles);
  in.integer("steps", scene.steps, 0);
  in.object("frames", [&](ObjectReader& frames) { frames.integer("every", scene.frames_every, 0); });
}

/// The name of a body, which becomes that of a folder: its number unless it has one.
std::string read_name(ObjectReader& in, const std::vector<Scene>& before) {
  std::string name = std::to_string(before.size());
  in.text("name", name);
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  if (name.empty() || !std::all_of(name.begin(), name.end(), is_plain))
    in.problems().add(in.path_of("name"), fmt::format("must be letters, digits, - and _, is \"{}\"", name));
  if (std::any_of(before.begin(), before.end(), [&](const Scene& other) { return other.name == name; }))
    in.problems().add(in.path_of("name"), fmt::format("another body is called \"{}\"", name));
  return name;
}

}  // namespace

std::vector<Scene> read_scenes(const fs::path& path) {
  const Json json = read_json(path);
  const fs::path folder = path.parent_path();
  Problems problems(path.string());
  ObjectReader in(json, "", problems);
  Scene shared;
  shared.file = path;
  read_shared(in, folder, shared);

  std::vector<Scene> bodies;
  if (in.has("bodies")) {
    in.list("bodies", [&](const Json& value, const std::string& where) {
      ObjectReader body(value, where, problems);
      Scene scene = shared;
      scene.name = read_name(body, bodies);
      scene.key_prefix = where + ".";
      read_body(body, value, folder, scene);
      body.refuse_others();
      bodies.push_back(std::move(scene));
    });
    if (json["bodies"].is_array() && json["bodies"].empty()) problems.add("bodies", "must hold at least one body");
  } else {
    read_body(in, json, folder, bodies.emplace_back(shared));
  }
  in.refuse_others();
  for (const Scene& scene : bodies) check_integrator(scene, problems);
  problems.stop_if_any();
  for (const Scene& scene : bodies)
    if (scene.scalar == ScalarKind::single_precision) check_float_range(scene, problems);
  problems.stop_if_any();
  return bodies;
}

Scene read_scene(const fs::path& path) {
  Scene scene = std::move(read_scenes(path).front());
  if (!scene.name.empty())
    throw Failure(path.string() +
                  ": bodies: only `corotet run` takes several: write the keys of one body beside \"steps\"");
  return scene;
}

void refuse_contact(const Scene& scene, const char* command) {
  Problems problems(scene.file.string());
  const auto refuse = [&](const char* key, bool is_there) {
    if (is_there)
      problems.add(key, fmt::format("`corotet {}` compares bodies that touch nothing: leave it out; `corotet run` "
                                    "runs the whole scene",
                                    command));
  };
  refuse("obstacles", !scene.obstacles.empty());
  refuse("attachments", !scene.contact.attachments.empty());
  problems.stop_if_any();
}

}  // namespace corotet::program
