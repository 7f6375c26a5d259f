// Reads surfaces in Geomview's object file format, .off (Geomview manual, "OFF Files").
#pragma once

#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/surface_mesh_builder.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1 {
namespace detail {

/// What the prefixes before OFF announce: [ST][C][N][4][n]OFF.
struct OffHeader {
  bool valid = false;
  bool normals = false;
  bool four_dimensional = false;
};

inline OffHeader parse_off_keyword(std::string_view word) {
  OffHeader header;
  const auto take = [&](std::string_view prefix) {
    const bool found = word.substr(0, prefix.size()) == prefix;
    if (found) word.remove_prefix(prefix.size());
    return found;
  };
  take("ST");
  take("C");
  header.normals = take("N");
  const bool four = take("4"), any = take("n");
  header.four_dimensional = four || any;
  header.valid = word == "OFF";
  return header;
}

}  // namespace detail

/// OFF with any of the prefixes N (normals, used), C and ST (colours and texture coordinates, ignored). One vertex or
/// face a line; what follows on the line is ignored. Other dimensions and binary files are `unsupported`.
[[nodiscard]] inline Result<SurfaceMesh> read_off(std::string_view text, std::string_view name) {
  detail::TextScanner in(text, name, {.comment = '#'});
  detail::SurfaceMeshBuilder sink;
  const std::string_view keyword = in.token();
  const detail::OffHeader header = detail::parse_off_keyword(keyword);
  if (!header.valid) in.fail("expected 'OFF', found " + detail::quoted(keyword));
  if (header.four_dimensional) in.fail("its vertices do not have three dimensions", ErrorCode::unsupported);
  if (in.peek() == "BINARY") in.fail("it is a binary OFF file; only the text form can be read", ErrorCode::unsupported);

  const std::size_t vertices = in.count("vertices", header.normals ? 6 : 3);
  const std::size_t faces = in.count("faces", 4);
  if (!in.at_line_end()) in.integer("the number of edges", 0);
  bool extra = false;
  const auto end_line = [&] {
    extra = extra || !in.at_line_end();
    in.rest_of_line();
  };
  end_line();

  if (in.ok()) sink.mesh.positions.reserve(vertices);
  for (std::size_t v = 0; v < vertices && in.ok(); ++v) {
    sink.add_vertex(in, in.point());
    if (header.normals) sink.mesh.normals.push_back(in.point());
    end_line();
  }
  if (in.ok()) sink.mesh.triangles.reserve(faces);
  std::vector<Index> corners;
  for (std::size_t f = 0; f < faces && in.ok(); ++f) {
    const std::size_t count = in.count("corners", 1);
    corners.clear();
    for (std::size_t c = 0; c < count && in.ok(); ++c)
      corners.push_back(detail::surface_vertex(in, in.integer("a vertex number"), vertices));
    if (in.ok()) sink.add_polygon(in, corners);
    end_line();
  }
  if (!in.ok()) return in.error();
  if (extra) sink.note("ignored colours or other values at the ends of lines");
  if (!in.at_end()) sink.note("ignored what follows the last face");
  return sink.finish(name);
}

}  // namespace corotet::inline v0_1
