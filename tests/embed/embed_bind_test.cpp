#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <type_traits>

#include "embed/embed_fixtures.hpp"

namespace corotet {
namespace {

template <class K>
class EmbedBind : public EmbedFixture<K> {};
TYPED_TEST_SUITE(EmbedBind, AllKinds);

TYPED_TEST(EmbedBind, WeightsSumToOneAndReproduceThePoint) {
  USE_KIND;
  const Mesh mesh = this->block();
  Points points = this->inside(mesh, 300);
  const Points outside = this->around(300);
  points.insert(points.end(), outside.begin(), outside.end());
  const auto surface = Surface::bind(mesh, points);
  ASSERT_TRUE(surface.ok());
  for (Index v = 0; v < surface->vertex_count(); ++v) {
    const auto weights = surface->weights(v);
    double sum = 0, magnitude = 0;
    Vec3<double> x = Vec3<double>::Zero();
    for (std::size_t a = 0; a < weights.size(); ++a) {
      sum += weights[a];
      magnitude += std::abs(weights[a]);
      x += weights[a] * mesh.position(surface->carriers(v)[a]).template cast<double>();
    }
    EXPECT_NEAR(sum, 1, 8 * Fixture::epsilon * magnitude);
    EXPECT_LE((x - points[at(v)]).norm(), 8 * Fixture::epsilon * magnitude);
  }
}

TYPED_TEST(EmbedBind, PointsOfElementsAreInsideAndFollowTheShapeFunctions) {
  USE_KIND;
  const Mesh mesh = this->block();
  Points points;
  std::vector<Index> elements;
  Points natural;
  for (Index e = 0; e < mesh.element_count(); ++e)
    for (int i = 0; i < 4; ++i) {
      elements.push_back(e);
      natural.push_back(this->random_natural());
      points.push_back(this->interpolate_position(mesh, e, natural.back()));
    }
  auto surface = Surface::bind(mesh, points);
  ASSERT_TRUE(surface.ok());
  EXPECT_EQ(surface->outside_count(), 0);
  EXPECT_EQ(surface->max_distance(), 0);

  // Any motion of the nodes, smooth or not, moves the point by its element's shape functions.
  Field<Scalar> u;
  for (Index v = 0; v < mesh.vertex_count(); ++v) u.push_back(this->random_vector(0.1).template cast<Scalar>());
  const Field<Scalar> moved = this->positions(*surface, u);
  for (Index v = 0; v < surface->vertex_count(); ++v) {
    const Vec3<double> expected =
        points[at(v)] + this->interpolate(mesh, elements[at(v)], natural[at(v)],
                                          [&](Index a) { return Vec3<double>(u[at(a)].template cast<double>()); });
    // Positions known to 8 epsilon, gradients of displacement up to 0.2 / 0.1 in the smallest direction and more.
    EXPECT_LE((moved[at(v)].template cast<double>() - expected).norm(), 200 * Fixture::epsilon) << v;
  }
}

TYPED_TEST(EmbedBind, SharedFacesEdgesAndCornersAreInside) {
  USE_KIND;
  const Mesh mesh = this->block();
  Points points;
  for (Index e = 0; e < mesh.element_count(); ++e) {
    const auto add = [&](double a, double b, double c) {
      points.push_back(this->interpolate_position(mesh, e, {a, b, c}));
    };
    for (const double t : {0.0, 1.0}) add(t, 0, 0), add(0, t, 0), add(0, 0, t);
    for (const double t : {0.5, 0.3}) {
      add(t, 0, 0), add(0, t, 0), add(0, 0, t);
      add(t, 1 - t, 0), add(0, t, 1 - t), add(1 - t, 0, t);
      add(t, t / 2, 0), add(0, t, t / 2), add(t / 2, 0, t);
      add(t, t / 2, 1 - 1.5 * t);
    }
  }
  auto surface = Surface::bind(mesh, points);
  ASSERT_TRUE(surface.ok());
  EXPECT_EQ(surface->outside_count(), 0) << surface->max_distance();
  // Neighbours agree on shared points, so whichever was chosen, the motion is that of the mesh.
  const auto motion = [](const Vec3<double>& x) { return Vec3<double>(1.5 * x + Vec3<double>(x[1], -x[2], x[0])); };
  const Field<Scalar> u = this->displacements(mesh, motion);
  const Field<Scalar> moved = this->positions(*surface, u);
  for (Index v = 0; v < surface->vertex_count(); ++v)
    EXPECT_LE((moved[at(v)].template cast<double>() - motion(points[at(v)])).norm(),
              this->rounding(*surface, v, points[at(v)], u));
}

TYPED_TEST(EmbedBind, ReportsExactlyTheVerticesOutside) {
  USE_KIND;
  const Mesh mesh = this->block();
  Points points = this->inside(mesh, 20);
  if (TypeParam::curved) {
    points.insert(points.begin() + 5, Vec3<double>(3, 0, 0));
    points.push_back({0, -7, 0});
    const auto surface = Surface::bind(mesh, points);
    ASSERT_TRUE(surface.ok());
    EXPECT_EQ(surface->outside_vertices(), (std::vector<Index>{5, 21}));
    // Against the nearest of many points of the mesh.
    const Points sample = this->inside(mesh, 50000);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3<double>& x : sample) nearest = std::min(nearest, (x - points.back()).norm());
    EXPECT_LE(surface->max_distance(), nearest);
    EXPECT_GE(surface->max_distance(), nearest - 0.05);
  } else {
    const Vec3<double> high = this->corner + this->size;
    points.insert(points.begin() + 5, high + Vec3<double>(0.3, 0, 0.4));
    points.insert(points.begin() + 9, this->corner - Vec3<double>(0, 0.25, 0));
    const auto surface = Surface::bind(mesh, points);
    ASSERT_TRUE(surface.ok());
    EXPECT_EQ(surface->outside_count(), 2);
    EXPECT_EQ(surface->outside_vertices(), (std::vector<Index>{5, 9}));
    EXPECT_NEAR(surface->max_distance(), 0.5, 8 * Fixture::epsilon);
  }
}

TYPED_TEST(EmbedBind, NearestPointOfACurvedMeshIsNoFartherThanAnySample) {
  USE_KIND;
  const Mesh mesh = this->block();
  const Points sample = this->inside(mesh, 20000);
  for (const Vec3<double>& p : this->around(60)) {
    const auto surface = Surface::bind(mesh, Points{p});
    ASSERT_TRUE(surface.ok());
    for (const Vec3<double>& x : sample)
      ASSERT_LE(surface->max_distance(), (x - p).norm() * (1 + 1e-5) + 8 * Fixture::epsilon)
          << ::testing::PrintToString(p);
  }
}

TYPED_TEST(EmbedBind, DoesNotDependOnTheExecutor) {
  USE_KIND;
  const Mesh mesh = this->block();
  const Points points = this->around(300), normals = this->directions(300);
  auto serial = Surface::bind(mesh, points, normals);
  auto backwards = Surface::bind(mesh, points, normals, [](Index count, TaskRef task) {
    for (Index i = count; i-- > 0;) task(i);
  });
  ASSERT_TRUE(serial.ok() && backwards.ok());
  EXPECT_EQ(serial->outside_vertices(), backwards->outside_vertices());
  EXPECT_EQ(serial->max_distance(), backwards->max_distance());
  EXPECT_EQ(serial->boxes_visited(), backwards->boxes_visited());
  const Field<Scalar> u =
      this->displacements(mesh, [](const Vec3<double>& x) { return Vec3<double>(x.cwiseProduct(x)); });
  EXPECT_EQ(this->positions(*serial, u), this->positions(*backwards, u));
  EXPECT_EQ(this->normals(*serial, u), this->normals(*backwards, u));
}

TYPED_TEST(EmbedBind, BadInputIsNamed) {
  USE_KIND;
  const Mesh mesh = this->block();
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  Points points = this->inside(mesh, 4), normals = this->directions(4);
  for (const double bad : {nan, infinity, -infinity}) {
    Points broken = points;
    broken[2][1] = bad;
    auto result = Surface::bind(mesh, broken, normals);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::non_finite_value);
    EXPECT_EQ(result.error().where, "surface vertex 2");
    broken = normals;
    broken[3][0] = bad;
    result = Surface::bind(mesh, points, broken);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::non_finite_value);
    EXPECT_EQ(result.error().where, "surface vertex 3");
  }
  normals.pop_back();
  const auto result = Surface::bind(mesh, points, normals);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::invalid_argument);
}

// Far vertices are kept to rounding or refused by name, never lost.
TYPED_TEST(EmbedBind, AFarVertexIsKeptOrNamed) {
  USE_KIND;
  const Mesh mesh = this->block();
  const Field<Scalar> at_rest(at(mesh.vertex_count()), Vec3<Scalar>::Zero());
  const double kept = std::is_same_v<Scalar, float> ? 1e29 : 1e99;
  for (const double far : {1e10, 1e29, 1e31, 1e45, 1e99, 1e101, 1e160, 1e200, 1e308})
    for (const Vec3<double>& way : {Vec3<double>(1, 0, 0), Vec3<double>(0, -1, 0), Vec3<double>(-1, 1, -1)}) {
      const Points points{mesh.origin(), way * far};
      auto surface = Surface::bind(mesh, points);
      EXPECT_EQ(surface.ok(), far <= kept) << far;
      if (surface.ok()) {
        const Vec3<double> x = this->positions(*surface, at_rest)[1].template cast<double>();
        EXPECT_LE((x - points[1]).norm(), 1000 * Fixture::epsilon * far) << ::testing::PrintToString(x);
      } else {
        EXPECT_EQ(surface.error().code, ErrorCode::non_finite_value);
        EXPECT_EQ(surface.error().where, "surface vertex 1");
      }
    }
}

// In float, natural coordinates in a tiny element leave the range before positions do.
TEST(EmbedBindRange, AVertexTooFarForATinyElementIsNamed) {
  MeshData tiny;
  tiny.positions = {{0, 0, 0}, {1e-10, 0, 0}, {0, 1e-10, 0}, {0, 0, 1e-10}};
  tiny.connectivity = {0, 1, 2, 3};
  const auto mesh = TetMesh<float, Tet4>::create(tiny);
  ASSERT_TRUE(mesh.ok());
  EXPECT_TRUE((EmbeddedSurface<float, Tet4>::bind(*mesh, Points{{0, 1e20, 0}}).ok()));
  const auto surface = EmbeddedSurface<float, Tet4>::bind(*mesh, Points{{0, 0, 0}, {0, 1e29, 0}});
  ASSERT_FALSE(surface.ok());
  EXPECT_EQ(surface.error().code, ErrorCode::non_finite_value);
  EXPECT_EQ(surface.error().where, "surface vertex 1");
}

TYPED_TEST(EmbedBind, TriangleSurfaces) {
  USE_KIND;
  const Mesh mesh = this->block();
  SurfaceMesh square;  // two coplanar triangles and a vertex that no triangle uses
  square.positions = {{0, 0.2, 0.3}, {0.4, 0.2, 0.3}, {0.4, 0.6, 0.3}, {0, 0.6, 0.3}, {0, 0.2, 0.6}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Field<Scalar> at_rest(at(mesh.vertex_count()), Vec3<Scalar>::Zero());
  auto surface = Surface::bind(mesh, square);
  ASSERT_TRUE(surface.ok());
  EXPECT_EQ(surface->replaced_normals(), 1);
  for (const Vec3<Scalar>& n : this->normals(*surface, at_rest))
    EXPECT_LE((n.template cast<double>() - Vec3<double>(0, 0, 1)).norm(), 100 * Fixture::epsilon);

  square.normals.assign(5, Vec3<double>(0, 3, 0));  // given normals win, whatever their length
  surface = Surface::bind(mesh, square);
  ASSERT_TRUE(surface.ok());
  EXPECT_EQ(surface->replaced_normals(), 0);
  for (const Vec3<Scalar>& n : this->normals(*surface, at_rest))
    EXPECT_LE((n.template cast<double>() - Vec3<double>(0, 1, 0)).norm(), 100 * Fixture::epsilon);

  for (const Index bad : {-1, 5}) {
    square.triangles[1][2] = bad;
    const auto result = Surface::bind(mesh, square);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::index_out_of_range);
    EXPECT_EQ(result.error().where, "triangle 1");
  }
}

TYPED_TEST(EmbedBind, NoVerticesIsNotAnError) {
  USE_KIND;
  const Mesh mesh = this->block();
  const auto surface = Surface::bind(mesh, Points{});
  ASSERT_TRUE(surface.ok());
  EXPECT_EQ(surface->vertex_count(), 0);
  EXPECT_EQ(surface->outside_count(), 0);
}

TEST(EmbedBindCost, BoxesPerVertexGrowAsTheLogarithmOfTheMesh) {
  const auto boxes_per_vertex = [](Index n) {
    BlockOptions options;
    options.cells = {n, n, n};
    const auto mesh = TetMesh<double, Tet4>::create(make_block(options).value()).value();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> coordinate(-0.02, 1.02);  // some outside, close by
    Points points;
    for (int i = 0; i < 400; ++i) points.push_back({coordinate(random), coordinate(random), coordinate(random)});
    return double(EmbeddedSurface<double, Tet4>::bind(mesh, points).value().boxes_visited()) / 400;
  };
  // 27 times the elements: log2 grows from 10.5 to 15.2. All-pairs would grow 27-fold.
  const double small = boxes_per_vertex(6), large = boxes_per_vertex(18);
  EXPECT_LT(large, 1.8 * small) << small << " and " << large;
}

}  // namespace
}  // namespace corotet
