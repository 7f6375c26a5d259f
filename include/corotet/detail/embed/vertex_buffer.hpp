// The caller's vertex buffer: where positions and normals are written for drawing.
#pragma once

#include <array>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/embed/coordinates.hpp>
#include <cstddef>
#include <cstring>
#include <limits>

namespace corotet::inline v0_1 {

/// Interleaved vertices with float32 attributes, such as a mapped GPU buffer. Nothing is assumed about alignment, and
/// nothing but the 12 bytes of each attribute is touched.
struct VertexBuffer {
  /// Of an offset: the buffer has no such attribute.
  static constexpr std::size_t none = (std::numeric_limits<std::size_t>::max)();

  std::byte* data = nullptr;          ///< the first vertex
  std::size_t stride = 0;             ///< bytes from one vertex to the next
  Index count = 0;                    ///< vertices in the buffer
  std::size_t position_offset = 0;    ///< bytes from the start of a vertex to its position, or `none`
  std::size_t normal_offset = none;   ///< the same for its normal
  Vec3<double> translation{0, 0, 0};  ///< m, added to each position in the body's precision and coordinates
  /// Into the engine's coordinates, after the translation: CoordinateConversion::between. Its index buffer:
  /// write_indices.
  CoordinateConversion conversion{};

  /// Whether the attribute at `offset` lies within a vertex.
  [[nodiscard]] bool fits(std::size_t offset) const {
    return offset == none || (stride >= 3 * sizeof(float) && offset <= stride - 3 * sizeof(float));
  }
};

namespace detail {

/// The first three entries as floats at any address.
template <std::floating_point Scalar>
void store(std::byte* where, const Matrix<Scalar, 4, 1>& v) {
  const std::array<float, 3> xyz{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  std::memcpy(where, xyz.data(), sizeof xyz);
}

}  // namespace detail
}  // namespace corotet::inline v0_1
