#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/quality.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>

namespace corotet {
namespace {

using Corners = std::array<Vec3<double>, 4>;

constexpr double degrees = 180 / std::numbers::pi;

ElementQuality measure(const Corners& x) { return measure_element<Tet4>(x); }

const Corners regular{Vec3<double>(1, 1, 1), {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}};
const Corners bcc{Vec3<double>(0, 0, 0), {2, 0, 0}, {1, 1, 1}, {1, -1, 1}};
const Corners kuhn{Vec3<double>(0, 0, 0), {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
const Corners right_angled{Vec3<double>(0, 0, 0), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Equilateral triangle of edge 1 with a corner at `height` over its centre.
Corners spire(double height) {
  const double r = std::sqrt(1.0 / 3);
  return {Vec3<double>(r, 0, 0), {-r / 2, 0.5, 0}, {-r / 2, -0.5, 0}, {0, 0, height}};
}

/// Two perpendicular edges of length 2, centre over centre, 2h apart.
Corners crossed(double h) { return {Vec3<double>(1, 0, h), {-1, 0, h}, {0, 1, -h}, {0, -1, -h}}; }

void expect_angles(const ElementQuality& quality, std::vector<double> expected) {
  std::vector<double> angles(quality.dihedrals.begin(), quality.dihedrals.end());
  std::sort(angles.begin(), angles.end());
  std::sort(expected.begin(), expected.end());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(angles[i], expected[i], 1e-10);
  EXPECT_EQ(quality.min_dihedral, angles.front());
  EXPECT_EQ(quality.max_dihedral, angles.back());
}

/// V/(sum of A^2)^(3/4) against that of a regular tetrahedron of edge 1, written out independently.
double shape_of(double volume, double squared_areas) {
  return volume / std::pow(squared_areas, 0.75) / ((std::sqrt(2) / 12) / std::pow(4 * 3.0 / 16, 0.75));
}

TEST(ElementQualityTest, RegularTetrahedronIsOne) {
  const ElementQuality q = measure(regular);
  EXPECT_NEAR(q.volume, 8.0 / 3, 1e-14);
  EXPECT_NEAR(q.shape, 1, 1e-14);
  EXPECT_NEAR(q.radius_ratio, 1, 1e-14);
  EXPECT_NEAR(q.edge_ratio, 1, 1e-14);
  EXPECT_EQ(q.jacobian_ratio, 1);
  expect_angles(q, std::vector<double>(6, std::acos(1.0 / 3) * degrees));
}

TEST(ElementQualityTest, LatticeTetrahedra) {
  const ElementQuality b = measure(bcc);
  EXPECT_NEAR(b.volume, 2.0 / 3, 1e-14);
  EXPECT_NEAR(b.shape, shape_of(2.0 / 3, 8), 1e-14);
  EXPECT_NEAR(b.radius_ratio, 3 / std::sqrt(10), 1e-14);
  EXPECT_NEAR(b.edge_ratio, 2 / std::sqrt(3), 1e-14);
  expect_angles(b, {60, 60, 60, 60, 90, 90});

  const ElementQuality k = measure(kuhn);
  EXPECT_NEAR(k.volume, 1.0 / 6, 1e-15);
  EXPECT_NEAR(k.shape, shape_of(1.0 / 6, 1.5), 1e-14);
  EXPECT_NEAR(k.radius_ratio, 3 * (0.5 / (1 + std::sqrt(2))) / (std::sqrt(3) / 2), 1e-14);
  EXPECT_NEAR(k.edge_ratio, std::sqrt(3), 1e-14);
  expect_angles(k, {45, 45, 60, 90, 90, 90});

  const ElementQuality c = measure(right_angled);
  EXPECT_NEAR(c.volume, 1.0 / 6, 1e-15);
  EXPECT_NEAR(c.shape, shape_of(1.0 / 6, 1.5), 1e-14);
  EXPECT_NEAR(c.radius_ratio, 3 * (0.5 / (1.5 + std::sqrt(3) / 2)) / (std::sqrt(3) / 2), 1e-14);
  const double slant = std::acos(1 / std::sqrt(3)) * degrees;
  expect_angles(c, {90, 90, 90, slant, slant, slant});

  for (const ElementQuality& q : {b, k, c}) EXPECT_EQ(classify(q), ElementDefect::none);
}

TEST(ElementQualityTest, NeedleHasGoodAnglesAndBadShape) {
  const double h = 10, r = std::sqrt(3) / 6;
  const ElementQuality q = measure(spire(h));
  const double base = std::atan2(h, r) * degrees;
  const double side = 180 - std::acos((r * r - h * h / 2) / (h * h + r * r)) * degrees;
  expect_angles(q, {base, base, base, side, side, side});
  EXPECT_GT(q.min_dihedral, 60);
  EXPECT_NEAR(q.edge_ratio, std::sqrt(h * h + 1.0 / 3), 1e-12);
  EXPECT_NEAR(q.volume, std::sqrt(3) / 4 * h / 3, 1e-13);
  EXPECT_NEAR(q.shape, shape_of(std::sqrt(3) / 4 * h / 3, 3.0 / 16 + 3 * (h * h + r * r) / 4), 1e-14);
  EXPECT_LT(q.shape, 0.5);
  EXPECT_EQ(classify(q), ElementDefect::needle);
}

TEST(ElementQualityTest, SliverByItsClosedForm) {
  for (const double h : {0.1, 1e-3, 1e-6}) {
    const ElementQuality q = measure(crossed(h));
    const double beta = 2 * std::atan(1 / (2 * h));
    // (1 - cos beta)/2 = cos alpha, written with tangents to keep its digits.
    const double alpha = 2 * std::atan(std::sqrt(4 * h * h / (2 + 4 * h * h)));
    expect_angles(q,
                  {alpha * degrees, alpha * degrees, alpha * degrees, alpha * degrees, beta * degrees, beta * degrees});
    EXPECT_NEAR(q.volume, 4 * h / 3, 1e-14);
    EXPECT_NEAR(q.shape, shape_of(4 * h / 3, 4 * (1 + 4 * h * h)), 1e-14);
    EXPECT_NEAR(q.radius_ratio, 3 * h / std::sqrt(1 + 4 * h * h) / std::sqrt(1 + h * h), 1e-14);
    EXPECT_EQ(classify(q), ElementDefect::sliver);
  }
}

TEST(ElementQualityTest, DefectsByName) {
  EXPECT_EQ(classify(measure(spire(0.02))), ElementDefect::cap);
  EXPECT_EQ(classify(measure({Vec3<double>(0, 0, 0), {0, 0, 0.02}, {1, -0.5, 0}, {1, 0.5, 0}})), ElementDefect::wedge);
  EXPECT_EQ(classify(measure({Vec3<double>(0, 0, 0), {1, 0, 0}, {0, 1, 0}, {2, 3, 0}})), ElementDefect::flat);
  EXPECT_EQ(classify(measure({Vec3<double>(0, 0, 0), {0, 1, 0}, {1, 0, 0}, {0, 0, 1}})), ElementDefect::inverted);
  // A corner close to the middle of an edge: on the opposite face, or beside it.
  EXPECT_EQ(classify(measure({Vec3<double>(0, 0, 0), {2, 0, 0}, {1, 1, 0}, {1, 0.02, 0.02}})), ElementDefect::cap);
  EXPECT_EQ(classify(measure({Vec3<double>(0, 0, 0), {2, 0, 0}, {1, 1, 0}, {1, 0, 0.02}})), ElementDefect::flat);
  for (const ElementDefect defect :
       {ElementDefect::none, ElementDefect::inverted, ElementDefect::flat, ElementDefect::curved, ElementDefect::sliver,
        ElementDefect::cap, ElementDefect::wedge, ElementDefect::needle}) {
    EXPECT_STRNE(name_of(defect), "unknown");
    const std::string name = defect == ElementDefect::none ? "no defect" : name_of(defect);
    EXPECT_EQ(std::string(describe(defect)).substr(0, name.size()), name);
  }
}

TEST(ElementQualityTest, DegenerateElementsGiveFiniteMeasures) {
  const Vec3<double> o(0, 0, 0), x(1, 0, 0), y(0, 1, 0);
  for (const Corners& corners : {Corners{o, o, o, o}, Corners{o, x, x, x}, Corners{o, x, 2 * x, 3 * x},
                                 Corners{o, o, x, y}, Corners{o, x, y, x + y}, Corners{o, x, y, (x + y) / 2}}) {
    const ElementQuality q = measure(corners);
    EXPECT_EQ(q.volume, 0);
    EXPECT_EQ(q.shape, 0);
    EXPECT_EQ(q.radius_ratio, 0);
    EXPECT_GE(q.min_dihedral, 0);
    EXPECT_LE(q.max_dihedral, 180);
    EXPECT_GE(q.edge_ratio, 1);  // may be infinite, not NaN
    EXPECT_EQ(classify(q), ElementDefect::flat);
  }
}

Corners random_tetrahedron(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  Corners x;
  for (Vec3<double>& p : x) p = Vec3<double>(coordinate(random), coordinate(random), coordinate(random));
  return x;
}

void expect_same_measures(const ElementQuality& a, const ElementQuality& b, double tolerance) {
  EXPECT_NEAR(a.shape, b.shape, tolerance);
  EXPECT_NEAR(a.min_dihedral, b.min_dihedral, 180 * tolerance);
  EXPECT_NEAR(a.max_dihedral, b.max_dihedral, 180 * tolerance);
  EXPECT_NEAR(a.radius_ratio, b.radius_ratio, tolerance);
  EXPECT_NEAR(a.edge_ratio / b.edge_ratio, 1, tolerance);
  EXPECT_NEAR(a.jacobian_ratio, b.jacobian_ratio, tolerance);
}

TEST(ElementQualityTest, UnchangedByRotationScalingAndNumbering) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 500; ++trial) {
    const Corners x = random_tetrahedron(random);
    const ElementQuality q = measure(x);
    EXPECT_LE(std::abs(q.shape), 1 + 1e-14);
    EXPECT_LE(q.radius_ratio, 1 + 1e-14);

    const Corners axes = random_tetrahedron(random);
    const Mat3<double> rotation = rotation_by(3 * axes[0].norm() * axes[1].normalized());
    for (const double scale : {1.0, 1e-90, 1e90, 1e-3}) {
      Corners moved;
      for (std::size_t i = 0; i < 4; ++i) moved[i] = scale * (rotation * x[i] + axes[2]);
      const ElementQuality m = measure(moved);
      expect_same_measures(q, m, 1e-11);
      EXPECT_NEAR(m.volume / scale / scale / scale, q.volume, 1e-13);
    }

    std::array<std::size_t, 4> order{0, 1, 2, 3};
    do {
      const int swaps = (order[0] > order[1]) + (order[0] > order[2]) + (order[0] > order[3]) + (order[1] > order[2]) +
                        (order[1] > order[3]) + (order[2] > order[3]);
      const double sign = swaps % 2 == 0 ? 1 : -1;
      ElementQuality p = measure({x[order[0]], x[order[1]], x[order[2]], x[order[3]]});
      p.shape *= sign;
      expect_same_measures(q, p, 1e-11);
      EXPECT_NEAR(p.volume * sign, q.volume, 1e-14);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

std::array<Vec3<double>, 10> straight_tet10(const Corners& c) {
  std::array<Vec3<double>, 10> x;
  std::copy(c.begin(), c.end(), x.begin());
  for (std::size_t e = 0; e < 6; ++e) x[4 + e] = (c[tet_edges[e].a] + c[tet_edges[e].b]) / 2;
  return x;
}

TEST(ElementQualityTest, StraightTet10MeasuresAsItsCorners) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const Corners c = random_tetrahedron(random);
    const ElementQuality q4 = measure(c), q10 = measure_element<Tet10>(straight_tet10(c));
    expect_same_measures(q4, q10, 1e-10);
    EXPECT_NEAR(q4.volume, q10.volume, 1e-13);
  }
}

TEST(ElementQualityTest, CurvatureByItsClosedForm) {
  // Node 4 of the reference tetrahedron moved by d along y: y = xi2 + 4 d xi1 (1 - xi1 - xi2 - xi3), so that
  // det J = 1 - 4 d xi1 and the volume is (1 - d)/6.
  for (const double d : {0.1, 0.2, -0.15, 0.5}) {
    std::array<Vec3<double>, 10> x = straight_tet10(right_angled);
    x[4][1] += d;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& point : Tet10::mass_points) least = std::min(least, 1 - 4 * d * point.xi[0]);
    for (const auto& point : Tet10::stiffness_points) least = std::min(least, 1 - 4 * d * point.xi[0]);
    const ElementQuality q = measure_element<Tet10>(x);
    EXPECT_NEAR(q.volume, (1 - d) / 6, 1e-15);
    EXPECT_NEAR(q.jacobian_ratio, least / (1 - d), 1e-14);
    EXPECT_NEAR(q.shape, measure(right_angled).shape, 1e-15);
    EXPECT_EQ(classify(q), d == 0.5 ? ElementDefect::curved : ElementDefect::none);
  }
}

TEST(MeshQualityTest, BlockIsSummarisedExactly) {
  for (const int order : {1, 2}) {
    BlockOptions options;
    options.cells = {4, 2, 2};
    options.size = Vec3<double>(2, 1, 1);
    options.split = BlockSplit::kuhn6;
    options.order = order;
    const MeshQuality q = measure_quality(make_block(options).value()).value();
    ASSERT_EQ(q.elements.size(), 16u * 6);
    EXPECT_NEAR(q.total_volume, 2, 1e-12);
    EXPECT_NEAR(q.shape.least, measure(kuhn).shape, 1e-12);
    EXPECT_NEAR(q.shape.most, measure(kuhn).shape, 1e-12);
    EXPECT_NEAR(q.min_dihedral.median, 45, 1e-10);
    EXPECT_NEAR(q.max_dihedral.median, 90, 1e-10);
    EXPECT_NEAR(q.jacobian_ratio.least, 1, 1e-12);
    EXPECT_EQ(std::accumulate(q.dihedral_histogram.begin(), q.dihedral_histogram.end(), 0), 16 * 6 * 6);
    EXPECT_EQ(q.dihedral_histogram[4], 16 * 6 * 2);                            // 45
    EXPECT_EQ(q.dihedral_histogram[5] + q.dihedral_histogram[6], 16 * 6);      // 60, to rounding
    EXPECT_EQ(q.dihedral_histogram[8] + q.dihedral_histogram[9], 16 * 6 * 3);  // 90, to rounding
  }
}

/// Separate random elements, so that any of them may be inverted.
MeshData random_soup(int elements) {
  std::mt19937 random(17);
  MeshData mesh;
  for (int e = 0; e < elements; ++e)
    for (const Vec3<double>& x : random_tetrahedron(random)) {
      mesh.connectivity.push_back(mesh.vertex_count());
      mesh.positions.push_back(x);
    }
  return mesh;
}

TEST(MeshQualityTest, SpreadHoldsItsDefinition) {
  for (const int count : {1, 2, 19, 20, 101, 1000}) {
    const MeshQuality q = measure_quality(random_soup(count)).value();
    const auto not_above = [&](double bound) {
      return std::count_if(q.elements.begin(), q.elements.end(), [&](const auto& e) { return e.shape <= bound; });
    };
    const auto below = [&](double bound) {
      return std::count_if(q.elements.begin(), q.elements.end(), [&](const auto& e) { return e.shape < bound; });
    };
    EXPECT_EQ(below(q.shape.least), 0);
    EXPECT_EQ(not_above(q.shape.most), count);
    for (const auto& [value, p] :
         {std::pair(q.shape.percentile5, 5), {q.shape.median, 50}, {q.shape.percentile95, 95}}) {
      EXPECT_GE(100 * not_above(value), p * count);
      EXPECT_LT(100 * below(value), p * count);
    }
  }
}

TEST(MeshQualityTest, WorstElementsAreTheWorst) {
  const MeshQuality q = measure_quality(random_soup(300)).value();
  const auto worst = worst_elements(q, 10);
  ASSERT_EQ(worst.size(), 10u);
  for (std::size_t i = 0; i < worst.size(); ++i) {
    const auto worse = std::count_if(q.elements.begin(), q.elements.end(),
                                     [&](const auto& e) { return e.shape < worst[i].quality.shape; });
    EXPECT_EQ(worse, static_cast<std::ptrdiff_t>(i));
    EXPECT_EQ(worst[i].quality.shape, q.elements[at(worst[i].element)].shape);
    EXPECT_EQ(worst[i].defect, ElementDefect::inverted);  // half of them are
  }
  EXPECT_EQ(worst_elements(q, 1000).size(), 300u);
  EXPECT_TRUE(worst_elements(q, 0).empty());
  EXPECT_TRUE(worst_elements(q, -1).empty());
}

TEST(MeshQualityTest, OneSliverInABlockIsFound) {
  MeshData mesh = make_block({}).value();
  const Index first = mesh.vertex_count();
  for (const Vec3<double>& x : crossed(0.01)) mesh.positions.push_back(x + Vec3<double>(5, 0, 0));
  for (Index i = 0; i < 4; ++i) mesh.connectivity.push_back(first + i);
  const auto worst = worst_elements(measure_quality(mesh).value(), 2);
  EXPECT_EQ(worst[0].element, 5);
  EXPECT_EQ(worst[0].defect, ElementDefect::sliver);
  EXPECT_EQ(worst[1].defect, ElementDefect::none);
}

TEST(MeshQualityTest, CurvatureRanksToo) {
  BlockOptions options;
  options.order = 2;
  MeshData mesh = make_block(options).value();
  const Index moved = mesh.connectivity[10 * 3 + 4];
  mesh.positions[at(moved)] += Vec3<double>(0.2, 0.2, 0.2);
  const MeshQuality q = measure_quality(mesh).value();
  const auto worst = worst_elements(q, 1);
  EXPECT_EQ(worst[0].quality.jacobian_ratio, q.jacobian_ratio.least);
  EXPECT_LT(worst[0].quality.jacobian_ratio, worst[0].quality.shape);
}

TEST(MeshQualityTest, OfCheckedMeshIsThatOfItsData) {
  const MeshData data = make_block({}).value();
  const MeshQuality a = measure_quality(data).value();
  const MeshQuality b = measure_quality(TetMesh<double>::create(data).value());
  const MeshQuality c = measure_quality(TetMesh<float>::create(data).value());
  ASSERT_EQ(a.elements.size(), b.elements.size());
  for (std::size_t e = 0; e < a.elements.size(); ++e) {
    EXPECT_EQ(a.elements[e].shape, b.elements[e].shape);
    EXPECT_NEAR(a.elements[e].shape, c.elements[e].shape, 1e-6);
  }
}

TEST(MeshQualityTest, BadDataIsNamed) {
  MeshData mesh = make_block({}).value();
  mesh.positions[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(measure_quality(mesh).error().code, ErrorCode::non_finite_value);
  EXPECT_EQ(measure_quality(mesh).error().where, "vertex 3");
  mesh.positions[3][1] = 1e101;
  EXPECT_EQ(measure_quality(mesh).error().code, ErrorCode::non_finite_value);
  mesh.positions[3][1] = 0;
  mesh.connectivity[7] = 8;
  EXPECT_EQ(measure_quality(mesh).error().code, ErrorCode::index_out_of_range);
  EXPECT_EQ(measure_quality(mesh).error().where, "element 1");
  EXPECT_TRUE(measure_quality(MeshData{}).value().elements.empty());
}

}  // namespace
}  // namespace corotet
