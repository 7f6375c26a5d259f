#include <gtest/gtest.h>

#include <algorithm>
#include <corotet/detail/mesh/io/read_surface.hpp>
#include <corotet/detail/mesh/io/write_obj.hpp>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "mesh/mesh_files.hpp"
#include "support/seeds.hpp"

namespace corotet {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code code;
  for (auto i = fs::recursive_directory_iterator(folder, code); !code && i != fs::recursive_directory_iterator();
       i.increment(code))
    if (i->is_regular_file(code) && i->path().extension() != ".py" && i->path().extension() != ".md")
      files.push_back(i->path());
  std::sort(files.begin(), files.end());
  return files;
}

Result<SurfaceMesh> read_as(SurfaceFormat format, std::string_view bytes) {
  switch (format) {
    case SurfaceFormat::obj:
      return read_obj(bytes, "input");
    case SurfaceFormat::stl:
      return read_stl(bytes, "input");
    case SurfaceFormat::ply:
      return read_ply(bytes, "input");
    case SurfaceFormat::off:
      return read_off(bytes, "input");
    case SurfaceFormat::unknown:
      break;
  }
  return Error{ErrorCode::unknown_format, "input", "unknown"};
}

SurfaceFormat format_of(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".obj"   ? SurfaceFormat::obj
         : extension == ".stl" ? SurfaceFormat::stl
         : extension == ".ply" ? SurfaceFormat::ply
         : extension == ".off" ? SurfaceFormat::off
                               : SurfaceFormat::unknown;
}

using Triangle = std::array<std::array<double, 3>, 3>;

/// Triangles by position, each from its least corner on, so that numbering does not matter but winding does.
std::multiset<Triangle> triangles_of(const SurfaceMesh& surface) {
  std::multiset<Triangle> out;
  for (const auto& t : surface.triangles) {
    Triangle triangle;
    for (std::size_t i = 0; i < 3; ++i)
      for (int a = 0; a < 3; ++a) triangle[i][static_cast<std::size_t>(a)] = surface.positions[at(t[i])][a];
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
    out.insert(triangle);
  }
  return out;
}

/// The box that all good files hold: 1 x 2 x 0.5, corner i at the bits of i, sides wound outwards.
SurfaceMesh box() {
  SurfaceMesh surface;
  for (int i = 0; i < 8; ++i) surface.positions.emplace_back(1.0 * (i & 1), 2.0 * (i >> 1 & 1), 0.5 * (i >> 2 & 1));
  constexpr std::array<std::array<Index, 4>, 6> quads{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& q : quads) {
    surface.triangles.push_back({q[0], q[1], q[2]});
    surface.triangles.push_back({q[0], q[2], q[3]});
  }
  return surface;
}

TEST(ReadSurface, EveryVariantGivesTheSameBox) {
  const auto files = files_below(data_dir() / "surfaces");
  ASSERT_GE(files.size(), 25u);
  std::map<std::string, int> variants;
  for (const fs::path& path : files) {
    SCOPED_TRACE(path.filename().string());
    const auto surface = read_surface(path);
    ASSERT_TRUE(surface.ok()) << surface.error().message();
    EXPECT_EQ(surface->positions.size(), 8u);
    EXPECT_EQ(triangles_of(*surface), triangles_of(box()));
    const bool expect_normals = path.filename().string().find("normals") != std::string::npos;
    ASSERT_EQ(surface->normals.size(), expect_normals ? 8u : 0u);
    for (std::size_t v = 0; v < surface->normals.size(); ++v)
      EXPECT_LT((surface->normals[v] - (surface->positions[v] - Vec3<double>(0.5, 1, 0.25)).normalized()).norm(),
                1e-15);
    ++variants[path.extension().string()];
  }
  for (const char* extension : {".obj", ".stl", ".ply", ".off"}) EXPECT_GE(variants[extension], 5) << extension;
}

TEST(ReadSurface, FormatIsToldByTheContentNotTheName) {
  const TemporaryFolder folder;
  for (const fs::path& path : files_below(data_dir() / "surfaces")) {
    SCOPED_TRACE(path.filename().string());
    const std::string bytes = read_file(path).value();
    if (path.filename() == "binary_with_trailer.stl") continue;  // its length proves nothing, its name must
    EXPECT_EQ(detect_surface_format(bytes), format_of(path));
    ASSERT_TRUE(write_file(folder / "surface.dat", bytes).ok());
    EXPECT_TRUE(read_surface(folder / "surface.dat").ok());
  }
  EXPECT_EQ(detect_surface_format("f 1 2 3\n"), SurfaceFormat::obj);
  EXPECT_EQ(detect_surface_format("# made by hand\n\nv \\\n 1 2 3\n"), SurfaceFormat::obj);
  EXPECT_EQ(detect_surface_format(""), SurfaceFormat::unknown);
}

TEST(ReadSurface, WhatWasLeftOutIsNoted) {
  const auto notes = [](const std::string& file) {
    std::string all;
    const SurfaceMesh surface = read_surface(data_dir() / "surfaces" / file).value();
    for (const std::string& note : surface.notes) all += note + "; ";
    return all;
  };
  EXPECT_EQ(notes("obj/plain.obj"), "split 6 polygons into triangles, as fans from their first corners; ");
  const std::string rich = notes("obj/rich.obj");
  for (const char* part : {"texture", "groups", "points, lines", "weights", "normals"})
    EXPECT_NE(rich.find(part), std::string::npos) << part;
  EXPECT_EQ(notes("stl/text.stl"), "merged 36 vertices into 8; ");
  EXPECT_NE(notes("stl/text_two_solids.stl").find("joined 2 solids"), std::string::npos);
  EXPECT_NE(notes("stl/binary_called_solid.stl").find("attributes"), std::string::npos);
  EXPECT_NE(notes("stl/binary_with_trailer.stl").find("7 bytes after"), std::string::npos);
  EXPECT_NE(notes("ply/rich_binary_big.ply").find("'material'"), std::string::npos);
  EXPECT_NE(notes("off/colours.off").find("colours"), std::string::npos);
  EXPECT_EQ(notes("off/plain.off").find("colours"), std::string::npos);
}

SurfaceMesh random_surface(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-10, 10);
  std::uniform_int_distribution<Index> vertex(0, 49);
  SurfaceMesh surface;
  for (int v = 0; v < 50; ++v)
    surface.positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  while (surface.triangles.size() < 120) {
    const std::array<Index, 3> t{vertex(random), vertex(random), vertex(random)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) surface.triangles.push_back(t);
  }
  return surface;
}

TEST(ReadSurface, RoundTripThroughObjIsExact) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SurfaceMesh surface = random_surface(seed);
    const SurfaceMesh bare = read_obj(format_obj(surface).value(), "input").value();
    EXPECT_EQ(bare.positions, surface.positions);
    EXPECT_EQ(bare.triangles, surface.triangles);
    EXPECT_TRUE(bare.normals.empty());
    EXPECT_TRUE(bare.notes.empty());

    for (const auto& x : surface.positions) surface.normals.push_back(x.normalized());
    const SurfaceMesh back = read_obj(format_obj(surface).value(), "input").value();
    EXPECT_EQ(back.triangles, surface.triangles);
    std::set<Index> used;
    for (const auto& t : surface.triangles) used.insert(t.begin(), t.end());
    if (used.size() < 50) continue;  // the file gives normals to the corners of faces only
    ASSERT_EQ(back.normals.size(), 50u);
    for (std::size_t v = 0; v < 50; ++v) EXPECT_LT((back.normals[v] - surface.normals[v]).norm(), 1e-15);
  }
}

TEST(ReadStl, MergesExactlyEqualVerticesOnly) {
  // Triangles in random order whose corners repeat; one vertex differs from another in the last bit, one is -0.
  SurfaceMesh surface = random_surface(3);
  surface.positions[1] = surface.positions[0];
  surface.positions[1][2] = std::nextafter(surface.positions[1][2], 100);
  surface.positions[2] = {-0.0, 1, 1};
  std::string text = "solid\n";
  for (const auto& t : surface.triangles) {
    text += "facet normal 0 0 1 outer loop\n";
    for (const Index v : t) {
      detail::TextWriter out;
      out << "vertex " << surface.positions[at(v)] << '\n';
      text += out.take();
    }
    text += "endloop endfacet\n";
  }
  text += "endsolid\n";
  const SurfaceMesh back = read_stl(text, "input").value();
  std::set<Index> used;
  for (const auto& t : surface.triangles) used.insert(t.begin(), t.end());
  EXPECT_EQ(back.positions.size(), used.size());
  EXPECT_EQ(triangles_of(back), triangles_of(surface));
  // Vertices are numbered as they first appear.
  Index next = 0;
  for (const auto& t : back.triangles)
    for (const Index v : t) {
      EXPECT_LE(v, next);
      next = std::max(next, v + 1);
    }
}

TEST(ReadStl, DropsTrianglesThatCollapse) {
  const std::string text =
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex -0 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
  const SurfaceMesh surface = read_stl(text, "input").value();
  EXPECT_EQ(surface.triangles.size(), 1u);
  EXPECT_NE(surface.notes.back().find("dropped 1 triangles"), std::string::npos);
}

TEST(ReadObj, NormalsAreUsedOnlyWhereFacesAgree) {
  const std::string start = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 2\nvn 1 0 0\nvn 0 0 2\nvn 0 0 0\n";
  EXPECT_EQ(read_obj(start + "f 1//1 2//1 3//1\nf 1//3 2//3 4//2\n", "input").value().normals.size(), 4u);
  for (const char* faces : {"f 1//1 2//1 3//1\nf 1//2 2//1 4//1\n",     // they differ at vertex 1
                            "f 1//1 2//1 3//1\nf 1 2 4\n",              // vertex 4 has none
                            "f 1//1 2//1 3//1\nf 1//1 2//1 4//4\n"}) {  // that of vertex 4 has no direction
    const SurfaceMesh surface = read_obj(start + faces, "input").value();
    EXPECT_TRUE(surface.normals.empty());
    EXPECT_NE(surface.notes.front().find("ignored normals"), std::string::npos);
  }
}

struct Malformed {
  const char* file;
  ErrorCode code;
  const char* where;   // a part of it, behind the file's name
  const char* reason;  // a part of it
};

constexpr Malformed malformed[] = {
    {"index_zero.obj", ErrorCode::index_out_of_range, ":9", "'0'"},
    {"index_beyond.obj", ErrorCode::index_out_of_range, ":10", "vertex 9, but there are 8"},
    {"index_negative_beyond.obj", ErrorCode::index_out_of_range, ":9", "'-9'"},
    {"index_overflow.obj", ErrorCode::malformed_file, ":9", "out of range"},
    {"index_not_an_integer.obj", ErrorCode::malformed_file, ":9", "'3.5'"},
    {"corner_with_three_slashes.obj", ErrorCode::malformed_file, ":9", "normal number"},
    {"normal_beyond.obj", ErrorCode::index_out_of_range, ":10", "normal 2, but there are 1"},
    {"two_corners.obj", ErrorCode::malformed_file, ":9", "2 corners"},
    {"not_a_number.obj", ErrorCode::malformed_file, ":1", "'zero'"},
    {"nan.obj", ErrorCode::non_finite_value, ":1", "'nan'"},
    {"infinite.obj", ErrorCode::non_finite_value, ":1", "'1e999'"},
    {"missing_coordinate.obj", ErrorCode::malformed_file, ":1", "missing"},
    {"unknown_keyword.obj", ErrorCode::malformed_file, ":9", "'face'"},
    {"no_faces.obj", ErrorCode::empty_mesh, "", "no triangles"},
    {"only_degenerate_faces.obj", ErrorCode::empty_mesh, "", "no triangles"},

    {"binary_truncated.stl", ErrorCode::malformed_file, "@byte 80", "12 triangles"},
    {"binary_called_solid_truncated.stl", ErrorCode::malformed_file, "@byte 80", "12 triangles"},
    {"binary_announces_too_many.stl", ErrorCode::malformed_file, "@byte 80", "4294967295 triangles"},
    {"binary_header_only.stl", ErrorCode::malformed_file, "@byte 0", "header"},
    {"binary_nan.stl", ErrorCode::non_finite_value, "@byte 96", "not a finite"},
    {"binary_no_triangles.stl", ErrorCode::empty_mesh, "", "no vertices"},
    {"text_truncated.stl", ErrorCode::malformed_file, ":24", "'loop', found 'loo'"},
    {"text_four_vertices.stl", ErrorCode::malformed_file, ":7", "'endloop', found 'vertex'"},
    {"text_two_coordinates.stl", ErrorCode::malformed_file, ":5", "'vertex', not a number"},
    {"text_infinite.stl", ErrorCode::non_finite_value, ":", "'inf'"},
    {"text_no_triangles.stl", ErrorCode::empty_mesh, "", "no vertices"},
    {"text_two_solids_garbage_between.stl", ErrorCode::malformed_file, ":", "'liquid'"},

    {"no_end_header.ply", ErrorCode::malformed_file, ":", "end_header"},
    {"no_format.ply", ErrorCode::malformed_file, ":", "'format'"},
    {"unknown_format.ply", ErrorCode::malformed_file, ":2", "'utf8'"},
    {"future_version.ply", ErrorCode::unsupported, ":2", "'2.0'"},
    {"unknown_type.ply", ErrorCode::malformed_file, ":6", "'quad'"},
    {"unknown_header_keyword.ply", ErrorCode::malformed_file, ":10", "'colour'"},
    {"real_list_length.ply", ErrorCode::malformed_file, ":9", "not an integer"},
    {"real_indices.ply", ErrorCode::malformed_file, ":", "list of integers"},
    {"property_before_element.ply", ErrorCode::malformed_file, ":4", "before the first element"},
    {"second_vertex_element.ply", ErrorCode::malformed_file, ":8", "second element 'vertex'"},
    {"announces_too_many.ply", ErrorCode::malformed_file, ":", "2000000000 vertex"},
    {"announces_more_than_64_bits.ply", ErrorCode::malformed_file, ":4", "out of range"},
    {"announces_minus_one.ply", ErrorCode::malformed_file, ":4", "out of range"},
    {"binary_announces_too_many.ply", ErrorCode::malformed_file, "@byte", "9000000000000000000 vertex"},
    {"element_without_properties.ply", ErrorCode::malformed_file, ":", "no properties"},
    {"no_vertex_element.ply", ErrorCode::malformed_file, ":", "no element 'vertex'"},
    {"vertices_without_z.ply", ErrorCode::malformed_file, ":", "'z'"},
    {"z_is_a_list.ply", ErrorCode::malformed_file, ":", "'z' is a list"},
    {"faces_without_indices.ply", ErrorCode::malformed_file, ":", "vertex_indices"},
    {"index_beyond.ply", ErrorCode::index_out_of_range, ":20", "vertex 8, but there are 8"},
    {"index_negative.ply", ErrorCode::index_out_of_range, ":20", "vertex -1"},
    {"list_length_negative.ply", ErrorCode::malformed_file, ":19", "-4 entries"},
    {"list_longer_than_file.ply", ErrorCode::malformed_file, "@byte", "4294967295 entries"},
    {"two_corners.ply", ErrorCode::malformed_file, ":19", "2 corners"},
    {"nan.ply", ErrorCode::non_finite_value, "@byte", "not a finite"},
    {"truncated.ply", ErrorCode::malformed_file, ":24", ""},
    {"binary_truncated.ply", ErrorCode::malformed_file, "@byte", "only 15 bytes follow"},
    {"triangle_strips.ply", ErrorCode::unsupported, ":", "strips"},
    {"point_cloud.ply", ErrorCode::empty_mesh, "", "no triangles"},

    {"counts_missing.off", ErrorCode::malformed_file, ":", "missing"},
    {"announces_too_many_vertices.off", ErrorCode::malformed_file, ":2", "2000000000 vertices"},
    {"announces_too_many_faces.off", ErrorCode::malformed_file, ":2", "2000000000 faces"},
    {"announces_minus_one.off", ErrorCode::malformed_file, ":2", "out of range"},
    {"index_beyond.off", ErrorCode::index_out_of_range, ":12", "vertex 8, but there are 8"},
    {"face_longer_than_file.off", ErrorCode::malformed_file, ":11", "1000000000 corners"},
    {"one_corner.off", ErrorCode::malformed_file, ":11", "1 corners"},
    {"truncated.off", ErrorCode::malformed_file, ":16", ""},
    {"infinite.off", ErrorCode::non_finite_value, ":7", "'inf'"},
    {"four_dimensions.off", ErrorCode::unsupported, ":1", "three dimensions"},
    {"binary.off", ErrorCode::unsupported, ":", "binary"},
    {"no_vertices.off", ErrorCode::empty_mesh, "", "no vertices"},

    {"empty.txt", ErrorCode::unknown_format, "", "empty"},
    {"prose.txt", ErrorCode::unknown_format, "", "none of"},
    {"zeros.txt", ErrorCode::unknown_format, "", "none of"},
    {"tetrahedra.txt", ErrorCode::unknown_format, "", "none of"},
};

TEST(ReadMalformedSurface, IsAnErrorThatSaysWhereAndWhy) {
  const fs::path folder = data_dir() / "malformed" / "surfaces";
  for (const Malformed& expected : malformed) {
    SCOPED_TRACE(expected.file);
    const fs::path path = folder / fs::path(expected.file).extension().string().substr(1) / expected.file;
    const auto result = read_surface(path);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, expected.code) << result.error().message();
    const std::string& where = result.error().where;
    EXPECT_EQ(where.substr(0, path.string().size()), path.string());
    EXPECT_EQ(where.substr(path.string().size()).substr(0, std::string(expected.where).size()), expected.where);
    EXPECT_FALSE(result.error().reason.empty());
    EXPECT_NE(result.error().reason.find(expected.reason), std::string::npos) << result.error().message();
  }
  EXPECT_EQ(files_below(folder).size(), std::size(malformed));  // each file is in the table
}

TEST(ReadMalformedSurface, MissingFilesAreNamed) {
  const TemporaryFolder folder;
  const auto result = read_surface(folder / "none.obj");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::file_not_found);
  EXPECT_NE(result.error().where.find("none.obj"), std::string::npos);
}

/// Whatever the bytes: an error with a place and a reason, or a surface whose indices are in range.
void expect_sound(const Result<SurfaceMesh>& result) {
  if (!result) {
    EXPECT_FALSE(result.error().where.empty());
    EXPECT_FALSE(result.error().reason.empty());
    return;
  }
  EXPECT_TRUE(format_obj(*result).ok());
  EXPECT_FALSE(result->triangles.empty());
}

TEST(ReadMalformedSurface, EveryTruncationIsSurvived) {
  for (const fs::path& path : files_below(data_dir() / "surfaces")) {
    SCOPED_TRACE(path.filename().string());
    const std::string bytes = read_file(path).value();
    for (std::size_t size = 0; size < bytes.size(); ++size)
      expect_sound(read_as(format_of(path), std::string_view(bytes).substr(0, size)));
  }
}

TEST(ReadMalformedSurface, ChangedBytesAreSurvived) {
  for (const fs::path& path : files_below(data_dir() / "surfaces")) {
    SCOPED_TRACE(path.filename().string());
    const std::string good = read_file(path).value();
    testing::for_seeds(10, [&](unsigned seed) {
      std::mt19937 random(seed);
      for (int trial = 0; trial < 30; ++trial) {
        std::string bytes = good;
        for (int changes = 0; changes < 3; ++changes)
          bytes[random() % bytes.size()] = static_cast<char>(random() % 2 == 0 ? random() % 256 : '0' + random() % 10);
        expect_sound(read_as(format_of(path), bytes));
      }
    });
  }
}

}  // namespace
}  // namespace corotet
