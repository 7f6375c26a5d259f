// Wavefront .obj: a surface as text that every graphics program reads.
#pragma once

#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/text_writer.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <cstdint>
#include <string>

namespace corotet::inline v0_1 {

/// The content of an .obj file: `v`, `vn` if the surface has normals, and `f` lines, with as many digits as reading the
/// same numbers back needs. Errors: invalid_argument (normals that are not one a vertex), index_out_of_range,
/// non_finite_value.
[[nodiscard]] inline Result<std::string> format_obj(const SurfaceMesh& surface) {
  const bool has_normals = !surface.normals.empty();
  if (has_normals && surface.normals.size() != surface.positions.size()) {
    return Error{ErrorCode::invalid_argument, "normals",
                 "there are " + std::to_string(surface.normals.size()) + " for " +
                     std::to_string(surface.positions.size()) + " vertices; give one each, or none"};
  }
  detail::TextWriter text;
  text.reserve(surface.positions.size() * (has_normals ? 120 : 60) + surface.triangles.size() * 30);
  text << "# metres\n";
  const auto add_vectors = [&](const char* keyword, const Field<double>& vectors) -> Result<void> {
    for (std::size_t v = 0; v < vectors.size(); ++v) {
      if (!vectors[v].allFinite())
        return Error{ErrorCode::non_finite_value, "vertex " + std::to_string(v),
                     "its position or normal is not a finite number"};
      text << keyword << ' ' << vectors[v] << '\n';
    }
    return {};
  };
  if (Result<void> status = add_vectors("v", surface.positions); !status) return status.error();
  if (Result<void> status = add_vectors("vn", surface.normals); !status) return status.error();

  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    text << 'f';
    for (const Index v : surface.triangles[t]) {
      if (v < 0 || at(v) >= surface.positions.size())
        return Error{ErrorCode::index_out_of_range, "triangle " + std::to_string(t),
                     "it names vertex " + std::to_string(v) + " of " + std::to_string(surface.positions.size())};
      const std::int64_t number = std::int64_t{v} + 1;
      text << ' ' << number;
      if (has_normals) text << "//" << number;
    }
    text << '\n';
  }
  return text.take();
}

/// Writes an .obj file. Errors: those of `format_obj`, and file_unreadable.
[[nodiscard]] inline Result<void> write_obj(const FilePath& path, const SurfaceMesh& surface) {
  const Result<std::string> text = format_obj(surface);
  return text ? write_file(path, *text) : Result<void>(text.error());
}

}  // namespace corotet::inline v0_1
