// The edges of a tetrahedral mesh as lines to draw.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <vector>

namespace corotet::inline v0_1 {

/// Each edge of each element once, as a pair of vertices, the lower first; sorted. An edge with a node in its middle is
/// two lines, so that a curved one is drawn bent.
template <std::floating_point Scalar, TetrahedralElement Element>
[[nodiscard]] std::vector<std::array<Index, 2>> element_lines(const TetMesh<Scalar, Element>& mesh) {
  std::vector<std::array<Index, 2>> lines;
  const auto add = [&](Index a, Index b) { lines.push_back({(std::min)(a, b), (std::max)(a, b)}); };
  for (const auto& nodes : mesh.elements())
    for (std::size_t e = 0; e < tet_edges.size(); ++e) {
      const Index a = nodes[tet_edges[e].a], b = nodes[tet_edges[e].b];
      if constexpr (Element::edge_nodes == 1) {
        add(a, nodes[4 + e]);
        add(nodes[4 + e], b);
      } else {
        add(a, b);
      }
    }
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  return lines;
}

}  // namespace corotet::inline v0_1
