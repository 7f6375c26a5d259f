// Meshes, materials, bodies and their models.
#include <array>
#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>
#include <cstdio>
#include <vector>

using namespace corotet;

namespace {

//! [mesh]
/// Two tetrahedra that share a face, from arrays.
Result<TetMesh<float>> make_two_tetrahedra() {
  MeshData data;
  data.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};  // m
  data.connectivity = {0, 1, 2, 3, 1, 2, 3, 4};
  return TetMesh<float>::create(data);  // an error names the element that is inverted, or the index out of range
}
//! [mesh]

//! [body]
/// A beam of rubber, held at one end.
Result<SoftBody<float, Tet10>> make_beam() {
  const auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {10, 2, 2}, .order = 2});
  if (!block) return block.error();
  const auto mesh = TetMesh<float, Tet10>::create(*block);
  if (!mesh) return mesh.error();
  auto body = SoftBody<float, Tet10>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  if (!body) return body.error();
  body->pin_where([](const Vec3<float>& x) { return x.x() == 0; });
  body->set_gravity({0, 0, -9.81f});
  return body;
}
//! [body]

//! [model]
/// A hundred copies of a body share mesh, law, mass and the pattern of the matrix.
std::vector<SoftBody<float>> make_copies(const TetMesh<float>& mesh) {
  const auto model = BodyModel<float>::create(mesh, Material{.young = 2e5, .poisson = 0.4, .density = 900});
  if (!model) return {};
  return std::vector<SoftBody<float>>(100, SoftBody<float>(*model));
}
//! [model]

//! [materials]
/// A material for each element: the lower half is ten times as stiff.
Result<void> stiffen_lower_half(SoftBody<float>& body) {
  std::vector<Material> materials;
  for (const auto& nodes : body.mesh().elements()) {
    float height = 0;
    for (const Index v : nodes) height += body.mesh().position(v).z() / 4;
    materials.push_back({.young = height < 0.5f ? 5e6 : 5e5, .poisson = 0.3, .density = 1000});
  }
  return body.set_materials(materials);
}
//! [materials]

int fail(const Error& error) { return std::fprintf(stderr, "%s\n", error.message().c_str()), 1; }

}  // namespace

int main() {
  const auto mesh = make_two_tetrahedra();
  if (!mesh) return fail(mesh.error());
  auto copies = make_copies(*mesh);
  if (copies.size() != 100 || copies.front().model() != copies.back().model()) return 1;
  if (const Result<void> changed = stiffen_lower_half(copies.front()); !changed) return fail(changed.error());
  auto beam = make_beam();
  if (!beam) return fail(beam.error());
  std::printf("%d pins\n", size_of(beam->pins().vertices()));
  return beam->pins().vertices().size() == 25 ? 0 : 1;
}
