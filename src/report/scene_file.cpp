#include "scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace corotet::program {
namespace {

namespace fs = std::filesystem;

std::string relative_path(const fs::path& path, const fs::path& folder) {
  const fs::path from = folder.empty() ? fs::path(".") : folder;
  const fs::path relative =
      fs::absolute(path).lexically_normal().lexically_relative(fs::absolute(from).lexically_normal());
  return (relative.empty() ? fs::absolute(path) : relative).generic_string();  // empty: on another drive
}

void rebase(Json& object, const char* key, const fs::path& old_folder, const fs::path& folder) {
  if (object.contains(key)) object[key] = relative_path(old_folder / object[key].get<std::string>(), folder);
}

}  // namespace

std::string format_scene(const fs::path& original, const Configuration& configuration, const fs::path& mesh,
                         const fs::path& folder) {
  Json json = read_json(original);
  const Scene& scene = configuration.scene;
  const Scene before = read_scene(original);
  const double steps_in_one = before.dt / scene.dt;
  json["mesh"] = relative_path(mesh, folder);
  json["order"] = configuration.order;
  json["scalar"] = scene.scalar == ScalarKind::single_precision ? "float" : "double";
  json["mass"] = scene.mass == MassModel::lumped ? "lumped" : "consistent";
  json["integrator"]["name"] = name_of(scene.integrator);
  json["integrator"]["dt"] = scene.dt;
  json["solver"]["preconditioner"] = std::string(corotet::name_of(scene.solver.preconditioner));
  json["solver"]["tolerance"] = scene.solver.tolerance;
  json["steps"] = std::lround(before.steps * steps_in_one);
  if (before.frames_every > 0) json["frames"]["every"] = std::max(1L, std::lround(before.frames_every * steps_in_one));
  rebase(json, "surface", original.parent_path(), folder);
  if (json.contains("initial"))
    for (const char* key : {"positions", "velocities"}) rebase(json["initial"], key, original.parent_path(), folder);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace corotet::program
