// CGAL's Mesh_3 meshes the beam from its outline, keeping the sharp edges; corotet lets it sag.
//
// This program links CGAL, whose mesh generation is under the GPL, so what is built from this file is under the GPL
// too. The library corotet is under the MIT licence: it neither needs CGAL nor includes or links it. Built with
// -DCOROTET_BUILD_GPL_EXAMPLES=ON only.
//
//   beam_cgal [edge length / beam thickness, default 0.5] [file.mesh, to keep the mesh as CGAL writes it]
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_polyhedron_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Polyhedral_mesh_domain_with_features_3.h>
#include <CGAL/make_mesh_3.h>

#include <cmath>
#include <corotet/io.hpp>
#include <corotet/mesh.hpp>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "self_weight_beam.hpp"

using namespace corotet;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Outline = CGAL::Mesh_polyhedron_3<Kernel>::type;
using Domain = CGAL::Polyhedral_mesh_domain_with_features_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

/// The box as a polyhedron, by way of the .off format that CGAL reads.
Outline make_outline() {
  std::stringstream off;
  off << "OFF\n8 6 0\n";
  for (int corner = 0; corner < 8; ++corner)
    off << (corner & 1 ? beam::length : 0) << ' ' << beam::thickness * (corner & 2 ? 0.5 : -0.5) << ' '
        << beam::thickness * (corner & 4 ? 0.5 : -0.5) << '\n';
  off << "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";
  Outline outline;
  off >> outline;
  CGAL::Polygon_mesh_processing::triangulate_faces(outline);
  return outline;
}

/// Four vertices of a flat face of the outline may form a cell without volume, which TetMesh would refuse. It lies in
/// the face, so nothing is lost with it.
MeshData without_flat_cells(MeshData mesh, double edge_length) {
  const double min_volume = 1e-4 * std::pow(edge_length, 3);
  std::vector<Index> kept;
  for (std::size_t first = 0; first < mesh.connectivity.size(); first += 4) {
    const Index* cell = &mesh.connectivity[first];
    const auto edge = [&](int a) { return mesh.positions[at(cell[a])] - mesh.positions[at(cell[0])]; };
    if (std::abs(edge(1).cross(edge(2)).dot(edge(3))) / 6 >= min_volume) kept.insert(kept.end(), cell, cell + 4);
  }
  const std::size_t left_out = (mesh.connectivity.size() - kept.size()) / 4;
  if (left_out > 0) std::printf("left out %zu flat cells on the faces\n", left_out);
  mesh.connectivity = std::move(kept);
  mesh.regions.clear();
  return remove_unreferenced(std::move(mesh));
}

/// Also writes the mesh to `path`, as CGAL writes it, if that is not empty.
MeshData mesh_beam(double edge_length, const std::string& path) {
  namespace parameter = CGAL::parameters;
  Outline outline = make_outline();
  Domain domain(outline);
  domain.detect_features(60);  // degrees: edges that turn by more are kept
  const Criteria criteria(parameter::edge_size = edge_length, parameter::facet_angle = 25,
                          parameter::facet_size = edge_length, parameter::facet_distance = 0.05 * edge_length,
                          parameter::cell_radius_edge_ratio = 2, parameter::cell_size = edge_length);
  // Perturbing and exuding remove slivers; without time limits the mesh is the same on every machine.
  const auto complex = CGAL::make_mesh_3<Complex>(domain, criteria, parameter::perturb(parameter::time_limit = 0),
                                                  parameter::exude(parameter::time_limit = 0));

  // The way a mesh comes from CGAL in a file, too: in Medit's format.
  std::ostringstream file;
  complex.output_to_medit(file);
  if (!path.empty()) std::ofstream(path) << file.str();
  Result<MeshData> mesh = read_medit(file.str(), "CGAL's mesh");
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().message().c_str());
    return {};
  }
  return without_flat_cells(*std::move(mesh), edge_length);
}

}  // namespace

int main(int argc, char** argv) {
  const double edge_length = beam::thickness * (argc > 1 ? std::atof(argv[1]) : 0.5);
  if (!(edge_length > 0)) return std::fprintf(stderr, "the edge length must be positive\n"), 2;
  const MeshData mesh = mesh_beam(edge_length, argc > 2 ? argv[2] : "");
  return beam::sag<Tet4>(mesh) && beam::sag<Tet10>(raise_order(mesh)) ? 0 : 1;
}
