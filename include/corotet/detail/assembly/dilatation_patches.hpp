// Patches of 4-node elements that share one dilatation: a grouping of the elements of any mesh.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/core/elementary.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Each element is in one patch. Patches, elements in a patch and vertices of a patch are in fixed order.
struct DilatationPatches {
  std::vector<Index> start;    ///< patches + 1 entries
  std::vector<Index> element;  ///< of patch p: element[start[p]] ... element[start[p + 1] - 1]
  Stencils vertices;           ///< of each patch

  [[nodiscard]] Index count() const { return vertices.count(); }
};

/// Groups elements as F-bar patches do (de Souza Neto, Andrade Pires & Owen 2005, "F-bar-based linear triangles and
/// tetrahedra for finite strain analysis of nearly incompressible solids"), here greedily, so that any mesh will do:
///  1. From the largest element left, a patch grows by the neighbour that leaves it most compact (V^(2/3) to surface),
///     first by those that bring no new vertex, as long as it has at most eight vertices. The cells of `make_block`
///     come out whole, with either split.
///  2. A patch of less than five elements joins the neighbour with which it shares most surface for its size, as long
///     as that gives at most twelve vertices.
/// That leaves some six degrees of freedom for each patch of an unstructured mesh (docs/benchmarks/elements.md).
template <std::floating_point Scalar, LinearTetrahedron Element>  // so that only who uses it compiles it
class PatchGrower {
 public:
  explicit PatchGrower(const TetMesh<Scalar, Element>& mesh)
      : nodes_(mesh.elements()), patch_of_(nodes_.size(), none), volume_(nodes_.size()), neighbours_(nodes_.size()) {
    for (std::size_t e = 0; e < nodes_.size(); ++e)
      measure(e, [&](std::size_t a) { return mesh.node_position(static_cast<Index>(e), a); });
    find_neighbours();
    grow_all();
    for (std::size_t size = 1; size < min_elements; ++size)
      for (std::size_t p = 0; p < patches_.size(); ++p)
        if (patches_[p].elements.size() == size) join_a_neighbour(p);
  }

  [[nodiscard]] DilatationPatches result() const {
    DilatationPatches out;
    out.start.assign(1, 0);
    out.vertices.start.assign(1, 0);
    for (const Patch& patch : patches_) {
      if (patch.elements.empty()) continue;
      out.element.insert(out.element.end(), patch.elements.begin(), patch.elements.end());
      std::sort(out.element.end() - std::ptrdiff_t(patch.elements.size()), out.element.end());
      out.start.push_back(size_of(out.element));
      out.vertices.vertex.insert(out.vertices.vertex.end(), patch.vertices.begin(), patch.vertices.end());
      out.vertices.start.push_back(size_of(out.vertices.vertex));
    }
    return out;
  }

 private:
  static constexpr Index none = -1;
  static constexpr std::size_t max_vertices_grown = 8, max_vertices_joined = 12, min_elements = 5;
  static_assert(max_vertices_joined <= Stencils::max_vertices);

  struct Face {
    Index element = none;  // behind it
    double area = 0;       // m^2
  };
  struct Patch {
    std::vector<Index> elements, vertices;  // vertices ascending
    double volume = 0, surface = 0;         // m^3, m^2
  };
  /// An element or a patch that could be added, and the surface that it shares.
  struct Candidate {
    Index index;
    double shared;
  };

  // Scores that differ by rounding of the positions, or little more, are the same: the first wins.
  static constexpr double clearly = 1 + 1e-4;

  template <class Position>
  void measure(std::size_t e, const Position& position) {
    for (std::size_t f = 0; f < 4; ++f) {
      const auto [a, b, c] = tet_faces[f];
      neighbours_[e][f].area = (position(b) - position(a)).cross(position(c) - position(a)).norm() / 2;
    }
    volume_[e] = (position(1) - position(0)).cross(position(2) - position(0)).dot(position(3) - position(0)) / 6;
  }

  void find_neighbours() {
    std::vector<FaceUse> uses;
    uses.reserve(4 * nodes_.size());
    for (std::size_t e = 0; e < nodes_.size(); ++e)
      for (int f = 0; f < 4; ++f) uses.push_back(face_use(nodes_[e].data(), 0, static_cast<Index>(e), f));
    sort_faces(uses);
    for (std::size_t k = 0; k + 1 < uses.size(); ++k) {
      if (uses[k].corners != uses[k + 1].corners) continue;
      neighbours_[at(uses[k].element)][at(uses[k].face)].element = uses[k + 1].element;
      neighbours_[at(uses[k + 1].element)][at(uses[k + 1].face)].element = uses[k].element;
    }
  }

  /// The whole number nearest to 8 log2(x), x > 0: the power of two in sqrt(2) x^8, which no C library rounds.
  [[nodiscard]] static int eighths_of_octaves(double x) {
    int octaves = 0, eighths = 0;
    const double m = std::frexp(x, &octaves), m2 = m * m, m4 = m2 * m2;
    std::frexp(square_root(2.0) * m4 * m4, &eighths);
    return 8 * octaves + eighths - 1;
  }

  /// Elements by falling volume, in classes of an eighth of an octave so that equals stay in their order.
  [[nodiscard]] std::vector<Index> seeds() const {
    const double largest = *std::max_element(volume_.begin(), volume_.end());
    std::vector<std::pair<int, Index>> order;
    order.reserve(volume_.size());
    for (std::size_t e = 0; e < volume_.size(); ++e)
      order.emplace_back(eighths_of_octaves(largest / volume_[e]), static_cast<Index>(e));
    std::sort(order.begin(), order.end());
    std::vector<Index> seeds;
    seeds.reserve(order.size());
    for (const auto& [size_class, e] : order) seeds.push_back(e);
    return seeds;
  }

  void grow_all() {
    for (const Index seed : seeds()) {
      if (patch_of_[at(seed)] != none) continue;
      patches_.emplace_back();
      add(seed, 0);
      for (Candidate next = best_neighbour(patches_.back()); next.index != none; next = best_neighbour(patches_.back()))
        add(next.index, next.shared);
    }
  }

  /// Adds an element to the newest patch.
  void add(Index e, double shared) {
    Patch& patch = patches_.back();
    patch_of_[at(e)] = size_of(patches_) - 1;
    patch.elements.push_back(e);
    patch.vertices = united(patch.vertices, nodes_[at(e)]);
    patch.volume += volume_[at(e)];
    patch.surface += surface(e) - 2 * shared;
  }

  [[nodiscard]] Candidate best_neighbour(const Patch& patch) const {
    candidates_.clear();
    for (const Index e : patch.elements)
      for (const Face& face : neighbours_[at(e)])
        if (face.element != none && patch_of_[at(face.element)] == none) add_candidate(face.element, face.area);
    Candidate best{none, 0};
    double best_score = 0;
    for (const Candidate& c : candidates_) {
      const std::size_t vertices = united(patch.vertices, nodes_[at(c.index)]).size();
      if (vertices > max_vertices_grown) continue;
      // Compactness is .21 for a cube and less for any polyhedron with fewer faces: a vertex spared outweighs it.
      const double spared = vertices == patch.vertices.size() ? 1 : 0;
      const double volume = patch.volume + volume_[at(c.index)];
      const double compactness = cube_root(volume * volume) / (patch.surface + surface(c.index) - 2 * c.shared);
      if (spared + compactness <= best_score * clearly) continue;
      best_score = spared + compactness;
      best = c;
    }
    return best;
  }

  void join_a_neighbour(std::size_t p) {
    candidates_.clear();
    for (const Index e : patches_[p].elements)
      for (const Face& face : neighbours_[at(e)])
        if (face.element != none && patch_of_[at(face.element)] != static_cast<Index>(p))
          add_candidate(patch_of_[at(face.element)], face.area);
    Index best = none;
    double best_score = 0;
    for (const Candidate& c : candidates_) {
      const Patch& other = patches_[at(c.index)];
      const double score = c.shared / double(other.elements.size());
      if (score <= best_score * clearly || united(patches_[p].vertices, other.vertices).size() > max_vertices_joined)
        continue;
      best_score = score;
      best = c.index;
    }
    if (best == none) return;
    Patch& other = patches_[at(best)];
    other.vertices = united(patches_[p].vertices, other.vertices);
    for (const Index e : patches_[p].elements) {
      patch_of_[at(e)] = best;
      other.elements.push_back(e);
    }
    patches_[p] = {};
  }

  void add_candidate(Index index, double shared) const {
    const auto known =
        std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& c) { return c.index == index; });
    if (known == candidates_.end())
      candidates_.push_back({index, shared});
    else
      known->shared += shared;
  }

  [[nodiscard]] double surface(Index e) const {
    double sum = 0;
    for (const Face& face : neighbours_[at(e)]) sum += face.area;
    return sum;
  }

  /// `sorted` with what `more` has besides, ascending.
  template <class Vertices>
  [[nodiscard]] static std::vector<Index> united(std::vector<Index> sorted, const Vertices& more) {
    for (const Index v : more) {
      const auto place = std::lower_bound(sorted.begin(), sorted.end(), v);
      if (place == sorted.end() || *place != v) sorted.insert(place, v);
    }
    return sorted;
  }

  const std::vector<std::array<Index, 4>>& nodes_;
  std::vector<Index> patch_of_;
  std::vector<double> volume_;                   // m^3, > 0
  std::vector<std::array<Face, 4>> neighbours_;  // [element][face]
  std::vector<Patch> patches_;
  mutable std::vector<Candidate> candidates_;
};

/// Patches of some five to eight elements over the whole mesh; the same for the same mesh. O(n log n).
template <std::floating_point Scalar, LinearTetrahedron Element>
[[nodiscard]] DilatationPatches dilatation_patches(const TetMesh<Scalar, Element>& mesh) {
  return PatchGrower<Scalar, Element>(mesh).result();
}

}  // namespace corotet::inline v0_1::detail
