#include <corotet/corotet.hpp>
#include <cstdio>

corotet::AssertHandler* handler_seen_by_other();
float fall_in_other(float h);

int main() {
  // One program has one assertion handler, and both files agree on what the library does.
  if (&corotet::assert_handler != handler_seen_by_other()) return 1;
  const corotet::Result<corotet::MeshData> block = corotet::make_block({.cells = {2, 1, 1}});
  if (!block) return 2;
  const auto mesh = corotet::TetMesh<float>::create(*block);
  if (!mesh) return 3;
  auto body = corotet::SoftBody<float>::create(*mesh, corotet::Material{});
  if (!body) return 4;
  body->set_gravity({0, -10, 0});
  corotet::ImplicitEuler euler(*body);
  if (!euler.step(*body, 0.1f).ok()) return 5;
  if (body->displacements()[0].y() != fall_in_other(0.1f)) return 6;
  if (euler.step(*body, -1.0f).error != corotet::StepError::time_step) return 7;
  std::printf("corotet %d.%d.%d\n", COROTET_VERSION_MAJOR, COROTET_VERSION_MINOR, COROTET_VERSION_PATCH);
  return 0;
}
