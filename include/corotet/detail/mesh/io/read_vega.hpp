// Reads the text form of Vega FEM's .veg files (Vega user's manual, "Volumetric mesh file format").
#pragma once

#include <array>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/tet_mesh_builder.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1 {
namespace detail {

/// The parts of a .veg file; the last ones come together only when all of them are known.
struct VegaFile {
  TetMeshBuilder sink;
  VertexRange vertices, elements;
  bool has_vertices = false, has_elements = false;
  std::map<std::string, std::vector<std::int64_t>, std::less<>> sets;  ///< element numbers by the set's name
  struct Region {
    std::string set, material;
  };
  std::vector<Region> regions;
};

/// `number` against the one that the item at `i` must have; the first item says whether numbers start at 0 or 1.
inline void check_vega_number(TextScanner& in, VertexRange& range, std::size_t i) {
  const std::int64_t number = in.integer("an item's number");
  if (i == 0) range.first = number;
  if (in.ok() && (range.first < 0 || range.first > 1 || number != range.first + static_cast<std::int64_t>(i)))
    in.fail("number " + std::to_string(number) + " is out of order; they count up from 0 or 1");
}

/// A section may hold the name of another file instead of its data.
inline void refuse_vega_include(TextScanner& in) {
  if (in.peek() != "*INCLUDE") return;
  in.token();
  in.fail("*INCLUDE is not supported: put the included file's content in its place", ErrorCode::unsupported);
}

inline void read_vega_vertices(TextScanner& in, VegaFile& file) {
  if (file.has_vertices) return in.fail("there is a second *VERTICES section");
  file.has_vertices = true;
  refuse_vega_include(in);
  file.vertices.count = in.count("vertices", 4);
  const std::int64_t dimension = in.integer("the dimension");
  if (in.ok() && dimension != 3)
    return in.fail("the vertices have dimension " + std::to_string(dimension) + ", not 3", ErrorCode::unsupported);
  in.rest_of_line();  // numbers of attributes and markers, always 0
  file.sink.mesh.positions.reserve(file.vertices.count);
  for (std::size_t i = 0; i < file.vertices.count && in.ok(); ++i) {
    check_vega_number(in, file.vertices, i);
    file.sink.mesh.positions.push_back(in.point());
  }
}

inline void read_vega_elements(TextScanner& in, VegaFile& file) {
  if (file.has_elements) return in.fail("there is a second *ELEMENTS section");
  if (!file.has_vertices) return in.fail("*ELEMENTS must come after *VERTICES");
  file.has_elements = true;
  const std::string_view type = in.token();
  if (in.ok() && type != "TET" && type != "TETS")
    return in.fail("its elements are of type " + detail::quoted(type) + ", not TET", ErrorCode::unsupported);
  refuse_vega_include(in);
  file.elements.count = in.count("elements", 5);
  const std::int64_t nodes_each = in.integer("the number of vertices of an element");
  if (in.ok() && nodes_each != 4)
    return in.fail("its elements have " + std::to_string(nodes_each) + " vertices, not 4", ErrorCode::unsupported);
  in.rest_of_line();
  for (std::size_t i = 0; i < file.elements.count && in.ok(); ++i) {
    check_vega_number(in, file.elements, i);
    std::array<Index, 10> nodes{};
    for (std::size_t k = 0; k < 4; ++k) nodes[k] = file.vertices.find(in, in.integer("a vertex number"));
    if (in.ok()) file.sink.add(nodes, vtk_order, 0);
  }
}

inline void read_vega_set(TextScanner& in, VegaFile& file, std::string name) {
  std::vector<std::int64_t>& members = file.sets[std::move(name)];
  while (in.ok() && !in.at_end() && in.peek().substr(0, 1) != "*") members.push_back(in.integer("a set's element"));
}

/// Turns *REGION and *SET into tags: the first region is 1, elements in none are 0, later regions win, as in Vega.
inline void assign_vega_regions(TextScanner& in, VegaFile& file) {
  std::vector<int>& tags = file.sink.mesh.regions;
  for (std::size_t r = 0; r < file.regions.size(); ++r)
    file.sink.note("region " + std::to_string(r + 1) + " is set " + detail::quoted(file.regions[r].set) +
                   " of material " + detail::quoted(file.regions[r].material));
  // Walks backwards, so that each element is given its last region once; a set is emptied by its last region, so that
  // it is looked at once, however many regions name it.
  for (std::size_t r = file.regions.size(); r-- > 0;) {
    const auto number = static_cast<int>(r + 1);
    if (file.regions[r].set == "allElements") {
      for (int& t : tags)
        if (t == 0) t = number;
      return;
    }
    const auto set = file.sets.find(file.regions[r].set);
    if (set == file.sets.end())
      return in.fail("a *REGION names the set " + detail::quoted(file.regions[r].set) +
                     ", which the file does not have");
    for (const std::int64_t element : set->second) {
      const std::int64_t e = element - file.elements.first;
      if (e < 0 || e >= static_cast<std::int64_t>(tags.size()))
        return in.fail("set " + detail::quoted(set->first) + " holds element " + std::to_string(element) +
                           ", which the file does not have",
                       ErrorCode::index_out_of_range);
      if (tags[static_cast<std::size_t>(e)] == 0) tags[static_cast<std::size_t>(e)] = number;
    }
    set->second.clear();
  }
}

}  // namespace detail

/// Tetrahedra from the content of a .veg file. Regions count its *REGION sections from 1, in order; `notes` say which
/// set and material each is. Material constants are not read. *INCLUDE and cubes are `unsupported`.
[[nodiscard]] inline Result<MeshData> read_vega(std::string_view text, std::string_view name) {
  detail::TextScanner in(text, name, {.comment = '#', .separator = ','});
  detail::VegaFile file;
  while (in.ok() && !in.at_end()) {
    detail::refuse_vega_include(in);
    const std::string_view section = in.token();
    if (section == "*VERTICES") {
      detail::read_vega_vertices(in, file);
    } else if (section == "*ELEMENTS") {
      detail::read_vega_elements(in, file);
    } else if (section == "*SET") {
      detail::read_vega_set(in, file, std::string(in.token_on_line()));
    } else if (section == "*REGION") {
      const std::string set(in.token()), material(in.token());
      if (material.empty()) in.fail("a *REGION must name a set and a material");
      file.regions.push_back({set, material});
    } else if (section.substr(0, 1) == "*") {
      while (in.ok() && in.next_line() && in.peek().substr(0, 1) != "*") {
      }
    } else {
      in.fail("expected a section such as '*VERTICES', found " + detail::quoted(section));
    }
  }
  if (in.ok() && !file.has_vertices) in.fail("there is no *VERTICES section");
  if (in.ok() && !file.has_elements) in.fail("there is no *ELEMENTS section");
  if (in.ok()) detail::assign_vega_regions(in, file);
  if (!in.ok()) return in.error();
  file.sink.note("vertex numbers start at " + std::to_string(file.vertices.first));
  return file.sink.finish(name);
}

}  // namespace corotet::inline v0_1
