// Nodes and elements of gmsh's .msh format, version 2 (reference manual, "MSH file format version 2").
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/mesh/io/msh_input.hpp>
#include <corotet/detail/mesh/io/tet_mesh_builder.hpp>

namespace corotet::inline v0_1::detail {

inline void read_msh22_nodes(MshInput& in, TetMeshBuilder& sink) {
  const std::size_t count = in.text.count("nodes", 4);
  in.begin_data();
  in.tags.reserve(count);
  sink.mesh.positions.reserve(count);
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    in.tags.add(in.integer("a node number"));
    sink.mesh.positions.push_back(in.point());
  }
  in.finish_nodes();
}

/// One element after its header. Returns true if it repeats the element before it.
inline bool read_msh22_tet(MshInput& in, TetMeshBuilder& sink, std::int64_t type, std::int64_t tags) {
  int region = 0;
  for (std::int64_t t = 0; t < tags && in.ok(); ++t) {
    const auto tag = static_cast<int>(in.integer("an element tag"));
    if (t == 0) region = tag;  // the first tag is the physical group
  }
  std::array<Index, 10> nodes{};
  const std::size_t size = type == msh_tet4 ? 4 : 10;
  for (std::size_t k = 0; k < size; ++k) nodes[k] = in.node(in.integer("a node number"));
  if (!in.ok() || !sink.begin(in, static_cast<int>(size))) return false;
  sink.add(nodes, gmsh_order, region);
  // gmsh writes an element of two physical groups twice, one after the other.
  auto& all = sink.mesh.connectivity;
  const auto step = static_cast<std::ptrdiff_t>(size);
  if (all.size() < 2 * size || !std::equal(all.end() - step, all.end(), all.end() - 2 * step)) return false;
  all.resize(all.size() - size);
  sink.mesh.regions.pop_back();
  return true;
}

inline void read_msh22_elements(MshInput& in, TetMeshBuilder& sink) {
  const std::size_t count = in.text.count("elements", 4);
  in.begin_data();
  std::size_t done = 0, repeated = 0;
  while (done < count && in.ok()) {
    // Text has a header for each element (its number first), binary data one for a run of them (its length second).
    if (!in.binary()) in.integer("an element number");
    const std::int64_t type = in.integer("an element type");
    const auto run = in.binary() ? in.integer("the number of elements in a run") : std::int64_t{1};
    const std::int64_t tags = in.integer("the number of tags");
    const MshElementType known = msh_element_type(type);
    if (!in.ok()) return;
    if (tags < 0 || run < 1 || static_cast<std::size_t>(run) > count - done)
      return in.fail("an element header with " + std::to_string(tags) + " tags and " + std::to_string(run) +
                     " elements of the " + std::to_string(count) + " announced makes no sense");
    if (in.binary() && known.nodes == 0)
      return in.fail("element type " + std::to_string(type) + " is unknown, so it cannot be skipped",
                     ErrorCode::unsupported);
    done += static_cast<std::size_t>(run);
    const bool tet = type == msh_tet4 || type == msh_tet10;
    if (!tet) sink.ignore(known.dimension == 3, static_cast<std::size_t>(run));
    for (std::int64_t r = 0; r < run && in.ok(); ++r) {
      if (in.binary()) in.integer("an element number");
      if (tet)
        repeated += read_msh22_tet(in, sink, type, tags);
      else if (in.binary())
        for (std::int64_t k = 0; k < tags + known.nodes && in.ok(); ++k) in.integer("an element");
      else
        in.text.rest_of_line();
    }
  }
  if (repeated != 0)
    sink.note("dropped " + std::to_string(repeated) +
              " elements that repeat the one before, in another physical group");
  in.has_elements = true;
  in.end_data("$EndElements");
}

}  // namespace corotet::inline v0_1::detail
