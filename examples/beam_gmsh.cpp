// gmsh meshes the beam in this process, with 4-node and with 10-node tetrahedra; corotet lets it sag.
//
// This program links gmsh, which is under the GPL, so what is built from this file is under the GPL too. The library
// corotet is under the MIT licence: it neither needs gmsh nor includes or links it. Built with
// -DCOROTET_BUILD_GPL_EXAMPLES=ON only.
//
//   beam_gmsh [edge length / beam thickness, default 0.5]
#include <gmsh.h>

#include <corotet/mesh.hpp>
#include <cstdio>
#include <cstdlib>
#include <unordered_map>

#include "self_weight_beam.hpp"

using namespace corotet;

namespace {

/// The mesh that gmsh holds at present, as corotet wants it.
MeshData from_gmsh(int order) {
  MeshData mesh;
  std::vector<std::size_t> tags, element_tags, node_tags;
  std::vector<double> coordinates, parametric;
  gmsh::model::mesh::getNodes(tags, coordinates, parametric);
  std::unordered_map<std::size_t, Index> vertex;  // gmsh numbers its nodes as it likes
  for (std::size_t i = 0; i < tags.size(); ++i) {
    vertex[tags[i]] = static_cast<Index>(i);
    mesh.positions.emplace_back(coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]);
  }
  mesh.nodes_per_element = order == 1 ? 4 : 10;
  gmsh::model::mesh::getElementsByType(order == 1 ? 4 : 11, element_tags, node_tags);
  for (const std::size_t tag : node_tags) mesh.connectivity.push_back(vertex.at(tag));
  // The last two of the ten nodes lie on edges 2-3 and 1-3 in gmsh, on edges 1-3 and 2-3 here.
  if (order == 2)
    for (std::size_t end = 10; end <= mesh.connectivity.size(); end += 10)
      std::swap(mesh.connectivity[end - 1], mesh.connectivity[end - 2]);
  return remove_unreferenced(std::move(mesh));
}

MeshData mesh_beam(double edge_length, int order) {
  gmsh::clear();
  gmsh::model::occ::addBox(0, -beam::thickness / 2, -beam::thickness / 2, beam::length, beam::thickness,
                           beam::thickness);
  gmsh::model::occ::synchronize();
  gmsh::option::setNumber("Mesh.MeshSizeMin", edge_length);
  gmsh::option::setNumber("Mesh.MeshSizeMax", edge_length);
  gmsh::model::mesh::generate(3);
  gmsh::model::mesh::setOrder(order);
  return from_gmsh(order);
}

}  // namespace

int main(int argc, char** argv) {
  const double edge_length = beam::thickness * (argc > 1 ? std::atof(argv[1]) : 0.5);
  if (!(edge_length > 0)) return std::fprintf(stderr, "the edge length must be positive\n"), 2;
  try {
    gmsh::initialize();
    gmsh::option::setNumber("General.Verbosity", 2);
    const bool ok = beam::sag<Tet4>(mesh_beam(edge_length, 1)) && beam::sag<Tet10>(mesh_beam(edge_length, 2));
    gmsh::finalize();
    return ok ? 0 : 1;
  } catch (...) {  // what gmsh throws has changed from version to version
    std::fprintf(stderr, "gmsh could not mesh the beam\n");
    return 1;
  }
}
