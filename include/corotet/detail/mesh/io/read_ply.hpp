// Reads the faces of .ply files, text and binary in either byte order.
#pragma once

#include <array>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/byte_reader.hpp>
#include <corotet/detail/mesh/io/ply_header.hpp>
#include <corotet/detail/mesh/io/surface_mesh_builder.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1 {
namespace detail {

/// Values from the data of a text file. `PlyBytes` offers the same for a binary one.
class PlyText {
 public:
  explicit PlyText(TextScanner& in) : in_(in) {}
  [[nodiscard]] bool ok() const { return in_.ok(); }
  void fail(std::string reason, ErrorCode code = ErrorCode::malformed_file) { in_.fail(std::move(reason), code); }
  double real(PlyType /*type*/) { return in_.number("a number"); }
  std::int64_t integer(PlyType /*type*/) { return in_.integer("an integer"); }
  void skip(PlyType /*type*/, std::size_t count) {
    for (std::size_t i = 0; i < count && in_.ok(); ++i)
      if (in_.token().empty()) in_.fail("the file ends within its data");
  }
  bool fits(std::size_t items, std::string_view what, const PlyElement& element) {
    return in_.fits(items, what, element.properties.size());
  }
  bool fits_list(std::int64_t items, PlyType /*type*/) {
    if (in_.ok() && items < 0) in_.fail("a list has " + std::to_string(items) + " entries");
    return in_.ok() && in_.fits(static_cast<std::size_t>(items), "entries of a list", 1);
  }
  [[nodiscard]] bool at_end() { return in_.at_end(); }

 private:
  TextScanner& in_;
};

class PlyBytes {
 public:
  explicit PlyBytes(ByteReader& in) : in_(in) {}
  [[nodiscard]] bool ok() const { return in_.ok(); }
  void fail(std::string reason, ErrorCode code = ErrorCode::malformed_file) { in_.fail(std::move(reason), code); }
  double real(PlyType type) {
    if (type == PlyType::float32) return in_.read_finite<float>("a number");
    if (type == PlyType::float64) return in_.read_finite<double>("a number");
    return static_cast<double>(integer(type));
  }
  std::int64_t integer(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return in_.read<std::int8_t>("an integer");
      case PlyType::uint8:
        return in_.read<std::uint8_t>("an integer");
      case PlyType::int16:
        return in_.read<std::int16_t>("an integer");
      case PlyType::uint16:
        return in_.read<std::uint16_t>("an integer");
      case PlyType::int32:
        return in_.read<std::int32_t>("an integer");
      case PlyType::uint32:
        return in_.read<std::uint32_t>("an integer");
      case PlyType::none:
      case PlyType::float32:
      case PlyType::float64:
        break;
    }
    in_.fail("an integer was expected where the header announces a real number");
    return 0;
  }
  void skip(PlyType type, std::size_t count) { in_.skip(count * byte_size(type), "the data"); }
  bool fits(std::size_t items, std::string_view what, const PlyElement& element) {
    return in_.fits(items, what, element.min_bytes());
  }
  bool fits_list(std::int64_t items, PlyType type) {
    if (in_.ok() && items < 0) in_.fail("a list has " + std::to_string(items) + " entries");
    return in_.ok() && in_.fits(static_cast<std::size_t>(items), "entries of a list", byte_size(type));
  }
  [[nodiscard]] bool at_end() const { return in_.at_end(); }

 private:
  ByteReader& in_;
};

/// Where in a row of properties the wanted ones stand; -1: nowhere.
inline int find_property(const PlyElement& element, std::string_view name) {
  for (std::size_t i = 0; i < element.properties.size(); ++i)
    if (element.properties[i].name == name) return static_cast<int>(i);
  return -1;
}

template <class Data>
void skip_ply_property(Data& in, const PlyProperty& property) {
  if (!property.is_list()) return in.skip(property.type, 1);
  const std::int64_t count = in.integer(property.count_type);
  if (in.fits_list(count, property.type)) in.skip(property.type, static_cast<std::size_t>(count));
}

template <class Data>
void read_ply_vertices(Data& in, const PlyElement& element, SurfaceMeshBuilder& sink) {
  constexpr std::array<std::string_view, 6> names{"x", "y", "z", "nx", "ny", "nz"};
  std::array<int, 6> columns{};
  for (std::size_t k = 0; k < 6; ++k) columns[k] = find_property(element, names[k]);
  const bool normals = columns[3] >= 0 && columns[4] >= 0 && columns[5] >= 0;
  std::vector<int> wanted(element.properties.size(), -1);  // what each property is, as an index into `names`
  for (std::size_t k = 0; k < (normals ? 6u : 3u); ++k) {
    if (columns[k] < 0) return in.fail("its vertices have no property " + quoted(names[k]));
    if (element.properties[at(columns[k])].is_list()) return in.fail("property " + quoted(names[k]) + " is a list");
    wanted[at(columns[k])] = static_cast<int>(k);
  }
  sink.mesh.positions.reserve(element.count);
  for (std::size_t v = 0; v < element.count && in.ok(); ++v) {
    std::array<double, 6> values{};
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      if (wanted[p] < 0)
        skip_ply_property(in, element.properties[p]);
      else
        values[at(wanted[p])] = in.real(element.properties[p].type);
    }
    if (!in.ok()) return;
    sink.add_vertex(in, {values[0], values[1], values[2]});
    if (normals) sink.mesh.normals.emplace_back(values[3], values[4], values[5]);
  }
}

template <class Data>
void read_ply_faces(Data& in, const PlyElement& element, std::size_t vertex_count, SurfaceMeshBuilder& sink) {
  int column = find_property(element, "vertex_indices");
  if (column < 0) column = find_property(element, "vertex_index");
  if (column < 0) return in.fail("its faces have no property 'vertex_indices'");
  const PlyProperty& indices = element.properties[at(column)];
  if (!indices.is_list() || is_real(indices.type)) return in.fail("the vertex indices are not a list of integers");
  sink.mesh.triangles.reserve(element.count);
  std::vector<Index> corners;
  for (std::size_t f = 0; f < element.count && in.ok(); ++f) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (at(column) != p) {
        skip_ply_property(in, element.properties[p]);
        continue;
      }
      const std::int64_t count = in.integer(indices.count_type);
      corners.clear();
      if (!in.fits_list(count, indices.type)) return;
      for (std::int64_t c = 0; c < count && in.ok(); ++c)
        corners.push_back(surface_vertex(in, in.integer(indices.type), vertex_count));
    }
    if (in.ok()) sink.add_polygon(in, corners);
  }
}

template <class Data>
void read_ply_data(Data& in, const PlyHeader& header, SurfaceMeshBuilder& sink) {
  const PlyElement* vertices = header.find("vertex");
  if (vertices == nullptr) return in.fail("it has no element 'vertex'");
  if (header.find("face") == nullptr && header.find("tristrips") != nullptr)
    return in.fail("its triangles come as strips", ErrorCode::unsupported);
  for (const PlyElement& element : header.elements) {
    if (element.count == 0) continue;
    if (element.properties.empty()) return in.fail("element " + quoted(element.name) + " has no properties");
    if (!in.fits(element.count, element.name, element)) return;
    if (element.name == "vertex") {
      read_ply_vertices(in, element, sink);
    } else if (element.name == "face") {
      read_ply_faces(in, element, vertices->count, sink);
    } else {
      for (std::size_t i = 0; i < element.count && in.ok(); ++i)
        for (const PlyProperty& property : element.properties) skip_ply_property(in, property);
      sink.note("ignored element " + quoted(element.name));
    }
  }
  if (in.ok() && !in.at_end()) sink.note("ignored what follows the last element");
}

}  // namespace detail

/// The faces of a .ply file: x, y, z and, if there are, nx, ny, nz of `vertex`, and the list `vertex_indices` (or
/// `vertex_index`) of `face`, each of any type and in any order. Other properties and elements are skipped.
[[nodiscard]] inline Result<SurfaceMesh> read_ply(std::string_view bytes, std::string_view name) {
  detail::TextScanner in(bytes, name);
  const detail::PlyHeader header = detail::read_ply_header(in);
  if (!in.ok()) return in.error();
  detail::SurfaceMeshBuilder sink;
  if (header.text) {
    detail::PlyText data(in);
    detail::read_ply_data(data, header, sink);
    if (!in.ok()) return in.error();
  } else {
    detail::ByteReader reader(bytes, name, header.order, in.position());
    detail::PlyBytes data(reader);
    detail::read_ply_data(data, header, sink);
    if (!reader.ok()) return reader.error();
  }
  return sink.finish(name);
}

}  // namespace corotet::inline v0_1
