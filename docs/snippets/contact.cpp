// A soft block falls on a floor, carries a crate, and is grabbed.
#include <array>
#include <corotet/attachment.hpp>
#include <corotet/contact.hpp>
#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/points.hpp>
#include <corotet/sleep.hpp>
#include <corotet/soft_body.hpp>
#include <cstdio>

using namespace corotet;

int main() {
  const auto block = make_block({.corner = {0, 0, 0.01}, .size = {0.4, 0.4, 0.2}, .cells = {4, 4, 2}});
  if (!block) return 1;
  const auto mesh = TetMesh<float>::create(*block);
  if (!mesh) return 1;
  auto created = SoftBody<float>::create(*mesh, Material{.young = 1e5, .poisson = 0.3, .density = 1000});
  if (!created) return 1;
  SoftBody<float>& body = *created;
  body.set_gravity({0, 0, -9.81f});
  ImplicitEuler euler(body);
  constexpr float h = 1.0f / 60;

  //! [contact]
  Obstacles obstacles;
  obstacles.gravity = {0, 0, -9.81};
  obstacles.add(HalfSpace{.normal = {0, 0, 1}, .offset = 0});
  const Index crate =
      obstacles.add(OrientedBox{{0.1, 0.1, 0.1}}, {.pose = {.position = {0.2, 0.2, 0.5}}, .friction = 0.6, .mass = 4});

  auto points = ContactPoints::boundary(body.mesh());
  if (!points) return 1;
  Contacts<float> contacts(*points, obstacles, {.friction = 0.5});
  StepContext<float> context;
  context.terms = contacts;
  for (int step = 0; step < 300; ++step) {
    const StepReport report = euler.step(body, h, context);
    if (!report.ok()) std::puts(report.advice());
    obstacles.advance(h);  // moves the crate
  }
  const double on_floor = contacts.report().normal_force;  // of floor and crate, N
  //! [contact]
  std::printf("%d of %d points touch, with %.0f N; the crate is at z = %.3f m\n", contacts.report().touching,
              contacts.points().size(), on_floor, obstacles[crate].pose().position.z());

  //! [attachment]
  const PointLocator locator(body.mesh());
  const auto corner = locator.locate(Vec3<double>(0, 0, 0.21));
  Attachment<float> grab(corner, {.stiffness = 1e4, .damping = 100});
  const std::array<StepTerm<float>*, 2> both{&contacts, &grab};
  context.terms = Terms<float>(both);
  for (int step = 0; step < 120; ++step) {
    grab.set_target({0, 0, 0.2 + 0.3 * (step + 1) / 120}, {0, 0, 0.15});
    const StepReport report = euler.step(body, h, context);
    if (!report.ok()) std::puts(report.advice());
    obstacles.advance(h);
  }
  //! [attachment]

  context.terms = contacts;
  //! [sleep]
  Sleep sleep(obstacles);
  const Index sleeper = sleep.add();  // one for each body
  for (int step = 0; step < 600; ++step) {
    sleep.step(sleeper, euler, body, h, context);  // steps the body, unless it sleeps
    obstacles.advance(h);
  }
  //! [sleep]
  if (!sleep.is_asleep(sleeper)) return 1;

  const SurfaceMesh surface = compact_surface(*extract_boundary(*block), block->positions).surface;
  //! [mesh]
  const auto rock = MeshCollider::create_centred(surface);
  if (!rock) return 1;  // rock.error().message() names the triangle
  const Index boulder =
      obstacles.add(*rock, {.pose = rock->obstacle_pose({.position = {0.2, 0.2, 2}}),  // the mesh is put there
                            .mass = 2600 * rock->properties().volume});
  const Pose drawn = rock->mesh_pose(obstacles[boulder].pose());
  //! [mesh]
  if (!((drawn.position - Vec3<double>(0.2, 0.2, 2)).norm() < 1e-12)) return 1;
  std::printf("the grab pulls with %.0f N\n", grab.force().norm());
  const double weight = (body.mass().total() + 4) * 9.81;
  return on_floor > 0.9 * weight && grab.force().z() > 10 ? 0 : 1;
}
