// Nothing of this is run: it instantiates the library for compilers with all warnings on.
#include <corotet/corotet.hpp>
#include <corotet/detail/core/eigen.hpp>
template <class S, class E>
int use() {
  using namespace corotet;
  auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {2, 1, 1}, .order = E::order});
  auto mesh = TetMesh<S, E>::create(*block);
  auto body = SoftBody<S, E>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  if (!body) return 1;
  body->pin_where([](const Vec3<S>& x) { return x.x() < S(0.01); });
  ImplicitEuler euler(*body);
  Bdf2 second_order(*body);
  SubsteppingIntegrator adaptive{ImplicitEuler(*body), *body};
  const bool stepped =
      euler.step(*body, S(0.01)).ok() && second_order.step(*body, S(0.01)).ok() && adaptive.step(*body, S(0.1)).ok();
  SurfaceMesh skin = compact_surface(*extract_boundary(*block), block->positions).surface;
  auto surface = EmbeddedSurface<S, E>::bind(*mesh, skin);
  const Result<MeshData> read = read_mesh("none");
  const auto stuffed = stuff_surface(skin, {.size = 0.1});
  const auto q = measure_quality(*block);
  return stepped && surface && !read && stuffed && q && write_obj("x", skin).ok() && write_msh("x", *block).ok() ? 0
                                                                                                                 : 1;
}
int main() {
  return use<float, corotet::Tet4>() + use<double, corotet::Tet10>() + use<double, corotet::Tet4>() +
         use<float, corotet::Tet10>();
}
