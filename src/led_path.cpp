#include "led_path.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <string>

namespace corotet::program {

Vec3<double> displacement_at(const std::vector<PathPoint>& path, double t) {
  if (path.empty()) return Vec3<double>::Zero();
  if (t <= path.front().time) return path.front().displacement;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const PathPoint &from = path[k - 1], &to = path[k];
    if (t > to.time) continue;
    const double part = (t - from.time) / (to.time - from.time);
    return (1 - part) * from.displacement + part * to.displacement;
  }
  return path.back().displacement;
}

std::vector<PathPoint> read_path_points(ObjectReader& in) {
  std::vector<PathPoint> path;
  in.list("path", [&](const Json& entry, const std::string& where) {
    const auto numbers = read_numbers(entry, 4, where, in.problems());
    if (!numbers) return;
    if (!path.empty() && (*numbers)[0] <= path.back().time)
      in.problems().add(where, fmt::format("times must ascend, {} follows {}", (*numbers)[0], path.back().time));
    path.push_back({(*numbers)[0], Vec3<double>::load(numbers->data() + 1)});
  });
  return path;
}

}  // namespace corotet::program
