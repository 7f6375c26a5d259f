#include "output_folder.hpp"

#include <fmt/format.h>

#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/write_vtu.hpp>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include "failure.hpp"

namespace corotet::program {
namespace {

namespace fs = std::filesystem;

constexpr const char* body_prefix = "body_";

void remove_results(const fs::path& folder) {
  std::error_code ignored;
  for (const char* name : {"summary.json", "final.txt", "probes.csv", "attachments.csv", "obstacles.csv", "volume.pvd",
                           "surface.pvd", "obstacles.pvd"})
    fs::remove(folder / name, ignored);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / frames_folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool is_frame = name.starts_with("volume_") || name.starts_with("surface_") || name.starts_with("obstacles_");
    if (is_frame && name.ends_with(".vtu")) fs::remove(entry.path(), ignored);
  }
}

/// Removes what a run writes and nothing else, so that old files cannot pass for new ones.
void remove_earlier_run(const fs::path& folder) {
  std::error_code ignored;
  remove_results(folder);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().filename().string().starts_with(body_prefix) && entry.is_directory(ignored))
      remove_results(entry.path());
}

}  // namespace

std::string body_folder(const std::string& name) { return body_prefix + name; }

void make_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (!fs::is_directory(folder))
    throw Failure(fmt::format("{}: this folder cannot be made: {}", folder.string(),
                              code ? code.message() : "a file of this name is there"));
}

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  make_folder(folder_);
  remove_earlier_run(folder_);
}

void OutputFolder::add_probes(double t, const Simulation& simulation, const std::vector<Index>& probes) {
  if (!probes_.is_open()) probes_.open(folder_ / "probes.csv", "t,probe,x,y,z");
  std::string rows;
  for (std::size_t p = 0; p < probes.size(); ++p) {
    const Vec3<double> x = simulation.position(probes[p]);
    fmt::format_to(std::back_inserter(rows), "{},{},{},{},{}\n", t, p, x[0], x[1], x[2]);
  }
  probes_.add(rows);
}

void OutputFolder::add_attachments(double t, const std::vector<AttachmentState>& attachments) {
  if (attachments.empty()) return;
  if (!attachments_.is_open()) attachments_.open(folder_ / "attachments.csv", "t,attachment,x,y,z,fx,fy,fz");
  std::string rows;
  for (std::size_t i = 0; i < attachments.size(); ++i) {
    const auto& [x, f] = attachments[i];
    fmt::format_to(std::back_inserter(rows), "{},{},{},{},{},{},{},{}\n", t, i, x[0], x[1], x[2], f[0], f[1], f[2]);
  }
  attachments_.add(rows);
}

void OutputFolder::add_frame(double t, Simulation& simulation, const MeshData& mesh, const SurfaceMesh* surface) {
  Field<double> positions, displacements, velocities;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    positions.push_back(simulation.position(v));
    displacements.push_back(simulation.displacement(v));
    velocities.push_back(simulation.velocity(v));
  }
  VtuGrid grid{.points = positions,
               .cells = vtu_cells(mesh),
               .point_data = {{"displacement", displacements}, {"velocity", velocities}}};
  if (!mesh.regions.empty()) grid.cell_data = {{"region", mesh.regions}};
  volume_.add(folder_, t, grid);
  if (surface == nullptr) return;

  const SurfaceState state = simulation.surface();
  surface_.add(folder_, t,
               {.points = state.positions, .cells = vtu_cells(*surface), .point_data = {{"normal", state.normals}}});
}

void OutputFolder::write_whole(const char* name, const std::string& bytes) const {
  const fs::path path = folder_ / name, unfinished = folder_ / (std::string(name) + ".part");
  require(write_file(unfinished, bytes));
  std::error_code code;
  fs::rename(unfinished, path, code);
  if (code) throw Failure(fmt::format("{}: it cannot be written: {}", path.string(), code.message()));
}

void OutputFolder::write_final(const Simulation& simulation, Index vertices) {
  std::string text;
  for (Index v = 0; v < vertices; ++v) {
    const Vec3<double> x = simulation.position(v);
    fmt::format_to(std::back_inserter(text), "{:.17g} {:.17g} {:.17g}\n", x[0], x[1], x[2]);
  }
  write_whole("final.txt", text);
}

void OutputFolder::write_summary(const std::string& json) { write_whole("summary.json", json); }

}  // namespace corotet::program
