// Entities, nodes and elements of gmsh's .msh format, version 4.1 (reference manual, "MSH file format").
#pragma once

#include <array>
#include <corotet/detail/mesh/io/msh_input.hpp>
#include <corotet/detail/mesh/io/tet_mesh_builder.hpp>
#include <map>

namespace corotet::inline v0_1::detail {

/// Physical group of each volume entity that is in one.
using MshRegions = std::map<std::int64_t, int>;

/// $Entities, or $PartitionedEntities, whose entities have a parent and a list of partitions besides.
inline void read_msh41_entities(MshInput& in, MshRegions& regions, bool partitioned) {
  in.begin_data();
  if (partitioned) {
    in.size("the number of partitions");
    const std::size_t ghosts = in.count("ghost entities", 2, 8);
    for (std::size_t g = 0; g < 2 * ghosts && in.ok(); ++g) in.integer("a ghost entity");
  }
  std::array<std::size_t, 4> counts{};
  for (std::size_t& count : counts) count = in.count("entities", 5, 36);
  for (std::size_t dimension = 0; dimension < 4; ++dimension)
    for (std::size_t i = 0; i < counts[dimension] && in.ok(); ++i) {
      const std::int64_t tag = in.integer("an entity's tag");
      if (partitioned) {
        in.integer("a parent's dimension");
        in.integer("a parent's tag");
        const std::size_t partitions = in.count("partitions", 1, 4);
        for (std::size_t k = 0; k < partitions && in.ok(); ++k) in.integer("a partition");
      }
      const int box = dimension == 0 ? 3 : 6;  // a point has a position, the others a bounding box
      for (int k = 0; k < box; ++k) in.real("an entity's extent");
      const std::size_t groups = in.count("physical groups", 1, 4);
      for (std::size_t k = 0; k < groups && in.ok(); ++k) {
        const auto group = static_cast<int>(in.integer("a physical group"));
        if (dimension == 3 && k == 0) regions[tag] = group;
      }
      if (dimension == 0) continue;
      const std::size_t bounds = in.count("bounding entities", 1, 4);
      for (std::size_t k = 0; k < bounds && in.ok(); ++k) in.integer("a bounding entity");
    }
  in.end_data(partitioned ? "$EndPartitionedEntities" : "$EndEntities");
}

inline void read_msh41_nodes(MshInput& in, TetMeshBuilder& sink) {
  in.begin_data();
  const std::size_t blocks = in.count("node blocks", 4, 20), total = in.count("nodes", 4, 32);
  in.size("the least node number");
  in.size("the greatest node number");
  if (!in.ok()) return;
  in.tags.reserve(total);
  sink.mesh.positions.reserve(total);
  for (std::size_t b = 0; b < blocks && in.ok(); ++b) {
    const std::int64_t dimension = in.integer("an entity's dimension");
    in.integer("an entity's tag");
    const std::int64_t parametric = in.integer("a parametric flag");
    const std::size_t count = in.count("nodes", 4, 32);
    if (!in.ok()) return;
    if (dimension < 0 || dimension > 3 || parametric < 0 || parametric > 1)
      return in.fail("a node block of dimension " + std::to_string(dimension) + " with parametric flag " +
                     std::to_string(parametric) + " makes no sense");
    if (count > total - sink.mesh.positions.size())
      return in.fail("the blocks hold more nodes than the " + std::to_string(total) + " announced");
    for (std::size_t i = 0; i < count && in.ok(); ++i) in.tags.add(in.size("a node number"));
    for (std::size_t i = 0; i < count && in.ok(); ++i) {
      sink.mesh.positions.push_back(in.point());
      for (std::int64_t k = 0; k < parametric * dimension; ++k) in.real("a parametric coordinate");
    }
  }
  if (sink.mesh.positions.size() != total)
    in.fail("the blocks hold " + std::to_string(sink.mesh.positions.size()) + " of the " + std::to_string(total) +
            " nodes announced");
  in.finish_nodes();
}

/// The elements of one block, which are all of the same type.
inline void read_msh41_block(MshInput& in, TetMeshBuilder& sink, std::int64_t type, std::size_t count, int region) {
  const MshElementType known = msh_element_type(type);
  if (type != msh_tet4 && type != msh_tet10) {
    sink.ignore(known.dimension == 3, count);
    if (known.nodes == 0 && in.binary())
      return in.fail("element type " + std::to_string(type) + " is unknown, so it cannot be skipped",
                     ErrorCode::unsupported);
    if (known.nodes == 0) static_cast<void>(in.text.at_end());  // moves to the line of the first element
    for (std::size_t i = 0; i < count && in.ok(); ++i) {
      if (known.nodes == 0) in.text.rest_of_line();
      for (int k = 0; known.nodes != 0 && k < 1 + known.nodes; ++k) in.size("an element");
    }
    return;
  }
  if (count == 0 || !sink.begin(in, known.nodes)) return;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    in.size("an element number");
    std::array<Index, 10> nodes{};
    for (std::size_t k = 0; k < at(known.nodes); ++k) nodes[k] = in.node(in.size("a node number"));
    if (in.ok()) sink.add(nodes, gmsh_order, region);
  }
}

inline void read_msh41_elements(MshInput& in, TetMeshBuilder& sink, const MshRegions& regions) {
  in.begin_data();
  const std::size_t blocks = in.count("element blocks", 4, 20), total = in.count("elements", 2, 16);
  in.size("the least element number");
  in.size("the greatest element number");
  std::size_t done = 0;
  for (std::size_t b = 0; b < blocks && in.ok(); ++b) {
    const std::int64_t dimension = in.integer("an entity's dimension");
    const std::int64_t entity = in.integer("an entity's tag");
    const std::int64_t type = in.integer("an element type");
    const std::size_t count = in.count("elements", 2, 16);
    if (!in.ok()) return;
    if (count > total - done)
      return in.fail("the blocks hold more elements than the " + std::to_string(total) + " announced");
    done += count;
    const auto region = dimension == 3 ? regions.find(entity) : regions.end();
    read_msh41_block(in, sink, type, count, region == regions.end() ? 0 : region->second);
  }
  if (done != total)
    in.fail("the blocks hold " + std::to_string(done) + " of the " + std::to_string(total) + " elements announced");
  in.has_elements = true;
  in.end_data("$EndElements");
}

}  // namespace corotet::inline v0_1::detail
