#include "obstacle_surface.hpp"

#include <array>
#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <numbers>
#include <vector>

namespace corotet::program {
namespace {

/// A point of the half plane through the axis of a body of revolution, m.
struct ProfilePoint {
  double radius, height;
};

/// Turns a profile from the lower pole to the upper one about z; `rings`: its points without the poles, upwards.
SurfaceMesh revolve(double bottom, const std::vector<ProfilePoint>& rings, double top) {
  constexpr Index sides = 32;
  SurfaceMesh surface;
  surface.positions.emplace_back(0, 0, bottom);
  for (const ProfilePoint& ring : rings)
    for (Index side = 0; side < sides; ++side) {
      const double angle = 2 * std::numbers::pi * side / sides;
      surface.positions.emplace_back(ring.radius * std::cos(angle), ring.radius * std::sin(angle), ring.height);
    }
  surface.positions.emplace_back(0, 0, top);
  const Index count = size_of(rings), last = size_of(surface.positions) - 1;
  const auto at_ring = [&](Index ring, Index side) { return 1 + ring * sides + side % sides; };
  for (Index side = 0; side < sides; ++side) {
    surface.triangles.push_back({0, at_ring(0, side + 1), at_ring(0, side)});
    for (Index ring = 0; ring + 1 < count; ++ring) {
      const Index a = at_ring(ring, side), b = at_ring(ring, side + 1), c = at_ring(ring + 1, side),
                  d = at_ring(ring + 1, side + 1);
      surface.triangles.push_back({a, b, d});
      surface.triangles.push_back({a, d, c});
    }
    surface.triangles.push_back({last, at_ring(count - 1, side), at_ring(count - 1, side + 1)});
  }
  return surface;
}

}  // namespace

SurfaceMesh surface_of(const OrientedBox& box) {
  SurfaceMesh surface;
  const Vec3<double>& h = box.half_extents;
  for (const int corner : {0, 1, 2, 3, 4, 5, 6, 7})
    surface.positions.emplace_back((corner & 1) != 0 ? h.x() : -h.x(), (corner & 2) != 0 ? h.y() : -h.y(),
                                   (corner & 4) != 0 ? h.z() : -h.z());
  constexpr std::array<std::array<Index, 4>, 6> faces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : faces) {
    surface.triangles.push_back({a, b, c});
    surface.triangles.push_back({a, c, d});
  }
  return surface;
}

SurfaceMesh surface_of(const Sphere& sphere) { return surface_of(Capsule{sphere.radius, 0}); }

SurfaceMesh surface_of(const Capsule& capsule) {
  constexpr int half_rings = 8;  // from a pole to the equator
  std::vector<ProfilePoint> rings;
  for (int i = 1; i < 2 * half_rings; ++i) {
    const double angle = std::numbers::pi * i / (2 * half_rings);
    const ProfilePoint point{capsule.radius * std::sin(angle), -capsule.radius * std::cos(angle)};
    if (i <= half_rings) rings.push_back({point.radius, point.height - capsule.half_height});
    if (i > half_rings || (i == half_rings && capsule.half_height > 0))
      rings.push_back({point.radius, point.height + capsule.half_height});
  }
  const double pole = capsule.radius + capsule.half_height;
  return revolve(-pole, rings, pole);
}

SurfaceMesh surface_of(const HalfSpace& half_space, const Vec3<double>& centre, double size) {
  const auto [distance, normal] = half_space(centre);
  const Vec3<double> foot = centre - distance * normal;
  Vec3<double> away = Vec3<double>::Zero();
  int least = 0;
  for (int i = 1; i < 3; ++i)
    if (std::fabs(normal[i]) < std::fabs(normal[least])) least = i;
  away[least] = 1;
  const Vec3<double> u = size * normal.cross(away).normalized(), v = normal.cross(u);
  SurfaceMesh surface;
  surface.positions = {foot - u - v, foot + u - v, foot + u + v, foot - u + v};
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  return surface;
}

}  // namespace corotet::program
