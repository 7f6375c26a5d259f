// A closed triangle mesh as a shape that bodies collide with.
#pragma once

#include <cmath>
#include <corotet/detail/contact/collider.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/contact/solid_properties.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/shared.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/box.hpp>
#include <corotet/detail/mesh/signed_distance.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <utility>

namespace corotet::inline v0_1 {

/// The solid that a closed triangle mesh encloses, convex or not: a Collider. Copies share the mesh.
///
/// Use `create` for obstacles that are led: their frame is that of the mesh. A free obstacle has its centre of mass at
/// the origin of its frame, and its principal axes along the axes: use `create_centred`, whose frame is there.
/// @snippet contact.cpp mesh
/// The distance is exact: to the nearest triangle, with the sign of the angle-weighted pseudonormal there (Bærentzen &
/// Aanæs 2005). Where the mesh intersects itself the sign is that of the nearest triangle.
class MeshCollider {
 public:
  /// In the frame of the mesh. A mesh that is wound clockwise seen from outside is understood; vertices at exactly the
  /// same place, as along seams of textures, are merged where the mesh is open otherwise, and triangles that vanish
  /// then are left out.
  ///
  /// Errors: empty_mesh, index_out_of_range, non_finite_value (also beyond 1e100 m), degenerate_element (a triangle
  /// without area); invalid_argument where an edge does not belong to two triangles that are wound alike (the triangle
  /// is named), or where no volume is enclosed.
  [[nodiscard]] COROTET_COLD static Result<MeshCollider> create(const SurfaceMesh& surface) {
    return create(surface, Pose{});
  }
  /// The same in the frame of its centre of mass and principal axes: see `frame`.
  [[nodiscard]] COROTET_COLD static Result<MeshCollider> create_centred(const SurfaceMesh& surface) {
    const Result<MeshCollider> there = create(surface);
    if (!there) return there.error();
    const SolidProperties& solid = there->properties();
    const Pose frame{solid.centroid, quaternion_of(solid.axes)};
    const Mat3<double> to_frame = rotation_of(frame.rotation).transpose();
    SurfaceMesh moved = surface;
    for (Vec3<double>& x : moved.positions) x = to_frame * (x - frame.position);
    return create(moved, frame);
  }

  /// The distance of a point of the frame, m, of magnitude 1e120 at most, and the normal there. Allocates nothing.
  [[nodiscard]] SurfaceDistance operator()(const Vec3<double>& point) const {
    const detail::SignedDistance::Nearest nearest = shape_->distance.nearest(point);
    return {nearest.distance, nearest.normal};
  }
  /// Principal moments of inertia of a uniform solid along the axes of its frame, m^2: of a mass of 1 kg, kg m^2. Zero
  /// where the frame is not that of its centre of mass and principal axes: no free obstacle can be made of it then.
  [[nodiscard]] const Vec3<double>& inertia() const { return shape_->inertia; }
  /// Volume, centroid and principal axes, in the frame of the collider.
  [[nodiscard]] const SolidProperties& properties() const { return shape_->properties; }
  /// The box around it in its frame, m.
  [[nodiscard]] Box bounds() const { return shape_->distance.bounds(); }
  /// Whether the mesh was wound the wrong way round.
  [[nodiscard]] bool was_inside_out() const { return shape_->distance.turned(); }

  /// Its frame in that of the mesh.
  [[nodiscard]] const Pose& frame() const { return shape_->frame; }
  /// The pose of the obstacle whose mesh has this pose.
  [[nodiscard]] Pose obstacle_pose(const Pose& of_mesh) const {
    const Mat3<double> r = rotation_of(of_mesh.rotation);
    return {of_mesh.position + r * frame().position, quaternion_of<double>(r * rotation_of(frame().rotation))};
  }
  /// The pose of the mesh, to draw it, of an obstacle with this pose: of `obstacle_pose` the inverse.
  [[nodiscard]] Pose mesh_pose(const Pose& of_obstacle) const {
    const Mat3<double> r = rotation_of(of_obstacle.rotation) * rotation_of(frame().rotation).transpose();
    return {of_obstacle.position - r * frame().position, quaternion_of(r)};
  }

 private:
  struct Shape {
    detail::SignedDistance distance;
    Pose frame;
    SolidProperties properties;
    Vec3<double> inertia;
  };

  explicit MeshCollider(detail::Shared<Shape> shape) : shape_(std::move(shape)) {}

  [[nodiscard]] COROTET_COLD static Result<MeshCollider> create(const SurfaceMesh& surface, const Pose& frame) {
    auto distance = detail::SignedDistance::create(surface, {.refuses_flat = true});
    if (!distance && (distance.error().code == ErrorCode::invalid_argument ||
                      distance.error().code == ErrorCode::degenerate_element))
      distance = detail::SignedDistance::create(surface, {.merges_coinciding = true, .refuses_flat = true});
    if (!distance) return distance.error();
    const SolidProperties solid = solid_properties(distance->surface());
    const Vec3<double> inertia = inertia_in_frame(solid, distance->bounds());
    return MeshCollider(detail::Shared<Shape>::make(*std::move(distance), frame, solid, inertia));
  }

  /// The moments about the axes of the frame, if these are the principal ones and meet in the centroid; else zero.
  [[nodiscard]] COROTET_COLD static Vec3<double> inertia_in_frame(const SolidProperties& solid, const Box& box) {
    constexpr double negligible = 1e-6;  // coordinates may come from float
    Mat3<double> tensor = solid.axes;
    for (int i = 0; i < 3; ++i) tensor.set_col(i, solid.inertia[i] * solid.axes.col(i));
    tensor = tensor * solid.axes.transpose();
    bool is_principal = solid.centroid.norm() <= negligible * (box.high - box.low).maxCoeff();
    for (int i = 0; i < 3; ++i)
      is_principal = is_principal && std::fabs(tensor(i, (i + 1) % 3)) <= negligible * tensor.trace();
    if (!is_principal) return Vec3<double>::Zero();
    return {tensor(0, 0), tensor(1, 1), tensor(2, 2)};
  }

  detail::Shared<Shape> shape_;
};

}  // namespace corotet::inline v0_1
