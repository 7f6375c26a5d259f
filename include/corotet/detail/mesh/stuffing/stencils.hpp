// How the part of a lattice tetrahedron inside the surface is cut into tetrahedra.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/stuffing/lattice.hpp>
#include <cstdint>
#include <utility>

namespace corotet::inline v0_1::detail {

/// A vertex of the mesh: the lattice vertex `a` where a == b, otherwise the cut point on the edge a b.
struct StencilVertex {
  Index a, b;
};

/// A lattice face whose corners `a` and `b` are inside and `o` outside leaves a quadrilateral. Whether its diagonal is
/// the one from `a` to the cut point on b o; otherwise it is the one from `b` to the cut point on a o. Both tetrahedra
/// at the face ask the same question, and the answers keep the angles from 0 and 180 degrees:
/// - a cut point on a long edge takes the diagonal;
/// - if both are on short edges (a b is long), the diagonals alternate around a b (the parity rule of the paper).
inline bool diagonal_from(const BccLattice& lattice, Index a, Index b, Index o) {
  if (!lattice.is_long(a, b)) return lattice.is_long(b, o);
  const BccLattice::Coordinates ca = lattice.coordinates(a), cb = lattice.coordinates(b), co = lattice.coordinates(o);
  // Counted from the lower end, so that a and b can be exchanged; along the edge, o lies above it always.
  const BccLattice::Coordinates& low = ca < cb ? ca : cb;
  int above = 0;
  for (std::size_t i = 0; i < 3; ++i) above += co[i] > low[i] ? 1 : 0;
  return (above % 2 == 0) == (ca < cb);
}

/// A triangular prism p q with the side edges p[i] q[i]. `before[i][j]`: the diagonal of side ij is p[i] q[j], not
/// p[j] q[i]. This must order the three sides; each tetrahedron then holds p up to one place of the order, q from it.
template <class AddTet>
void split_prism(const std::array<StencilVertex, 3>& p, const std::array<StencilVertex, 3>& q, bool before01,
                 bool before02, bool before12, AddTet&& add_tet) {
  std::array<std::size_t, 3> place{};  // how many come before
  ++place[before01 ? 1 : 0];
  ++place[before02 ? 2 : 0];
  ++place[before12 ? 2 : 1];
  std::array<std::size_t, 3> r{};
  for (std::size_t i = 0; i < 3; ++i) r[place[i]] = i;
  add_tet(p[r[0]], p[r[1]], p[r[2]], q[r[2]]);
  add_tet(p[r[0]], p[r[1]], q[r[1]], q[r[2]]);
  add_tet(p[r[0]], q[r[0]], q[r[1]], q[r[2]]);
}

/// Calls `add_tet(v0, v1, v2, v3)` for each tetrahedron of the part inside (sign < 0), of either winding.
template <class AddTet>
void fill_tetrahedron(const BccLattice& lattice, const std::array<Index, 4>& tet,
                      const std::array<std::int8_t, 4>& sign, AddTet&& add_tet) {
  std::array<Index, 4> in{}, on{}, out{};
  std::size_t ins = 0, ons = 0, outs = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (sign[i] < 0) in[ins++] = tet[i];
    if (sign[i] == 0) on[ons++] = tet[i];
    if (sign[i] > 0) out[outs++] = tet[i];
  }
  const auto lattice_vertex = [](Index v) { return StencilVertex{v, v}; };
  const auto from = [&](Index a, Index b, Index o) { return diagonal_from(lattice, a, b, o); };
  if (ins == 0) return;
  if (outs == 0) {
    add_tet(lattice_vertex(tet[0]), lattice_vertex(tet[1]), lattice_vertex(tet[2]), lattice_vertex(tet[3]));
  } else if (ins == 1) {
    std::array<StencilVertex, 3> others;
    for (std::size_t i = 0; i < ons; ++i) others[i] = lattice_vertex(on[i]);
    for (std::size_t i = 0; i < outs; ++i) others[ons + i] = {in[0], out[i]};
    add_tet(lattice_vertex(in[0]), others[0], others[1], others[2]);
  } else if (ons == 1) {  // two in, one out: a pyramid over the quadrilateral
    const StencilVertex a = lattice_vertex(in[0]), b = lattice_vertex(in[1]), top = lattice_vertex(on[0]);
    const StencilVertex cut_a{in[0], out[0]}, cut_b{in[1], out[0]};
    if (from(in[0], in[1], out[0])) {
      add_tet(a, b, cut_b, top);
      add_tet(a, cut_b, cut_a, top);
    } else {
      add_tet(a, b, cut_a, top);
      add_tet(b, cut_b, cut_a, top);
    }
  } else if (ins == 3) {  // a tip is cut off: a prism between the face inside and the cut
    const Index o = out[0];
    split_prism({lattice_vertex(in[0]), lattice_vertex(in[1]), lattice_vertex(in[2])},
                {StencilVertex{in[0], o}, StencilVertex{in[1], o}, StencilVertex{in[2], o}}, from(in[0], in[1], o),
                from(in[0], in[2], o), from(in[1], in[2], o), add_tet);
  } else {  // two in, two out: a prism between the two corners that are cut off
    const bool first = from(in[0], in[1], out[0]), second = from(in[0], in[1], out[1]);
    // The third side lies on the surface, so its diagonal is free: take one that goes with the other two.
    split_prism({lattice_vertex(in[0]), StencilVertex{in[0], out[0]}, StencilVertex{in[0], out[1]}},
                {lattice_vertex(in[1]), StencilVertex{in[1], out[0]}, StencilVertex{in[1], out[1]}}, first, second,
                second, add_tet);
  }
}

}  // namespace corotet::inline v0_1::detail
