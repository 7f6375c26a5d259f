// The second translation unit: a function or variable that a header defines without `inline` fails to link.
#include <corotet/corotet.hpp>

corotet::AssertHandler* handler_seen_by_other();
float fall_in_other(float h);

corotet::AssertHandler* handler_seen_by_other() { return &corotet::assert_handler; }

float fall_in_other(float h) {
  const corotet::Result<corotet::MeshData> block = corotet::make_block({.cells = {2, 1, 1}});
  auto body = corotet::SoftBody<float>::create(*corotet::TetMesh<float>::create(*block), corotet::Material{});
  body->set_gravity({0, -10, 0});
  corotet::ImplicitEuler euler(*body);
  return euler.step(*body, h).ok() ? body->displacements()[0].y() : 0.0f;
}
