#include <gtest/gtest.h>

#include <corotet/detail/mesh/io/write_obj.hpp>
#include <limits>
#include <sstream>

#include "mesh/mesh_files.hpp"

namespace corotet {
namespace {

SurfaceMesh two_triangles() {
  SurfaceMesh surface;
  surface.positions = {
      {0, 0, 0}, {1.0 / 3, 0.1, -0.0}, {1e-300, 5e-324, 1.7976931348623157e308}, {-123456789.123456, 2, 3}};
  surface.triangles = {{0, 1, 2}, {2, 1, 3}};
  return surface;
}

/// Takes the text apart with the standard library, not with the reader of this library.
SurfaceMesh parse(const std::string& text) {
  SurfaceMesh surface;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword, a, b, c;
    words >> keyword >> a >> b >> c;
    if (keyword == "v")
      surface.positions.emplace_back(std::strtod(a.c_str(), nullptr), std::strtod(b.c_str(), nullptr),
                                     std::strtod(c.c_str(), nullptr));
    if (keyword == "vn")
      surface.normals.emplace_back(std::strtod(a.c_str(), nullptr), std::strtod(b.c_str(), nullptr),
                                   std::strtod(c.c_str(), nullptr));
    if (keyword == "f")
      surface.triangles.push_back({std::atoi(a.c_str()) - 1, std::atoi(b.c_str()) - 1, std::atoi(c.c_str()) - 1});
  }
  return surface;
}

TEST(WriteObj, NumbersReadBackExactly) {
  SurfaceMesh surface = two_triangles();
  for (const bool with_normals : {false, true}) {
    if (with_normals) surface.normals.assign(4, Vec3<double>(1, 2, 3).normalized());
    const Result<std::string> text = format_obj(surface);
    ASSERT_TRUE(text.ok());
    const SurfaceMesh back = parse(*text);
    EXPECT_EQ(back.positions, surface.positions);
    EXPECT_EQ(back.triangles, surface.triangles);
    EXPECT_EQ(back.normals, surface.normals);
    EXPECT_EQ(text->find("f 1//1 2//2 3//3\n") != std::string::npos, with_normals);
  }
}

TEST(WriteObj, BadSurfacesAreRefused) {
  SurfaceMesh surface = two_triangles();
  surface.triangles[1][2] = 4;
  EXPECT_EQ(format_obj(surface).error().code, ErrorCode::index_out_of_range);
  EXPECT_EQ(format_obj(surface).error().where, "triangle 1");
  surface.triangles[1][2] = -1;
  EXPECT_EQ(format_obj(surface).error().code, ErrorCode::index_out_of_range);
  surface = two_triangles();
  surface.positions[2][1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(format_obj(surface).error().code, ErrorCode::non_finite_value);
  EXPECT_EQ(format_obj(surface).error().where, "vertex 2");
  surface = two_triangles();
  surface.normals.resize(3, Vec3<double>::UnitX());
  EXPECT_EQ(format_obj(surface).error().code, ErrorCode::invalid_argument);
}

TEST(WriteObj, WritesTheFileOrSaysWhyNot) {
  const TemporaryFolder folder;
  const std::string path = (folder / "surface.obj").string();
  ASSERT_TRUE(write_obj(path, two_triangles()).ok());
  EXPECT_EQ(read_file(path).value(), format_obj(two_triangles()).value());
  EXPECT_EQ(write_obj(folder / "no_such_folder/x.obj", two_triangles()).error().code, ErrorCode::file_unreadable);
  SurfaceMesh bad = two_triangles();
  bad.triangles[0][0] = 9;
  EXPECT_EQ(write_obj(path, bad).error().code, ErrorCode::index_out_of_range);
  EXPECT_EQ(read_file(path).value(), format_obj(two_triangles()).value());  // what was there stays
}

}  // namespace
}  // namespace corotet
