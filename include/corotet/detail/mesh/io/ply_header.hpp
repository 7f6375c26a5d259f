// The header of .ply files: what the data hold and how (G. Turk, "The PLY Polygon File Format", 1994).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1::detail {

enum class PlyType { none, int8, uint8, int16, uint16, int32, uint32, float32, float64 };

inline PlyType ply_type(std::string_view name) {
  struct Name {
    std::string_view old_name, new_name;
    PlyType type;
  };
  constexpr std::array<Name, 8> names{{{"char", "int8", PlyType::int8},
                                       {"uchar", "uint8", PlyType::uint8},
                                       {"short", "int16", PlyType::int16},
                                       {"ushort", "uint16", PlyType::uint16},
                                       {"int", "int32", PlyType::int32},
                                       {"uint", "uint32", PlyType::uint32},
                                       {"float", "float32", PlyType::float32},
                                       {"double", "float64", PlyType::float64}}};
  for (const Name& known : names)
    if (name == known.old_name || name == known.new_name) return known.type;
  return PlyType::none;
}

constexpr bool is_real(PlyType type) { return type == PlyType::float32 || type == PlyType::float64; }

constexpr std::size_t byte_size(PlyType type) {
  switch (type) {
    case PlyType::none:
      return 0;
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      return 8;
  }
  return 0;
}

struct PlyProperty {
  std::string_view name;
  PlyType type = PlyType::none;
  PlyType count_type = PlyType::none;  // of a list; none for a single value

  [[nodiscard]] bool is_list() const { return count_type != PlyType::none; }
};

struct PlyElement {
  std::string_view name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  /// The least that one of them takes: lists may be empty.
  [[nodiscard]] std::size_t min_bytes() const {
    std::size_t bytes = 0;
    for (const PlyProperty& p : properties) bytes += byte_size(p.is_list() ? p.count_type : p.type);
    return bytes;
  }
};

struct PlyHeader {
  bool text = true;
  std::endian order = std::endian::little;
  std::vector<PlyElement> elements;

  [[nodiscard]] const PlyElement* find(std::string_view name) const {
    const auto found =
        std::find_if(elements.begin(), elements.end(), [&](const PlyElement& e) { return e.name == name; });
    return found == elements.end() ? nullptr : &*found;
  }
};

inline PlyType read_ply_type(TextScanner& in) {
  const std::string_view name = in.token_on_line();
  const PlyType type = ply_type(name);
  if (type == PlyType::none) in.fail(quoted(name) + " is not a type");
  return type;
}

inline PlyProperty read_ply_property(TextScanner& in) {
  PlyProperty property;
  TextScanner ahead(in);
  if (ahead.token_on_line() == "list") {
    in.token_on_line();
    property.count_type = read_ply_type(in);
    if (is_real(property.count_type)) in.fail("the length of a list is not an integer");
  }
  property.type = read_ply_type(in);
  property.name = in.token_on_line();
  if (property.name.empty()) in.fail("a property has no name");
  return property;
}

/// Leaves `in` at the first byte of the data.
inline PlyHeader read_ply_header(TextScanner& in) {
  PlyHeader header;
  bool has_format = false;
  in.expect("ply");
  while (in.next_line()) {  // false after a failure, too
    const std::string_view keyword = in.token_on_line();
    if (keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "end_header") {
      in.rest_of_line();
      if (!has_format) in.fail("the header has no 'format'");
      return header;
    }
    if (keyword == "format") {
      const std::string_view format = in.token_on_line();
      has_format = true;
      header.text = format == "ascii";
      header.order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
      if (!header.text && format != "binary_big_endian" && format != "binary_little_endian")
        in.fail(quoted(format) + " is not a format of .ply files");
      if (const std::string_view version = in.token_on_line(); version != "1.0")
        in.fail("its version is " + quoted(version) + ", not 1.0", ErrorCode::unsupported);
    } else if (keyword == "element") {
      PlyElement element;
      element.name = in.token_on_line();
      element.count = static_cast<std::size_t>(in.integer_on_line("the number of " + quoted(element.name), 0));
      if (header.find(element.name) != nullptr) in.fail("there is a second element " + quoted(element.name));
      if (header.elements.size() >= 256) in.fail("it has more than 256 elements", ErrorCode::unsupported);
      header.elements.push_back(element);
    } else if (keyword == "property") {
      if (header.elements.empty())
        in.fail("a property comes before the first element");
      else
        header.elements.back().properties.push_back(read_ply_property(in));
    } else {
      in.fail(quoted(keyword) + " is not a keyword of the header");
    }
  }
  in.fail("the header does not end with 'end_header'");
  return header;
}

}  // namespace corotet::inline v0_1::detail
