// What has to be the same everywhere: a mesh from text, and the beam of the README for sixty steps, with linear and
// with quadratic elements. Prints a hash of the bytes of all displacements of all steps, and the deepest position of
// the tip as a number to compare by where the bytes differ. Exit code 0 if everything worked.
#include <array>
#include <bit>
#include <corotet/detail/core/from_chars_by_strtod.hpp>
#include <corotet/detail/core/parse_number.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/io/read_medit.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <cstdint>
#include <cstdio>
#include <string_view>
#include <vector>

namespace {

using namespace corotet;

/// FNV-1a, 64 bits.
class Hash {
 public:
  template <class Number>
  void add(Number number) {
    for (const unsigned char byte : std::bit_cast<std::array<unsigned char, sizeof(Number)>>(number))
      value_ = (value_ ^ byte) * 0x100000001b3u;
  }
  template <class Vectors>
  void add_all(const Vectors& vectors) {
    for (const auto& v : vectors)
      for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void print(const char* name, double number) const {
    std::printf("%s %016llx %.9g\n", name, static_cast<unsigned long long>(value_), number);
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

template <class Element>
bool swing(const char* name) {
  auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {10, 2, 2}, .order = Element::order});
  auto mesh = TetMesh<float, Element>::create(*block);
  if (!mesh) return false;
  auto body = SoftBody<float, Element>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  if (!body) return false;
  body->pin_where([](const Vec3<float>& x) { return x.x() == 0; });
  body->set_gravity({0, 0, -9.81f});
  ImplicitEuler euler(*body);
  const Index tip = mesh->nearest_vertex({1, 0.1f, 0.1f});
  Hash hash;
  float deepest = 0;
  bool ok = true;
  for (int frame = 0; frame < 60; ++frame) {
    ok = euler.step(*body, 1.0f / 60).ok() && ok;
    hash.add_all(body->displacements());
    const float height = body->displacements()[at(tip)].z();
    if (height < deepest) deepest = height;
  }
  hash.print(name, static_cast<double>(deepest));
  return ok;
}

/// A free body that spins, bends and is damped, by the second-order integrator, with a surface on it: what the beams do
/// not go through (rotations of the whole, the exponential, mean dilatation, normals).
bool spin() {
  auto block = make_block({.size = {1, 0.3, 0.2}, .cells = {5, 2, 2}});
  auto mesh = TetMesh<double, Tet4>::create(*block);
  if (!mesh) return false;
  auto body =
      SoftBody<double, Tet4>::create(*mesh, Material{.young = 1e5, .poisson = 0.45, .density = 1000},
                                     {.damping = {.mass = 0.1}, .volumetric_strain = VolumetricStrain::averaged});
  const auto boundary = extract_boundary(*mesh);
  if (!boundary) return false;
  SurfaceMesh skin;
  skin.positions = block->positions;
  skin.triangles = boundary->triangles;
  auto surface = EmbeddedSurface<double, Tet4>::bind(*mesh, skin);
  if (!body || !surface) return false;
  Field<double> velocity;
  for (const Vec3<double>& x : mesh->positions())
    velocity.push_back(Vec3<double>(1, -2, 3).cross(x) + Vec3<double>(0, 0, 4 * x.x() * x.x()));
  if (!body->set_velocities(velocity)) return false;
  Bdf2 bdf2(*body);
  Hash of_displacements, of_velocities, of_normals;
  bool ok = true;
  std::vector<Vec3<double>> normals(at(surface->vertex_count()));
  for (int frame = 0; frame < 60; ++frame) {
    ok = bdf2.step(*body, 1.0 / 60).accepted() && ok;
    surface->normals(body->displacements(), normals);
    of_displacements.add_all(body->displacements());
    of_velocities.add_all(body->velocities());
    of_normals.add_all(normals);
  }
  of_displacements.print("spin", body->displacements().front().z());
  of_velocities.print("spin_velocities", body->velocities().front().z());
  of_normals.print("spin_normals", normals.front().z());
  return ok;
}

/// The C library reads numbers as what the library uses here does.
bool strtod_agrees() {
  for (const std::string_view text :
       {"0.1", "-1.7976931348623157e308", "1e999", "2.4703282292062328e-324", "9007199254740993",
        "123456789012345678901234567890e-20", "-inf", "0x10", "1e", ".", "1,5"}) {
    const char *first = text.data(), *last = first + text.size();
    const auto a = detail::parse_number(first, last),
               b = detail::parse_number(first, last, detail::from_chars_by_strtod);
    if (a.end != b.end || std::bit_cast<std::uint64_t>(a.value) != std::bit_cast<std::uint64_t>(b.value)) {
      std::printf("strtod reads %s as %.17g, not %.17g\n", text.data(), b.value, a.value);
      return false;
    }
  }
  return true;
}

/// Numbers in the forms that files have them in.
bool read_text() {
  constexpr std::string_view text =
      "MeshVersionFormatted 2\nDimension 3\n"
      "Vertices 4\n0 0 -0.0 1\n+1.5 0 0 1\n0 2.5e-1 0 1\n.1 1e-400 4.9406564584124654e-324 1\n"
      "Tetrahedra 1\n1 2 3 4 7\nEnd\n";
  const Result<MeshData> mesh = read_medit(text, "text");
  if (!mesh) {
    std::puts(mesh.error().message().c_str());
    return false;
  }
  Hash hash;
  hash.add_all(mesh->positions);
  hash.print("text", 0);
  return mesh->positions.size() == 4 &&
         !read_medit("MeshVersionFormatted 2\nDimension 3\nVertices 1\n0x1 0 0 1\n", "text");
}

}  // namespace

int main() {
  const bool read = strtod_agrees() && read_text(), linear = swing<Tet4>("Tet4"), quadratic = swing<Tet10>("Tet10"),
             spun = spin();
  return read && linear && quadratic && spun ? 0 : 1;
}
