// CGAL's Mesh_3 meshes the beam from its outline, keeping the sharp edges; corotet lets it sag.
//
// This program links CGAL, whose mesh generation is under the GPL, so what is built from this file is under the GPL
// too. The library corotet is under the MIT licence: it neither needs CGAL nor includes or links it. Built with
// -DCOROTET_BUILD_GPL_EXAMPLES=ON only.
//
//   beam_cgal [edge length / beam thickness, default 0.5]
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_polyhedron_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Polyhedral_mesh_domain_with_features_3.h>
#include <CGAL/make_mesh_3.h>

#include <cmath>
#include <corotet/mesh/raise_order.hpp>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <unordered_map>

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

MeshData mesh_beam(double edge_length) {
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

  MeshData mesh;
  int flat_cells = 0;
  std::unordered_map<Triangulation::Vertex_handle, Index> vertex;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
    // Four vertices of a flat face of the outline may form a cell without volume, which TetMesh would refuse. It lies
    // in the face, so nothing is lost with it.
    if (std::abs(complex.triangulation().tetrahedron(cell).volume()) < 1e-4 * std::pow(edge_length, 3)) {
      ++flat_cells;
      continue;
    }
    for (int i = 0; i < 4; ++i) {
      const auto [found, is_new] = vertex.try_emplace(cell->vertex(i), mesh.vertex_count());
      if (is_new) {
        const auto& p = cell->vertex(i)->point();
        mesh.positions.emplace_back(p.x(), p.y(), p.z());
      }
      mesh.connectivity.push_back(found->second);
    }
  }
  if (flat_cells > 0) std::printf("left out %d flat cells on the faces\n", flat_cells);
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  const double edge_length = beam::thickness * (argc > 1 ? std::atof(argv[1]) : 0.5);
  if (!(edge_length > 0)) return std::fprintf(stderr, "the edge length must be positive\n"), 2;
  const MeshData mesh = mesh_beam(edge_length);
  return beam::sag<Tet4>(mesh) && beam::sag<Tet10>(raise_order(mesh)) ? 0 : 1;
}
