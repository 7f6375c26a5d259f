// Reads TetGen's .node and .ele files, which belong together (TetGen manual, "File formats").
#pragma once

#include <array>
#include <cmath>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/tet_mesh_builder.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

namespace corotet::inline v0_1 {
namespace detail {

/// Points with their attributes and boundary markers, which are skipped. Numbers start at 0 or 1: the first one tells.
inline VertexRange read_tetgen_nodes(TextScanner& in, TetMeshBuilder& sink) {
  VertexRange range;
  range.count = in.count("points", 4);
  const std::int64_t dimension = in.integer("the dimension");
  const std::int64_t attributes = in.integer("the number of attributes", 0, (std::numeric_limits<int>::max)());
  const std::int64_t markers = in.integer("the number of boundary markers", 0, 1);
  if (in.ok() && dimension != 3)
    in.fail("the points have dimension " + std::to_string(dimension) + ", not 3", ErrorCode::unsupported);
  if (!in.ok()) return range;
  sink.mesh.positions.reserve(range.count);
  for (std::size_t i = 0; i < range.count && in.ok(); ++i) {
    const std::int64_t number = in.integer("a point number");
    if (i == 0) range.first = number;
    if (in.ok() && (range.first < 0 || range.first > 1 || number != range.first + static_cast<std::int64_t>(i)))
      in.fail("point number " + std::to_string(number) + " is out of order; they count up from 0 or 1");
    sink.mesh.positions.push_back(in.point());
    for (std::int64_t k = 0; k < attributes + markers && in.ok(); ++k) in.number("a point's attribute");
  }
  if (in.ok() && !in.at_end()) in.fail("there is more after the last point: " + quoted(in.peek()));
  return range;
}

inline void read_tetgen_elements(TextScanner& in, TetMeshBuilder& sink, VertexRange range) {
  const std::size_t count = in.count("tetrahedra", 5);
  const std::int64_t size = in.integer("the number of nodes of a tetrahedron");
  const std::int64_t attributes = in.integer("the number of attributes", 0, (std::numeric_limits<int>::max)());
  if (in.ok() && size != 4 && size != 10)
    in.fail("its tetrahedra have " + std::to_string(size) + " nodes, not 4 or 10", ErrorCode::unsupported);
  if (!in.ok() || !sink.begin(in, static_cast<int>(size))) return;
  bool odd_attributes = false;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    in.integer("a tetrahedron's number");
    std::array<Index, 10> nodes{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(size); ++k) nodes[k] = range.find(in, in.integer("a node"));
    double region = 0;
    for (std::int64_t k = 0; k < attributes && in.ok(); ++k) {
      const double attribute = in.number("an attribute");
      if (k == 0) region = attribute;  // -A writes the region here
    }
    const bool whole =
        exactly_equal(std::nearbyint(region), region) && std::fabs(region) <= (std::numeric_limits<int>::max)();
    odd_attributes = odd_attributes || !whole;
    if (in.ok()) sink.add(nodes, tetgen_order, whole ? static_cast<int>(region) : 0);
  }
  if (odd_attributes) sink.note("attributes that are not whole numbers became region 0");
  if (in.ok() && !in.at_end()) in.fail("there is more after the last tetrahedron: " + quoted(in.peek()));
}

}  // namespace detail

/// Tetrahedra of 4 or 10 nodes from the contents of a .node and a .ele file. Regions are the first attribute.
[[nodiscard]] inline Result<MeshData> read_tetgen(std::string_view node_text, std::string_view ele_text,
                                                  std::string_view node_name, std::string_view ele_name) {
  detail::TetMeshBuilder sink;
  detail::TextScanner nodes(node_text, node_name, {.comment = '#'});
  const detail::VertexRange range = detail::read_tetgen_nodes(nodes, sink);
  if (!nodes.ok()) return nodes.error();
  detail::TextScanner elements(ele_text, ele_name, {.comment = '#'});
  detail::read_tetgen_elements(elements, sink, range);
  if (!elements.ok()) return elements.error();
  sink.note("vertex numbers start at " + std::to_string(range.first));
  return sink.finish(ele_name);
}

/// The same from files: given x.node or x.ele, reads both.
[[nodiscard]] inline Result<MeshData> read_tetgen(const FilePath& path) {
  const FilePath node = path.with_extension(".node"), ele = path.with_extension(".ele");
  const Result<std::string> node_text = read_file(node);
  if (!node_text) return node_text.error();
  const Result<std::string> ele_text = read_file(ele);
  if (!ele_text) return ele_text.error();
  return read_tetgen(*node_text, *ele_text, node.text(), ele.text());
}

}  // namespace corotet::inline v0_1
