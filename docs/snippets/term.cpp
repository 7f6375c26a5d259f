// A term of your own: a vertex is tied to a moving point by a spring.
#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/terms.hpp>
#include <cstdio>

using namespace corotet;

//! [term]
/// A spring of length zero from a vertex to a point.
class Tether final : public StepTerm<float> {
 public:
  Tether(Index vertex, float stiffness) : vertex_(vertex), stiffness_(stiffness) {}

  Vec3<float> point = {0, 0, 0};  ///< m, relative to the body's origin

  void add_force(const TermState<float>& state, TermForces<float>& out) override {
    if (state.contains(vertex_)) out.add(vertex_, stiffness_ * (point - state.position(vertex_)));
  }
  void add_stiffness(const TermState<float>& state, TermStiffness<float>& out) override {
    if (state.contains(vertex_)) out.add_stiffness(vertex_, vertex_, stiffness_ * Mat3<float>::Identity());
  }
  bool has_energy() const override { return true; }
  double energy(const TermState<float>& state) override {
    if (!state.contains(vertex_)) return 0;
    return stiffness_ / 2 * (state.position(vertex_) - point).squaredNorm();
  }

 private:
  Index vertex_;
  float stiffness_;  // N/m
};
//! [term]

int main() {
  const auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {5, 1, 1}});
  if (!block) return 1;
  const auto mesh = TetMesh<float>::create(*block);
  if (!mesh) return 1;
  auto created = SoftBody<float>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000},
                                         {.damping = {.mass = 4, .stiffness = 0.01}});
  if (!created) return 1;
  SoftBody<float>& body = *created;
  body.set_gravity({0, 0, -9.81f});
  //! [use]
  const Index corner = body.mesh().nearest_vertex({0, 0, 0.2f});
  Tether tether(corner, 1e5f);
  tether.point = body.position(corner);

  StepContext<float> context;
  context.terms = tether;
  ImplicitEuler euler(body);
  for (int step = 0; step < 300; ++step) {
    const StepReport report = euler.step(body, 1.0f / 60, context);
    if (!report.ok()) std::puts(report.advice());
  }
  //! [use]
  const float stretch = (body.position(corner) - tether.point).norm();  // weight / stiffness: 40 kg by 1e5 N/m
  std::printf("the tether is %.4f m long\n", stretch);
  return stretch > 0.0037f && stretch < 0.0041f ? 0 : 1;
}
