// Views of the library's arrays in the terms of VTK: typed values and cells.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <corotet/detail/core/span_of.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstdint>
#include <iterator>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

namespace corotet::inline v0_1 {
namespace detail {

template <class T>
inline constexpr bool is_vtu_scalar = std::same_as<T, float> || std::same_as<T, double> || std::same_as<T, Index>;

template <class T>
inline constexpr bool is_vtu_vector = std::same_as<T, Vec3<float>> || std::same_as<T, Vec3<double>>;

template <class Range>
using VtuEntry = std::remove_cvref_t<decltype(*std::data(std::declval<const Range&>()))>;
template <class Range>
concept VtuRange = requires(const Range& range) {
  { std::size(range) } -> std::convertible_to<std::size_t>;
  requires is_vtu_scalar<VtuEntry<Range>> || is_vtu_vector<VtuEntry<Range>>;
};

template <class T>
constexpr std::string_view vtk_type_name() {
  if constexpr (std::same_as<T, float>) return "Float32";
  if constexpr (std::same_as<T, double>) return "Float64";
  if constexpr (std::same_as<T, std::int32_t>) return "Int32";
  if constexpr (std::same_as<T, std::int64_t>) return "Int64";
  if constexpr (std::same_as<T, std::uint8_t>) return "UInt8";
}

/// VTK_TRIANGLE, VTK_TETRA and VTK_QUADRATIC_TETRA (vtkCellType.h), whose node order is ours; 0 for anything else.
constexpr std::uint8_t vtk_cell_type(int nodes_per_cell) {
  return nodes_per_cell == 3 ? 5 : nodes_per_cell == 4 ? 10 : nodes_per_cell == 10 ? 24 : 0;
}

}  // namespace detail

/// A view of scalars (float, double, Index) or 3-vectors (float, double), such as a vector, a span or a `Field`.
class VtuValues {
 public:
  VtuValues() = default;

  /// Refers to an array of numbers or of vectors, which must outlive it.
  template <detail::VtuRange Range>
  VtuValues(const Range& range) {  // NOLINT(google-explicit-constructor): arrays are given as they are
    using Value = detail::VtuEntry<Range>;
    size_ = std::size(range);
    if constexpr (detail::is_vtu_scalar<Value>) {
      numbers_ = std::data(range);
      kind_ = kind_of<Value>;
    } else {
      components_ = 3;
      numbers_ = size_ == 0 ? nullptr : std::data(range)->data();
      kind_ = kind_of<typename Value::Scalar>;
    }
  }

  /// Calls `visitor` with the numbers as a span of float, double or Index.
  template <class Visitor>
  auto visit(Visitor&& visitor) const {
    if (kind_ == kind_of<double>) return visitor(numbers<double>());
    if (kind_ == kind_of<Index>) return visitor(numbers<Index>());
    return visitor(numbers<float>());
  }

  /// How many scalars or vectors.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Numbers an entry: 1, or those of a vector.
  [[nodiscard]] int components() const { return components_; }

  /// The first entry that holds NaN or infinity; `size()` if none does.
  [[nodiscard]] std::size_t first_non_finite() const {
    return visit([&](auto values) {
      std::size_t i = 0;
      if constexpr (std::floating_point<typename decltype(values)::value_type>)
        while (i < values.size() && std::isfinite(values[i])) ++i;
      else
        i = values.size();
      return i / at(components_);
    });
  }

 private:
  enum class Kind : std::uint8_t { f32, f64, i32 };
  template <class T>
  static constexpr Kind kind_of = std::same_as<T, float>    ? Kind::f32
                                  : std::same_as<T, double> ? Kind::f64
                                                            : Kind::i32;

  template <class T>
  [[nodiscard]] std::span<const T> numbers() const {
    return {static_cast<const T*>(numbers_), size_ * at(components_)};
  }

  const void* numbers_ = nullptr;
  std::size_t size_ = 0;
  int components_ = 1;
  Kind kind_ = Kind::f32;
};

/// A view of cells of one kind.
struct VtuCells {
  std::span<const Index> connectivity;  ///< `nodes_per_cell` point indices a cell, in the order of Tet4 and Tet10
  int nodes_per_cell = 4;               ///< 3: triangle, 4: tetrahedron, 10: quadratic tetrahedron
};

/// The cells of mesh data.
[[nodiscard]] inline VtuCells vtu_cells(const MeshData& mesh) {
  return {detail::span_of(mesh.connectivity), mesh.nodes_per_element};
}

/// The cells of triangles.
[[nodiscard]] inline VtuCells vtu_cells(std::span<const std::array<Index, 3>> triangles) {
  return {{triangles.empty() ? nullptr : triangles.front().data(), 3 * triangles.size()}, 3};
}

/// The cells of a surface.
[[nodiscard]] inline VtuCells vtu_cells(const SurfaceMesh& surface) {
  return vtu_cells(detail::span_of(surface.triangles));
}

/// The cells of a mesh, or of a body's.
template <std::floating_point Scalar, TetrahedralElement Element>
[[nodiscard]] VtuCells vtu_cells(const TetMesh<Scalar, Element>& mesh) {
  const auto& elements = mesh.elements();
  return {{elements.front().data(), elements.size() * Element::nodes}, Element::nodes};
}

}  // namespace corotet::inline v0_1
