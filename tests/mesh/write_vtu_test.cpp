#include <gtest/gtest.h>

#include <corotet/detail/mesh/io/write_vtu.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <sstream>

#include "mesh/mesh_files.hpp"

namespace corotet {
namespace {

/// One array taken out of a .vtu file again.
struct ParsedArray {
  std::string type;
  int components = 0;
  std::vector<double> values;  // all types in use here fit in a double
};

struct ParsedGrid {
  std::string byte_order;
  std::size_t points = 0, cells = 0;
  std::map<std::string, ParsedArray> arrays;
};

std::string attribute(const std::string& tag, const std::string& name) {
  const std::string key = " " + name + "=\"";
  const std::size_t begin = tag.find(key);
  if (begin == std::string::npos) return {};
  return tag.substr(begin + key.size(), tag.find('"', begin + key.size()) - begin - key.size());
}

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) continue;  // line ends
    bits = (bits << 6) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count >= 8) bytes += static_cast<char>((bits >> (count -= 8)) & 255);
  }
  return bytes;
}

template <class T>
T value_at(const std::string& bytes, std::size_t offset, bool big_endian) {
  char raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i)
    raw[big_endian ? sizeof(T) - 1 - i : i] = bytes[offset + i];  // the tests' machine is little-endian
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

template <class T>
void decode(const std::string& bytes, std::size_t offset, bool big_endian, std::vector<double>& values) {
  const auto size = value_at<std::uint64_t>(bytes, offset, big_endian);
  EXPECT_EQ(size % sizeof(T), 0u);
  for (std::size_t i = 0; i < size; i += sizeof(T))
    values.push_back(static_cast<double>(value_at<T>(bytes, offset + 8 + i, big_endian)));
}

void decode(const std::string& type, const std::string& bytes, std::size_t offset, bool big, std::vector<double>& out) {
  if (type == "Float32") return decode<float>(bytes, offset, big, out);
  if (type == "Float64") return decode<double>(bytes, offset, big, out);
  if (type == "Int32") return decode<std::int32_t>(bytes, offset, big, out);
  if (type == "Int64") return decode<std::int64_t>(bytes, offset, big, out);
  if (type == "UInt8") return decode<std::uint8_t>(bytes, offset, big, out);
  FAIL() << "unknown type " << type;
}

ParsedGrid parse_grid(const std::string& file) {
  ParsedGrid grid;
  const auto tag_after = [&](const std::string& name, std::size_t from) {
    const std::size_t begin = file.find("<" + name + " ", from);
    return begin == std::string::npos ? std::string() : file.substr(begin, file.find('>', begin) - begin + 1);
  };
  const std::string root = tag_after("VTKFile", 0), piece = tag_after("Piece", 0);
  EXPECT_EQ(attribute(root, "type"), "UnstructuredGrid");
  EXPECT_EQ(attribute(root, "header_type"), "UInt64");
  grid.byte_order = attribute(root, "byte_order");
  const bool big = grid.byte_order == "BigEndian";
  grid.points = std::stoul(attribute(piece, "NumberOfPoints"));
  grid.cells = std::stoul(attribute(piece, "NumberOfCells"));
  const std::size_t appended = file.find("<AppendedData encoding=\"raw\">");
  const std::size_t data = appended == std::string::npos ? 0 : file.find('_', appended) + 1;
  for (std::size_t i = file.find("<DataArray "); i < appended && i != std::string::npos;
       i = file.find("<DataArray ", i + 1)) {
    const std::string tag = tag_after("DataArray", i);
    ParsedArray array;
    array.type = attribute(tag, "type");
    array.components = std::stoi(attribute(tag, "NumberOfComponents"));
    const std::string body = file.substr(i + tag.size(), file.find("</DataArray>", i) - i - tag.size());
    if (attribute(tag, "format") == "appended") {
      decode(array.type, file, data + std::stoul(attribute(tag, "offset")), big, array.values);
    } else if (attribute(tag, "format") == "binary") {
      decode(array.type, from_base64(body), 0, big, array.values);
    } else {
      std::istringstream words(body);
      for (std::string word; words >> word;)
        array.values.push_back(array.type == "Float32" ? double{std::strtof(word.c_str(), nullptr)}
                                                       : std::strtod(word.c_str(), nullptr));
    }
    grid.arrays[attribute(tag, "Name")] = array;
  }
  return grid;
}

template <class Range>
std::vector<double> numbers(const Range& range) {
  std::vector<double> out;
  for (const auto& value : range) {
    if constexpr (requires { value.size(); })
      for (const auto x : value) out.push_back(static_cast<double>(x));
    else
      out.push_back(static_cast<double>(value));
  }
  return out;
}

/// Values of every magnitude, both zeros, the extremes included.
template <class Scalar>
Field<Scalar> field(Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-30, 30);
  Field<Scalar> out(at(count));
  for (auto& v : out)
    for (Scalar& x : v) x = static_cast<Scalar>(std::ldexp(mantissa(random), exponent(random)));
  out[0] = {-Scalar{0}, std::numeric_limits<Scalar>::max(), std::numeric_limits<Scalar>::denorm_min()};
  return out;
}

template <class T>
class WriteVtu : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(WriteVtu, Scalars);

TYPED_TEST(WriteVtu, EveryEncodingGivesTheSameNumbersBack) {
  using Scalar = TypeParam;
  const std::string type = sizeof(Scalar) == 4 ? "Float32" : "Float64";
  for (const int order : {1, 2})
    for (const VtuEncoding encoding : {VtuEncoding::appended, VtuEncoding::base64, VtuEncoding::ascii})
      for (const std::endian byte_order : {std::endian::little, std::endian::big}) {
        BlockOptions options;
        options.cells = {2, 1, 1};
        options.order = order;
        const MeshData mesh = make_block(options).value();
        const auto points = field<Scalar>(mesh.vertex_count(), 1), velocity = field<Scalar>(mesh.vertex_count(), 2);
        const std::vector<Scalar> energy = [&] {
          std::vector<Scalar> out;
          for (const auto& v : velocity) out.push_back(v[0]);
          return out;
        }();
        std::vector<Index> region(at(mesh.element_count()));
        for (Index e = 0; e < mesh.element_count(); ++e) region[at(e)] = 7 - 3 * e;

        const VtuGrid grid{.points = points,
                           .cells = vtu_cells(mesh),
                           .point_data = {{"velocity", velocity}, {"energy", energy}},
                           .cell_data = {{"region", region}}};
        const auto text = format_vtu(grid, {.encoding = encoding, .byte_order = byte_order});
        ASSERT_TRUE(text.ok()) << text.error().message();
        const ParsedGrid back = parse_grid(*text);
        EXPECT_EQ(back.byte_order, byte_order == std::endian::big ? "BigEndian" : "LittleEndian");
        EXPECT_EQ(back.points, mesh.positions.size());
        EXPECT_EQ(back.cells, at(mesh.element_count()));
        ASSERT_EQ(back.arrays.size(), 7u);
        EXPECT_EQ(back.arrays.at("Points").values, numbers(points));
        EXPECT_EQ(back.arrays.at("velocity").values, numbers(velocity));
        EXPECT_EQ(back.arrays.at("energy").values, numbers(energy));
        EXPECT_EQ(back.arrays.at("region").values, numbers(region));
        EXPECT_EQ(back.arrays.at("connectivity").values, numbers(mesh.connectivity));
        EXPECT_EQ(back.arrays.at("Points").type, type);
        EXPECT_EQ(back.arrays.at("velocity").components, 3);
        EXPECT_EQ(back.arrays.at("energy").components, 1);
        EXPECT_EQ(back.arrays.at("region").type, "Int32");
        for (std::size_t c = 0; c < back.cells; ++c) {
          EXPECT_EQ(back.arrays.at("offsets").values[c], static_cast<double>((c + 1) * (order == 1 ? 4 : 10)));
          EXPECT_EQ(back.arrays.at("types").values[c], order == 1 ? 10 : 24);
        }
        EXPECT_TRUE(std::signbit(back.arrays.at("Points").values[0]));
      }
}

TEST(WriteVtuCells, MeshesAndSurfacesAsTheyAre) {
  const MeshData data = make_block({}).value();
  const auto mesh = TetMesh<float, Tet4>::create(data).value();
  const ParsedGrid tets = parse_grid(format_vtu({.points = mesh.positions(), .cells = vtu_cells(mesh)}).value());
  EXPECT_EQ(tets.arrays.at("connectivity").values, numbers(data.connectivity));

  SurfaceMesh surface;
  surface.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  surface.triangles = {{0, 1, 2}, {2, 1, 3}};
  const ParsedGrid triangles =
      parse_grid(format_vtu({.points = surface.positions, .cells = vtu_cells(surface)}).value());
  EXPECT_EQ(triangles.arrays.at("connectivity").values, (std::vector<double>{0, 1, 2, 2, 1, 3}));
  EXPECT_EQ(triangles.arrays.at("types").values, (std::vector<double>{5, 5}));
}

TEST(WriteVtuCells, NothingIsAGridToo) {
  const SurfaceMesh nothing;
  for (const VtuEncoding encoding : {VtuEncoding::appended, VtuEncoding::base64, VtuEncoding::ascii}) {
    const auto text = format_vtu({.points = nothing.positions, .cells = vtu_cells(nothing)}, {.encoding = encoding});
    ASSERT_TRUE(text.ok());
    EXPECT_EQ(parse_grid(*text).points, 0u);
    EXPECT_EQ(parse_grid(*text).cells, 0u);
  }
}

TEST(WriteVtuNames, AreEscaped) {
  const MeshData mesh = make_block({}).value();
  const std::string name = "<a & \"b\" 'c'>";
  const std::string text =
      format_vtu({.points = mesh.positions, .cells = vtu_cells(mesh), .point_data = {{name, mesh.positions}}},
                 {.encoding = VtuEncoding::ascii})
          .value();
  EXPECT_NE(text.find("Name=\"&lt;a &amp; &quot;b&quot; &apos;c&apos;&gt;\""), std::string::npos);
  EXPECT_EQ(text.find(name), std::string::npos);
}

class WriteVtuErrors : public ::testing::Test {
 protected:
  /// The error of writing `points_` and `mesh_` with the given arrays.
  Error error_of(std::vector<VtuArray> point_data, std::vector<VtuArray> cell_data = {}) {
    const auto result = format_vtu({points_, vtu_cells(mesh_), std::move(point_data), std::move(cell_data)});
    EXPECT_FALSE(result.ok());
    return result.ok() ? Error{} : result.error();
  }
  MeshData mesh_ = make_block({}).value();
  Field<double> points_ = mesh_.positions;
  std::vector<float> numbers_ = std::vector<float>(8, 1.0f);
};

TEST_F(WriteVtuErrors, BadArraysAreNamed) {
  numbers_.pop_back();
  Error error = error_of({{"short", numbers_}});
  EXPECT_EQ(error.code, ErrorCode::invalid_argument);
  EXPECT_EQ(error.where, "'short'");
  EXPECT_EQ(error_of({}, {{"cells", numbers_}}).code, ErrorCode::invalid_argument);

  numbers_ = std::vector<float>(8, 1.0f);
  EXPECT_EQ(error_of({{"a", numbers_}, {"b", numbers_}, {"a", numbers_}}).where, "'a'");
  EXPECT_EQ(error_of({{"", numbers_}}).code, ErrorCode::invalid_argument);
  EXPECT_EQ(error_of({{"a\tb", numbers_}}).code, ErrorCode::invalid_argument);

  numbers_[5] = std::numeric_limits<float>::quiet_NaN();
  error = error_of({{"heat", numbers_}});
  EXPECT_EQ(error.code, ErrorCode::non_finite_value);
  EXPECT_NE(error.reason.find("entry 5"), std::string::npos);
  points_[3][2] = -std::numeric_limits<double>::infinity();
  EXPECT_NE(error_of({}).reason.find("entry 3"), std::string::npos);
}

TEST_F(WriteVtuErrors, BadCellsAreNamed) {
  mesh_.connectivity[9] = 8;
  Error error = error_of({});
  EXPECT_EQ(error.code, ErrorCode::index_out_of_range);
  EXPECT_EQ(error.where, "cell 2");
  mesh_.connectivity[9] = -1;
  EXPECT_EQ(error_of({}).code, ErrorCode::index_out_of_range);
  mesh_.connectivity.pop_back();
  EXPECT_EQ(error_of({}).code, ErrorCode::invalid_argument);
  for (const int nodes : {0, -4, 5, 8}) {
    mesh_.nodes_per_element = nodes;
    EXPECT_EQ(error_of({}).code, ErrorCode::invalid_argument);
  }
  EXPECT_EQ(format_vtu({.points = numbers_, .cells = {}}).error().code, ErrorCode::invalid_argument);
}

TEST_F(WriteVtuErrors, FilesAreWrittenOrNotTouched) {
  const TemporaryFolder folder;
  const std::string path = (folder / "grid.vtu").string();
  const VtuGrid grid{.points = points_, .cells = vtu_cells(mesh_)};
  ASSERT_TRUE(write_vtu(path, grid).ok());
  EXPECT_EQ(read_file(path).value(), format_vtu(grid).value());
  EXPECT_EQ(write_vtu(folder / "no_such_folder/x.vtu", grid).error().code, ErrorCode::file_unreadable);
  const std::string before = read_file(path).value();
  mesh_.connectivity[0] = 99;
  EXPECT_EQ(write_vtu(path, grid).error().code, ErrorCode::index_out_of_range);
  EXPECT_EQ(read_file(path).value(), before);
}

}  // namespace
}  // namespace corotet
