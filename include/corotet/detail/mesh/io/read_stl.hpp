// Reads stereolithography files, .stl, text and binary (M. Burns, "Automated Fabrication", 1993, section 6.5).
#pragma once

#include <array>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/byte_reader.hpp>
#include <corotet/detail/mesh/io/surface_mesh_builder.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <cstdint>
#include <string>
#include <string_view>

namespace corotet::inline v0_1 {
namespace detail {

inline constexpr std::size_t stl_header_bytes = 80, stl_triangle_bytes = 50;

/// True if the length is exactly that of a binary file with the number of triangles that it states.
inline bool is_binary_stl(std::string_view bytes) {
  ByteReader in(bytes, "");
  in.skip(stl_header_bytes, "the header");
  const std::uint64_t triangles = in.read<std::uint32_t>("the number of triangles");
  return in.ok() && in.remaining() == triangles * stl_triangle_bytes;
}

inline bool equals_ignoring_case(std::string_view text, std::string_view lower_case) {
  if (text.size() != lower_case.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i] >= 'A' && text[i] <= 'Z' ? static_cast<char>(text[i] - 'A' + 'a') : text[i];
    if (c != lower_case[i]) return false;
  }
  return true;
}

/// True for text. The word "solid" at the beginning proves nothing, since the header of a binary file may hold it:
/// lengths decide, and then zero bytes, which text never has.
inline bool is_text_stl(std::string_view bytes) {
  if (is_binary_stl(bytes)) return false;
  return equals_ignoring_case(TextScanner(bytes, "").token().substr(0, 5), "solid") &&
         bytes.substr(0, 512).find('\0') == std::string_view::npos;
}

inline void expect_stl(TextScanner& in, std::string_view keyword) {
  const std::string_view found = in.token();
  if (in.ok() && !equals_ignoring_case(found, keyword))
    in.fail("expected " + quoted(keyword) + ", found " + (found.empty() ? "the end of the file" : quoted(found)));
}

inline void add_stl_triangle(SurfaceMeshBuilder& sink, auto& in, const std::array<Vec3<double>, 3>& corners) {
  const Index first = size_of(sink.mesh.positions);
  for (const Vec3<double>& x : corners) sink.add_vertex(in, x);
  if (in.ok()) sink.mesh.triangles.push_back({first, first + 1, first + 2});
}

inline void read_text_stl(TextScanner& in, SurfaceMeshBuilder& sink) {
  int solids = 0;
  while (in.ok() && !in.at_end()) {
    expect_stl(in, "solid");
    in.rest_of_line();  // a name, which may hold anything
    ++solids;
    for (;;) {
      const std::string_view keyword = in.token();
      if (!in.ok() || equals_ignoring_case(keyword, "endsolid")) break;
      if (!equals_ignoring_case(keyword, "facet")) {
        in.fail("expected 'facet' or 'endsolid', found " + (keyword.empty() ? "the end of the file" : quoted(keyword)));
        break;
      }
      expect_stl(in, "normal");  // which follows from the corners
      for (int i = 0; i < 3; ++i) in.token();
      expect_stl(in, "outer");
      expect_stl(in, "loop");
      std::array<Vec3<double>, 3> corners;
      for (Vec3<double>& x : corners) {
        expect_stl(in, "vertex");
        x = in.point();
      }
      expect_stl(in, "endloop");
      expect_stl(in, "endfacet");
      if (in.ok()) add_stl_triangle(sink, in, corners);
    }
    in.rest_of_line();
  }
  if (solids > 1) sink.note("joined " + std::to_string(solids) + " solids");
}

inline void read_binary_stl(ByteReader& in, SurfaceMeshBuilder& sink) {
  in.skip(stl_header_bytes, "the header");
  const std::size_t triangles = in.count<std::uint32_t>("triangles", stl_triangle_bytes);
  if (in.ok()) sink.mesh.positions.reserve(3 * triangles);
  bool attributes = false;
  for (std::size_t t = 0; t < triangles && in.ok(); ++t) {
    in.skip(12, "a normal");
    std::array<Vec3<double>, 3> corners;
    for (Vec3<double>& x : corners) x = in.read_point<float>();
    attributes = in.read<std::uint16_t>("attributes") != 0 || attributes;
    if (in.ok()) add_stl_triangle(sink, in, corners);
  }
  if (attributes) sink.note("ignored triangle attributes (colours)");
  if (in.ok() && in.remaining() > 0)
    sink.note("ignored " + std::to_string(in.remaining()) + " bytes after the last triangle");
}

}  // namespace detail

/// The triangles of an .stl file. Vertices at exactly the same place become one; the normals in the file are ignored.
[[nodiscard]] inline Result<SurfaceMesh> read_stl(std::string_view bytes, std::string_view name) {
  detail::SurfaceMeshBuilder sink;
  if (detail::is_text_stl(bytes)) {
    detail::TextScanner in(bytes, name);
    detail::read_text_stl(in, sink);
    if (!in.ok()) return in.error();
  } else {
    detail::ByteReader in(bytes, name);
    detail::read_binary_stl(in, sink);
    if (!in.ok()) return in.error();
  }
  sink.merge_equal_vertices();
  return sink.finish(name);
}

}  // namespace corotet::inline v0_1
