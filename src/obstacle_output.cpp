#include "obstacle_output.hpp"

#include <fmt/format.h>

#include <corotet/detail/mesh/io/write_vtu.hpp>
#include <iterator>
#include <string>
#include <utility>

namespace corotet::program {

ObstacleOutput::ObstacleOutput(std::filesystem::path folder, const Vec3<double>& centre, double size)
    : folder_(std::move(folder)), centre_(centre), size_(size) {}

void ObstacleOutput::add_rows(double t, double h, const ObstacleRun& run) {
  const Obstacles& obstacles = run.obstacles();
  if (obstacles.size() == 0) return;
  if (!rows_.is_open()) rows_.open(folder_ / "obstacles.csv", "t,obstacle,x,y,z,qw,qx,qy,qz,fx,fy,fz,tx,ty,tz");
  std::string rows;
  for (Index o = 0; o < obstacles.size(); ++o) {
    const auto [x, q] = run.pose(o);
    const Vec3<double> force = obstacles[o].load().impulse / h, torque = obstacles[o].load().angular_impulse / h;
    fmt::format_to(std::back_inserter(rows), "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", t, o, x[0], x[1], x[2],
                   q[0], q[1], q[2], q[3], force[0], force[1], force[2], torque[0], torque[1], torque[2]);
  }
  rows_.add(rows);
}

void ObstacleOutput::add_frame(double t, const ObstacleRun& obstacles) {
  if (obstacles.obstacles().size() == 0) return;
  const ObstacleRun::Drawing drawing = obstacles.draw(centre_, size_);
  frames_.add(folder_, t,
              {.points = drawing.surface.positions,
               .cells = vtu_cells(drawing.surface),
               .cell_data = {{"obstacle", drawing.obstacle}}});
}

}  // namespace corotet::program
