#include <corotet/cholmod.hpp>
#include <corotet/corotet.hpp>

// Runs before main; a wrong result ends the program, which the test sees.
static const bool cholmod_steps = [] {
  using Body = corotet::SoftBody<float>;
  auto body = Body::create(*corotet::TetMesh<float>::create(*corotet::make_block({})), corotet::Material{});
  body->set_gravity({0, -10, 0});
  corotet::ImplicitEuler<Body, corotet::CholmodSolver<float>> euler(*body);
  return euler.step(*body, 0.1f).accepted() ? true : (__builtin_trap(), false);
}();
