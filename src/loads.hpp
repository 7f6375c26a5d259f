// What a scene does to whole parts of a body, as numbers for each vertex.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <vector>

#include "scene.hpp"

namespace corotet::program {

/// Of each vertex: its elements' volumes (of the straight tetrahedra), shared evenly by their nodes, m^3. Elements with
/// an index out of range are left out (the mesh is refused later).
[[nodiscard]] std::vector<double> vertex_volumes(const MeshData& mesh);

/// Adds a box's force to the `vertices` in it: `total` in shares of their volume V, and `torque` T about their centre c
/// as forces V n x (x - c), n = T / |T|, scaled to the moment |T|; their sum is zero. False if none has a lever.
[[nodiscard]] bool add_force(const MeshData& mesh, const std::vector<double>& volume,
                             const std::vector<Index>& vertices, const ForceBox& force, Field<double>& forces);

/// v + w x (x - c), c the centre of mass at `positions`.
[[nodiscard]] Field<double> rigid_velocities(const Field<double>& positions, const std::vector<double>& volume,
                                             const Vec3<double>& velocity, const Vec3<double>& angular_velocity);

}  // namespace corotet::program
