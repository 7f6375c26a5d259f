// The simulation of one scalar, element and rotation. Included by the four files that instantiate it.
#pragma once

#include <corotet/detail/assembly/assemble.hpp>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/thread_pool.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/dynamics/static_solve.hpp>
#include <corotet/detail/dynamics/step_context.hpp>
#include <corotet/detail/dynamics/substepping_integrator.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <corotet/detail/rotation/gram_schmidt.hpp>
#include <corotet/detail/rotation/identity.hpp>
#include <corotet/detail/rotation/per_element.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "contact_terms.hpp"
#include "failure.hpp"
#include "local_origin.hpp"
#include "plain_product.hpp"
#include "problems.hpp"
#include "simulation.hpp"
#include "timing.hpp"

namespace corotet::program {

template <class Scalar, class Element, class Rotation>
class TypedSimulation final : public Simulation {
 public:
  using Body = SoftBody<Scalar, Element, Rotation>;

  TypedSimulation(const Scene& scene, const MeshData& mesh)
      : body_(make_body(scene, mesh)), integrator_(make_integrator(scene, body_)), dt_(static_cast<Scalar>(scene.dt)) {
    body_.set_gravity(scene.gravity.cast<Scalar>());
  }

  [[nodiscard]] SimulationFacts facts() const override {
    SimulationFacts facts;
    facts.vertices = body_.vertex_count();
    facts.elements = body_.mesh().element_count();
    facts.flipped_elements = body_.mesh().flipped_elements();
    facts.origin = body_.mesh().origin();
    facts.mass = body_.mass().total();
    const auto& solver =
        std::visit([](const auto& i) -> const AutoSolver<Scalar>& { return i.integrator().solver(); }, integrator_);
    facts.solver = solver.method() == SolverMethod::cholesky ? "cholesky" : "pcg";
    if (solver.method() != SolverMethod::cholesky) facts.preconditioner = name_of(solver.preconditioner());
    facts.predicted_products = solver.predicted_products();
    return facts;
  }

  Result<void> set_positions(const Field<double>& positions) override {
    Field<Scalar> displacements(positions.size());
    for (Index v = 0; v < size_of(positions); ++v)
      displacements[at(v)] = (positions[at(v)] - rest(v)).template cast<Scalar>();
    return body_.set_displacements(displacements);
  }

  Result<void> set_velocities(const Field<double>& velocities) override {
    Field<Scalar> rounded;
    rounded.reserve(velocities.size());
    for (const Vec3<double>& v : velocities) rounded.push_back(v.template cast<Scalar>());
    return body_.set_velocities(rounded);
  }

  Result<void> set_materials(const Materials& materials) override { return body_.set_materials(materials); }

  void set_forces(const Field<double>& forces) override {
    for (Index v = 0; v < size_of(forces); ++v) body_.external_forces()[at(v)] = forces[at(v)].template cast<Scalar>();
  }

  void pin(Index vertex) override {
    const Vec3<Scalar>& here = body_.displacements()[at(vertex)];
    body_.pins().pin(vertex, here);
    pinned_at_.resize(at(body_.vertex_count()));
    pinned_at_[at(vertex)] = here;
  }

  void release(Index vertex) override { body_.pins().release(vertex); }

  void move_pin(Index vertex, const Vec3<double>& displacement) override {
    body_.pins().move(vertex, pinned_at_[at(vertex)] + displacement.cast<Scalar>());
  }

  StepReport step(double h, ThreadPool& pool, PhaseClock& clock) override {
    const StepContext<Scalar> context{pool, clock, terms_.terms(), {}};
    return std::visit([&](auto& i) { return i.step(body_, static_cast<Scalar>(h), context); }, integrator_);
  }

  Result<void> touch(Obstacles& obstacles, const ContactScene& contact) override {
    if (contact.points == TouchingPoints::surface) {
      terms_.touch(ContactPoints(*surface_, body_.mesh()), obstacles, contact.options);
      return {};
    }
    auto points = ContactPoints::boundary(body_.mesh());
    if (!points) return points.error();
    terms_.touch(std::move(points).value(), obstacles, contact.options);
    return {};
  }

  std::vector<PointOnBody> attach(const std::vector<AttachmentEntry>& attachments) override {
    Field<double> asked;
    for (const AttachmentEntry& attachment : attachments) asked.push_back(attachment.nearest);
    std::vector<PointOnBody> points;
    for (const BodyPoint<Element>& point : nearest_body_points(body_.mesh(), asked)) {
      terms_.attach(point, attachments[points.size()].options);
      points.push_back({{point.vertices.begin(), point.vertices.end()}, {point.weights.begin(), point.weights.end()}});
    }
    return points;
  }

  [[nodiscard]] ContactTerms& contact_terms() override { return terms_; }

  StaticReport solve_static(ThreadPool& pool) override { return corotet::solve_static(body_, {}, {.executor = pool}); }

  [[nodiscard]] Vec3<double> position(Index vertex) const override { return rest(vertex) + displacement(vertex); }
  [[nodiscard]] Vec3<double> displacement(Index vertex) const override {
    return body_.displacements()[at(vertex)].template cast<double>();
  }
  [[nodiscard]] Vec3<double> velocity(Index vertex) const override {
    return body_.velocities()[at(vertex)].template cast<double>();
  }

  Result<BindingFacts> bind(const SurfaceMesh& surface, ThreadPool& pool) override {
    auto bound = EmbeddedSurface<Scalar, Element>::bind(body_.mesh(), surface, pool);
    if (!bound) return bound.error();
    surface_ = std::move(bound).value();
    return BindingFacts{surface_->outside_count(), surface_->max_distance()};
  }

  [[nodiscard]] SurfaceState surface() override {
    const std::size_t count = at(surface_->vertex_count());
    Field<Scalar> vectors(count);
    SurfaceState state;
    state.positions.reserve(count);
    surface_->positions(body_.displacements(), vectors);
    for (const Vec3<Scalar>& x : vectors)
      state.positions.emplace_back(x.template cast<double>() + body_.mesh().origin());
    if (!surface_->has_normals()) return state;
    state.normals.reserve(count);
    surface_->normals(body_.displacements(), vectors);
    for (const Vec3<Scalar>& n : vectors) state.normals.emplace_back(n.template cast<double>());
    return state;
  }

  [[nodiscard]] double vertex_mass(Index vertex) const override {
    return static_cast<double>(body_.mass().row_sum(vertex));
  }

  [[nodiscard]] double elastic_energy() const override { return body_.law().energy(body_.displacements()); }

  [[nodiscard]] double stiffness_product(const Field<double>& change) const override {
    const BlockMatrix<Scalar> stiffness = present_matrix(0, 1);
    const BlockPattern& p = stiffness.pattern();
    double sum = 0;
    for (Index i = 0; i < stiffness.rows(); ++i)
      for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k)
        sum += change[at(i)].dot(stiffness.block(k).template cast<double>() * change[at(p.column[at(k)])]);
    return sum;
  }

  [[nodiscard]] double measure_spmv_us() const override {
    const BlockMatrix<float> matrix = step_matrix();
    Field<float> x(at(matrix.rows()), Vec3<float>::Ones()), y(x);
    return median_us([&] {
      plain_product(matrix, x, y);
      x.front()[0] = y.front()[0] > 0 ? 1.0F : 0.5F;  // each product needs the one before it: none can be left out
    });
  }

  [[nodiscard]] KernelTimes measure_kernels(ThreadPool& pool) const override {
    typename Body::Law::Evaluation state(body_.law());
    BlockMatrix<Scalar> matrix(body_.pattern());
    Field<Scalar> x(at(matrix.rows()), Vec3<Scalar>::Ones()), y(x);
    KernelTimes times;
    times.evaluate_us = median_us([&] { body_.law().evaluate(body_.displacements(), state, pool); });
    times.assemble_us =
        median_us([&] { assemble(body_.law(), state, body_.mass(), Scalar(1), dt_ * dt_, matrix, pool); });
    times.product_us = median_us([&] { matrix.apply(x, y, pool); });
    return times;
  }

 private:
  using Euler = SubsteppingIntegrator<ImplicitEuler<Body>, Body>;
  using SecondOrder = SubsteppingIntegrator<Bdf2<Body>, Body>;
  using Integrator = std::variant<Euler, SecondOrder>;

  static Integrator make_integrator(const Scene& scene, const Body& body) {
    const SubsteppingOptions trust{.on_unreliable = scene.untrusted};
    if (scene.integrator == IntegratorKind::bdf2)
      return SecondOrder(Bdf2<Body>(body, scene.solver, scene.newton), body, trust);
    return Euler(ImplicitEuler<Body>(body, scene.solver, scene.newton), body, trust);
  }

  static Body make_body(const Scene& scene, const MeshData& mesh) {
    Problems problems(scene.file.string(), scene.key_prefix);
    auto checked = TetMesh<Scalar, Element>::create(mesh, local_origin<Scalar>(mesh));
    if (!checked) {
      const bool unused_vertex = checked.error().code == ErrorCode::unreferenced_vertex;
      problems.add("mesh", scene.mesh.string() + ": " + checked.error().message() +
                               (unused_vertex ? "; `corotet mesh --from FILE --clean` writes a mesh without it" : ""));
    }
    problems.stop_if_any();
    return require(
        Body::create(std::move(checked).value(), scene.material,
                     {.mass = scene.mass, .damping = scene.damping, .volumetric_strain = scene.volumetric_strain}));
  }

  [[nodiscard]] Vec3<double> rest(Index vertex) const {
    return body_.mesh().origin() + body_.mesh().position(vertex).template cast<double>();
  }

  /// mass_factor M + stiffness_factor K' of the present state.
  [[nodiscard]] BlockMatrix<Scalar> present_matrix(Scalar mass_factor, Scalar stiffness_factor) const {
    SerialExecutor serial;
    typename Body::Law::Evaluation state(body_.law());
    body_.law().evaluate(body_.displacements(), state, serial);
    BlockMatrix<Scalar> matrix(body_.pattern());
    assemble(body_.law(), state, body_.mass(), mass_factor, stiffness_factor, matrix, serial);
    return matrix;
  }

  /// M + h^2 K' of the present state.
  [[nodiscard]] BlockMatrix<float> step_matrix() const {
    const BlockMatrix<Scalar> matrix = present_matrix(Scalar(1), dt_ * dt_);
    if constexpr (std::is_same_v<Scalar, float>) {
      return matrix;
    } else {
      BlockMatrix<float> rounded(body_.pattern());
      for (Index slot = 0; slot < body_.pattern()->blocks(); ++slot)
        rounded.block(slot) = matrix.block(slot).template cast<float>();
      return rounded;
    }
  }

  Body body_;
  Integrator integrator_;
  Scalar dt_;
  Field<Scalar> pinned_at_;
  std::optional<EmbeddedSurface<Scalar, Element>> surface_;
  TypedContactTerms<Scalar> terms_;
};

/// The rotation that the scene names.
template <class Scalar, class Element>
std::unique_ptr<Simulation> make_typed_simulation(const Scene& scene, const MeshData& mesh) {
  const auto make = [&]<class Rotation>() -> std::unique_ptr<Simulation> {
    return std::make_unique<TypedSimulation<Scalar, Element, Rotation>>(scene, mesh);
  };
  // A 4-node element has one point: both sites are the same there. So are they for the identity.
  const bool per_element = Element::order > 1 && scene.rotation_site == RotationSite::element;
  if (scene.rotation == RotationKind::identity) return make.template operator()<Identity>();
  if constexpr (Element::order > 1) {
    if (per_element && scene.rotation == RotationKind::polar) return make.template operator()<PerElement<Polar>>();
    if (per_element) return make.template operator()<PerElement<GramSchmidt>>();
  }
  if (scene.rotation == RotationKind::gram_schmidt) return make.template operator()<GramSchmidt>();
  return make.template operator()<Polar>();
}

extern template std::unique_ptr<Simulation> make_typed_simulation<float, Tet4>(const Scene&, const MeshData&);
extern template std::unique_ptr<Simulation> make_typed_simulation<float, Tet10>(const Scene&, const MeshData&);
extern template std::unique_ptr<Simulation> make_typed_simulation<double, Tet4>(const Scene&, const MeshData&);
extern template std::unique_ptr<Simulation> make_typed_simulation<double, Tet10>(const Scene&, const MeshData&);

}  // namespace corotet::program
