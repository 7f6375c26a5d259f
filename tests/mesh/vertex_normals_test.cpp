#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/io/read_obj.hpp>
#include <corotet/detail/mesh/io/read_ply.hpp>
#include <corotet/detail/mesh/io/read_stl.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/vertex_normals.hpp>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace corotet {
namespace {

/// A sphere whose first meridian is there twice and each pole once for each side, as texture coordinates need it.
SurfaceMesh sphere_with_seam(Index rings, Index sides) {
  SurfaceMesh out;
  for (Index i = 0; i <= rings; ++i)
    for (Index j = 0; j <= sides; ++j) {
      const double polar = std::numbers::pi * i / rings, turn = 2 * std::numbers::pi * (j % sides) / sides;
      const double r = i % rings == 0 ? 0 : std::sin(polar);
      out.positions.push_back(Vec3<double>(r * std::cos(turn), r * std::sin(turn), std::cos(polar)));
    }
  for (Index i = 0; i < rings; ++i)
    for (Index j = 0; j < sides; ++j) {
      const Index a = i * (sides + 1) + j, c = a + sides + 1;
      if (i > 0) out.triangles.push_back({a, c, a + 1});
      if (i + 1 < rings) out.triangles.push_back({a + 1, c, c + 1});
    }
  return out;
}

SurfaceMesh box_surface() {
  const MeshData block = make_block({.corner = {-0.2, 0.3, 0}, .size = {1, 0.6, 0.4}, .cells = {3, 2, 2}}).value();
  return compact_surface(extract_boundary(block).value(), block.positions).surface;
}

/// The same triangles over copies of the vertices, in random numbers and order: each corner names any of them.
SurfaceMesh divided(const SurfaceMesh& surface, Index max_copies, unsigned seed, std::vector<Index>& source) {
  std::mt19937 random(seed);
  source.clear();
  for (Index v = 0; v < size_of(surface.positions); ++v) source.insert(source.end(), 1 + random() % at(max_copies), v);
  std::shuffle(source.begin(), source.end(), random);
  std::vector<std::vector<Index>> copies(surface.positions.size());
  SurfaceMesh out;
  for (Index c = 0; c < size_of(source); ++c) {
    copies[at(source[at(c)])].push_back(c);
    out.positions.push_back(surface.positions[at(source[at(c)])]);
  }
  for (std::array<Index, 3> t : surface.triangles) {
    for (Index& v : t) v = copies[at(v)][random() % copies[at(v)].size()];
    out.triangles.push_back(t);
  }
  std::shuffle(out.triangles.begin(), out.triangles.end(), random);
  return out;
}

void expect_one_normal_a_place(const SurfaceMesh& surface) {
  const auto normals = seamless_normals(surface);
  ASSERT_EQ(normals.size(), surface.positions.size());
  const auto first = detail::first_coinciding(surface.positions);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    EXPECT_EQ(normals[v], normals[at(first[v])]) << v;
    EXPECT_NEAR(normals[v].norm(), 1, 1e-14) << v;
  }
}

TEST(SeamlessNormals, AreThoseOfTheUndividedSurface) {
  std::vector<Index> source;
  for (unsigned seed = 0; seed < 20; ++seed)
    for (const SurfaceMesh& surface : {box_surface(), sphere_with_seam(5, 7), sphere_with_seam(12, 9)}) {
      // Undivided: each place once.
      std::vector<Index> once(surface.positions.size(), -1);
      SurfaceMesh whole;
      const auto first = detail::first_coinciding(surface.positions);
      for (std::size_t v = 0; v < first.size(); ++v)
        if (at(first[v]) == v) {
          once[v] = size_of(whole.positions);
          whole.positions.push_back(surface.positions[v]);
        }
      for (std::array<Index, 3> t : surface.triangles) {
        for (Index& v : t) v = once[at(first[at(v)])];
        whole.triangles.push_back(t);
      }
      const auto expected = vertex_normals(whole);
      const SurfaceMesh copies = divided(whole, 1 + static_cast<Index>(seed % 5), seed, source);
      expect_one_normal_a_place(copies);
      const auto normals = seamless_normals(copies);
      for (std::size_t c = 0; c < normals.size(); ++c) EXPECT_LE((normals[c] - expected[at(source[c])]).norm(), 1e-13);
    }
}

TEST(SeamlessNormals, ASphereShowsNoSeam) {
  const SurfaceMesh sphere = sphere_with_seam(24, 32);
  expect_one_normal_a_place(sphere);
  const auto normals = seamless_normals(sphere), divided_normals = vertex_normals(sphere);
  double seam = 0;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    EXPECT_GT(normals[v].dot(sphere.positions[v]), 0.9999);
    seam = std::max(seam, (divided_normals[v] - normals[v]).norm());
  }
  EXPECT_GT(seam, 0.05) << "the test would see no seam";
}

TEST(SeamlessNormals, ACubeOfSingleTrianglesHasTheNormalsOfItsCorners) {
  std::string text = "solid cube\n";
  SurfaceMesh soup;
  SurfaceMesh cube;
  for (int i = 0; i < 8; ++i) cube.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  constexpr std::array<std::array<Index, 4>, 6> quads{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& q : quads)
    for (const std::array<Index, 3>& t : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}}) {
      text += "facet normal 0 0 0 outer loop\n";
      for (const Index v : t) {
        const Vec3<double>& x = cube.positions[at(v)];
        // One -0 among the zeros is the same place.
        soup.positions.emplace_back(soup.positions.size() % 7 == 0 && x[0] == 0 ? -0.0 : x[0], x[1], x[2]);
        text += "vertex " + std::to_string(x[0]) + " " + std::to_string(x[1]) + " " + std::to_string(x[2]) + "\n";
      }
      const Index n = size_of(soup.positions);
      soup.triangles.push_back({n - 3, n - 2, n - 1});
      text += "endloop endfacet\n";
    }
  text += "endsolid\n";
  const SurfaceMesh read = read_stl(text, "input").value();
  EXPECT_EQ(read.positions.size(), 8u);
  expect_one_normal_a_place(soup);
  for (const SurfaceMesh* surface : {static_cast<const SurfaceMesh*>(&soup), &read}) {
    const auto normals = seamless_normals(*surface);
    for (std::size_t v = 0; v < normals.size(); ++v)
      EXPECT_LE((normals[v] - (surface->positions[v] - Vec3<double>::Constant(0.5)).normalized()).norm(), 1e-15);
  }
  // Where sharp edges are meant, divided vertices keep them.
  const auto sharp = vertex_normals(soup);
  for (std::size_t v = 0; v < sharp.size(); ++v) EXPECT_DOUBLE_EQ(sharp[v].cwiseAbs().maxCoeff(), 1);
}

// A roof of two slopes whose ridge is there twice.
TEST(SeamlessNormals, SeamsOfFilesAreClosed) {
  const std::string vertices = "0 0 0\n0 1 0\n1 0 0.5\n1 1 0.5\n1 0 0.5\n1 1 0.5\n2 0 0\n2 1 0\n";
  std::string obj = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  for (std::size_t begin = 0, end = 0; (end = vertices.find('\n', begin)) != std::string::npos; begin = end + 1)
    obj += "v " + vertices.substr(begin, end - begin) + "\n";
  obj += "f 1/1 3/2 4/3 2/4\nf 5/1 7/2 8/3 6/4\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n" +
      vertices + "4 0 2 3 1\n4 4 6 7 5\n";
  for (const Result<SurfaceMesh>& read : {read_obj(obj, "input"), read_ply(ply, "input")}) {
    ASSERT_TRUE(read.ok()) << read.error().message();
    ASSERT_EQ(read->positions.size(), 8u);
    expect_one_normal_a_place(*read);
    const auto normals = seamless_normals(*read);
    for (std::size_t v = 2; v < 6; ++v) EXPECT_LE((normals[v] - Vec3<double>(0, 0, 1)).norm(), 1e-15);
    for (std::size_t v : {0u, 1u, 6u, 7u}) EXPECT_LT(normals[v][2], 0.95);
  }
  // One vertex with several texture coordinates needs no copies.
  const std::string shared =
      "v 0 0 0\nv 0 1 0\nv 1 0 0.5\nv 1 1 0.5\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "vn 0 0 1\nf 1/1 3/2 4/3 2/4\nf 3/1 5/2 6/3 4/4\n";
  const auto normals = seamless_normals(read_obj(shared, "input").value());
  for (const std::size_t v : {2u, 3u}) EXPECT_LE((normals[v] - Vec3<double>(0, 0, 1)).norm(), 1e-15);
}

/// A bent sheet, with a copy of each column of vertices at a seam in its middle.
SurfaceMesh sheet_with_seam() {
  SurfaceMesh out;
  const auto add_half = [&](int begin) {
    const Index first = size_of(out.positions);
    for (int i = begin; i <= begin + 3; ++i)
      for (int j = 0; j < 4; ++j) out.positions.emplace_back(0.3 * i, 0.25 * j, 0.1 * std::sin(i + 0.5 * j));
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < 3; ++j) {
        const Index a = first + 4 * i + j;
        out.triangles.push_back({a, a + 4, a + 5});
        out.triangles.push_back({a, a + 5, a + 1});
      }
  };
  add_half(0);
  add_half(3);
  return out;
}

TEST(SeamlessNormals, EachSideOfASheetHasItsOwn) {
  const SurfaceMesh front = sheet_with_seam();
  const auto expected = seamless_normals(front);
  const Index n = size_of(front.positions);
  SurfaceMesh both = front;
  both.positions.insert(both.positions.end(), front.positions.begin(), front.positions.end());
  for (const auto& [a, b, c] : front.triangles) both.triangles.push_back({a + n, c + n, b + n});
  std::mt19937 random(4);
  for (int order = 0; order < 10; ++order) {
    const auto normals = seamless_normals(both);
    for (Index v = 0; v < n; ++v) {
      EXPECT_LE((normals[at(v)] - expected[at(v)]).norm(), 1e-12);
      EXPECT_LE((normals[at(v + n)] + expected[at(v)]).norm(), 1e-12);
    }
    std::shuffle(both.triangles.begin(), both.triangles.end(), random);
  }
  // Without copies there is no such direction: zero here, +z in a surface that is bound.
  SurfaceMesh shared = front;
  for (const auto& [a, b, c] : front.triangles) shared.triangles.push_back({a, c, b});
  for (const Vec3<double>& normal : seamless_normals(shared)) EXPECT_TRUE(normal.isZero());
  const auto mesh =
      TetMesh<double, Tet4>::create(make_block({.corner = {-1, -1, -1}, .size = {4, 4, 4}, .cells = {2, 2, 2}}).value())
          .value();
  EXPECT_EQ((EmbeddedSurface<double, Tet4>::bind(mesh, shared).value().replaced_normals()), n);
  EXPECT_EQ((EmbeddedSurface<double, Tet4>::bind(mesh, both).value().replaced_normals()), 0);
}

TEST(SeamlessNormals, TrianglesWithoutAreaChangeNothing) {
  SurfaceMesh sphere = sphere_with_seam(6, 8);
  const auto expected = seamless_normals(sphere);
  const Index n = size_of(sphere.positions);
  std::mt19937 random(8);
  for (int i = 0; i < 50; ++i) {
    const auto v = static_cast<Index>(random() % at(n)), w = static_cast<Index>(random() % at(n));
    sphere.triangles.insert(sphere.triangles.begin(), {v, w, w});
    sphere.triangles.push_back({v, v, v});
  }
  // And vertices that no triangle names: at a place of others, they have the normal of that.
  sphere.positions.push_back(sphere.positions[20]);
  sphere.positions.push_back({5, 5, 5});
  const auto normals = seamless_normals(sphere);
  for (Index v = 0; v < n; ++v) EXPECT_EQ(normals[at(v)], expected[at(v)]);
  EXPECT_EQ(normals[at(n)], expected[20]);
  EXPECT_TRUE(normals[at(n + 1)].isZero());
}

// Through the embedding, in motion too: the copies stay one.
TEST(SeamlessNormals, ABoundSurfaceShowsNoSeam) {
  const MeshData block =
      make_block({.corner = {-1.2, -1.2, -1.2}, .size = {2.4, 2.4, 2.4}, .cells = {3, 2, 2}, .order = 2}).value();
  const auto mesh = TetMesh<float, Tet10>::create(block).value();
  const SurfaceMesh sphere = sphere_with_seam(12, 16);
  auto surface = EmbeddedSurface<float, Tet10>::bind(mesh, sphere).value();
  EXPECT_EQ(surface.replaced_normals(), 0);
  Field<float> u, x(sphere.positions.size()), n(x);
  for (const Vec3<float>& p : mesh.positions()) u.push_back({0.2f * p[1] * p[1], 0.1f * p[0] * p[2], -0.1f * p[0]});
  surface.positions(u, x);
  surface.normals(u, n);
  const auto first = detail::first_coinciding(sphere.positions);
  for (std::size_t v = 0; v < x.size(); ++v) {
    EXPECT_EQ(x[v], x[at(first[v])]);
    EXPECT_EQ(n[v], n[at(first[v])]);
  }
}

}  // namespace
}  // namespace corotet
