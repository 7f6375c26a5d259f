#include "loads.hpp"

#include <algorithm>
#include <cmath>

namespace corotet::program {
namespace {

template <class Vertices>
Vec3<double> centre_of(const Field<double>& positions, const std::vector<double>& volume, const Vertices& vertices) {
  Vec3<double> sum = Vec3<double>::Zero();
  double total = 0;
  for (const Index v : vertices) {
    sum += volume[at(v)] * positions[at(v)];
    total += volume[at(v)];
  }
  return total > 0 ? Vec3<double>(sum / total) : sum;
}

}  // namespace

std::vector<double> vertex_volumes(const MeshData& mesh) {
  std::vector<double> volume(mesh.positions.size(), 0.0);
  const auto nodes = at(mesh.nodes_per_element);
  const auto in_range = [&](Index v) { return v >= 0 && v < mesh.vertex_count(); };
  for (std::size_t first = 0; first + nodes <= mesh.connectivity.size(); first += nodes) {
    const Index* element = mesh.connectivity.data() + first;
    if (!std::all_of(element, element + nodes, in_range)) continue;
    const auto x = [&](int k) { return mesh.positions[at(element[k])]; };
    const double sixfold = std::abs((x(1) - x(0)).cross(x(2) - x(0)).dot(x(3) - x(0)));
    for (std::size_t k = 0; k < nodes; ++k) volume[at(element[k])] += sixfold / 6 / double(nodes);
  }
  return volume;
}

bool add_force(const MeshData& mesh, const std::vector<double>& volume, const std::vector<Index>& vertices,
               const ForceBox& force, Field<double>& forces) {
  double whole = 0;
  for (const Index v : vertices) whole += volume[at(v)];
  if (!(whole > 0)) return true;  // of no element: the mesh is refused later
  for (const Index v : vertices) forces[at(v)] += volume[at(v)] / whole * force.total;

  const double torque = force.torque.stableNorm();
  if (torque == 0) return true;
  const Vec3<double> axis = force.torque / torque, centre = centre_of(mesh.positions, volume, vertices);
  const auto arm = [&](Index v) { return Vec3<double>(axis.cross(mesh.positions[at(v)] - centre)); };
  double inertia = 0, farthest = 0;
  for (const Index v : vertices) {
    inertia += volume[at(v)] * arm(v).squaredNorm();
    farthest = std::max(farthest, (mesh.positions[at(v)] - centre).norm());
  }
  if (!(inertia > 1e-24 * whole * farthest * farthest)) return false;  // rounding of vertices on the axis
  for (const Index v : vertices) forces[at(v)] += torque * volume[at(v)] / inertia * arm(v);
  return true;
}

Field<double> rigid_velocities(const Field<double>& positions, const std::vector<double>& volume,
                               const Vec3<double>& velocity, const Vec3<double>& angular_velocity) {
  std::vector<Index> all(positions.size());
  for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<Index>(v);
  const Vec3<double> centre = centre_of(positions, volume, all);
  Field<double> velocities;
  velocities.reserve(positions.size());
  for (const Vec3<double>& x : positions) velocities.emplace_back(velocity + angular_velocity.cross(x - centre));
  return velocities;
}

}  // namespace corotet::program
