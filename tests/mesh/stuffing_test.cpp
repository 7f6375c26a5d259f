#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/quality.hpp>
#include <corotet/detail/mesh/stuffing/isosurface_stuffing.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <limits>
#include <numbers>
#include <random>

namespace corotet {
namespace {

Box cube(double half) {
  Box box;
  box.add(Vec3<double>::Constant(-half));
  box.add(Vec3<double>::Constant(half));
  return box;
}

double sphere(const Vec3<double>& p) { return (p - Vec3<double>(0.01, 0.02, -0.03)).norm() - 1; }
double torus(const Vec3<double>& p) { return std::hypot(std::hypot(p[0], p[1]) - 1, p[2]) - 0.4; }

/// Smooth lumps; some touch, some are thin.
struct Metaballs {
  std::vector<Vec3<double>> centres;
  explicit Metaballs(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> coordinate(-0.7, 0.7);
    for (int i = 0; i < 9; ++i) centres.push_back({coordinate(random), coordinate(random), coordinate(random)});
  }
  double operator()(const Vec3<double>& p) const {
    double sum = 0;
    for (const Vec3<double>& c : centres) sum += std::exp(-20 * (p - c).squaredNorm());
    return 0.5 - sum;
  }
};

/// A function without any smoothness within a sphere: every combination of signs and cut points turns up.
double noise(const Vec3<double>& p) {
  if (p.norm() > 0.9) return 1;
  double n = std::sin(p.dot(Vec3<double>(127.1, 311.7, 74.7))) * 43758.5453;
  n -= std::floor(n);
  return n - 0.45;
}

template <class Function>
MeshData stuff(const Function& f, double half, double size) {
  StuffingOptions options;
  options.size = size;
  auto mesh = stuff_isosurface(f, cube(half), options);
  EXPECT_TRUE(mesh.ok()) << mesh.error().message();
  return std::move(mesh).value();
}

detail::SurfaceTopology boundary_topology(const MeshData& mesh) {
  return detail::surface_topology(extract_boundary(mesh).value().triangles, mesh.positions.size());
}

/// The bounds that Labelle & Shewchuk 2007 give for the best warping limits.
void expect_good_angles(const MeshData& mesh) {
  const MeshQuality quality = measure_quality(mesh).value();
  EXPECT_GT(quality.volume.least, 0);
  EXPECT_GE(quality.min_dihedral.least, 10.7);
  EXPECT_LE(quality.max_dihedral.most, 164.8);
}

TEST(Stuffing, DihedralAnglesOfSmoothShapes) {
  Index elements = 0;
  const auto check = [&](const auto& f, double half, double size) {
    const MeshData mesh = stuff(f, half, size);
    expect_good_angles(mesh);
    EXPECT_TRUE((TetMesh<float, Tet4>::create(mesh).ok()));
    elements += mesh.element_count();
  };
  for (const double size : {0.31, 0.2, 0.13}) {
    check(sphere, 1.1, size);
    check(torus, 1.45, size);
  }
  for (unsigned seed = 1; seed <= 8; ++seed) check(Metaballs(seed), 1.2, 0.09);
  EXPECT_GT(elements, 50000);
}

TEST(Stuffing, AnyFunctionGivesPositiveElementsThatFitTogether) {
  const MeshData mesh = stuff(noise, 1, 0.05);
  ASSERT_GT(mesh.element_count(), 20000);
  expect_good_angles(mesh);
  const MeshQuality quality = measure_quality(mesh).value();
  // Neighbours agree on the diagonal of each shared quadrilateral, or there would be gaps: the boundary, then, would
  // have faces inside; its triangles would enclose another volume than the elements.
  const BoundarySurface boundary = extract_boundary(mesh).value();
  double enclosed = 0;
  std::vector<std::pair<Index, Index>> edges;
  for (const auto& t : boundary.triangles) {
    enclosed += mesh.positions[at(t[0])].cross(mesh.positions[at(t[1])]).dot(mesh.positions[at(t[2])]) / 6;
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(std::minmax(t[i], t[(i + 1) % 3]));
  }
  EXPECT_NEAR(enclosed, quality.total_volume, 1e-10);
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    ASSERT_EQ((j - i) % 2, 0u) << "a gap";
  }
}

TEST(Stuffing, VolumeAndSurfaceConvergeWithOrderTwo) {
  const double exact = 4 * std::numbers::pi / 3;
  std::vector<double> errors, distances;
  for (const double size : {0.2, 0.1, 0.05}) {
    const MeshData mesh = stuff(sphere, 1.1, size);
    errors.push_back(std::abs(measure_quality(mesh)->total_volume - exact) / exact);
    double farthest = 0;
    const BoundarySurface boundary = extract_boundary(mesh).value();
    for (const auto& t : boundary.triangles)
      farthest = std::max(
          farthest,
          std::abs(sphere((mesh.positions[at(t[0])] + mesh.positions[at(t[1])] + mesh.positions[at(t[2])]) / 3)));
    distances.push_back(farthest);
  }
  for (const std::vector<double>& e : {errors, distances})
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(std::log2(e[i] / e[i + 1]), 2, 0.3) << e[i];
  EXPECT_LT(errors.back(), 1e-3);
}

TEST(Stuffing, BoundaryIsClosedAndHasTheTopologyOfTheShape) {
  EXPECT_EQ(boundary_topology(stuff(sphere, 1.1, 0.15)), (detail::SurfaceTopology{1, 2}));
  EXPECT_EQ(boundary_topology(stuff(torus, 1.45, 0.12)), (detail::SurfaceTopology{1, 0}));
  const auto shell = [](const Vec3<double>& p) { return std::abs(p.norm() - 0.8) - 0.2; };
  EXPECT_EQ(boundary_topology(stuff(shell, 1.1, 0.1)), (detail::SurfaceTopology{2, 4}));
}

TEST(Stuffing, BoundaryVerticesLieOnTheSurface) {
  const MeshData mesh = stuff(torus, 1.45, 0.15);
  const BoundarySurface boundary = extract_boundary(mesh).value();
  for (const auto& t : boundary.triangles)
    for (const Index v : t) EXPECT_NEAR(torus(mesh.positions[at(v)]), 0, 1e-6);
}

TEST(Stuffing, DistancesSkipEvaluationsButChangeNothing) {
  StuffingOptions options;
  options.size = 0.06;
  long calls = 0;
  const auto counted = [&](const Vec3<double>& p) {
    ++calls;
    return torus(p - Vec3<double>(0.013, 0.007, 0.003));  // off the lattice's symmetries, which rounding would break
  };
  const MeshData all = stuff_isosurface(counted, cube(1.45), options).value();
  const long without = std::exchange(calls, 0);
  options.is_distance = true;
  const MeshData skipped = stuff_isosurface(counted, cube(1.45), options).value();
  EXPECT_LT(calls, without * 3 / 4);
  EXPECT_EQ(all.connectivity, skipped.connectivity);
  ASSERT_EQ(all.positions.size(), skipped.positions.size());
  for (std::size_t v = 0; v < all.positions.size(); ++v)
    EXPECT_LE((all.positions[v] - skipped.positions[v]).norm(), 1e-6);
}

TEST(Stuffing, IsDeterministic) {
  const MeshData a = stuff(Metaballs(3), 1.2, 0.1), b = stuff(Metaballs(3), 1.2, 0.1);
  EXPECT_EQ(a.connectivity, b.connectivity);
  EXPECT_EQ(a.positions, b.positions);
}

TEST(StuffingErrors, AreNamed) {
  StuffingOptions options;
  const auto code = [&](const auto& f, const Box& box) {
    const auto result = stuff_isosurface(f, box, options);
    EXPECT_FALSE(result.ok());
    return result.ok() ? std::string() : result.error().where;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double size : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    options.size = size;
    EXPECT_EQ(code(sphere, cube(1)), "size");
  }
  options.size = 1e-6;
  EXPECT_EQ(code(sphere, cube(1)), "size");
  options.size = 0.1;
  EXPECT_EQ(code(sphere, Box{}), "box");
  EXPECT_EQ(code(sphere, cube(0.3)), "box");
  EXPECT_EQ(code([&](const Vec3<double>&) { return nan; }, cube(1)), "function");
  EXPECT_EQ(stuff_isosurface([](const Vec3<double>&) { return 1.0; }, cube(1), options).error().code,
            ErrorCode::empty_mesh);
}

/// The boundary of a block as a closed triangle surface.
SurfaceMesh block_surface(const Vec3<double>& size) {
  BlockOptions options;
  options.size = size;
  options.corner = -size / 2;
  const MeshData block = make_block(options).value();
  return compact_surface(extract_boundary(block).value(), block.positions).surface;
}

TEST(StuffingSurface, SignedDistanceOfABlockIsExact) {
  const Vec3<double> half(0.5, 1, 0.25);
  SurfaceMesh surface = block_surface(2 * half);
  for (const bool turned : {false, true}) {
    if (turned)
      for (auto& t : surface.triangles) std::swap(t[0], t[1]);
    const auto distance = detail::SignedDistance::create(surface);
    ASSERT_TRUE(distance.ok()) << distance.error().message();
    EXPECT_EQ(distance->turned(), turned);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> coordinate(-2, 2);
    for (int i = 0; i < 3000; ++i) {
      Vec3<double> p(coordinate(random), coordinate(random), coordinate(random));
      if (i % 3 == 0) p *= 0.25;
      if (i % 5 == 0) p[0] = p[1] = p[2];  // nearest to a corner, where single face normals mislead
      const Vec3<double> q = p.cwiseAbs() - half;
      const double expected = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
      EXPECT_NEAR((*distance)(p), expected, 1e-12);
    }
  }
}

// At 1e100 m all is still computed; beyond, the squared distance would overflow and no triangle be nearest.
TEST(StuffingSurface, SurfacesOfAnySizeAreMeasuredOrRefused) {
  for (const double size : {1e-90, 1e90, 1e99}) {
    const auto distance = detail::SignedDistance::create(block_surface(Vec3<double>::Constant(size)));
    ASSERT_TRUE(distance.ok()) << distance.error().message();
    EXPECT_NEAR((*distance)(Vec3<double>::Zero()) / size, -0.5, 1e-12);
    EXPECT_NEAR((*distance)(Vec3<double>(2 * size, 0, 0)) / size, 1.5, 1e-12);
  }
  for (const double size : {1e101, 1e160, 1e300}) {
    SurfaceMesh surface = block_surface(Vec3<double>::Ones());
    for (Vec3<double>& x : surface.positions) x *= size;
    const auto mesh = stuff_surface(surface, {.size = size / 8});
    ASSERT_FALSE(mesh.ok()) << size;
    EXPECT_EQ(mesh.error().code, ErrorCode::non_finite_value);
    EXPECT_EQ(mesh.error().where, "surface vertex 0");
  }
}

TEST(StuffingSurface, FillsAClosedSurface) {
  // A torus made of triangles: the boundary of a stuffed torus.
  const MeshData source = stuff(torus, 1.45, 0.1);
  const SurfaceMesh surface = compact_surface(extract_boundary(source).value(), source.positions).surface;
  StuffingOptions options;
  options.size = 0.13;
  const auto mesh = stuff_surface(surface, options);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message();
  expect_good_angles(*mesh);
  EXPECT_EQ(boundary_topology(*mesh), (detail::SurfaceTopology{1, 0}));
  const double volume = measure_quality(source)->total_volume;
  EXPECT_NEAR(measure_quality(*mesh)->total_volume, volume, 0.02 * volume);
  EXPECT_EQ(mesh->notes.size(), 1u) << mesh->notes.back();
}

TEST(StuffingSurface, PerforationIsReported) {
  StuffingOptions options;
  options.size = 0.2;
  // Thinner than a cube and inclined: here and there no lattice vertex stays inside.
  SurfaceMesh plate = block_surface({2.03, 2.07, 0.15});
  for (Vec3<double>& x : plate.positions) x[2] += 0.21 * x[0] + 0.13 * x[1];
  const auto thin = stuff_surface(plate, options);
  ASSERT_TRUE(thin.ok()) << thin.error().message();
  ASSERT_GE(thin->notes.size(), 2u);
  EXPECT_NE(thin->notes[1].find("perforated"), std::string::npos) << thin->notes[1];
  EXPECT_NE(boundary_topology(*thin), (detail::SurfaceTopology{1, 2}));
  options.size = 0.04;
  const auto fine = stuff_surface(plate, options);
  ASSERT_TRUE(fine.ok()) << fine.error().message();
  EXPECT_EQ(fine->notes.size(), 1u) << fine->notes.back();
}

TEST(StuffingSurface, OpenAndBrokenSurfacesAreRefused) {
  StuffingOptions options;
  options.size = 0.1;
  const SurfaceMesh good = block_surface({1, 1, 1});
  const auto refused = [&](const SurfaceMesh& surface, ErrorCode code) {
    const auto result = stuff_surface(surface, options);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, code) << result.error().message();
  };
  SurfaceMesh bad = good;
  bad.triangles.pop_back();
  refused(bad, ErrorCode::invalid_argument);
  bad = good;
  std::swap(bad.triangles[3][0], bad.triangles[3][1]);
  refused(bad, ErrorCode::invalid_argument);
  bad = good;
  bad.triangles[2][1] = bad.triangles[2][0];
  refused(bad, ErrorCode::invalid_argument);
  bad = good;
  bad.triangles[2][1] = 99;
  refused(bad, ErrorCode::index_out_of_range);
  bad = good;
  bad.positions[0][2] = std::numeric_limits<double>::quiet_NaN();
  refused(bad, ErrorCode::non_finite_value);
  refused(SurfaceMesh{}, ErrorCode::empty_mesh);
  EXPECT_TRUE(stuff_surface(good, options).ok());
}

}  // namespace
}  // namespace corotet
