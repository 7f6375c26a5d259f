// Closed triangle surfaces for tests of mesh obstacles.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace corotet::contact_surfaces {

/// A box about the origin, each face cut into some triangles.
inline SurfaceMesh box_surface(const Vec3<double>& half, Index cells = 2) {
  const MeshData block =
      make_block({.corner = -half, .size = 2 * half, .cells = {cells, cells + 1, (cells + 1) / 2}}).value();
  return compact_surface(extract_boundary(block).value(), block.positions).surface;
}

/// An L: the box [-.5, .5] x [-.5, .5] x [-.3, .3] without its quarter x > 0, y > 0.
inline SurfaceMesh l_surface() {
  SurfaceMesh out;
  const std::array<std::array<double, 2>, 6> outline = {
      {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0}, {0, 0}, {0, 0.5}, {-0.5, 0.5}}};
  for (const double z : {-0.3, 0.3})
    for (const auto& [x, y] : outline) out.positions.push_back({x, y, z});
  for (Index i = 0; i < 6; ++i) {
    const Index j = (i + 1) % 6;
    out.triangles.push_back({i, j, j + 6});
    out.triangles.push_back({i, j + 6, i + 6});
  }
  for (const std::array<Index, 3>& t : {std::array<Index, 3>{3, 4, 5}, {3, 5, 0}, {3, 0, 1}, {3, 1, 2}}) {
    out.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
    out.triangles.push_back({t[0], t[2], t[1]});
  }
  return out;
}
inline bool l_contains(const Vec3<double>& p) {
  return std::fabs(p.x()) < 0.5 && std::fabs(p.y()) < 0.5 && std::fabs(p.z()) < 0.3 && !(p.x() > 0 && p.y() > 0);
}

/// A torus about the z axis, of n x m quadrilaterals.
inline SurfaceMesh torus_surface(double large, double small, Index n = 24, Index m = 12) {
  SurfaceMesh out;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < m; ++j) {
      const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / m;
      const double r = large + small * std::cos(b);
      out.positions.push_back({r * std::cos(a), r * std::sin(a), small * std::sin(b)});
      const Index i1 = (i + 1) % n, j1 = (j + 1) % m;
      out.triangles.push_back({i * m + j, i1 * m + j, i1 * m + j1});
      out.triangles.push_back({i * m + j, i1 * m + j1, i * m + j1});
    }
  return out;
}

/// A sphere by dividing an octahedron, its points moved out to radius(direction).
inline SurfaceMesh star_surface(Index divisions, const std::function<double(const Vec3<double>&)>& radius) {
  SurfaceMesh out;
  const Index n = divisions;
  // Each octant is a triangle of rows; corners on shared edges are found again by their coordinates.
  const auto vertex = [&](const Vec3<double>& at_octahedron) {
    const Vec3<double> direction = at_octahedron.normalized();
    for (Index v = 0; v < size_of(out.positions); ++v)
      if ((out.positions[at(v)] - direction).norm() < 1e-9) return v;
    out.positions.push_back(direction);
    return size_of(out.positions) - 1;
  };
  for (const int sx : {1, -1})
    for (const int sy : {1, -1})
      for (const int sz : {1, -1}) {
        const auto corner = [&](Index i, Index j) {
          return vertex({sx * double(i), sy * double(j), sz * double(n - i - j)});
        };
        const auto add = [&](Index a, Index b, Index c) {
          if (sx * sy * sz > 0)
            out.triangles.push_back({a, b, c});
          else
            out.triangles.push_back({a, c, b});
        };
        for (Index i = 0; i < n; ++i)
          for (Index j = 0; i + j < n; ++j) {
            add(corner(i, j), corner(i + 1, j), corner(i, j + 1));
            if (i + j + 1 < n) add(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
          }
      }
  for (Vec3<double>& x : out.positions) x *= radius(x);
  return out;
}
inline SurfaceMesh sphere_surface(double radius, Index divisions = 8) {
  return star_surface(divisions, [radius](const Vec3<double>&) { return radius; });
}
/// Bumps and hollows on a sphere.
inline SurfaceMesh rock_surface(double radius, Index divisions = 8) {
  return star_surface(divisions, [radius](const Vec3<double>& n) {
    return radius * (1 + 0.25 * std::sin(5 * n.x() + 1) * std::cos(4 * n.y()) + 0.15 * std::sin(7 * n.z() - n.x()));
  });
}

/// How often the surface goes around a point, from the solid angles of its triangles (van Oosterom & Strackee 1983).
inline double winding_number(const SurfaceMesh& surface, const Vec3<double>& p) {
  double sum = 0;
  for (const auto& t : surface.triangles) {
    const Vec3<double> a = surface.positions[at(t[0])] - p, b = surface.positions[at(t[1])] - p,
                       c = surface.positions[at(t[2])] - p;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace corotet::contact_surfaces
