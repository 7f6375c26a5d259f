// Isosurface stuffing: a tetrahedral mesh of good shape for the inside of a function or of a closed surface.
//
// Labelle & Shewchuk, "Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles", 2007: cut a BCC lattice
// at the surface, warp lattice vertices that lie near it onto it, fill the rest from a few stencils. Every dihedral
// angle lies within 10.7 and 164.8 degrees, whatever the function (tested, see cut_points.hpp). Elements have one size.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/signed_distance.hpp>
#include <corotet/detail/mesh/stuffing/cut_points.hpp>
#include <corotet/detail/mesh/stuffing/lattice.hpp>
#include <corotet/detail/mesh/stuffing/perforation.hpp>
#include <corotet/detail/mesh/stuffing/stencils.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/mesh/validate.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

struct StuffingOptions {
  double size = 0;  ///< side of a lattice cube, m, > 0: elements have edges of 0.87 and 1 of it, less at the surface
  double max_cubes = 1e7;  ///< refuse larger lattices; each cube takes some 50 bytes while meshing, up to 1e8
  /// The function changes by no more than 1 m a m, as distances do: whole blocks of the lattice in_middle from the
  /// surface are then settled by one evaluation.
  bool is_distance = false;
};

namespace detail {

inline constexpr Index stuffing_margin = 2;  // cubes around the box: the outermost layer must lie outside

/// Values of `f` at the lattice vertices; with `is_distance` bounds of the same sign where the surface is in_middle.
template <class Function>
std::vector<double> sample(const BccLattice& lattice, const Function& f, bool is_distance) {
  std::vector<double> values(at(lattice.vertex_count()));
  constexpr Index block = 8;  // cubes
  const BccLattice::Coordinates& n = lattice.cells();
  for (Index k = 0; k <= n[2]; k += block)
    for (Index j = 0; j <= n[1]; j += block)
      for (Index i = 0; i <= n[0]; i += block) {
        // The vertices of a block fill half a cube less than `block` cubes, from its first corner on.
        const Vec3<double> middle =
            lattice.position(lattice.corner(i, j, k)) + Vec3<double>::Constant((block - 0.5) / 2 * lattice.size());
        const double in_middle = is_distance ? f(middle) : 0;
        const auto fill = [&](Index v) {
          const Vec3<double> p = lattice.position(v);
          const double bound = std::fabs(in_middle) - (p - middle).norm();
          values[at(v)] = bound > 0 ? std::copysign(bound, in_middle) : f(p);
        };
        for (Index z = k; z < (std::min)(k + block, n[2] + 1); ++z)
          for (Index y = j; y < (std::min)(j + block, n[1] + 1); ++y)
            for (Index x = i; x < (std::min)(i + block, n[0] + 1); ++x) {
              fill(lattice.corner(x, y, z));
              if (x < n[0] && y < n[1] && z < n[2]) fill(lattice.centre(x, y, z));
            }
      }
  return values;
}

/// The mesh of a cut lattice, vertices numbered in the order in which its tetrahedra name them.
inline MeshData fill_lattice(const BccLattice& lattice, const CutLattice& cut) {
  constexpr Index unused = -1;
  std::vector<Index> of_lattice(cut.sign.size(), unused), of_cut(cut.cuts.size(), unused);
  MeshData mesh;
  const auto number = [&](Index& known, auto&& position) {
    if (known == unused) {
      known = mesh.vertex_count();
      mesh.positions.push_back(position());
    }
    return known;
  };
  const auto vertex = [&](const StencilVertex& v) {
    if (v.a != v.b) {
      const Index c = cut.find_cut(v.a, v.b);
      return number(of_cut[at(c)], [&] {
        const Vec3<double> a = lattice.position(cut.cuts[at(c)].ends.first);
        return a + cut.cuts[at(c)].along * (lattice.position(cut.cuts[at(c)].ends.second) - a);
      });
    }
    return number(of_lattice[at(v.a)], [&] {
      const auto moved = std::lower_bound(cut.warped.begin(), cut.warped.end(), v.a,
                                          [](const auto& entry, Index w) { return entry.first < w; });
      return moved != cut.warped.end() && moved->first == v.a ? moved->second : lattice.position(v.a);
    });
  };
  lattice.for_each_tetrahedron([&](const std::array<Index, 4>& tet) {
    std::array<std::int8_t, 4> sign;
    for (std::size_t i = 0; i < 4; ++i) sign[i] = cut.sign[at(tet[i])];
    fill_tetrahedron(lattice, tet, sign, [&](const auto&... corners) {
      std::array<Index, 4> nodes{vertex(corners)...};
      if (corner_volume(mesh.positions, nodes.data()) < 0) turn_round<Tet4>(nodes);
      mesh.connectivity.insert(mesh.connectivity.end(), nodes.begin(), nodes.end());
    });
  });
  return mesh;
}

}  // namespace detail

/// The mesh of the points of `box` where `f` (m or any unit) is negative. The surface should lie inside `box`; what
/// reaches more than two cubes beyond it is an error. Features thinner than about one cube are lost or perforated; the
/// notes say how many pieces and tunnels the mesh has.
/// Errors: invalid_argument (size, box, too many cubes, the region leaves the box), non_finite_value, empty_mesh (no
/// lattice vertex is inside).
template <std::invocable<const Vec3<double>&> Function>
[[nodiscard]] Result<MeshData> stuff_isosurface(const Function& f, const Box& box, const StuffingOptions& options) {
  if (!(options.size > 0) || !std::isfinite(options.size))
    return Error{ErrorCode::invalid_argument, "size", "the side of a lattice cube must be positive and finite"};
  if (!box.low.allFinite() || !box.high.allFinite() || !((box.high - box.low).minCoeff() >= 0))
    return Error{ErrorCode::invalid_argument, "box", "it must be finite, and low no greater than high"};
  const double cubes = detail::BccLattice::cell_count_of(box, options.size, detail::stuffing_margin);
  if (!(cubes <= (std::min)(options.max_cubes, 1e8)))
    return Error{ErrorCode::invalid_argument, "size",
                 "it takes " + std::to_string(cubes) + " lattice cubes; at most " +
                     std::to_string((std::min)(options.max_cubes, 1e8)) + " are allowed"};

  const detail::BccLattice lattice(box, options.size, detail::stuffing_margin);
  const std::vector<double> values = detail::sample(lattice, f, options.is_distance);
  Index inside = 0;
  for (Index v = 0; v < lattice.vertex_count(); ++v) {
    if (!std::isfinite(values[at(v)]))
      return Error{ErrorCode::non_finite_value, "function", "it is not finite at a lattice vertex"};
    if (values[at(v)] < 0 && lattice.on_rim(v))
      return Error{ErrorCode::invalid_argument, "box", "the region inside reaches beyond it"};
    inside += values[at(v)] < 0 ? 1 : 0;
  }
  if (inside == 0) return Error{ErrorCode::empty_mesh, "size", "no lattice vertex is inside: use smaller cubes"};
  const detail::CutLattice cut = detail::cut_and_warp(lattice, f, values);
  MeshData mesh = detail::fill_lattice(lattice, cut);
  if (mesh.connectivity.empty())
    return Error{ErrorCode::empty_mesh, "size", "the region is too thin for any element: use smaller cubes"};
  const auto& [nx, ny, nz] = lattice.cells();
  mesh.notes.push_back("lattice of " + std::to_string(nx) + " x " + std::to_string(ny) + " x " + std::to_string(nz) +
                       " cubes of " + std::to_string(options.size) + " m; " + std::to_string(cut.warped.size()) +
                       " vertices warped onto the surface");
  return mesh;
}

/// The mesh of the inside of a closed triangle surface of either winding. Errors: as above, and those of
/// SignedDistance::create. Where the mesh differs from the surface in its number of pieces or tunnels, or leaves out
/// surface vertices by more than a cube, the notes say so.
[[nodiscard]] inline Result<MeshData> stuff_surface(const SurfaceMesh& surface, StuffingOptions options) {
  const Result<detail::SignedDistance> distance = detail::SignedDistance::create(surface);
  if (!distance) return distance.error();
  options.is_distance = true;
  Result<MeshData> mesh = stuff_isosurface(*distance, distance->bounds(), options);
  if (!mesh) return mesh;
  if (distance->turned())
    mesh->notes.push_back("the surface is wound clockwise seen from outside: taken as turned round");
  if (Result<void> status = detail::note_perforation(*mesh, surface, options.size); !status) return status.error();
  return mesh;
}

}  // namespace corotet::inline v0_1
