// Integrators, options, static equilibrium, snapshots and executors.
#include <corotet/executor.hpp>
#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/snapshot.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/static_solve.hpp>
#include <cstddef>
#include <cstdio>
#include <thread>
#include <vector>

using namespace corotet;
using Body = SoftBody<float, Tet10>;

namespace {

//! [euler]
/// One second of motion. The integrator is made once; then a step allocates nothing.
void simulate(Body& body) {
  ImplicitEuler euler(body);
  for (int step = 0; step < 60; ++step) {
    const StepReport report = euler.step(body, 1.0f / 60);
    if (!report.ok()) std::printf("step %d: %s\n", step, report.advice());
  }
}
//! [euler]

//! [bdf2]
/// The same by the integrator of second order, with Newton's method.
void simulate_accurately(Body& body) {
  Bdf2<Body> bdf2(body, SolverOptions{.tolerance = 1e-6}, {.iterations = 10, .tangent = Tangent::consistent});
  for (int step = 0; step < 60; ++step) {
    const StepReport report = bdf2.step(body, 1.0f / 60);
    if (!report.newton_converged) std::printf("step %d: error %.1e\n", step, report.newton_residual);
  }
}
//! [bdf2]

//! [adaptive]
/// A hard jolt: steps that cannot be trusted are divided into at most 16.
int jolt(Body& body) {
  SubsteppingIntegrator stepper(ImplicitEuler<Body>(body), body,
                                {.on_unreliable = OnUnreliable::divide, .max_halvings = 4});
  for (const Index pin : body.pins().vertices()) body.move_pin(pin, body.position(pin) + Vec3<float>(0.5f, 0, 0));
  const StepReport report = stepper.step(body, 1.0f / 60);
  return report.sub_steps;
}
//! [adaptive]

//! [static]
/// The shape in which the body rests under its weight.
bool hang(Body& body) {
  const StaticReport report = solve_static(body);
  if (!report.converged) std::puts(report.advice());
  return report.converged;
}
//! [static]

//! [snapshot]
/// Steps that are rolled back, and repeat to the last bit.
bool roll_back(Body& body, ImplicitEuler<Body>& euler) {
  std::vector<std::byte> bytes(snapshot_size(body, euler));
  if (!save_snapshot(body, euler, bytes)) return false;
  euler.step(body, 1.0f / 60);
  const Field<float> after = body.displacements();
  if (!restore_snapshot(bytes, body, euler)) return false;
  euler.step(body, 1.0f / 60);
  return body.displacements() == after;
}
//! [snapshot]

//! [solver]
/// A solver by name, with a tighter tolerance than the default.
ImplicitEuler<Body> make_integrator(const Body& body) {
  return ImplicitEuler<Body>(body,
                             SolverOptions{.preconditioner = PreconditionerKind::block_jacobi, .tolerance = 1e-5});
}
//! [solver]

//! [executor]
/// Any parallel loop is an executor: it calls task(i) for each i in [0, count) and returns when all have returned.
void simulate_on_two_threads(Body& body, ImplicitEuler<Body>& euler) {
  const auto two_threads = [](Index count, auto&& task) {
    std::thread other([&] {
      for (Index i = 0; i < count / 2; ++i) task(i);
    });
    for (Index i = count / 2; i < count; ++i) task(i);
    other.join();
  };
  euler.step(body, 1.0f / 60, two_threads);  // a real program keeps its threads: see ThreadPool
}
//! [executor]

}  // namespace

int main() {
  const auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {4, 1, 1}, .order = 2});
  if (!block) return 1;
  const auto mesh = TetMesh<float, Tet10>::create(*block);
  if (!mesh) return 1;
  auto created = Body::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  if (!created) return 1;
  Body& body = *created;
  body.pin_where([](const Vec3<float>& x) { return x.x() == 0; });
  body.set_gravity({0, 0, -9.81f});

  Body jolted = body;
  std::printf("%d steps instead of one\n", jolt(jolted));
  simulate(body);
  simulate_accurately(body);
  ImplicitEuler<Body> euler = make_integrator(body);
  const Body before = body;
  simulate_on_two_threads(body, euler);
  if (body.displacements() == before.displacements()) return 1;
  if (!roll_back(body, euler)) return 1;
  return hang(body) ? 0 : 1;
}
