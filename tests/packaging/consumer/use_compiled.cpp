#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>

#if !defined(COROTET_COMPILED)
#error "corotet::compiled does not say that the instances are compiled"
#endif

// Runs before main; a wrong result ends the program, which the test sees.
static const bool the_library_steps = [] {
  using Body = corotet::SoftBody<float, corotet::Tet10>;
  auto mesh = corotet::TetMesh<float, corotet::Tet10>::create(*corotet::make_block({.order = 2}));
  auto body = Body::create(*mesh, corotet::Material{});
  body->set_gravity({0, -10, 0});
  corotet::ImplicitEuler<Body> euler(*body);
  return euler.step(*body, 0.1f).ok() ? true : (__builtin_trap(), false);
}();
