// How well a mesh is shaped: every element's measures, their spread, and the worst elements by name.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/span_of.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/check_connectivity.hpp>
#include <corotet/detail/mesh/element_quality.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// Order statistics of one measure over the elements. The p-th percentile is the smallest value that at least p per
/// cent of the elements do not exceed; the median is the 50th.
struct Spread {
  double least = 0;         ///< minimum
  double percentile5 = 0;   ///< 5 % are below
  double median = 0;        ///< half are below
  double percentile95 = 0;  ///< 95 % are below
  double most = 0;          ///< maximum
};

/// The measures of a mesh; all zero if it has no elements.
struct MeshQuality {
  std::vector<ElementQuality> elements;  ///< of each element

  double total_volume = 0;  ///< m^3
  Spread volume;            ///< m^3
  Spread shape;             ///< see ElementQuality, as for the others
  Spread min_dihedral;      ///< degrees
  Spread max_dihedral;      ///< degrees
  Spread radius_ratio;      ///< see ElementQuality
  Spread edge_ratio;        ///< see ElementQuality
  Spread jacobian_ratio;    ///< see ElementQuality

  /// How many dihedral angles, six an element, lie in [10 i, 10 i + 10) degrees; 180 counts in the last.
  std::array<Index, 18> dihedral_histogram{};
};

/// An element and what is wrong with it.
struct WorstElement {
  Index element = 0;                           ///< its number
  ElementQuality quality;                      ///< of this element
  ElementDefect defect = ElementDefect::none;  ///< describe(defect) says it in words
};

namespace detail {

inline Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto percentile = [&](std::size_t p) { return values[(values.size() * p + 99) / 100 - 1]; };
  return {values.front(), percentile(5), percentile(50), percentile(95), values.back()};
}

inline MeshQuality summarise(std::vector<ElementQuality> elements) {
  MeshQuality quality;
  quality.elements = std::move(elements);
  const auto spread = [&](double ElementQuality::*measure) {
    std::vector<double> values;
    values.reserve(quality.elements.size());
    for (const ElementQuality& element : quality.elements) values.push_back(element.*measure);
    return spread_of(std::move(values));
  };
  quality.volume = spread(&ElementQuality::volume);
  quality.shape = spread(&ElementQuality::shape);
  quality.min_dihedral = spread(&ElementQuality::min_dihedral);
  quality.max_dihedral = spread(&ElementQuality::max_dihedral);
  quality.radius_ratio = spread(&ElementQuality::radius_ratio);
  quality.edge_ratio = spread(&ElementQuality::edge_ratio);
  quality.jacobian_ratio = spread(&ElementQuality::jacobian_ratio);
  for (const ElementQuality& element : quality.elements) {
    quality.total_volume += element.volume;
    for (const double angle : element.dihedrals)
      ++quality.dihedral_histogram[std::min<std::size_t>(static_cast<std::size_t>(angle / 10), 17)];
  }
  return quality;
}

template <TetrahedralElement Element, std::floating_point Scalar>
ElementQuality measure_nodes(const std::vector<Vec3<Scalar>>& positions, const Index* nodes) {
  std::array<Vec3<double>, Element::nodes> x;
  for (std::size_t a = 0; a < x.size(); ++a) x[a] = positions[at(nodes[a])].template cast<double>();
  return measure_element<Element>(x);
}

}  // namespace detail

/// Measures an unchecked mesh, inverted and flat elements included.
/// Errors: invalid_argument (nodes_per_element), index_out_of_range, non_finite_value.
[[nodiscard]] inline Result<MeshQuality> measure_quality(const MeshData& mesh) {
  if (Result<void> status = detail::check_connectivity(mesh); !status) return status.error();
  if (Result<void> status = detail::check_positions(detail::span_of(mesh.positions), "vertex"); !status)
    return status.error();
  std::vector<ElementQuality> elements;
  elements.reserve(at(mesh.element_count()));
  for (Index e = 0; e < mesh.element_count(); ++e) {
    const Index* nodes = mesh.connectivity.data() + std::ptrdiff_t{e} * mesh.nodes_per_element;
    elements.push_back(mesh.nodes_per_element == 4 ? detail::measure_nodes<Tet4>(mesh.positions, nodes)
                                                   : detail::measure_nodes<Tet10>(mesh.positions, nodes));
  }
  return detail::summarise(std::move(elements));
}

/// Measures a checked mesh at rest.
template <std::floating_point Scalar, TetrahedralElement Element>
[[nodiscard]] MeshQuality measure_quality(const TetMesh<Scalar, Element>& mesh) {
  std::vector<ElementQuality> elements;
  elements.reserve(at(mesh.element_count()));
  for (const auto& nodes : mesh.elements())
    elements.push_back(detail::measure_nodes<Element>(mesh.positions(), nodes.data()));
  return detail::summarise(std::move(elements));
}

/// The `count` worst elements (all, if there are fewer), worst first: by `shape`, or `jacobian_ratio` where curvature
/// is the worse evil. Elements of equal rank come in the order of the mesh.
[[nodiscard]] inline std::vector<WorstElement> worst_elements(const MeshQuality& quality, Index count) {
  const auto rank = [&](Index e) {
    const ElementQuality& element = quality.elements[at(e)];
    return (std::min)(element.shape, element.jacobian_ratio);
  };
  std::vector<Index> order(quality.elements.size());
  std::iota(order.begin(), order.end(), 0);
  const auto end = order.begin() + std::clamp<Index>(count, 0, size_of(order));
  std::partial_sort(order.begin(), end, order.end(),
                    [&](Index a, Index b) { return std::pair(rank(a), a) < std::pair(rank(b), b); });
  std::vector<WorstElement> worst;
  for (auto e = order.begin(); e != end; ++e)
    worst.push_back({*e, quality.elements[at(*e)], classify(quality.elements[at(*e)])});
  return worst;
}

}  // namespace corotet::inline v0_1
