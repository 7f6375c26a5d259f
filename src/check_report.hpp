// What `corotet check` finds out about a mesh.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/element_quality.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/quality.hpp>
#include <map>
#include <string>
#include <vector>

#include "json_file.hpp"

namespace corotet::program {

struct CheckReport {
  std::string file;
  MeshData mesh;
  MeshQuality quality;
  std::vector<WorstElement> worst;
  std::map<ElementDefect, Index> defects;  ///< how many elements have each, `none` left out
  Index flipped_elements = 0;              ///< wound the other way round; turned when the mesh is used
  std::string error;                       ///< why the mesh cannot be used; empty if it can
  std::string float_refusal;               ///< the same in float
  std::string overlap;                     ///< where elements overlap at a face; empty if they do not, or are unusable

  [[nodiscard]] bool usable() const { return error.empty(); }
};

/// Looks at a mesh, with its `worst_count` worst elements. Throws a Failure if the file cannot be read.
[[nodiscard]] CheckReport check_mesh(const std::string& file, Index worst_count);

/// For people.
[[nodiscard]] std::string format_text(const CheckReport& report);

/// For programs.
[[nodiscard]] Json to_json(const CheckReport& report);

}  // namespace corotet::program
