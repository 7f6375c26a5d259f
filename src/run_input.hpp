// Everything that a scene's files hold, read and matched to the mesh.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene.hpp"

namespace corotet::program {

/// The vertices of one entry of `pins`.
struct PinnedVertices {
  std::vector<Index> vertices;
  std::vector<PathPoint> path;  ///< relative to where they started
};

struct RunInput {
  MeshData mesh;  ///< with the order that it shall run with
  std::vector<PinnedVertices> pins;
  std::vector<Index> probes;  ///< vertices
  std::optional<Field<double>> positions, velocities;
  std::optional<Field<double>> forces;  ///< N
  std::optional<SurfaceMesh> surface;
  std::vector<std::string> notes;  ///< what was changed or left out while reading
};

/// Throws a Failure that lists all that is wrong with the files, and boxes that hold no vertex.
[[nodiscard]] RunInput read_input(const Scene& scene);

/// The scene on another mesh than its own, which has the order that it shall run with. Files of the scene that have one
/// line a vertex must fit it. Throws as read_input.
[[nodiscard]] RunInput match_input(const Scene& scene, MeshData mesh);

}  // namespace corotet::program
