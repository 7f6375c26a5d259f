// Reads legacy .vtk unstructured grids, text and binary ("VTK file formats", simple legacy formats, versions 1 to 5.1).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/byte_reader.hpp>
#include <corotet/detail/mesh/io/tet_mesh_builder.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1 {
namespace detail {

/// Bytes of a value of the VTK type `name` in a binary file; 0 for types whose values have no fixed length.
inline std::size_t vtk_type_size(std::string_view name) {
  struct Type {
    std::string_view name;
    std::size_t size;
  };
  constexpr std::array<Type, 15> types{{{"float", 4},
                                        {"double", 8},
                                        {"int", 4},
                                        {"unsigned_int", 4},
                                        {"long", 8},
                                        {"unsigned_long", 8},
                                        {"vtktypeint64", 8},
                                        {"vtktypeint32", 4},
                                        {"vtkIdType", 4},
                                        {"char", 1},
                                        {"unsigned_char", 1},
                                        {"short", 2},
                                        {"unsigned_short", 2},
                                        {"vtktypeuint64", 8},
                                        {"vtktypeuint8", 1}}};
  const auto found = std::find_if(types.begin(), types.end(), [&](const Type& t) { return t.name == name; });
  return found == types.end() ? 0 : found->size;
}

/// True for the cell types of dimension 0, 1 and 2 (vtkCellType.h).
inline bool is_flat_vtk_cell(std::int64_t type) {
  return (type >= 0 && type <= 9) || (type >= 21 && type <= 23) || type == 28 || type == 30 ||
         (type >= 34 && type <= 36) || (type >= 68 && type <= 70) || (type >= 75 && type <= 77);
}

class VtkReader {
 public:
  VtkReader(std::string_view bytes, std::string_view name) : bytes_(bytes), text_(bytes, name) {}

  Result<MeshData> read() {
    read_header();
    while (text_.ok() && !complete() && !text_.at_end()) read_section(text_.token());
    if (text_.ok() && !complete()) text_.fail("the file ends before POINTS, CELLS and CELL_TYPES are complete");
    if (text_.ok()) add_cells();
    if (!text_.ok()) return text_.error();
    if (!text_.at_end()) sink_.note("ignored what follows the cells, such as point and cell data");
    return sink_.finish(text_.name());
  }

 private:
  [[nodiscard]] bool complete() const { return has_points_ && has_cells_ && has_types_; }

  void read_header() {
    if (text_.rest_of_line().substr(0, 14) != "# vtk DataFile") text_.fail("it does not start with '# vtk DataFile'");
    text_.rest_of_line();  // title
    const std::string_view mode = text_.token();
    binary_ = mode == "BINARY";
    if (!binary_ && mode != "ASCII") text_.fail("expected ASCII or BINARY, found " + quoted(mode));
    text_.expect("DATASET");
    const std::string_view dataset = text_.token();
    if (text_.ok() && dataset != "UNSTRUCTURED_GRID")
      text_.fail("it is a " + quoted(dataset) + ", not an UNSTRUCTURED_GRID", ErrorCode::unsupported);
  }

  void read_section(std::string_view keyword) {
    if (keyword == "POINTS" && !has_points_) {
      read_points();
    } else if (keyword == "CELLS" && !has_cells_) {
      read_cells();
    } else if (keyword == "CELL_TYPES" && !has_types_) {
      const std::size_t count = text_.count("cell types", 0);
      has_types_ = read_integers(types_, count, "int", "cell types");
    } else if (keyword == "FIELD") {
      skip_field();
    } else if (keyword == "METADATA") {
      text_.rest_of_line();
      while (text_.ok() && !text_.rest_of_line().empty()) {  // ends with an empty line
      }
    } else {
      text_.fail("expected POINTS, CELLS or CELL_TYPES, found " + quoted(keyword));
    }
  }

  void read_points() {
    const std::size_t count = text_.count("points", 3);
    const std::string_view type = text_.token();
    if (text_.ok() && type != "float" && type != "double")
      return text_.fail("points of type " + quoted(type) + " cannot be read, only float and double",
                        ErrorCode::unsupported);
    has_points_ = true;
    std::vector<Vec3<double>>& points = sink_.mesh.positions;
    if (!binary_) {
      points.reserve(count);
      for (std::size_t i = 0; i < count && text_.ok(); ++i) points.push_back(text_.point());
      return;
    }
    ByteReader data = begin_data();
    if (data.fits(count, "points", 3 * vtk_type_size(type))) points.reserve(count);
    for (std::size_t i = 0; i < count && data.ok(); ++i)
      points.push_back(type == "float" ? data.read_point<float>() : data.read_point<double>());
    end_data(data);
  }

  /// Up to version 4: for each cell its number of points, then these. From 5.1 on: offsets, then all points.
  void read_cells() {
    const std::size_t first = text_.count("cells", 0), second = text_.count("cell entries", 0);
    if (!text_.ok()) return;
    if (text_.peek() == "OFFSETS") {
      text_.token();
      const std::string_view offset_type = text_.token();
      if (!read_integers(offsets_, first, offset_type, "offsets")) return;
      text_.expect("CONNECTIVITY");
      const std::string_view point_type = text_.token();
      has_cells_ = read_integers(connectivity_, second, point_type, "cell points");
      return;
    }
    std::vector<std::int64_t> entries;
    if (!read_integers(entries, second, "int", "cell entries")) return;
    offsets_.push_back(0);
    std::size_t i = 0;
    while (i < entries.size()) {
      const std::int64_t size = entries[i++];
      if (size < 0 || static_cast<std::size_t>(size) > entries.size() - i)
        return text_.fail("a cell of " + std::to_string(size) + " points does not fit into the list of cells");
      const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(i);
      connectivity_.insert(connectivity_.end(), begin, begin + size);
      offsets_.push_back(static_cast<std::int64_t>(connectivity_.size()));
      i += static_cast<std::size_t>(size);
    }
    if (offsets_.size() != first + 1)
      return text_.fail("the list of cells holds " + std::to_string(offsets_.size() - 1) + " cells, not " +
                        std::to_string(first));
    has_cells_ = true;
  }

  bool read_integers(std::vector<std::int64_t>& out, std::size_t count, std::string_view type, std::string_view what) {
    const std::size_t size = vtk_type_size(type);
    if (text_.ok() && (type == "float" || type == "double" || (size != 4 && size != 8)))
      text_.fail(std::string(what) + " of type " + quoted(type) + " cannot be read", ErrorCode::unsupported);
    if (!text_.ok()) return false;
    if (!binary_) {
      if (text_.fits(count, what, 1)) out.reserve(count);
      for (std::size_t i = 0; i < count && text_.ok(); ++i) out.push_back(text_.integer(what));
      return text_.ok();
    }
    ByteReader data = begin_data();
    if (data.fits(count, what, size)) out.reserve(count);
    for (std::size_t i = 0; i < count && data.ok(); ++i)
      out.push_back(size == 4 ? data.read<std::int32_t>(what) : data.read<std::int64_t>(what));
    end_data(data);
    return text_.ok();
  }

  /// FIELD name arrays, then for each array: name, components, tuples, type and the values.
  void skip_field() {
    text_.token();
    const std::size_t arrays = text_.count("arrays", 4);
    for (std::size_t a = 0; a < arrays && text_.ok(); ++a) {
      text_.token();
      const std::size_t components = text_.count("components", 0), tuples = text_.count("tuples", 0);
      const std::string_view type = text_.token();
      const std::size_t size = vtk_type_size(type);
      if (text_.ok() && size == 0)
        return text_.fail("a field of type " + quoted(type) + " cannot be skipped", ErrorCode::unsupported);
      // Each factor is below 2^31, so the product cannot overflow.
      const std::uint64_t values = std::uint64_t{components} * tuples;
      if (binary_) {
        ByteReader data = begin_data();
        if (data.fits(values, "field values", size)) data.skip(values * size, "a field");
        end_data(data);
      } else if (text_.fits(values, "field values", 1)) {
        for (std::uint64_t i = 0; i < values && text_.ok(); ++i)
          if (text_.token().empty()) text_.fail("the file ends within a field");
      }
    }
  }

  void add_cells() {
    if (offsets_.empty() || types_.size() != offsets_.size() - 1)
      return text_.fail("there are " + std::to_string(types_.size()) + " cell types, but " +
                        std::to_string(offsets_.empty() ? 0 : offsets_.size() - 1) + " cells");
    const auto points = static_cast<std::int64_t>(sink_.mesh.positions.size());
    for (std::size_t c = 0; c < types_.size() && text_.ok(); ++c) {
      const std::int64_t begin = offsets_[c], end = offsets_[c + 1];
      if (begin < 0 || end < begin || end > static_cast<std::int64_t>(connectivity_.size()))
        return text_.fail("the offsets of cell " + std::to_string(c) + " are out of range");
      const bool straight = types_[c] == 10, curved = types_[c] == 24;  // VTK_TETRA, VTK_QUADRATIC_TETRA
      if (!straight && !curved) {
        sink_.ignore(!is_flat_vtk_cell(types_[c]), 1);
        continue;
      }
      const std::int64_t size = straight ? 4 : 10;
      if (end - begin != size)
        return text_.fail("cell " + std::to_string(c) + " is a tetrahedron of " + std::to_string(size) +
                          " points, but lists " + std::to_string(end - begin));
      if (!sink_.begin(text_, static_cast<int>(size))) return;
      std::array<Index, 10> nodes{};
      for (std::size_t k = 0; k < static_cast<std::size_t>(size); ++k) {
        const std::int64_t point = connectivity_[static_cast<std::size_t>(begin) + k];
        if (point < 0 || point >= points)
          return text_.fail("cell " + std::to_string(c) + " names point " + std::to_string(point) + ", but there are " +
                                std::to_string(points) + " points",
                            ErrorCode::index_out_of_range);
        nodes[k] = static_cast<Index>(point);
      }
      sink_.add(nodes, vtk_order, 0);
    }
  }

  /// Binary data start on the next line and are big-endian.
  ByteReader begin_data() {
    text_.rest_of_line();
    return ByteReader(bytes_, text_.name(), std::endian::big, text_.position());
  }
  void end_data(const ByteReader& data) {
    text_.seek(data.position());
    if (!data.ok()) text_.adopt(data.error());
  }

  std::string_view bytes_;
  TextScanner text_;
  TetMeshBuilder sink_;
  std::vector<std::int64_t> offsets_, connectivity_, types_;
  bool binary_ = false, has_points_ = false, has_cells_ = false, has_types_ = false;
};

}  // namespace detail

/// Tetrahedra of 4 and 10 nodes (cell types 10 and 24) from the content of a .vtk file; `name` stands for it in errors.
/// Other cells are counted in `notes`; point and cell data are not read, so there are no regions.
[[nodiscard]] inline Result<MeshData> read_vtk(std::string_view bytes, std::string_view name) {
  return detail::VtkReader(bytes, name).read();
}

}  // namespace corotet::inline v0_1
