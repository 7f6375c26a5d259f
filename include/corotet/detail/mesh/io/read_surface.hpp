// Reads a triangle surface in whatever known format the file has.
#pragma once

#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/read_obj.hpp>
#include <corotet/detail/mesh/io/read_off.hpp>
#include <corotet/detail/mesh/io/read_ply.hpp>
#include <corotet/detail/mesh/io/read_stl.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <string>
#include <string_view>

namespace corotet::inline v0_1 {

/// The formats that read_surface tells apart.
enum class SurfaceFormat {
  unknown,  ///< none of these
  obj,      ///< Wavefront
  stl,      ///< as text or binary
  ply,      ///< as text or binary
  off       ///< as text
};

/// Tells the format from the content. A binary .stl has no mark, but a length that follows from its header.
[[nodiscard]] inline SurfaceFormat detect_surface_format(std::string_view bytes) {
  if (bytes.substr(0, 4) == "ply\n" || bytes.substr(0, 4) == "ply\r") return SurfaceFormat::ply;
  if (detail::is_binary_stl(bytes) || detail::is_text_stl(bytes)) return SurfaceFormat::stl;
  const std::string_view first = detail::TextScanner(bytes, "", {.comment = '#'}).token();
  if (detail::parse_off_keyword(first).valid) return SurfaceFormat::off;
  for (const std::string_view keyword : {"v", "vn", "vt", "f", "g", "o", "s", "mtllib", "usemtl"})
    if (first == keyword) return SurfaceFormat::obj;
  return SurfaceFormat::unknown;
}

/// Reads a surface, to be embedded or filled with a mesh, from a file of any format.
///
/// The formats are .obj, .stl, .ply or .off, told by its content. A binary .stl whose length
/// contradicts its header is told by its extension. Errors name the file, the line or byte offset, and the reason;
/// `unknown_format` if no reader recognises the content.
[[nodiscard]] inline Result<SurfaceMesh> read_surface(const FilePath& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return bytes.error();
  const std::string& name = path.text();
  switch (detect_surface_format(*bytes)) {
    case SurfaceFormat::obj:
      return read_obj(*bytes, name);
    case SurfaceFormat::stl:
      return read_stl(*bytes, name);
    case SurfaceFormat::ply:
      return read_ply(*bytes, name);
    case SurfaceFormat::off:
      return read_off(*bytes, name);
    case SurfaceFormat::unknown:
      break;
  }
  if (bytes->empty()) return Error{ErrorCode::unknown_format, name, "the file is empty"};
  if (path.extension() == ".stl" || path.extension() == ".STL") return read_stl(*bytes, name);
  return Error{ErrorCode::unknown_format, name,
               "its content is none of Wavefront .obj, .stl, .ply (first line 'ply') and .off (first word 'OFF')"};
}

}  // namespace corotet::inline v0_1
