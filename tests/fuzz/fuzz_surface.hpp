// What every fuzz target of a reader of surfaces checks, whatever the bytes.
#pragma once

#include <cmath>
#include <corotet/detail/mesh/io/read_obj.hpp>
#include <corotet/detail/mesh/io/write_obj.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>

#include "fuzz/fuzz_check.hpp"

namespace corotet::fuzz {

/// A reader must return an error that says where and why, or a surface whose arrays fit together: the writer takes it
/// and the .obj reader gives the same arrays back.
inline int check_surface(const Result<SurfaceMesh>& result) {
  if (!result) return check_error(result.error());
  const Result<std::string> content = format_obj(*result);
  check(content.ok());
  const Result<SurfaceMesh> again = read_obj(*content, "again");
  check(again.ok());
  check(again->positions == result->positions);
  check(again->triangles == result->triangles);
  for (const Vec3<double>& normal : result->normals) check(std::abs(normal.norm() - 1) < 1e-12);
  return 0;
}

}  // namespace corotet::fuzz
