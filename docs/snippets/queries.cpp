// Points of a body, measures of its elements, forces of its pins, threads.
#include <algorithm>
#include <corotet/integrators.hpp>
#include <corotet/measures.hpp>
#include <corotet/mesh.hpp>
#include <corotet/points.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/static_solve.hpp>
#include <corotet/thread_pool.hpp>
#include <cstdio>
#include <span>
#include <vector>

using namespace corotet;
using Body = SoftBody<float, Tet10>;

namespace {

//! [points]
/// Strikes the point of the body that is nearest to `where` (m, at rest), and returns its velocity after.
Vec3<float> strike(Body& body, const Vec3<double>& where, const Vec3<float>& impulse) {
  const PointLocator locator(body.mesh());  // made once for a mesh
  const LocatedPoint<Tet10> point = locator.locate(where);
  if (!point.found() || !apply_impulse_at(body, point, impulse)) return Vec3<float>::Zero();
  return velocity_at(body, point);
}
//! [points]

//! [measures]
/// The largest von Mises stress of the body as it is now, Pa.
float max_stress(const Body& body) {
  std::vector<ElementMeasures<float>> measures(at(body.mesh().element_count()));
  element_measures(body, std::span(measures));
  float largest = 0;
  for (const ElementMeasures<float>& m : measures) largest = std::max(largest, m.von_mises);
  return largest;
}
//! [measures]

//! [reactions]
/// What the pins of a body at rest carry, N.
Vec3<double> carried_by_pins(const Body& body) {
  PinReactions reactions(body);
  reactions.evaluate_static(body);
  return reactions.total_force();
}
//! [reactions]

//! [pool]
/// One second on four threads. The pool is made once; its threads sleep between steps.
void simulate(Body& body) {
  ThreadPool pool(4);
  ImplicitEuler euler(body);
  for (int step = 0; step < 60; ++step) euler.step(body, 1.0f / 60, pool);
}
//! [pool]

}  // namespace

int main() {
  const auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {4, 1, 1}, .order = 2});
  if (!block) return 1;
  const auto mesh = TetMesh<float, Tet10>::create(*block);
  if (!mesh) return 1;
  auto body = Body::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  if (!body) return 1;
  body->pin_where([](const Vec3<float>& x) { return x.x() == 0; });
  if (!(strike(*body, {1, 0.1, 0.1}, {0, 0, 1}).z() > 0)) return 1;
  body->set_gravity({0, 0, -9.81f});
  simulate(*body);
  if (!(max_stress(*body) > 0) || !solve_static(*body).converged) return 1;
  const double carried = carried_by_pins(*body).z(), weight = 9.81 * body->mass().total();
  std::printf("the pins carry %.1f N of %.1f N\n", carried, weight);
  return carried > 0.99 * weight && carried < 1.01 * weight ? 0 : 1;
}
