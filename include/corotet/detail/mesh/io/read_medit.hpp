// Reads Medit .mesh files in text form (P. Frey, "MEDIT: an interactive mesh visualization software", INRIA RT-0253).
#pragma once

#include <array>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/tet_mesh_builder.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <limits>
#include <string>
#include <string_view>

namespace corotet::inline v0_1 {
namespace detail {

inline bool is_letter(std::string_view token) {
  return !token.empty() && ((token[0] >= 'A' && token[0] <= 'Z') || (token[0] >= 'a' && token[0] <= 'z'));
}

inline int read_medit_reference(TextScanner& in) {
  return static_cast<int>(
      in.integer("a reference", (std::numeric_limits<int>::min)(), (std::numeric_limits<int>::max)()));
}

inline void read_medit_tets(TextScanner& in, TetMeshBuilder& sink, VertexRange range, std::size_t size) {
  const std::size_t count = in.count("tetrahedra", size + 1);
  if (!in.ok() || count == 0 || !sink.begin(in, static_cast<int>(size))) return;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    std::array<Index, 10> nodes{};
    for (std::size_t k = 0; k < size; ++k) nodes[k] = range.find(in, in.integer("a vertex number"));
    const int region = read_medit_reference(in);
    if (in.ok()) sink.add(nodes, vtk_order, region);
  }
}

/// Skips the numbers of a section that is not needed.
inline void skip_medit_section(TextScanner& in, TetMeshBuilder& sink, std::string_view keyword) {
  const bool surface =
      keyword.substr(0, 8) == "Triangle" || keyword.substr(0, 5) == "Edges" || keyword.substr(0, 13) == "Quadrilateral";
  const bool volume = keyword.substr(0, 9) == "Hexahedra" || keyword.substr(0, 6) == "Prisms" ||
                      keyword.substr(0, 8) == "Pyramids" || keyword.substr(0, 10) == "Tetrahedra";
  if (surface || volume) sink.ignore(volume, in.count("elements", 2));
  while (in.ok() && !in.at_end() && !is_letter(in.peek())) in.token();
}

}  // namespace detail

/// Tetrahedra (4 nodes) or TetrahedraP2 (10 nodes) from the content of a .mesh file. Regions are their references.
/// Other sections are skipped. Binary .meshb is `unsupported`.
[[nodiscard]] inline Result<MeshData> read_medit(std::string_view text, std::string_view name) {
  detail::TextScanner in(text, name, {.comment = '#'});
  detail::TetMeshBuilder sink;
  detail::VertexRange range{1, 0};
  bool ended = false, has_vertices = false;
  in.expect("MeshVersionFormatted");
  in.integer("the version", 1, 4);
  while (in.ok() && !ended && !in.at_end()) {
    const std::string_view keyword = in.token();
    const bool tets = keyword == "Tetrahedra", curved = keyword == "TetrahedraP2";
    if (keyword == "End") {
      ended = true;
    } else if (keyword == "Dimension") {
      if (const auto dimension = in.integer("the dimension"); in.ok() && dimension != 3)
        in.fail("its dimension is " + std::to_string(dimension) + ", not 3", ErrorCode::unsupported);
    } else if (keyword == "Vertices") {
      if (has_vertices) in.fail("there is a second list of vertices");
      has_vertices = true;
      range.count = in.count("vertices", 4);
      sink.mesh.positions.reserve(range.count);
      for (std::size_t i = 0; i < range.count && in.ok(); ++i) {
        sink.mesh.positions.push_back(in.point());
        detail::read_medit_reference(in);
      }
    } else if ((tets || curved) && !has_vertices) {
      in.fail("tetrahedra come before the vertices");
    } else if (tets || curved) {
      detail::read_medit_tets(in, sink, range, tets ? 4 : 10);
    } else if (detail::is_letter(keyword)) {
      detail::skip_medit_section(in, sink, keyword);
    } else {
      in.fail("expected a keyword, found " + detail::quoted(keyword));
    }
  }
  if (!in.ok()) return in.error();
  if (!ended) sink.note("the file does not end with 'End': it may be incomplete");
  return sink.finish(name);
}

}  // namespace corotet::inline v0_1
