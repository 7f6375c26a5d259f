// What every fuzz target of a reader of tetrahedral meshes checks, whatever the bytes.
#pragma once

#include <corotet/detail/element/tet10.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <corotet/detail/mesh/io/read_msh.hpp>
#include <corotet/detail/mesh/io/write_msh.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>

#include "fuzz/fuzz_check.hpp"

namespace corotet::fuzz {

/// A reader must return an error that says where and why, or a mesh whose arrays fit together: the writer takes it and
/// the .msh reader gives the same arrays back.
inline int check_mesh(const Result<MeshData>& result) {
  if (!result) return check_error(result.error());
  const MeshData& mesh = *result;
  const Result<std::string> content = format_msh(mesh, {mesh.positions.size() % 2 == 0 ? 22 : 41, true});
  // The one thing that readers leave to TetMesh::create.
  if (!content && content.error().code == ErrorCode::duplicate_node) return 0;
  check(content.ok());
  const Result<MeshData> again = read_msh(*content, "again");
  check(again.ok());
  check(again->positions == mesh.positions);
  // Version 2 drops an element that repeats the one before, as gmsh's writer makes them.
  check(mesh.positions.size() % 2 == 0 || again->connectivity == mesh.connectivity);
  if (mesh.nodes_per_element == 4) {
    static_cast<void>(TetMesh<float, Tet4>::create(remove_unreferenced(mesh)).ok());
    static_cast<void>(TetMesh<double, Tet10>::create(raise_order(remove_unreferenced(mesh))).ok());
  } else {
    static_cast<void>(TetMesh<double, Tet10>::create(remove_unreferenced(mesh)).ok());
  }
  return 0;
}

}  // namespace corotet::fuzz
