// Reads a tetrahedral mesh in whatever known format the file has.
#pragma once

#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/read_medit.hpp>
#include <corotet/detail/mesh/io/read_msh.hpp>
#include <corotet/detail/mesh/io/read_tetgen.hpp>
#include <corotet/detail/mesh/io/read_vega.hpp>
#include <corotet/detail/mesh/io/read_vtk.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <string>
#include <string_view>

namespace corotet::inline v0_1 {

/// The formats that mark their content.
enum class MeshFormat {
  unknown,       ///< none of these
  msh,           ///< gmsh
  medit,         ///< Medit, as text
  medit_binary,  ///< Medit, binary, which no reader here takes
  vtk,           ///< legacy VTK
  vega           ///< Vega
};

/// Tells the format from the first bytes. TetGen's files have no mark, they are `unknown`.
[[nodiscard]] inline MeshFormat detect_mesh_format(std::string_view bytes) {
  // The first word of a .meshb file is the integer 1, in the byte order of the machine that wrote it.
  using std::string_view_literals::operator""sv;
  if (bytes.substr(0, 4) == "\1\0\0\0"sv || bytes.substr(0, 4) == "\0\0\0\1"sv) return MeshFormat::medit_binary;
  if (bytes.substr(0, 14) == "# vtk DataFile") return MeshFormat::vtk;
  const std::string_view first = detail::TextScanner(bytes, "", {.comment = '#'}).token();
  if (first.substr(0, 1) == "$") return MeshFormat::msh;
  if (first == "MeshVersionFormatted") return MeshFormat::medit;
  if (first.substr(0, 1) == "*") return MeshFormat::vega;
  return MeshFormat::unknown;
}

/// Reads a volume mesh from a file of any format.
///
/// Use it for what a mesh generator wrote; the readers by name (read_msh, ...) take a text in memory. `stuff_surface`
/// makes a mesh from a surface.
/// @snippet files.cpp read
/// The formats are gmsh .msh, Medit .mesh, legacy .vtk or Vega .veg, told by their content, or TetGen's
/// .node and .ele, told by their extension. Errors name the file, the line or byte offset, and the reason;
/// `unknown_format` if no reader recognises the content.
[[nodiscard]] inline Result<MeshData> read_mesh(const FilePath& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return bytes.error();
  const std::string& name = path.text();
  switch (detect_mesh_format(*bytes)) {
    case MeshFormat::msh:
      return read_msh(*bytes, name);
    case MeshFormat::medit:
      return read_medit(*bytes, name);
    case MeshFormat::vtk:
      return read_vtk(*bytes, name);
    case MeshFormat::vega:
      return read_vega(*bytes, name);
    case MeshFormat::medit_binary:
      return Error{ErrorCode::unsupported, name, "it is a binary Medit file (.meshb); only the text form can be read"};
    case MeshFormat::unknown:
      break;
  }
  if (path.extension() == ".node" || path.extension() == ".ele") return read_tetgen(path);
  if (bytes->empty()) return Error{ErrorCode::unknown_format, name, "the file is empty"};
  return Error{ErrorCode::unknown_format, name,
               "its content is none of gmsh .msh ($MeshFormat), Medit .mesh (MeshVersionFormatted), legacy .vtk "
               "(# vtk DataFile) and Vega .veg (*VERTICES), and its name does not end with TetGen's .node or .ele"};
}

}  // namespace corotet::inline v0_1
