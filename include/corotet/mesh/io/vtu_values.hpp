// Views of the library's arrays in the terms of VTK: typed values and cells.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <corotet/core/types.hpp>
#include <corotet/mesh/mesh_data.hpp>
#include <corotet/mesh/surface_mesh.hpp>
#include <corotet/mesh/tet_mesh.hpp>
#include <cstdint>
#include <ranges>
#include <span>
#include <string_view>
#include <type_traits>
#include <variant>

namespace corotet::inline v0_1 {
namespace detail {

template <class T>
inline constexpr bool is_vtu_scalar = std::same_as<T, float> || std::same_as<T, double> || std::same_as<T, Index>;

template <class T>
inline constexpr bool is_vtu_vector = std::same_as<T, Vec3<float>> || std::same_as<T, Vec3<double>>;

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

  template <std::ranges::contiguous_range Range>
    requires(detail::is_vtu_scalar<std::ranges::range_value_t<Range>> ||
             detail::is_vtu_vector<std::ranges::range_value_t<Range>>)
  VtuValues(const Range& range) {  // NOLINT(google-explicit-constructor): arrays are given as they are
    using Value = std::ranges::range_value_t<Range>;
    if constexpr (detail::is_vtu_scalar<Value>) {
      values_ = std::span<const Value>(std::ranges::data(range), std::ranges::size(range));
    } else {
      using Scalar = typename Value::Scalar;
      components_ = 3;
      const std::size_t size = std::ranges::size(range);
      values_ = std::span<const Scalar>(size == 0 ? nullptr : std::ranges::data(range)->data(), 3 * size);
    }
  }

  /// Calls `visitor` with the numbers as a span of float, double or Index.
  template <class Visitor>
  auto visit(Visitor&& visitor) const {
    if (const auto* doubles = std::get_if<1>(&values_)) return visitor(*doubles);
    if (const auto* integers = std::get_if<2>(&values_)) return visitor(*integers);
    return visitor(*std::get_if<0>(&values_));
  }

  /// How many scalars or vectors.
  [[nodiscard]] std::size_t size() const {
    return visit([&](auto values) { return values.size() / at(components_); });
  }
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
  std::variant<std::span<const float>, std::span<const double>, std::span<const Index>> values_;
  int components_ = 1;
};

/// A view of cells of one kind.
struct VtuCells {
  std::span<const Index> connectivity;  ///< `nodes_per_cell` point indices a cell, in the order of Tet4 and Tet10
  int nodes_per_cell = 4;               ///< 3: triangle, 4: tetrahedron, 10: quadratic tetrahedron
};

[[nodiscard]] inline VtuCells vtu_cells(const MeshData& mesh) { return {mesh.connectivity, mesh.nodes_per_element}; }

[[nodiscard]] inline VtuCells vtu_cells(std::span<const std::array<Index, 3>> triangles) {
  return {{triangles.empty() ? nullptr : triangles.front().data(), 3 * triangles.size()}, 3};
}

[[nodiscard]] inline VtuCells vtu_cells(const SurfaceMesh& surface) {
  return vtu_cells(std::span<const std::array<Index, 3>>(surface.triangles));
}

template <std::floating_point Scalar, ReferenceElement Element>
[[nodiscard]] VtuCells vtu_cells(const TetMesh<Scalar, Element>& mesh) {
  const auto& elements = mesh.elements();
  return {{elements.front().data(), elements.size() * Element::nodes}, Element::nodes};
}

}  // namespace corotet::inline v0_1
