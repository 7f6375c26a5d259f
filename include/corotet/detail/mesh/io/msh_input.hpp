// The layer of gmsh's .msh format that hides whether numbers are text or binary.
#pragma once

#include <array>
#include <bit>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/io/byte_reader.hpp>
#include <corotet/detail/mesh/io/node_tags.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace corotet::inline v0_1::detail {

/// A gmsh element type: number of nodes and dimension; {0, 0} where unknown.
struct MshElementType {
  int nodes, dimension;
};

inline constexpr std::int64_t msh_tet4 = 4, msh_tet10 = 11;

/// From the list of types in the gmsh reference manual, "MSH file format".
inline MshElementType msh_element_type(std::int64_t type) {
  constexpr std::array<MshElementType, 32> types{
      {{0, 0},  {2, 1},  {3, 2},  {4, 2},  {4, 3}, {8, 3}, {6, 3},  {5, 3},  {3, 1},  {6, 2}, {9, 2},
       {10, 3}, {27, 3}, {18, 3}, {14, 3}, {1, 0}, {8, 2}, {20, 3}, {15, 3}, {13, 3}, {9, 2}, {10, 2},
       {12, 2}, {15, 2}, {15, 2}, {21, 2}, {4, 1}, {5, 1}, {6, 1},  {20, 3}, {35, 3}, {56, 3}}};
  if (type == 92) return {64, 3};
  if (type == 93) return {125, 3};
  return type >= 0 && type < 32 ? types[static_cast<std::size_t>(type)] : MshElementType{0, 0};
}

/// Section keywords are always text; the data within a section may be binary. `begin_data` and `end_data` mark it.
class MshInput {
 public:
  MshInput(std::string_view bytes, std::string_view name) : text(bytes, name), bytes_(bytes), data_({}, name) {}

  TextScanner text;

  void set_binary(std::endian order) {
    binary_ = true;
    order_ = order;
  }
  [[nodiscard]] bool binary() const { return binary_; }

  /// The data starts on the next line.
  void begin_data() {
    if (!binary_) return;
    text.rest_of_line();
    in_data_ = true;
    data_ = ByteReader(bytes_, text.name(), order_, text.position());
  }

  /// The data must end here, followed by `keyword`.
  void end_data(std::string_view keyword) {
    if (!ok()) return;
    if (in_data_) text.seek(data_.position());
    in_data_ = false;
    text.expect(keyword);
  }

  /// An `int` of the format: 4 bytes, signed.
  std::int64_t integer(std::string_view what) {
    if (in_data_) return data_.read<std::int32_t>(what);
    return text.integer(what, (std::numeric_limits<std::int32_t>::min)(), (std::numeric_limits<std::int32_t>::max)());
  }

  /// A `size_t` of the format: 8 bytes, unsigned.
  std::int64_t size(std::string_view what) {
    constexpr auto most = (std::numeric_limits<std::int64_t>::max)();
    if (!in_data_) return text.integer(what, 0, most);
    const auto value = data_.read<std::uint64_t>(what);
    if (value > std::uint64_t{most}) {
      fail(std::string(what) + " is " + std::to_string(value) + ", out of range");
      return 0;
    }
    return static_cast<std::int64_t>(value);
  }

  double real(std::string_view what) { return in_data_ ? data_.read_finite<double>(what) : text.number(what); }

  Vec3<double> point() { return in_data_ ? data_.read_point<double>() : text.point(); }

  /// A number of items that follow, stored as a size; see TextScanner::count.
  std::size_t count(std::string_view what, std::size_t tokens_each, std::size_t bytes_each) {
    return in_data_ ? data_.count<std::uint64_t>(what, bytes_each) : text.count(what, tokens_each);
  }

  void fail(std::string reason, ErrorCode code = ErrorCode::malformed_file) {
    in_data_ ? data_.fail(std::move(reason), code) : text.fail(std::move(reason), code);
  }

  [[nodiscard]] bool ok() const { return text.ok() && data_.ok(); }
  [[nodiscard]] const Error& error() const { return text.ok() ? data_.error() : text.error(); }

  NodeTags tags;
  bool has_nodes = false;     ///< $Nodes has been read
  bool has_elements = false;  ///< $Elements has been read

  /// The end of $Nodes.
  void finish_nodes() {
    if (!ok()) return;
    if (const auto twin = tags.finish()) fail("node " + std::to_string(*twin) + " is defined twice");
    has_nodes = true;
    end_data("$EndNodes");
  }

  /// The 0-based index of a node that an element names.
  Index node(std::int64_t tag) {
    if (!ok()) return 0;
    if (const auto index = tags.find(tag)) return *index;
    fail("an element names node " + std::to_string(tag) + ", which $Nodes does not have",
         ErrorCode::index_out_of_range);
    return 0;
  }

 private:
  std::string_view bytes_;
  ByteReader data_;
  bool binary_ = false;
  bool in_data_ = false;
  std::endian order_ = std::endian::native;
};

}  // namespace corotet::inline v0_1::detail
