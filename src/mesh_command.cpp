// `corotet mesh`: makes and converts meshes.
#include <fmt/core.h>

#include <array>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <corotet/detail/mesh/io/read_surface.hpp>
#include <corotet/detail/mesh/io/write_msh.hpp>
#include <corotet/detail/mesh/io/write_obj.hpp>
#include <corotet/detail/mesh/io/write_vtu.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <corotet/detail/mesh/stuffing/isosurface_stuffing.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command.hpp"
#include "failure.hpp"

namespace corotet::program {
namespace {

struct MeshCommandOptions {
  std::string shape;
  std::vector<double> size;
  std::vector<double> corner{0, 0, 0};
  std::vector<int> cells;
  std::string split = "alternating5";
  int order = 0;
  std::string from;
  std::string stuff;
  double cell = 0;  // m
  bool clean = false;
  std::string output;
  std::string msh_version;  // these two: empty if not given
  std::string encoding;
};

/// Said before anything is made, which may take long.
void check_output(const MeshCommandOptions& options) {
  const std::string ending = std::filesystem::path(options.output).extension().string();
  if (ending != ".msh" && ending != ".vtu" && ending != ".obj")
    throw Failure(fmt::format("--output {}: its name must end with .msh, .vtu or .obj, which says what to write",
                              options.output));
  if (!options.msh_version.empty() && ending != ".msh")
    throw Failure(fmt::format("--msh-version does not apply to --output {}: it is for .msh files", options.output));
  if (!options.encoding.empty() && ending == ".obj")
    throw Failure(fmt::format("--encoding does not apply to --output {}: .obj files are text", options.output));
}

MeshData make_shape(const MeshCommandOptions& options) {
  const bool beam = options.shape == "beam";
  BlockOptions block;
  block.size = beam ? Vec3<double>(1, 0.2, 0.2) : Vec3<double>(1, 1, 1);
  block.cells = beam ? std::array<Index, 3>{10, 2, 2} : std::array<Index, 3>{4, 4, 4};
  if (!options.size.empty()) block.size = Vec3<double>::load(options.size.data());
  if (!options.cells.empty()) block.cells = {options.cells[0], options.cells[1], options.cells[2]};
  block.corner = Vec3<double>::load(options.corner.data());
  block.split = options.split == "kuhn6" ? BlockSplit::kuhn6 : BlockSplit::alternating5;
  block.order = options.order == 0 ? 1 : options.order;
  return require(make_block(block));
}

MeshData convert(const MeshCommandOptions& options) {
  MeshData mesh = require(read_mesh(options.from));
  if (options.clean) mesh = remove_unreferenced(std::move(mesh));
  if (options.order == 1) mesh = lower_order(std::move(mesh));
  if (options.order == 2) mesh = raise_order(std::move(mesh));
  return mesh;
}

MeshData stuff(const MeshCommandOptions& options) {
  const SurfaceMesh surface = require(read_surface(options.stuff));
  Result<MeshData> stuffed = stuff_surface(surface, {.size = options.cell});
  if (!stuffed) throw Failure(fmt::format("{}: {}", options.stuff, stuffed.error().message()));
  MeshData mesh = std::move(stuffed).value();
  mesh.notes.insert(mesh.notes.begin(), surface.notes.begin(), surface.notes.end());
  return options.order == 2 ? raise_order(std::move(mesh)) : mesh;
}

/// Makes the one of the three that was asked for.
MeshData make(const MeshCommandOptions& options) {
  if (!options.shape.empty()) return make_shape(options);
  MeshData mesh = options.stuff.empty() ? convert(options) : stuff(options);
  const std::string& source = options.stuff.empty() ? options.from : options.stuff;
  for (const std::string& note : mesh.notes) fmt::print(stderr, "corotet: note: {}: {}\n", source, note);
  return mesh;
}

/// Says why a body could not be made of the mesh; the file is written all the same, for it may be what was asked for.
void warn_if_unusable(const MeshData& mesh) {
  const auto why = [&]() -> std::optional<Error> {
    if (mesh.nodes_per_element == 4) {
      const auto checked = TetMesh<double, Tet4>::create(mesh);
      return checked ? std::nullopt : std::optional(checked.error());
    }
    const auto checked = TetMesh<double, Tet10>::create(mesh);
    return checked ? std::nullopt : std::optional(checked.error());
  }();
  if (!why) return;
  fmt::print(stderr, "corotet: warning: `corotet run` will refuse this mesh: {}\n", why->message());
  if (why->code == ErrorCode::unreferenced_vertex) fmt::print(stderr, "corotet: --clean drops such vertices\n");
}

void write(const MeshCommandOptions& options, const MeshData& mesh) {
  const std::filesystem::path path = options.output;
  const std::string ending = path.extension().string();
  const char* nodes = mesh.nodes_per_element == 4 ? "4-node" : "10-node";
  if (ending == ".msh") {
    require(write_msh(path, mesh, {options.msh_version == "2.2" ? 22 : 41, options.encoding == "binary"}));
  } else if (ending == ".vtu") {
    VtuGrid grid{.points = mesh.positions, .cells = vtu_cells(mesh)};
    if (!mesh.regions.empty()) grid.cell_data = {{"region", mesh.regions}};
    require(write_vtu(path, grid, {options.encoding == "ascii" ? VtuEncoding::ascii : VtuEncoding::appended}));
  } else {  // .obj
    const CompactSurface boundary = compact_surface(require(extract_boundary(mesh)), mesh.positions);
    require(write_obj(path, boundary.surface));
    fmt::print("wrote {}: the boundary, {} vertices, {} triangles\n", options.output, boundary.surface.positions.size(),
               boundary.surface.triangles.size());
    return;
  }
  fmt::print("wrote {}: {} vertices, {} elements ({})\n", options.output, mesh.vertex_count(), mesh.element_count(),
             nodes);
}

}  // namespace

Command add_mesh_command(CLI::App& app) {
  auto options = std::make_shared<MeshCommandOptions>();
  CLI::App* syntax = app.add_subcommand("mesh", "Make a beam or a block, fill a surface, or convert a mesh");
  const auto shape =
      syntax
          ->add_option("shape", options->shape,
                       "What to make: beam (1 x 0.2 x 0.2 m unless --size says otherwise) or block (1 x 1 x 1 m)")
          ->check(CLI::IsMember({"beam", "block"}));
  const auto from =
      syntax
          ->add_option("--from", options->from,
                       "Convert this file instead: gmsh .msh, Medit .mesh, legacy .vtk, Vega .veg, TetGen .node/.ele")
          ->excludes(shape);
  const auto stuffed = syntax
                           ->add_option("--stuff", options->stuff,
                                        "Fill this closed surface instead: .obj, .stl, .ply, .off; needs --cell")
                           ->excludes(shape)
                           ->excludes(from);
  const auto cell =
      syntax->add_option("--cell", options->cell, "Size of the elements for --stuff, m, > 0")->needs(stuffed);
  stuffed->needs(cell);
  syntax->add_option("--size", options->size, "Length along x, y and z, m, > 0")->expected(3)->needs(shape);
  syntax->add_option("--corner", options->corner, "The corner with the least coordinates, m (0 0 0)")
      ->expected(3)
      ->needs(shape);
  syntax->add_option("--cells", options->cells, "Cells along x, y and z, >= 1 (beam 10 2 2, block 4 4 4)")
      ->expected(3)
      ->needs(shape);
  syntax->add_option("--split", options->split, "How a cell is cut (alternating5, which leans to no side; kuhn6 does)")
      ->check(CLI::IsMember({"alternating5", "kuhn6"}))
      ->needs(shape);
  syntax->add_option("--order", options->order, "1: 4-node elements, 2: 10-node elements (1; for --from the file's)")
      ->check(CLI::IsMember({1, 2}));
  syntax->add_flag("--clean", options->clean, "Drop vertices that belong to no element")->needs(from);
  syntax
      ->add_option("-o,--output", options->output,
                   "Where to: .msh (gmsh), .vtu (ParaView), .obj (only the boundary surface)")
      ->required();
  syntax->add_option("--msh-version", options->msh_version, "Of .msh files: 4.1 (the default) or 2.2")
      ->check(CLI::IsMember({"2.2", "4.1"}));
  syntax->add_option("--encoding", options->encoding, "ascii or binary (.msh: ascii, .vtu: binary)")
      ->check(CLI::IsMember({"ascii", "binary"}));
  syntax->footer(
      "Examples:\n"
      "  corotet mesh beam --order 2 -o beam.msh\n"
      "  corotet mesh beam --cells 20 4 4 --split kuhn6 -o beam_s.msh\n"
      "  corotet mesh block --size 2 2 1 --corner -1 -1 0 --cells 8 8 4 -o block.vtu\n"
      "  corotet mesh beam --cells 40 8 8 -o skin.obj\n"
      "  corotet mesh --from bunny.1.ele --clean --order 2 -o bunny.msh\n"
      "  corotet mesh --stuff skin.obj --cell 0.05 -o stuffed.msh");
  return {syntax, [options] {
            if (options->shape.empty() && options->from.empty() && options->stuff.empty())
              throw Failure("corotet mesh: say what to make: beam, block, --from FILE, or --stuff SURFACE");
            check_output(*options);
            const MeshData mesh = make(*options);
            write(*options, mesh);
            if (options->shape.empty()) warn_if_unusable(mesh);
            return 0;
          }};
}

}  // namespace corotet::program
