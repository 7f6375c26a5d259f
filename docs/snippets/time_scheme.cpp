// An integrator of your own: the backward differentiation formula of third order.
#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>
#include <cstddef>
#include <cstdio>

using namespace corotet;

//! [scheme]
/// Steps of one length: gamma = 6 h / 11, x_history = (18 x - 9 x_1 + 2 x_2) / 11. The first two are backward Euler's.
template <class Body>
class Bdf3Scheme {
 public:
  using Scalar = typename Body::scalar_type;

  explicit Bdf3Scheme(const Body& body) : x_(body.displacements()), v_(x_), past_x_{x_, x_}, past_v_{x_, x_} {}

  TimeStep<Scalar> discretize(const Body& body, Scalar h, ExecutorRef) {
    if (steps_ < 2) return backward_euler(body, h);
    const auto combine = [](const auto& now, const auto& last, const auto& before) -> Vec3<Scalar> {
      return (Scalar(18) * now - Scalar(9) * last + Scalar(2) * before) / Scalar(11);
    };
    for (std::size_t i = 0; i < x_.size(); ++i) {
      x_[i] = combine(body.displacements()[i], past_x_[0][i], past_x_[1][i]);
      v_[i] = combine(body.velocities()[i], past_v_[0][i], past_v_[1][i]);
    }
    return {.gamma = 6 * h / 11, .x_history = x_, .v_history = v_, .h = h, .order = 3, .linearization_time = h};
  }

  void accept(const Body&, Scalar, const StepReport&, Field<Scalar>& displacement, Field<Scalar>& velocity) {
    past_x_[0].swap(past_x_[1]);
    past_v_[0].swap(past_v_[1]);
    past_x_[0].swap(displacement);
    past_v_[0].swap(velocity);
    ++steps_;
  }

 private:
  Field<Scalar> x_, v_, past_x_[2], past_v_[2];
  int steps_ = 0;
};
//! [scheme]

int main() {
  const auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {5, 1, 1}});
  if (!block) return 1;
  const auto mesh = TetMesh<double>::create(*block);
  if (!mesh) return 1;
  auto created = SoftBody<double>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  if (!created) return 1;
  //! [use]
  using Body = SoftBody<double>;
  Body& body = *created;
  body.pin_where([](const Vec3<double>& x) { return x.x() == 0; });
  body.set_gravity({0, 0, -9.81});

  Integrator<Body, Bdf3Scheme<Body>, AutoSolver<double>> bdf3(body, AutoSolver<double>({.tolerance = 1e-6}), {});
  for (int step = 0; step < 60; ++step) {
    const StepReport report = bdf3.step(body, 1.0 / 240, {});
    if (!report.ok()) std::puts(report.advice());
  }
  //! [use]
  const double drop = -body.displacements()[at(body.mesh().nearest_vertex({1, 0.1, 0.1}))].z();
  std::printf("the tip has dropped by %.3f m\n", drop);
  return drop > 0.05 && drop < 0.5 ? 0 : 1;
}
