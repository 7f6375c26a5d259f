#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>
#include <cstdio>

using namespace corotet;

int fail(const Error& error) { return std::fprintf(stderr, "%s\n", error.message().c_str()), 1; }

int main() {
  auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {10, 2, 2}, .order = 2});  // a beam, m
  if (!block) return fail(block.error());
  auto mesh = TetMesh<float, Tet10>::create(*block);
  if (!mesh) return fail(mesh.error());
  auto body = SoftBody<float, Tet10>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  if (!body) return fail(body.error());
  body->pin_where([](const Vec3<float>& x) { return x.x() == 0; });
  body->set_gravity({0, 0, -9.81f});

  ImplicitEuler euler(*body);
  const Index tip = mesh->nearest_vertex({1, 0.1f, 0.1f});
  for (int frame = 1; frame <= 60; ++frame) {
    const StepReport report = euler.step(*body, 1.0f / 60);
    if (!report.ok()) std::puts(report.advice());
    if (frame % 15 == 0) std::printf("frame %d: the tip has moved by %.3f m\n", frame, body->displacements()[tip].z());
  }
}
