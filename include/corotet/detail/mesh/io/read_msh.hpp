// Reads gmsh's .msh files, versions 2.x and 4.1, text and binary.
#pragma once

#include <bit>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/msh_input.hpp>
#include <corotet/detail/mesh/io/read_msh_22.hpp>
#include <corotet/detail/mesh/io/read_msh_41.hpp>
#include <corotet/detail/mesh/io/tet_mesh_builder.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <string>
#include <string_view>

namespace corotet::inline v0_1 {
namespace detail {

/// $MeshFormat; sets the byte order of binary files. Returns the version, 2 or 4, or 0 after a failure.
inline int read_msh_format(MshInput& in) {
  const std::string_view version = in.text.token();
  const std::int64_t binary = in.text.integer("the file type", 0, 1);
  const std::int64_t size = in.text.integer("the data size");
  if (!in.ok()) return 0;
  const int major = version == "4.1" ? 4 : version == "2.2" || version == "2.1" || version == "2" ? 2 : 0;
  if (major == 0 || size != 8) {
    in.fail("it is version " + quoted(version) + " with data size " + std::to_string(size) +
                "; versions 2.2 and 4.1 with size 8 can be read (gmsh writes them with -format msh41)",
            ErrorCode::unsupported);
    return 0;
  }
  if (binary == 1) {
    in.set_binary(std::endian::little);
    in.begin_data();
    const std::int64_t one = in.integer("the byte order mark");
    if (one == 0x01000000) in.set_binary(std::endian::big);
    if (one != 1 && one != 0x01000000) in.fail("the byte order mark is " + std::to_string(one) + ", not 1");
  }
  in.end_data("$EndMeshFormat");
  return in.ok() ? major : 0;
}

}  // namespace detail

/// Tetrahedra of 4 and 10 nodes (gmsh types 4 and 11) from the content of a .msh file; `name` stands for it in errors.
/// Regions are the first physical group of each element, 0 where it has none; empty if no element has one.
/// Other elements are left out and counted in `notes`. Vertices keep the file's order, whatever their tags.
[[nodiscard]] inline Result<MeshData> read_msh(std::string_view bytes, std::string_view name) {
  detail::MshInput in(bytes, name);
  detail::TetMeshBuilder sink;
  detail::MshRegions regions;
  int version = 0;
  while (in.ok() && !in.text.at_end()) {
    const std::string_view section = in.text.token();
    if (section == "$MeshFormat" && version == 0) {
      version = detail::read_msh_format(in);
    } else if (section == "$NOD") {
      in.fail("it is version 1; versions 2.2 and 4.1 can be read (gmsh converts)", ErrorCode::unsupported);
    } else if (section.substr(0, 1) != "$" || section.substr(0, 4) == "$End") {
      in.fail("expected a section such as '$Nodes', found " + detail::quoted(section));
    } else if (version == 0 && (section == "$Nodes" || section == "$Elements")) {
      in.fail("$MeshFormat must come first");
    } else if ((section == "$Nodes" && in.has_nodes) || (section == "$Elements" && in.has_elements)) {
      in.fail("there is a second " + std::string(section));
    } else if (section == "$Elements" && !in.has_nodes) {
      in.fail("$Elements must come after $Nodes");
    } else if (section == "$Nodes") {
      version == 4 ? detail::read_msh41_nodes(in, sink) : detail::read_msh22_nodes(in, sink);
    } else if (section == "$Elements") {
      version == 4 ? detail::read_msh41_elements(in, sink, regions) : detail::read_msh22_elements(in, sink);
    } else if (version == 4 && (section == "$Entities" || section == "$PartitionedEntities")) {
      detail::read_msh41_entities(in, regions, section == "$PartitionedEntities");
    } else {
      in.text.skip_past("$End" + std::string(section.substr(1)));
    }
  }
  if (in.ok() && version == 0) in.fail("there is no $MeshFormat");
  if (in.ok() && !in.has_nodes) in.fail("there is no $Nodes section");
  if (in.ok() && !in.has_elements) in.fail("there is no $Elements section");
  if (!in.ok()) return in.error();
  return sink.finish(name);
}

}  // namespace corotet::inline v0_1
