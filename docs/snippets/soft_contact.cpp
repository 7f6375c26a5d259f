// Soft blocks fall onto each other.
#include <array>
#include <corotet/contact.hpp>
#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/soft_contact.hpp>
#include <cstdio>
#include <vector>

using namespace corotet;

int main() {
  const auto block = make_block({.corner = {0, 0, 0}, .size = {0.2, 0.2, 0.2}, .cells = {3, 3, 3}});
  if (!block) return 1;
  const auto mesh = TetMesh<float>::create(*block);
  if (!mesh) return 1;
  const auto model = BodyModel<float, Tet4>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  if (!model) return 1;
  constexpr float h = 1.0f / 60;

  //! [soft]
  std::vector<SoftBody<float>> bodies;
  std::vector<ImplicitEuler<SoftBody<float>>> integrators;  // one a body
  std::vector<Contacts<float>> floors;                      // likewise
  Obstacles obstacles;
  obstacles.add(HalfSpace{.normal = {0, 0, 1}, .offset = 0});
  SoftContacts<float> soft({.friction = 0.5});
  for (int i = 0; i < 3; ++i) {
    SoftBody<float> body(*model);
    Field<float> u(static_cast<std::size_t>(body.vertex_count()));
    for (Vec3<float>& move : u) move = {0.02f * static_cast<float>(i), 0, 0.21f * static_cast<float>(i)};
    body.set_gravity({0, 0, -9.81f});
    const auto surface = ContactSurface::boundary(body.mesh());
    if (!body.set_displacements(u) || !surface) return 1;
    soft.add(*surface);
    integrators.emplace_back(body);
    floors.emplace_back(surface->points(), obstacles, ContactOptions{.friction = 0.5});
    bodies.push_back(std::move(body));
  }
  for (int step = 0; step < 180; ++step) {
    soft.step([&](Index i, StepTerm<float>& touching) {
      const auto b = static_cast<std::size_t>(i);
      const std::array<StepTerm<float>*, 2> terms{&floors[b], &touching};
      StepContext<float> context;
      context.terms = Terms<float>(terms);
      const StepReport report = integrators[b].step(bodies[b], h, context);
      if (!report.ok()) std::puts(report.advice());
    });
    obstacles.advance(h);
  }
  const double between = soft.report().normal_force;  // N, summed over all contacts
  //! [soft]
  const double on_floor = floors[0].report().normal_force;
  std::printf("%d contacts bear %.0f N, the floor %.0f N\n", soft.report().touching, between, on_floor);
  const double weight = bodies[0].mass().total() * 9.81;
  return between > 2.8 * weight && between < 3.2 * weight && on_floor > 2.9 * weight && on_floor < 3.1 * weight ? 0 : 1;
}
