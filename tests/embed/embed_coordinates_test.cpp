#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <corotet/detail/embed/coordinates.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <vector>

#include "embed/embed_fixtures.hpp"

namespace corotet {
namespace {

constexpr std::array systems{coordinates::z_up,  coordinates::blender, coordinates::gltf,
                             coordinates::godot, coordinates::unity,   coordinates::unreal};

Vec3<double> unit_vector(Axis axis) {
  Vec3<double> e = Vec3<double>::Zero();
  e[static_cast<int>(axis) % 3] = axis < Axis::minus_x ? 1 : -1;
  return e;
}

TEST(Coordinates, EnginesAreAsTheirManualsSay) {
  for (const CoordinateSystem& s : systems) EXPECT_TRUE(s.is_valid());
  for (const CoordinateSystem& s : {coordinates::z_up, coordinates::blender, coordinates::gltf, coordinates::godot})
    EXPECT_TRUE(s.is_right_handed());
  EXPECT_FALSE(coordinates::unity.is_right_handed());
  EXPECT_FALSE(coordinates::unreal.is_right_handed());
  // What exporters of these programs do.
  const Vec3<double> x(1, 2, 3);
  const auto convert = [&](const CoordinateSystem& from, const CoordinateSystem& to) {
    return CoordinateConversion::between(from, to).position(x);
  };
  EXPECT_EQ(convert(coordinates::blender, coordinates::gltf), Vec3<double>(1, 3, -2));
  EXPECT_EQ(convert(coordinates::blender, coordinates::unity), Vec3<double>(-1, 3, -2));
  EXPECT_EQ(convert(coordinates::gltf, coordinates::unity), Vec3<double>(-1, 2, 3));
  EXPECT_EQ(convert(coordinates::z_up, coordinates::unreal), Vec3<double>(100, -200, 300));
  EXPECT_EQ(convert(coordinates::gltf, coordinates::godot), x);
}

TEST(Coordinates, ForwardRightAndUpStayWhatTheyAre) {
  for (const CoordinateSystem& from : systems)
    for (const CoordinateSystem& to : systems) {
      const auto conversion = CoordinateConversion::between(from, to);
      EXPECT_TRUE(conversion.is_valid());
      EXPECT_EQ(conversion.direction(unit_vector(from.forward)), unit_vector(to.forward));
      EXPECT_EQ(conversion.direction(unit_vector(from.right)), unit_vector(to.right));
      EXPECT_EQ(conversion.direction(unit_vector(from.up)), unit_vector(to.up));
      EXPECT_DOUBLE_EQ(conversion.scale * to.unit, from.unit);
      EXPECT_EQ(conversion.mirrors(), from.is_right_handed() != to.is_right_handed());
      const Vec3<double> x(0.3, -1.7, 2.2);
      EXPECT_LE((conversion.matrix() * x - conversion.position(x)).norm(), 1e-15 * conversion.scale);
      EXPECT_EQ(conversion.direction_to_source(conversion.direction(x)), x);
      EXPECT_LE((conversion.position_to_source(conversion.position(x)) - x).norm(), 1e-15);
      const auto back = CoordinateConversion::between(to, from);
      EXPECT_LE((back.position(conversion.position(x)) - x).norm(), 1e-14);
      EXPECT_EQ(back.direction(conversion.direction(x)), x);
      EXPECT_EQ(back.reverses_winding, conversion.reverses_winding);
    }
  for (const CoordinateSystem& s : systems) {
    EXPECT_TRUE(CoordinateConversion::between(s, s).is_identity());
    EXPECT_FALSE(CoordinateConversion::between(s, s).reverses_winding);
  }
}

TEST(Coordinates, SystemsWithoutThreeAxesAreNotValid) {
  EXPECT_FALSE((CoordinateSystem{.forward = Axis::x, .right = Axis::minus_x, .up = Axis::z}.is_valid()));
  EXPECT_FALSE((CoordinateSystem{.unit = 0}.is_valid()));
  EXPECT_FALSE((CoordinateConversion{.from = {Axis::x, Axis::y, Axis::minus_y}}.is_valid()));
  EXPECT_FALSE((CoordinateConversion{.scale = -1}.is_valid()));
}

/// A sphere, counter-clockwise seen from outside, in the middle of the fixture's block.
SurfaceMesh ball(const Vec3<double>& centre) {
  constexpr Index rings = 10, sides = 14;
  SurfaceMesh out;
  for (Index i = 0; i <= rings; ++i)
    for (Index j = 0; j < sides; ++j) {
      const double polar = std::numbers::pi * (0.05 + 0.9 * i / rings), turn = 2 * std::numbers::pi * j / sides;
      out.positions.push_back(centre + 0.2 * Vec3<double>(std::sin(polar) * std::cos(turn),
                                                          std::sin(polar) * std::sin(turn), std::cos(polar)));
    }
  for (Index i = 0; i < rings; ++i)
    for (Index j = 0; j < sides; ++j) {
      const Index a = i * sides + j, b = i * sides + (j + 1) % sides;
      out.triangles.push_back({a, a + sides, b});
      out.triangles.push_back({b, a + sides, b + sides});
    }
  return out;
}

template <class K>
class EmbedCoordinates : public EmbedFixture<K> {};
TYPED_TEST_SUITE(EmbedCoordinates, AllKinds);

struct Vertex {
  std::array<float, 3> position, normal;
};

template <class Surface, class Field>
std::vector<Vertex> update(Surface& surface, const Field& u, const CoordinateConversion& conversion) {
  std::vector<Vertex> vertices(at(surface.vertex_count()));
  surface.update(u, {.data = reinterpret_cast<std::byte*>(vertices.data()),
                     .stride = sizeof(Vertex),
                     .count = size_of(vertices),
                     .position_offset = offsetof(Vertex, position),
                     .normal_offset = offsetof(Vertex, normal),
                     .translation = {0.5, -3, 7},
                     .conversion = conversion});
  return vertices;
}

TYPED_TEST(EmbedCoordinates, AnUpdateConvertsWhatItWrites) {
  USE_KIND;
  const Mesh mesh = this->block();
  auto surface = Surface::bind(mesh, this->inside(mesh, 200), this->directions(200)).value();
  Field<Scalar> u;
  for (Index v = 0; v < mesh.vertex_count(); ++v) u.push_back(this->random_vector(0.2).template cast<Scalar>());
  const Field<Scalar> x = this->positions(surface, u), n = this->normals(surface, u);
  const auto plain = update(surface, u, {});
  for (const CoordinateSystem& from : systems)
    for (const CoordinateSystem& to : systems) {
      const auto conversion = CoordinateConversion::between(from, to);
      const auto vertices = update(surface, u, conversion);
      for (std::size_t v = 0; v < vertices.size(); ++v) {
        const Vec3<Scalar> moved = x[v] + Vec3<double>(0.5, -3, 7).template cast<Scalar>();
        EXPECT_EQ(Vec3<float>::load(vertices[v].position.data()), conversion.position(moved).template cast<float>());
        EXPECT_EQ(Vec3<float>::load(vertices[v].normal.data()), conversion.direction(n[v]).template cast<float>());
      }
      if (!conversion.is_identity()) continue;
      EXPECT_EQ(std::memcmp(vertices.data(), plain.data(), plain.size() * sizeof(Vertex)), 0);
    }
}

// In coordinates of either handedness, the cross product of a front face's edges has a side that the engine's manual
// states; for a triangle of the index buffer, that must be the side of the normals in the vertex buffer.
TYPED_TEST(EmbedCoordinates, TrianglesFaceAsTheirNormals) {
  USE_KIND;
  const Mesh mesh = this->block();
  const SurfaceMesh sphere = ball(TypeParam::curved ? this->bend({0.1, 0.4, 0.45}) : Vec3<double>(0.1, 0.4, 0.45));
  auto surface = Surface::bind(mesh, sphere).value();
  const Field<Scalar> u = this->displacements(mesh, [](const Vec3<double>& x) {
    return Vec3<double>(1.2 * x + Vec3<double>(0.3 * x[1], -0.2 * x[2], 0.1 * x[0]));
  });
  struct Engine {
    CoordinateSystem system;
    double cross_product;  // 1: outwards
  };
  for (const Engine& engine : {Engine{coordinates::gltf, 1}, Engine{coordinates::godot, -1},
                               Engine{coordinates::unity, 1}, Engine{coordinates::unreal, -1}})
    for (const CoordinateSystem& source : {coordinates::z_up, coordinates::blender, coordinates::gltf}) {
      const auto conversion = CoordinateConversion::between(source, engine.system);
      const auto vertices = update(surface, u, conversion);
      std::vector<std::uint16_t> indices(3 * sphere.triangles.size());
      write_indices(sphere.triangles, conversion, std::span(indices));
      for (std::size_t t = 0; t < indices.size(); t += 3) {
        std::array<Vec3<float>, 3> x;
        Vec3<float> n = Vec3<float>::Zero();
        for (std::size_t i = 0; i < 3; ++i) {
          x[i] = Vec3<float>::load(vertices[indices[t + i]].position.data());
          n += Vec3<float>::load(vertices[indices[t + i]].normal.data());
        }
        const Vec3<float> cross = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
        EXPECT_GT(engine.cross_product * double(cross.dot(n)), 2);
        EXPECT_EQ(indices[t], sphere.triangles[t / 3][0]);
      }
    }
}

}  // namespace
}  // namespace corotet
