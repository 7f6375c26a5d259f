// From the coordinates of a body to those of an engine: axes, handedness, unit of length, winding.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace corotet::inline v0_1 {

/// A direction along an axis.
enum class Axis : std::uint8_t {
  x,        ///< +x
  y,        ///< +y
  z,        ///< +z
  minus_x,  ///< -x
  minus_y,  ///< -y
  minus_z   ///< -z
};

namespace detail {

/// 0, 1 or 2.
[[nodiscard]] constexpr int axis_index(Axis axis) { return static_cast<int>(axis) % 3; }
/// 1 or -1.
[[nodiscard]] constexpr int axis_sign(Axis axis) { return static_cast<int>(axis) < 3 ? 1 : -1; }
[[nodiscard]] constexpr Axis reversed(Axis axis) { return static_cast<Axis>((static_cast<int>(axis) + 3) % 6); }

/// The determinant of the matrix whose rows are these directions: 1, -1, or 0 where two of them share an axis.
[[nodiscard]] constexpr int handedness(Axis a, Axis b, Axis c) {
  const int i = axis_index(a), j = axis_index(b), k = axis_index(c);
  if (i == j || j == k || k == i) return 0;
  return axis_sign(a) * axis_sign(b) * axis_sign(c) * ((j - i + 3) % 3 == 1 ? 1 : -1);
}

}  // namespace detail

/// The axes of a model that point forward, to its right and up; the unit of length; and the order of front faces.
struct CoordinateSystem {
  Axis forward = Axis::x;      ///< along which it looks
  Axis right = Axis::minus_y;  ///< to its right
  Axis up = Axis::z;           ///< upwards
  double unit = 1;             ///< m
  /// Whether the front of a triangle is the side from which its corners are seen in clockwise order.
  bool clockwise_front = false;

  /// Whether there are three axes and a length.
  [[nodiscard]] constexpr bool is_valid() const { return detail::handedness(right, forward, up) != 0 && unit > 0; }
  /// Whether the three axes are right-handed.
  [[nodiscard]] constexpr bool is_right_handed() const { return detail::handedness(right, forward, up) > 0; }
};

/// Systems of files and engines. Where nothing else is said: m, right-handed, front faces counter-clockwise.
namespace coordinates {

/// x forward, z up: robotics.
inline constexpr CoordinateSystem z_up{};
/// A model looks along -y, z up.
inline constexpr CoordinateSystem blender{.forward = Axis::minus_y, .right = Axis::minus_x};
/// A model looks along z, y up.
inline constexpr CoordinateSystem gltf{.forward = Axis::z, .right = Axis::minus_x, .up = Axis::y};
/// The axes of glTF, whose files it reads as they are; in a mesh that is made, front faces are clockwise.
inline constexpr CoordinateSystem godot{
    .forward = Axis::z, .right = Axis::minus_x, .up = Axis::y, .clockwise_front = true};
/// Left-handed, z forward, y up; front faces clockwise.
inline constexpr CoordinateSystem unity{.forward = Axis::z, .right = Axis::x, .up = Axis::y, .clockwise_front = true};
/// cm, left-handed, x forward, z up. Front faces are counter-clockwise on the screen; the cross product of their edges,
/// taken in these coordinates, points inwards.
inline constexpr CoordinateSystem unreal{.forward = Axis::x, .right = Axis::y, .up = Axis::z, .unit = 0.01};

}  // namespace coordinates

/// Takes vectors of one coordinate system to another: component i of the result is the component along from[i].
/// Lengths are multiplied by `scale`. The default is the identity.
struct CoordinateConversion {
  std::array<Axis, 3> from{Axis::x, Axis::y, Axis::z};  ///< the source's axis along which each component lies
  double scale = 1;                                     ///< > 0, target units in one of the source
  bool reverses_winding = false;  ///< whether the corners of a triangle must be listed in the opposite order

  /// The same model in another system: it looks forward, to its right and up as before. Both must be valid.
  [[nodiscard]] static constexpr CoordinateConversion between(const CoordinateSystem& source,
                                                              const CoordinateSystem& target) {
    COROTET_ASSERT(source.is_valid() && target.is_valid(), "forward, right and up need three different axes");
    CoordinateConversion out;
    const auto map = [&](Axis here, Axis there) {
      out.from[at(detail::axis_index(there))] = detail::axis_sign(there) > 0 ? here : detail::reversed(here);
    };
    map(source.forward, target.forward);
    map(source.right, target.right);
    map(source.up, target.up);
    out.scale = source.unit / target.unit;
    out.reverses_winding = source.clockwise_front != target.clockwise_front;
    return out;
  }

  /// Whether positions stay as they are.
  [[nodiscard]] constexpr bool is_identity() const {
    return from == std::array{Axis::x, Axis::y, Axis::z} && detail::exactly_equal(scale, 1.0);
  }
  /// Whether there are three axes and a scale.
  [[nodiscard]] constexpr bool is_valid() const {
    return detail::handedness(from[0], from[1], from[2]) != 0 && scale > 0;
  }
  /// Whether handedness changes.
  [[nodiscard]] constexpr bool mirrors() const { return detail::handedness(from[0], from[1], from[2]) < 0; }

  /// A unit vector, such as a normal, in the target system.
  template <std::floating_point Scalar>
  [[nodiscard]] constexpr Vec3<Scalar> direction(const Vec3<Scalar>& v) const {
    const auto along = [&](Axis axis) -> Scalar {
      return detail::axis_sign(axis) > 0 ? v[detail::axis_index(axis)] : -v[detail::axis_index(axis)];
    };
    return {along(from[0]), along(from[1]), along(from[2])};
  }
  /// A position or a displacement in the target system and its unit.
  template <std::floating_point Scalar>
  [[nodiscard]] constexpr Vec3<Scalar> position(const Vec3<Scalar>& x) const {
    return static_cast<Scalar>(scale) * direction(x);
  }
  /// The inverse of `direction`: from the target system to the source. For forces, multiply by what the target's unit
  /// of force is in N.
  template <std::floating_point Scalar>
  [[nodiscard]] constexpr Vec3<Scalar> direction_to_source(const Vec3<Scalar>& v) const {
    Vec3<Scalar> out;
    for (int i = 0; i < 3; ++i) {
      const Axis axis = from[at(i)];
      out[detail::axis_index(axis)] = detail::axis_sign(axis) > 0 ? v[i] : -v[i];
    }
    return out;
  }
  /// The inverse of `position`: a point in the target system, such as a hit, in the source's.
  template <std::floating_point Scalar>
  [[nodiscard]] constexpr Vec3<Scalar> position_to_source(const Vec3<Scalar>& x) const {
    return direction_to_source(x) / static_cast<Scalar>(scale);
  }

  /// The linear part of `position`.
  [[nodiscard]] constexpr Mat3<double> matrix() const {
    Mat3<double> m = Mat3<double>::Zero();
    for (int i = 0; i < 3; ++i) m(i, detail::axis_index(from[at(i)])) = scale * detail::axis_sign(from[at(i)]);
    return m;
  }
};

/// Fills an index buffer: three numbers a triangle, in the order that the conversion asks for; the first corner stays
/// first. `out` has three entries a triangle, of a type that holds every index.
template <std::integral Number>
void write_indices(std::span<const std::array<Index, 3>> triangles, const CoordinateConversion& conversion,
                   std::span<Number> out) {
  COROTET_ASSERT(out.size() == 3 * triangles.size(), "an index buffer has three entries a triangle");
  std::size_t next = 0;
  for (const auto& [a, b, c] : triangles)
    for (const Index v : {a, conversion.reverses_winding ? c : b, conversion.reverses_winding ? b : c}) {
      COROTET_ASSERT(std::in_range<Number>(v), "the index buffer's numbers are too small for this many vertices");
      out[next++] = static_cast<Number>(v);
    }
}

}  // namespace corotet::inline v0_1
