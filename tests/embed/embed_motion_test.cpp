#include <gtest/gtest.h>

#include <cmath>
#include <corotet/detail/embed/embedded_surface.hpp>

#include "embed/embed_fixtures.hpp"
#include "support/matrices.hpp"

namespace corotet {
namespace {

template <class K>
class EmbedMotion : public EmbedFixture<K> {};
TYPED_TEST_SUITE(EmbedMotion, AllKinds);

/// det(M) M^-T by minors.
Mat3<double> cofactors(const Mat3<double>& m) { return m.determinant() * m.inverse().transpose(); }

/// Rounding of a unit normal: displacements of size 2 in elements of size 0.1 leave 20 epsilon in F; the rest is for
/// well-shaped elements and motions that stretch by no more than 5:1.
constexpr double normal_rounding = 1000;

TYPED_TEST(EmbedMotion, AffineMotionIsReproducedInsideAndOutside) {
  USE_KIND;
  const Mesh mesh = this->block();
  Points points = this->inside(mesh, 300);
  const Points outside = this->around(300);
  points.insert(points.end(), outside.begin(), outside.end());
  const Points normals = this->directions(600);
  auto surface = Surface::bind(mesh, points, normals);
  ASSERT_TRUE(surface.ok());
  ASSERT_GT(surface->outside_count(), 100);

  const Mat3<double> turn = testing::of_rows({0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6});
  const Mat3<double> shear = testing::of_rows({1.4, 0.5, -0.2}, {0.1, 0.7, 0.3}, {-0.3, 0.2, 1.1});
  const Mat3<double> mirror = testing::diagonal({1, -1.2, 0.8});
  for (const Mat3<double>& a : {turn, shear, mirror, Mat3<double>(turn * shear)}) {
    const auto motion = [&](const Vec3<double>& x) { return Vec3<double>(a * x + Vec3<double>(0.3, -1, 0.5)); };
    const Field<Scalar> u = this->displacements(mesh, motion);
    const Field<Scalar> moved = this->positions(*surface, u), turned = this->normals(*surface, u);
    for (Index v = 0; v < surface->vertex_count(); ++v) {
      EXPECT_LE((moved[at(v)].template cast<double>() - motion(points[at(v)])).norm(),
                this->rounding(*surface, v, points[at(v)], u));
      const Vec3<double> n = (cofactors(a) * normals[at(v)]).normalized();
      EXPECT_LE((turned[at(v)].template cast<double>() - n).norm(), normal_rounding * Fixture::epsilon);
    }
  }
}

/// The only kind that contains all quadratic motions.
template <class K>
class EmbedQuadratic : public EmbedFixture<K> {};
TYPED_TEST_SUITE(EmbedQuadratic, StraightTet10Kinds);

TYPED_TEST(EmbedQuadratic, MotionIsReproduced) {
  USE_KIND;
  const Mesh mesh = this->block();
  Points points = this->inside(mesh, 400);
  const Points outside = this->around(400);
  points.insert(points.end(), outside.begin(), outside.end());
  const Points normals = this->directions(800);
  auto surface = Surface::bind(mesh, points, normals);
  ASSERT_TRUE(surface.ok());

  const auto motion = [](const Vec3<double>& x) {
    return Vec3<double>(x[0] + 0.3 * x[1] * x[1] - 0.2 * x[0] * x[2], x[1] - 0.4 * x[0] * x[0] + 0.2 * x[1] * x[2],
                        x[2] + 0.1 + 0.5 * x[0] * x[1] - 0.1 * x[2] * x[2]);
  };
  const auto gradient = [](const Vec3<double>& x) {
    return testing::of_rows({1 - 0.2 * x[2], 0.6 * x[1], -0.2 * x[0]}, {-0.8 * x[0], 1 + 0.2 * x[2], 0.2 * x[1]},
                            {0.5 * x[1], 0.5 * x[0], 1 - 0.2 * x[2]});
  };
  const Field<Scalar> u = this->displacements(mesh, motion);
  const Field<Scalar> moved = this->positions(*surface, u), turned = this->normals(*surface, u);
  for (Index v = 0; v < surface->vertex_count(); ++v) {
    // Outside, the linear extension from the nearest point of the block; inside, that is the point itself.
    const Vec3<double>& p = points[at(v)];
    const Vec3<double> c = p.cwiseMax(this->corner).cwiseMin(this->corner + this->size);
    const Vec3<double> expected = motion(c) + gradient(c) * (p - c);
    EXPECT_LE((moved[at(v)].template cast<double>() - expected).norm(), 4 * this->rounding(*surface, v, p, u));
    const Vec3<double> n = (cofactors(gradient(c)) * normals[at(v)]).normalized();
    EXPECT_LE((turned[at(v)].template cast<double>() - n).norm(), normal_rounding * Fixture::epsilon);
  }
}

/// Finite differences need double.
template <class K>
class EmbedTangents : public EmbedFixture<K> {};
TYPED_TEST_SUITE(EmbedTangents, DoubleKinds);

TYPED_TEST(EmbedTangents, NormalsStayPerpendicularToTheMovedSurface) {
  USE_KIND;
  const Mesh mesh = this->block();
  // For each of 100 vertices: its two tangents, sampled at +-h, in one element and away from its sides.
  constexpr double h = 1e-5;
  Points points, normals;
  for (int i = 0; i < 100; ++i) {
    const Vec3<double> xi = 0.5 * this->random_natural() + Vec3<double>::Constant(0.125);
    const Vec3<double> p =
        this->interpolate_position(mesh, static_cast<Index>(this->random_() % at(mesh.element_count())), xi);
    const Vec3<double> n = this->random_vector(1).normalized(), t = n.unitOrthogonal(), s = n.cross(t);
    for (const Vec3<double>& x :
         {p, Vec3<double>(p + h * t), Vec3<double>(p - h * t), Vec3<double>(p + h * s), Vec3<double>(p - h * s)}) {
      points.push_back(x);
      normals.push_back(n);
    }
  }
  auto surface = Surface::bind(mesh, points, normals);
  ASSERT_TRUE(surface.ok());
  Field<Scalar> u;
  for (Index v = 0; v < mesh.vertex_count(); ++v) u.push_back(this->random_vector(0.03).template cast<Scalar>());
  const Field<Scalar> x = this->positions(*surface, u), n = this->normals(*surface, u);
  for (std::size_t i = 0; i < points.size(); i += 5) {
    const Vec3<double> t = (x[i + 1] - x[i + 2]).template cast<double>() / (2 * h);
    const Vec3<double> s = (x[i + 3] - x[i + 4]).template cast<double>() / (2 * h);
    const Vec3<double> normal = n[i].template cast<double>();
    EXPECT_NEAR(normal.norm(), 1, 1e-14);
    EXPECT_LE((normal - t.cross(s).normalized()).norm(), 1e-7);
  }
}

TYPED_TEST(EmbedMotion, CollapsedBodyKeepsRestNormals) {
  USE_KIND;
  const Mesh mesh = this->block();
  const Points points = this->inside(mesh, 100), normals = this->directions(100);
  auto surface = Surface::bind(mesh, points, normals);
  ASSERT_TRUE(surface.ok());
  // Exactly to a point and to a line, so that nothing is left of any area.
  Field<Scalar> to_point, to_line;
  for (const Vec3<Scalar>& x : mesh.positions()) {
    to_point.push_back(-x);
    to_line.push_back({0, -x[1], -x[2]});
  }
  for (const Field<Scalar>& u : {to_point, to_line}) {
    const Field<Scalar> n = this->normals(*surface, u);
    for (std::size_t v = 0; v < n.size(); ++v)
      EXPECT_LE((n[v].template cast<double>() - normals[v]).norm(), normal_rounding * Fixture::epsilon);
  }
  // To a point and a line elsewhere, to rounding, and far beyond what a square can hold: any direction, but a unit one.
  const double huge = std::sqrt(double{std::numeric_limits<Scalar>::max()});
  for (const Field<Scalar>& u :
       {this->displacements(mesh, [](const Vec3<double>&) { return Vec3<double>(0.5, 0.3, 2); }),
        this->displacements(mesh, [](const Vec3<double>& x) { return Vec3<double>(x[0], 1.7 * x[0], 0.3); }),
        this->displacements(mesh, [&](const Vec3<double>& x) { return Vec3<double>(huge * x); })})
    for (const Vec3<Scalar>& n : this->normals(*surface, u)) {
      ASSERT_TRUE(n.allFinite());
      EXPECT_NEAR(n.norm(), 1, 8 * Fixture::epsilon);
    }
}

TYPED_TEST(EmbedMotion, FlattenedBodyTurnsNormalsToItsPlane) {
  USE_KIND;
  const Mesh mesh = this->block();
  const Points points = this->inside(mesh, 100);
  Points normals = this->directions(100);
  for (Vec3<double>& n : normals) n[2] = n[2] < 0 ? n[2] - 0.2 : n[2] + 0.2;
  auto surface = Surface::bind(mesh, points, normals);
  ASSERT_TRUE(surface.ok());
  const Field<Scalar> u = this->displacements(mesh, [](const Vec3<double>& x) { return Vec3<double>(x[0], x[1], 0); });
  const Field<Scalar> n = this->normals(*surface, u);
  for (std::size_t v = 0; v < n.size(); ++v)
    EXPECT_LE((n[v].template cast<double>() - Vec3<double>(0, 0, normals[v][2] < 0 ? -1 : 1)).norm(),
              normal_rounding * Fixture::epsilon);
}

TYPED_TEST(EmbedMotion, BodiesOfAnySizeHaveTheSameNormals) {
  USE_KIND;
  const MeshData data = this->block_data();
  const Points points = this->around(100), normals = this->directions(100);
  const auto turned = [&](double scale) {
    MeshData scaled = data;
    for (Vec3<double>& x : scaled.positions) x *= scale;
    Points scaled_points = points;
    for (Vec3<double>& x : scaled_points) x *= scale;
    const Mesh mesh = Mesh::create(scaled).value();
    auto surface = Surface::bind(mesh, scaled_points, normals).value();
    return this->normals(surface, this->displacements(mesh, [&](const Vec3<double>& x) {
      return Vec3<double>(x + 0.3 * x.cwiseProduct(x) / scale);
    }));
  };
  // Powers of two scale without rounding; a micrometre and a planet.
  const Field<Scalar> expected = turned(1);
  for (const double scale : {std::ldexp(1.0, -20), std::ldexp(1.0, 23)}) {
    const Field<Scalar> n = turned(scale);
    for (std::size_t v = 0; v < n.size(); ++v)
      EXPECT_LE((n[v] - expected[v]).norm(), normal_rounding * Fixture::epsilon);
  }
}

TYPED_TEST(EmbedMotion, BodyFarFromTheOriginMovesTheSame) {
  USE_KIND;
  // Coordinates on a grid of 2^-20 m, so that moving them by 2^20 m is exact in double.
  MeshData data = this->block_data();
  const auto snap = [](Vec3<double>& x) {
    for (double& coordinate : x) coordinate = std::round(std::ldexp(coordinate, 20)) / std::ldexp(1.0, 20);
  };
  for (Vec3<double>& x : data.positions) snap(x);
  Points points = this->around(200);
  for (Vec3<double>& p : points) snap(p);
  const Points normals = this->directions(200);
  const Vec3<double> origin = std::ldexp(1.0, 20) * Vec3<double>(1, -2, 3);
  const Mesh near_mesh = Mesh::create(data).value();
  auto near_surface = Surface::bind(near_mesh, points, normals).value();
  for (Vec3<double>& x : data.positions) x += origin;
  for (Vec3<double>& p : points) p += origin;
  const Mesh far_mesh = Mesh::create(data, origin).value();
  auto far_surface = Surface::bind(far_mesh, points, normals).value();
  const Field<Scalar> u =
      this->displacements(near_mesh, [](const Vec3<double>& x) { return Vec3<double>(x + x.cwiseProduct(x)); });
  EXPECT_EQ(this->positions(near_surface, u), this->positions(far_surface, u));
  EXPECT_EQ(this->normals(near_surface, u), this->normals(far_surface, u));
  EXPECT_EQ(near_surface.outside_vertices(), far_surface.outside_vertices());
}

}  // namespace
}  // namespace corotet
