// Shapes that bodies collide with, by their signed distance.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/types.hpp>
#include <memory>
#include <utility>

namespace corotet::inline v0_1 {

/// From a point to the surface of a collider.
struct SurfaceDistance {
  double distance;      ///< m, negative inside
  Vec3<double> normal;  ///< unit vector, outwards: the gradient of the distance
};

/// A solid by its signed distance, in its own frame: `shape(point)` for a point in m. Laws: the distance is 1-Lipschitz
/// (a bound from below will do, far from the surface), zero on the surface, and the normal has length 1 everywhere,
/// also where the gradient is not unique.
template <class S>
concept Collider = std::copy_constructible<S> && requires(const S& shape, const Vec3<double>& point) {
  { shape(point) } -> std::convertible_to<SurfaceDistance>;
};

/// All points p with normal . p <= offset: a floor or a wall.
struct HalfSpace {
  Vec3<double> normal = {0, 0, 1};  ///< out of the solid; need not have length 1, but not 0
  double offset = 0;                ///< m, along the unit normal

  /// The distance of a point of the frame, m, and the normal there.
  [[nodiscard]] SurfaceDistance operator()(const Vec3<double>& point) const {
    const Vec3<double> n = normal.stableNormalized();
    return {n.dot(point) - offset, n};
  }
};

/// A ball about the origin of its frame.
struct Sphere {
  double radius;  ///< m, >= 0

  /// The distance of a point of the frame, m, and the normal there.
  [[nodiscard]] SurfaceDistance operator()(const Vec3<double>& point) const {
    const double r = point.norm();
    return {r - radius, r > 0 ? point / r : Vec3<double>::UnitZ()};
  }
  /// Principal moments of inertia of a uniform solid, m^2: of a mass of 1 kg, kg m^2.
  [[nodiscard]] Vec3<double> inertia() const { return Vec3<double>::Constant(0.4 * radius * radius); }
};

/// A box about the origin, along the axes of its frame.
struct OrientedBox {
  Vec3<double> half_extents;  ///< m, >= 0

  /// The distance of a point of the frame, m, and the normal there.
  [[nodiscard]] SurfaceDistance operator()(const Vec3<double>& point) const {
    const Vec3<double> beyond = point.cwiseAbs() - half_extents;
    Vec3<double> normal = beyond.cwiseMax(0.0);
    double distance = normal.norm();
    if (distance > 0) {
      normal /= distance;
    } else {
      const int axis = beyond.index_of_max();
      distance = beyond[axis];
      normal = Vec3<double>::Zero();
      normal[axis] = 1;
    }
    for (int i = 0; i < 3; ++i)
      if (point[i] < 0) normal[i] = -normal[i];
    return {distance, normal};
  }
  /// See Sphere::inertia.
  [[nodiscard]] Vec3<double> inertia() const {
    const Vec3<double> squares = half_extents.cwiseProduct(half_extents) / 3;
    return Vec3<double>::Constant(squares.sum()) - squares;
  }
};

/// All points within `radius` of a segment along z about the origin.
struct Capsule {
  double radius;       ///< m, >= 0
  double half_height;  ///< of the segment, m, >= 0

  /// The distance of a point of the frame, m, and the normal there.
  [[nodiscard]] SurfaceDistance operator()(const Vec3<double>& point) const {
    const Vec3<double> away(point.x(), point.y(), point.z() - std::clamp(point.z(), -half_height, half_height));
    const double r = away.norm();
    return {r - radius, r > 0 ? away / r : Vec3<double>::UnitX()};
  }
  /// See Sphere::inertia.
  [[nodiscard]] Vec3<double> inertia() const {
    const double r = radius, a = half_height;  // a cylinder, and two half balls that are 3/8 r beyond its ends
    const double cylinder = 2 * a / (2 * a + 4 * r / 3), ball = 1 - cylinder;
    const double axial = r * r * (cylinder / 2 + 0.4 * ball);
    const double across = cylinder * (r * r / 4 + a * a / 3) + ball * (0.4 * r * r + a * a + 0.75 * a * r);
    return {across, across, axial};
  }
};

namespace detail {

/// Any collider; constant, and shared by copies.
class AnyCollider {
 public:
  template <class Shape>
    requires(!std::same_as<Shape, AnyCollider>) && Collider<Shape>
  COROTET_COLD explicit AnyCollider(Shape shape) : shape_(std::make_shared<const Model<Shape>>(std::move(shape))) {}

  [[nodiscard]] SurfaceDistance operator()(const Vec3<double>& point) const { return shape_->distance(point); }

 private:
  struct Base {
    Base() = default;
    Base(const Base&) = delete;
    Base& operator=(const Base&) = delete;
    virtual ~Base() = default;
    [[nodiscard]] virtual SurfaceDistance distance(const Vec3<double>& point) const = 0;
  };
  template <class Shape>
  struct Model final : Base {
    explicit Model(Shape given) : shape(std::move(given)) {}
    [[nodiscard]] SurfaceDistance distance(const Vec3<double>& point) const override { return shape(point); }
    Shape shape;
  };

  std::shared_ptr<const Base> shape_;
};

}  // namespace detail
}  // namespace corotet::inline v0_1
