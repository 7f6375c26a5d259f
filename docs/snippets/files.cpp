// Files, and errors that they bring; a surface that moves with a body.
#include <algorithm>
#include <array>
#include <corotet/integrators.hpp>
#include <corotet/io.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/surface.hpp>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

using namespace corotet;

namespace {

//! [read]
/// A body from a mesh file of any format that is read. An error says which file, where in it, and what is wrong.
Result<SoftBody<float, Tet10>> read_body(const std::string& path) {
  auto data = read_mesh(path);
  if (!data) return data.error();
  data = raise_order(*std::move(data));  // 10-node elements, whatever the file has
  if (!data) return data.error();
  const auto mesh = TetMesh<float, Tet10>::create(*data);
  if (!mesh) return mesh.error();
  return SoftBody<float, Tet10>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
}
//! [read]

//! [result]
/// Test a Result, then use it as a pointer to its value.
void print_size(const std::string& path) {
  const auto data = read_mesh(path);
  if (!data) {
    std::fprintf(stderr, "%s\n", data.error().message().c_str());  // "beam.msh: there is no such file"
    return;
  }
  std::printf("%zu vertices\n", data->positions.size());
}
//! [result]

//! [write]
/// A frame for ParaView: the deformed mesh with its displacements.
Result<void> write_frame(const std::string& path, const SoftBody<float, Tet10>& body) {
  Field<float> positions;
  for (Index v = 0; v < body.vertex_count(); ++v) positions.push_back(body.position(v));
  return write_vtu(
      path,
      {.points = positions, .cells = vtu_cells(body.mesh()), .point_data = {{"displacement", body.displacements()}}});
}
//! [write]

//! [surface]
/// A renderer's vertex, and its buffer.
struct Vertex {
  std::array<float, 3> position, normal;
};

/// Binds a skin once, then fills the buffer each frame.
Result<std::vector<Vertex>> draw(SoftBody<float, Tet10>& body, const SurfaceMesh& skin, int frames) {
  auto surface = EmbeddedSurface<float, Tet10>::bind(body.mesh(), skin);
  if (!surface) return surface.error();
  std::vector<Vertex> vertices(at(surface->vertex_count()));
  ImplicitEuler euler(body);
  for (int frame = 0; frame < frames; ++frame) {
    euler.step(body, 1.0f / 60);
    surface->update(body.displacements(), {.data = reinterpret_cast<std::byte*>(vertices.data()),
                                           .stride = sizeof(Vertex),
                                           .count = size_of(vertices),
                                           .position_offset = offsetof(Vertex, position),
                                           .normal_offset = offsetof(Vertex, normal)});
  }
  return vertices;
}
//! [surface]

int fail(const Error& error) { return std::fprintf(stderr, "%s\n", error.message().c_str()), 1; }

}  // namespace

int main(int, char** arguments) {
  const std::string folder = std::filesystem::path(arguments[0]).parent_path().string();
  const std::string beam = folder + "/snippet_beam.msh";
  const auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {4, 1, 1}});
  if (!block) return fail(block.error());
  if (const auto written = write_msh(beam, *block); !written) return fail(written.error());
  print_size(beam);
  auto body = read_body(beam);
  if (!body) return fail(body.error());
  body->set_gravity({0, 0, -9.81f});
  const auto boundary = extract_boundary(*block);
  if (!boundary) return fail(boundary.error());
  const auto vertices = draw(*body, compact_surface(*boundary, block->positions).surface, 6);
  if (!vertices) return fail(vertices.error());
  if (const auto written = write_frame(folder + "/snippet_beam.vtu", *body); !written) return fail(written.error());
  const float lowest = std::min_element(vertices->begin(), vertices->end(), [](const Vertex& a, const Vertex& b) {
                         return a.position[2] < b.position[2];
                       })->position[2];
  std::printf("lowest vertex at %.4f m\n", lowest);
  return lowest < -0.05f ? 0 : 1;
}
