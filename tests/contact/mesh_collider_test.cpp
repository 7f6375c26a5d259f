// Closed meshes as obstacles: against shapes whose distance is known, against winding numbers, and touched by bodies.
#include <corotet/detail/contact/mesh_collider.hpp>
#include <corotet/detail/contact/solid_properties.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "contact/scene.hpp"
#include "contact/surfaces.hpp"
#include "support/random.hpp"

namespace corotet::mesh_collider_test {
namespace {

using namespace contact_scene;
using namespace contact_surfaces;

MeshCollider collider_of(const SurfaceMesh& surface) {
  const Result<MeshCollider> made = MeshCollider::create(surface);
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().message());
  return made.value();
}

SurfaceMesh moved(SurfaceMesh surface, const Mat3<double>& turn, const V& way) {
  for (V& x : surface.positions) x = turn * x + way;
  return surface;
}

/// In and around a box, often exactly beside or on its faces, edges and corners.
V some_point(testing::Random& random, const V& half) {
  V p;
  for (int i = 0; i < 3; ++i) {
    const double which = random.uniform(), side = random.uniform() < 0.5 ? -1 : 1;
    p[i] = which < 0.6 ? random.uniform(-2, 2) * half[i] : which < 0.8 ? side * half[i] : side * 1.5 * half[i];
  }
  return p;
}

TEST(MeshCollider, ABoxOfTrianglesIsTheBox) {
  const V half(0.3, 0.5, 0.2);
  const OrientedBox box{half};
  for (const Index cells : {1, 2, 5}) {
    const MeshCollider mesh = collider_of(box_surface(half, cells));
    testing::Random random(1);
    int outside = 0, inside = 0;
    for (int i = 0; i < 5000; ++i) {
      const V p = some_point(random, half);
      const SurfaceDistance exact = box(p), seen = mesh(p);
      ASSERT_NEAR(seen.distance, exact.distance, 1e-15) << p.x() << ' ' << p.y() << ' ' << p.z();
      const V beyond = p.cwiseAbs() - half;
      int nearly = 0;  // faces that are as near: the gradient is not unique inside, nor on edges
      for (int k = 0; k < 3; ++k) nearly += beyond[k] > exact.distance - 1e-9;
      if (exact.distance < 1e-9 && nearly > 1) continue;
      (exact.distance > 0 ? outside : inside) += 1;
      ASSERT_LT((seen.normal - exact.normal).norm(), 1e-12) << p.x() << ' ' << p.y() << ' ' << p.z();
    }
    EXPECT_GT(outside, 1000);
    EXPECT_GT(inside, 300);
  }
}

/// Wherever the mesh lies in its frame, and by float coordinates that are far from the origin.
TEST(MeshCollider, TheFrameOfTheMeshDoesNotMatter) {
  const V half(0.3, 0.5, 0.2);
  const OrientedBox box{half};
  testing::Random random(2);
  for (const double far : {0.0, 1.0, 1e4}) {
    const Mat3<double> turn = random.rotation();
    const V way = random.vector(far);
    const MeshCollider mesh = collider_of(moved(box_surface(half), turn, way));
    for (int i = 0; i < 2000; ++i) {
      const V p = some_point(random, half);
      EXPECT_NEAR(mesh(turn * p + way).distance, box(p).distance, 1e-15 * (2 + 4 * far));
      EXPECT_NEAR(mesh(turn * p + way).normal.norm(), 1, 1e-14);
    }
  }
}

/// A fine mesh of a sphere lies between the sphere through its vertices and the one that its triangles touch.
TEST(MeshCollider, AFineSphereIsNearlyASphere) {
  constexpr double radius = 0.7;
  const SurfaceMesh surface = sphere_surface(radius, 12);
  const MeshCollider mesh = collider_of(surface);
  double least = radius;
  for (const auto& t : surface.triangles) {
    const V &a = surface.positions[at(t[0])], &b = surface.positions[at(t[1])], &c = surface.positions[at(t[2])];
    least = std::min(least, std::fabs(a.dot((b - a).cross(c - a).normalized())));
  }
  EXPECT_GT(least, 0.99 * radius);
  testing::Random random(3);
  for (int i = 0; i < 3000; ++i) {
    const V p = random.vector(0.6);
    const SurfaceDistance seen = mesh(p);
    EXPECT_GE(seen.distance, Sphere{radius}(p).distance - 1e-14);
    EXPECT_LE(seen.distance, Sphere{least}(p).distance + 1e-14);
    if (seen.distance > 0.1) {
      EXPECT_LT((seen.normal - p.normalized()).norm(), 0.1);
    }
  }
}

TEST(MeshCollider, TheSignIsThatOfTheWindingNumber) {
  testing::Random random(4);
  for (const SurfaceMesh& surface : {l_surface(), torus_surface(0.5, 0.2, 9, 5), rock_surface(0.5, 6)}) {
    const MeshCollider mesh = collider_of(surface);
    int inside = 0;
    for (int i = 0; i < 3000; ++i) {
      // Near corners and edges as well as elsewhere.
      V p = random.vector(0.4);
      if (i % 3 == 0) p = surface.positions[at(i % size_of(surface.positions))] + random.vector(1e-3);
      const double around = winding_number(surface, p);
      EXPECT_NEAR(around, std::round(around), 1e-9);
      EXPECT_EQ(mesh(p).distance<0, around> 0.5) << p.x() << ' ' << p.y() << ' ' << p.z();
      inside += around > 0.5;
    }
    EXPECT_GT(inside, 300);
  }
}

/// The distance is that to the nearest triangle of all.
TEST(MeshCollider, NoTriangleIsNearer) {
  testing::Random random(5);
  const SurfaceMesh surface = rock_surface(0.5, 5);
  const MeshCollider mesh = collider_of(surface);
  for (int i = 0; i < 300; ++i) {
    const V p = random.vector(0.5);
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& t : surface.triangles)
      nearest = std::min(nearest, detail::closest_on_triangle(surface.positions[at(t[0])], surface.positions[at(t[1])],
                                                              surface.positions[at(t[2])], p)
                                      .squared_distance);
    EXPECT_EQ(std::fabs(mesh(p).distance), std::sqrt(nearest));
  }
}

/// A solid with a hollow, whose surface is wound inwards there.
TEST(MeshCollider, AHollowIsOutside) {
  SurfaceMesh surface = box_surface(V::Constant(0.5));
  SurfaceMesh hollow = box_surface(V::Constant(0.2));
  const Index first = size_of(surface.positions);
  surface.positions.insert(surface.positions.end(), hollow.positions.begin(), hollow.positions.end());
  for (const auto& [a, b, c] : hollow.triangles) surface.triangles.push_back({first + a, first + c, first + b});
  const MeshCollider mesh = collider_of(surface);
  EXPECT_NEAR(mesh(V::Zero()).distance, 0.2, 1e-15);
  EXPECT_NEAR(mesh(V(0.3, 0, 0)).distance, -0.1, 1e-15);
  EXPECT_LT((mesh(V(0.1, 0, 0)).normal + V::UnitX()).norm(), 1e-14);
  EXPECT_LT((mesh(V(0.21, 0, 0)).normal + V::UnitX()).norm(), 1e-14);
  EXPECT_NEAR(mesh.properties().volume, 1 - 0.064, 1e-14);
}

/// Neither winding nor vertices that are divided along seams, with triangles that vanish there, change the solid.
TEST(MeshCollider, InsideOutAndDividedMeshesAreTheSame) {
  const SurfaceMesh surface = rock_surface(0.5, 4);
  const MeshCollider mesh = collider_of(surface);
  SurfaceMesh inside_out = surface, divided;
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  for (const auto& t : surface.triangles) {
    const Index n = size_of(divided.positions);
    for (const Index v : t) divided.positions.push_back(surface.positions[at(v)]);
    divided.triangles.push_back({n, n + 1, n + 2});
    divided.positions.push_back(surface.positions[at(t[0])]);
    divided.triangles.push_back({n, n + 3, n + 1});  // without area
  }
  const MeshCollider turned = collider_of(inside_out), merged = collider_of(divided);
  EXPECT_FALSE(mesh.was_inside_out());
  EXPECT_TRUE(turned.was_inside_out());
  testing::Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const V p = random.vector(0.5);
    EXPECT_EQ(mesh(p).distance, merged(p).distance);
    EXPECT_NEAR(mesh(p).distance, turned(p).distance, 1e-15);
    EXPECT_LT((mesh(p).normal - turned(p).normal).norm(), 1e-9);
  }
  EXPECT_NEAR(turned.properties().volume, mesh.properties().volume, 1e-15);
}

TEST(MeshCollider, EachMistakeIsNamed) {
  const auto expect_error = [](const SurfaceMesh& surface, ErrorCode code, const std::string& where,
                               const std::string& reason) {
    for (const auto& made : {MeshCollider::create(surface), MeshCollider::create_centred(surface)}) {
      ASSERT_FALSE(made.ok()) << where << ' ' << reason;
      EXPECT_EQ(made.error().code, code) << made.error().message();
      EXPECT_EQ(made.error().where, where) << made.error().message();
      EXPECT_NE(made.error().reason.find(reason), std::string::npos) << made.error().message();
    }
  };
  const SurfaceMesh good = l_surface();
  expect_error({}, ErrorCode::empty_mesh, "surface", "no triangles");

  SurfaceMesh bad = good;
  bad.triangles.erase(bad.triangles.begin() + 5);
  expect_error(bad, ErrorCode::invalid_argument, "triangle 2", "belongs to 1 triangles");
  bad = good;
  bad.triangles.push_back(bad.triangles[7]);
  expect_error(bad, ErrorCode::invalid_argument, "triangle 4", "belongs to 3 triangles");
  bad = good;
  std::swap(bad.triangles[5][0], bad.triangles[5][1]);
  expect_error(bad, ErrorCode::invalid_argument, "triangle 2", "triangle 5: they are wound in opposite ways");
  bad = good;
  bad.triangles[9][1] = 12;
  expect_error(bad, ErrorCode::index_out_of_range, "triangle 9", "vertex 12");
  bad = good;
  bad.positions[4].y() = std::numeric_limits<double>::quiet_NaN();
  expect_error(bad, ErrorCode::non_finite_value, "surface vertex 4", "finite");
  bad = good;
  bad.positions[3] = {-0.5, 0, -0.3};  // between 0 and 5, on the edge of triangle 15
  expect_error(bad, ErrorCode::degenerate_element, "triangle 15", "no area");
  SurfaceMesh sheet;
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 1}};
  expect_error(sheet, ErrorCode::invalid_argument, "surface", "no volume");
  SurfaceMesh points;
  points.positions = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  points.triangles = {{0, 1, 2}};
  expect_error(points, ErrorCode::invalid_argument, "surface", "no volume");
}

TEST(SolidProperties, AreThoseOfABox) {
  const V half(0.3, 0.5, 0.2), expected = OrientedBox{half}.inertia();
  testing::Random random(7);
  for (int i = 0; i < 20; ++i) {
    const Mat3<double> turn = i == 0 ? Mat3<double>::Identity() : random.rotation();
    const V way = random.vector(i < 10 ? 1 : 100);
    SurfaceMesh surface = moved(box_surface(half), turn, way);
    if (i % 2 == 1)
      for (auto& t : surface.triangles) std::swap(t[0], t[1]);
    const SolidProperties solid = solid_properties(surface);
    EXPECT_NEAR(solid.volume, 8 * half.x() * half.y() * half.z(), 1e-13);
    EXPECT_LT((solid.centroid - way).norm(), 1e-13);
    EXPECT_NEAR(solid.axes.determinant(), 1, 1e-14);
    Mat3<double> tensor = solid.axes, told = turn;
    for (int k = 0; k < 3; ++k) {
      tensor.set_col(k, solid.inertia[k] * solid.axes.col(k));
      told.set_col(k, expected[k] * turn.col(k));
    }
    EXPECT_LT((tensor * solid.axes.transpose() - told * turn.transpose()).norm(), 1e-12);
    if (i == 0) {
      EXPECT_LT((solid.axes - turn).norm(), 1e-12);
    }
  }
  EXPECT_EQ(solid_properties({}).volume, 0);
}

/// Of a fine mesh, the moments of the sphere and the torus.
TEST(SolidProperties, TendToThoseOfSmoothSolids) {
  const auto error = [](const SurfaceMesh& surface, double volume, const V& inertia) {
    const SolidProperties solid = solid_properties(surface);
    EXPECT_LT(solid.centroid.norm(), 1e-14);
    return std::max(std::fabs(solid.volume / volume - 1), (solid.inertia - inertia).norm() / inertia.norm());
  };
  const double r = 0.7, large = 0.5, small = 0.2, pi = std::numbers::pi;
  const V ball = V::Constant(0.4 * r * r);
  EXPECT_LT(error(sphere_surface(r, 16), 4 * pi / 3 * r * r * r, ball), 0.02);
  const double across = large * large / 2 + 5 * small * small / 8, along = large * large + 3 * small * small / 4;
  double before = 1;
  for (const Index n : {10, 20, 40}) {  // second order
    const double now =
        error(torus_surface(large, small, 2 * n, n), 2 * pi * pi * large * small * small, {across, across, along});
    EXPECT_LT(now, before / 3.5);
    before = now;
  }
  EXPECT_LT(before, 0.01);
}

/// The frame of a centred mesh: the same solid, with its centre of mass in the origin and its moments along the axes.
TEST(MeshCollider, ACentredMeshIsTheSameSolid) {
  testing::Random random(8);
  const SurfaceMesh surface = moved(rock_surface(0.5, 5), random.rotation(), V(1, 2, -3));
  const MeshCollider there = collider_of(surface);
  const MeshCollider centred = MeshCollider::create_centred(surface).value();
  EXPECT_TRUE(there.inertia().isZero());
  EXPECT_GT(centred.inertia().minCoeff(), 0);
  EXPECT_LT(centred.properties().centroid.norm(), 1e-15);
  EXPECT_NEAR(centred.inertia().sum(), there.properties().inertia.sum(), 1e-14);
  for (int i = 0; i < 100; ++i) {
    Pose of_mesh{random.vector(2), quaternion_of(random.rotation())};
    const Pose pose = centred.obstacle_pose(of_mesh);
    const Obstacle as_mesh(there, {.pose = of_mesh}), as_solid(centred, {.pose = pose});
    const V p = of_mesh.position + rotation_of(of_mesh.rotation) * (V(1, 2, -3) + random.vector(0.5));
    EXPECT_NEAR(as_mesh.distance(p).distance, as_solid.distance(p).distance, 1e-14);
    EXPECT_LT((as_mesh.distance(p).normal - as_solid.distance(p).normal).norm(), 1e-9);
    const Pose back = centred.mesh_pose(pose);
    EXPECT_LT((back.position - of_mesh.position).norm(), 1e-14);
    EXPECT_NEAR(std::fabs(back.rotation.dot(of_mesh.rotation)), 1, 1e-14);
  }
  // A mesh that is centred as it comes, of coordinates in float, needs nothing.
  SurfaceMesh box = box_surface(V(0.3, 0.5, 0.2));
  for (V& x : box.positions) x = x.cast<float>().cast<double>();
  EXPECT_LT((collider_of(box).inertia() - OrientedBox{V(0.3, 0.5, 0.2)}.inertia()).norm(), 1e-6);
}

class ContactMesh : public ByMethod {};
INSTANTIATE_TEST_SUITE_P(Methods, ContactMesh, all_methods, by_name);

/// A block lies on a box of triangles as on the box.
TEST_P(ContactMesh, ABlockRestsOnABoxOfTriangles) {
  const V half(0.5, 0.45, 0.2);
  const auto settled = [&](const auto& shape) {
    SceneOptions options = cube(method(), 3, 1e6);
    options.contact.friction = 0.8;
    auto scene = make_scene(method(), options);
    scene->set_gravity({0, 0, -g});
    scene->obstacles.add(shape, {.pose = {.position = {0.2, 0.2, -0.22}}});
    scene->run(2);
    EXPECT_NEAR(scene->report().normal_force, scene->total_mass() * g, 1e-3 * scene->total_mass() * g);
    return scene;
  };
  const auto on_box = settled(OrientedBox{half}), on_mesh = settled(collider_of(box_surface(half, 3)));
  EXPECT_EQ(on_box->report().touching, on_mesh->report().touching);
  for (Index v = 0; v < on_box->vertex_count(); ++v)
    EXPECT_LT((on_box->position(v) - on_mesh->position(v)).norm(), 1e-5) << v;
}

/// No vertex of a block that falls on it at any speed is inside a torus or a rock after a step, farther than a way
/// along the tangent of a bump leads.
TEST_P(ContactMesh, NothingPiercesATorusOrARock) {
  testing::Random random(9);
  const double bump = 0.1;  // about the least radius of both, m
  double deepest = 0;
  int touching = 0;
  for (int k = 0; k < 4; ++k) {
    const MeshCollider mesh = collider_of(k % 2 == 0 ? torus_surface(0.4, 0.15) : rock_surface(0.4));
    auto scene = make_scene(method(), cube(method(), 4, k < 2 ? 5e5 : 5e6));
    scene->set_gravity({0, 0, -g});
    scene->obstacles.add(mesh, {.pose = {.rotation = quaternion_of(random.rotation())}});
    const Mat3<double> turn = random.rotation();
    scene->place([&](const V& x) -> V { return turn * (x - V::Constant(0.2)) + V(0, 0, 0.9); });
    scene->throw_with(constant({0, 0, -3.0 * k}));
    for (int i = 0; i < 60; ++i) {
      ASSERT_TRUE(scene->step().accepted());
      touching += scene->report().touching;
      for (Index v = 0; v < scene->vertex_count(); ++v) {
        const SurfaceDistance to = scene->obstacles[0].distance(scene->position(v));
        const V way = frame_time * scene->velocity(v);
        const double along = (way - way.dot(to.normal) * to.normal).norm();
        deepest = std::max(deepest, -to.distance - along * along / (2 * bump));
      }
    }
  }
  EXPECT_GT(touching, 300);
  EXPECT_LT(deepest, 0.02 * 0.4);
}

/// A rigid rock strikes a block: both fly, and keep their momenta.
TEST_P(ContactMesh, AFreeRockKeepsMomenta) {
  const MeshCollider rock = MeshCollider::create_centred(rock_surface(0.15, 5)).value();
  const double mass = 2000 * rock.properties().volume;
  auto scene = make_scene(method(), cube(method(), 3, 5e5));
  scene->obstacles.add(rock, {.pose = rock.obstacle_pose({.position = {0.28, 0.22, 0.65}}),
                              .velocity = {0.5, 0, -3},
                              .angular_velocity = {1, 4, 0},
                              .mass = mass});
  const Obstacle& obstacle = scene->obstacles[0];
  const auto momentum = [&] { return V(scene->total_mass() * scene->mean_velocity() + mass * obstacle.velocity); };
  const auto angular = [&] {
    return V(scene->angular_momentum() + mass * obstacle.pose().position.cross(obstacle.velocity) +
             obstacle.inertia() * obstacle.angular_velocity);
  };
  const V p = momentum(), l = angular();
  bool touched = false;
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(scene->step().accepted());
    touched = touched || scene->report().touching > 0;
  }
  EXPECT_TRUE(touched);
  EXPECT_LT((momentum() - p).norm(), 1e-6 * p.norm());
  EXPECT_LT((angular() - l).norm(), 1e-3 * mass * 3 * 0.5);
}

}  // namespace
}  // namespace corotet::mesh_collider_test
