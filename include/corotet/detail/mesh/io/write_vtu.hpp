// VTK's .vtu: an unstructured grid with named arrays, for ParaView and everything else that stands on VTK.
// Format: "VTK XML formats" in the VTK documentation (docs.vtk.org, vtk_file_formats/vtkxml_file_format).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/span_of.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/io/base64.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/text_writer.hpp>
#include <corotet/detail/mesh/io/vtu_values.hpp>
#include <corotet/detail/mesh/io/xml_text.hpp>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1 {

/// How the numbers stand in a .vtu file.
enum class VtuEncoding {
  appended,  ///< raw bytes after the XML: smallest and fastest
  base64,    ///< binary within the XML, which stays a text file
  ascii      ///< for people; exact, but large and slow
};

/// How a .vtu file stores its numbers.
struct VtuOptions {
  VtuEncoding encoding = VtuEncoding::appended;  ///< appended: the smallest
  std::endian byte_order = std::endian::native;  ///< of the binary encodings
};

/// A named array with one entry a point or a cell.
struct VtuArray {
  std::string_view name;  ///< UTF-8, no control characters, unique among the point (or cell) arrays
  VtuValues values;       ///< one an entry; refers to the caller's array
};

/// What goes into the file: views, which must outlive the call. For instance
///   `VtuGrid grid{.points = x, .cells = vtu_cells(mesh), .point_data = {{"velocity", v}}};`
struct VtuGrid {
  VtuValues points;                    ///< three components each, m
  VtuCells cells;                      ///< refers to the caller's arrays
  std::vector<VtuArray> point_data{};  ///< one entry a point
  std::vector<VtuArray> cell_data{};   ///< one entry a cell
};

namespace detail {

template <class T>
void append_bytes(std::string& bytes, std::span<const T> values, std::endian order) {
  const std::size_t begin = bytes.size();
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  if (order == std::endian::native || sizeof(T) == 1) return;
  for (std::size_t i = begin; i < bytes.size(); i += sizeof(T))
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                 bytes.begin() + static_cast<std::ptrdiff_t>(i + sizeof(T)));
}

/// Collects the XML and, beside it, the appended data.
class VtuText {
 public:
  explicit VtuText(VtuOptions options) : options_(options) {}

  TextWriter& xml() { return xml_; }

  /// `name` is escaped already.
  template <class T>
  void add_array(std::string_view name, std::span<const T> values, int components) {
    xml_ << "        <DataArray type=\"" << vtk_type_name<T>() << "\" Name=\"" << name << "\" NumberOfComponents=\""
         << components << "\" format=\"";
    if (options_.encoding == VtuEncoding::appended) {
      xml_ << "appended\" offset=\"" << appended_.size() << "\"/>\n";
      append_block(appended_, values);
      return;
    }
    if (options_.encoding == VtuEncoding::base64) {
      std::string block;
      append_block(block, values);
      xml_ << "binary\">\n" << to_base64(block);
    } else {
      xml_ << "ascii\">\n";
      const std::size_t in_line = components > 1 ? at(components) : 10;
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (i > 0) xml_ << (i % in_line == 0 ? '\n' : ' ');
        if constexpr (sizeof(T) == 1)
          xml_ << static_cast<int>(values[i]);  // a number, not a character
        else
          xml_ << values[i];
      }
    }
    xml_ << "\n        </DataArray>\n";
  }

  std::string finish() {
    if (options_.encoding == VtuEncoding::appended) {
      xml_ << "  <AppendedData encoding=\"raw\">\n_" << appended_ << "\n  </AppendedData>\n";
    }
    xml_ << "</VTKFile>\n";
    return xml_.take();
  }

 private:
  /// A byte count, then the data.
  template <class T>
  void append_block(std::string& bytes, std::span<const T> values) const {
    const std::array<std::uint64_t, 1> size{values.size_bytes()};
    append_bytes(bytes, std::span<const std::uint64_t>(size), options_.byte_order);
    append_bytes(bytes, values, options_.byte_order);
  }

  VtuOptions options_;
  TextWriter xml_;
  std::string appended_;
};

inline Result<void> check_vtu_values(const VtuArray& array, std::size_t count, std::string_view per) {
  if (array.values.size() != count) {
    return Error{ErrorCode::invalid_argument, quoted(array.name),
                 "it has " + std::to_string(array.values.size()) + " entries for " + std::to_string(count) + " " +
                     std::string(per)};
  }
  if (const auto i = array.values.first_non_finite(); i < count)
    return Error{ErrorCode::non_finite_value, quoted(array.name),
                 "its entry " + std::to_string(i) + " is not a finite number"};
  return {};
}

inline Result<void> add_vtu_arrays(VtuText& text, const std::vector<VtuArray>& arrays, std::size_t count,
                                   std::string_view per) {
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    const VtuArray& array = arrays[i];
    const Result<std::string> name = xml_attribute(array.name, "array name");
    if (!name) return name.error();
    for (std::size_t j = 0; j < i; ++j)
      if (arrays[j].name == array.name)
        return Error{ErrorCode::invalid_argument, quoted(array.name), "two arrays have this name"};
    if (Result<void> status = check_vtu_values(array, count, per); !status) return status;
    array.values.visit([&](auto values) { text.add_array(*name, values, array.values.components()); });
  }
  return {};
}

inline Result<void> check_vtu_cells(const VtuCells& cells, std::size_t point_count) {
  if (vtk_cell_type(cells.nodes_per_cell) == 0 || cells.connectivity.size() % at(cells.nodes_per_cell) != 0) {
    return Error{ErrorCode::invalid_argument, "cells",
                 "cells have 3, 4 or 10 nodes, here " + std::to_string(cells.nodes_per_cell) + ", and " +
                     std::to_string(cells.connectivity.size()) + " entries of connectivity"};
  }
  for (std::size_t i = 0; i < cells.connectivity.size(); ++i) {
    const Index v = cells.connectivity[i];
    if (v < 0 || at(v) >= point_count)
      return Error{ErrorCode::index_out_of_range, "cell " + std::to_string(i / at(cells.nodes_per_cell)),
                   "it names point " + std::to_string(v) + " of " + std::to_string(point_count)};
  }
  return {};
}

}  // namespace detail

/// The content of a .vtu file. Numbers keep their type (Float32, Float64, Int32) and are exact in every encoding.
/// Errors: invalid_argument (array lengths and names, nodes_per_cell), index_out_of_range, non_finite_value.
[[nodiscard]] inline Result<std::string> format_vtu(const VtuGrid& grid, VtuOptions options = {}) {
  const std::size_t points = grid.points.size();
  if (points > 0 && grid.points.components() != 3)
    return Error{ErrorCode::invalid_argument, "points", "they must have three components"};
  if (Result<void> status = detail::check_vtu_values({"points", grid.points}, points, "points"); !status)
    return status.error();
  if (Result<void> status = detail::check_vtu_cells(grid.cells, points); !status) return status.error();
  const std::size_t nodes = at(grid.cells.nodes_per_cell), cells = grid.cells.connectivity.size() / nodes;

  detail::VtuText text(options);
  text.xml() << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\""
             << (options.byte_order == std::endian::big ? "BigEndian" : "LittleEndian")
             << "\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"" << points
             << "\" NumberOfCells=\"" << cells << "\">\n      <PointData>\n";
  if (Result<void> status = detail::add_vtu_arrays(text, grid.point_data, points, "points"); !status)
    return status.error();
  text.xml() << "      </PointData>\n      <CellData>\n";
  if (Result<void> status = detail::add_vtu_arrays(text, grid.cell_data, cells, "cells"); !status)
    return status.error();
  text.xml() << "      </CellData>\n      <Points>\n";
  grid.points.visit([&](auto values) { text.add_array("Points", values, 3); });
  text.xml() << "      </Points>\n      <Cells>\n";
  std::vector<std::int64_t> ends(cells);
  for (std::size_t c = 0; c < cells; ++c) ends[c] = static_cast<std::int64_t>((c + 1) * nodes);
  const std::vector<std::uint8_t> types(cells, detail::vtk_cell_type(grid.cells.nodes_per_cell));
  text.add_array("connectivity", grid.cells.connectivity, 1);
  text.add_array("offsets", detail::span_of(ends), 1);
  text.add_array("types", detail::span_of(types), 1);
  text.xml() << "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n";
  return text.finish();
}

/// Writes a .vtu file, for ParaView: points, cells and fields on them.
///
/// PvdWriter lists the files of a time series; write_animation_html makes a page for a browser.
/// @snippet files.cpp write
/// Errors: those of `format_vtu`, and file_unreadable.
[[nodiscard]] inline Result<void> write_vtu(const FilePath& path, const VtuGrid& grid, VtuOptions options = {}) {
  const Result<std::string> text = format_vtu(grid, options);
  return text ? write_file(path, *text) : Result<void>(text.error());
}

}  // namespace corotet::inline v0_1
