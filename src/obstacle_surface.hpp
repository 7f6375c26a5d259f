// The surfaces of obstacles as triangles, to be drawn.
#pragma once

#include <corotet/detail/contact/collider.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>

namespace corotet::program {

/// Each in the obstacle's own frame, counter-clockwise seen from outside.
[[nodiscard]] SurfaceMesh surface_of(const OrientedBox& box);
[[nodiscard]] SurfaceMesh surface_of(const Sphere& sphere);
[[nodiscard]] SurfaceMesh surface_of(const Capsule& capsule);
/// A square of the plane about the foot of `centre`, with edges of 2 `size`, m.
[[nodiscard]] SurfaceMesh surface_of(const HalfSpace& half_space, const Vec3<double>& centre, double size);

}  // namespace corotet::program
