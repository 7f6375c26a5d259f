// A soft body: what it is made of, where it is, how fast it moves, what holds it and what pulls at it.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/instances.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/message.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/span_of.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/body_model.hpp>
#include <corotet/detail/dynamics/pins.hpp>
#include <corotet/detail/material/corotated.hpp>
#include <corotet/detail/material/elastic_model.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/material/point_states.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <corotet/detail/terms/body_terms.hpp>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace corotet::inline v0_1 {

/// A soft body: a BodyModel, which copies share, and a state with its pins, gravity and forces.
///
/// Use one for each thing that deforms. An integrator (ImplicitEuler, Bdf2) moves it, and EmbeddedSurface draws it. For
/// stiffness and mass matrices alone use Elasticity, Mass and `assemble`.
/// @snippet bodies.cpp body
/// The state is a displacement from rest and a velocity, relative to `origin()`, so that float keeps its digits
/// wherever the rest configuration lies. The displacement of a body that travels many times its size is large: `rebase`
/// moves the origin after it.
template <std::floating_point Scalar, ReferenceElement Element = Tet4, ElasticLaw LawType = Polar>
class SoftBody : private PointStates<Scalar, detail::ElasticModelOf<LawType>> {
 public:
  using scalar_type = Scalar;  ///< float or double
  /// Tet4, Tet10 or one of your own
  using element_type = Element;
  using Mesh = TetMesh<Scalar, Element>;                                ///< of the body
  using Law = Elasticity<Scalar, Element, LawType>;                     ///< the elastic law on the mesh
  using Model = BodyModel<Scalar, Element, LawType>;                    ///< what copies of the body share
  using States = PointStates<Scalar, detail::ElasticModelOf<LawType>>;  ///< of the material at each quadrature point

  /// A body at rest in its rest shape, free of pins, gravity and forces, of a model of its own. Errors: as
  /// BodyModel::create.
  [[nodiscard]] COROTET_COLD static Result<SoftBody> create(Mesh mesh, const Materials& materials,
                                                            const BodyOptions& options = {});

  /// The same of a model that others may share.
  COROTET_COLD explicit SoftBody(std::shared_ptr<const Model> model);

  /// Mesh, law and mass, shared by copies of the body.
  [[nodiscard]] const std::shared_ptr<const Model>& model() const { return model_; }
  /// Mesh in the rest configuration.
  [[nodiscard]] const Mesh& mesh() const { return model_->mesh(); }
  /// Elastic law: forces and energies of elements.
  [[nodiscard]] const Law& law() const { return model_->law(); }
  /// Mass matrix.
  [[nodiscard]] const Mass<Scalar>& mass() const { return model_->mass(); }
  /// Rayleigh damping, 1/s and s.
  [[nodiscard]] const RayleighDamping& damping() const { return damping_.damping; }
  /// Which vertices the matrices couple.
  [[nodiscard]] const std::shared_ptr<const BlockPattern>& pattern() const { return model_->pattern(); }
  /// Number of vertices.
  [[nodiscard]] Index vertex_count() const { return mesh().vertex_count(); }

  /// m and m/s, one a vertex.
  [[nodiscard]] const Field<Scalar>& displacements() const { return displacement_; }
  /// Velocities, m/s, one a vertex.
  [[nodiscard]] const Field<Scalar>& velocities() const { return velocity_; }

  /// Of the body's coordinates in the world, m: mesh().origin() until `rebase` moves it.
  [[nodiscard]] Vec3<double> origin() const { return mesh().origin() + shift_; }
  /// By how much it has moved, m.
  [[nodiscard]] const Vec3<double>& origin_shift() const { return shift_; }

  /// Where a vertex is now, m, relative to `origin()`.
  [[nodiscard]] Vec3<Scalar> position(Index vertex) const {
    return mesh().position(vertex) + displacement_[at(vertex)];
  }

  /// Replaces the state. Errors: invalid_argument (length), non_finite_value (names the vertex); nothing changes then.
  COROTET_COLD Result<void> set_displacements(std::span<const Vec3<Scalar>> displacement);
  /// Sets all velocities, m/s, one a vertex. Refused if one is not finite or their number is another.
  COROTET_COLD Result<void> set_velocities(std::span<const Vec3<Scalar>> velocity);

  /// Moves the body to world positions (m) and sets its velocities (m/s), one a vertex; the origin moves along, so that
  /// displacements are as small as may be. Pins keep their places in the world. Errors as before; nothing changes then.
  COROTET_COLD Result<void> set_state(std::span<const Vec3<double>> positions, std::span<const Vec3<Scalar>> velocity);

  /// Moves the origin to where the mean displacement is zero, which gives float its digits back. Nothing moves in the
  /// world, and integrators go on as if nothing had happened.
  void rebase();
  /// The same by a given shift, m.
  void rebase(const Vec3<Scalar>& shift);

  /// The state of the material at each quadrature point; empty for a model without state.
  [[nodiscard]] const States& point_states() const { return *this; }
  /// Replaces it, by what point_states() of a body with this model returned.
  void set_point_states(const States& states);

  /// For integrators, once a step is accepted: the trial states of `evaluation`, which must be that of the body's
  /// present displacement, become the body's. Nothing for a model without state.
  void commit(const typename Law::Evaluation& evaluation);

  /// The law evaluated with the body's point states: see Elasticity.
  void evaluate(const Field<Scalar>& displacement, typename Law::Evaluation& out, ExecutorRef executor) const;
  /// W at a displacement, J. `scratch` has law().mean_dilatation().scratch_size() entries. Allocates nothing.
  [[nodiscard]] double elastic_energy(const Field<Scalar>& displacement, std::span<double> scratch,
                                      ExecutorRef executor) const;

  /// Vertices held in place or led along a path.
  [[nodiscard]] Pins<Scalar>& pins() { return pins_; }
  /// Vertices whose motion is prescribed.
  [[nodiscard]] const Pins<Scalar>& pins() const { return pins_; }

  /// Pins each vertex whose rest position (relative to the origin) satisfies `predicate`, where it is now; along some
  /// axes alone, if asked for. Returns how many.
  template <std::predicate<const Vec3<Scalar>&> Predicate>
  Index pin_where(Predicate&& predicate, PinnedAxes axes = {}) {
    Index count = 0;
    for (Index v = 0; v < vertex_count(); ++v)
      if (predicate(mesh().position(v))) {
        pins_.pin(v, displacement_[at(v)], axes);
        ++count;
      }
    return count;
  }

  /// Leads a pinned vertex: it will be at `position` (m, relative to `origin()`) after the next step.
  void move_pin(Index vertex, const Vec3<Scalar>& position) {
    COROTET_ASSERT(pins_.is_pinned(vertex), "pin the vertex before moving it");
    if (pins_.is_pinned(vertex)) pins_.move(vertex, position - mesh().position(vertex));
  }

  /// m/s^2.
  void set_gravity(const Vec3<Scalar>& gravity) { gravity_.acceleration = gravity; }
  /// Gravity, m/s^2.
  [[nodiscard]] const Vec3<Scalar>& gravity() const { return gravity_.acceleration; }

  /// Force on each vertex, N, besides gravity; zero until the caller writes to it, and kept from step to step. Ask for
  /// it again to write again: a body that sleeps (Sleep) is looked at only then.
  [[nodiscard]] std::span<Vec3<Scalar>> external_forces() {
    ++force_accesses_;
    return nodal_force_.force;
  }
  /// Forces on vertices, N, one a vertex.
  [[nodiscard]] std::span<const Vec3<Scalar>> external_forces() const { return detail::span_of(nodal_force_.force); }

  /// How often the caller may have written to them.
  [[nodiscard]] std::uint64_t force_accesses() const { return force_accesses_; }

  /// Bytes of its own state, and of the model that it shares with its copies.
  [[nodiscard]] COROTET_COLD MemoryUse memory() const {
    return {detail::bytes_of(displacement_) + detail::bytes_of(velocity_) + detail::bytes_of(nodal_force_.force) +
                pins_.bytes(),
            model_->bytes()};
  }

  /// For integrators: gravity, nodal forces and damping, as terms of a step.
  [[nodiscard]] std::array<StepTerm<Scalar>*, 3> terms() { return {&gravity_, &nodal_force_, &damping_}; }

  /// New materials: this body gets a model of its own. The mass follows. Errors as for `create`; nothing changes then.
  COROTET_COLD Result<void> set_materials(const Materials& materials);

  /// How long sound takes through the body where it is thin, s: see hydraulic_diameter.
  [[nodiscard]] double wave_transit_time() const { return model_->wave_transit_time(); }

  /// Another than that of any body with other materials or another mesh.
  [[nodiscard]] Revision material_revision() const { return model_->revision(); }

  /// Stands for these displacements and materials: no other state of any body with this mesh has it, but
  /// copies of this one. Lets an integrator keep what it evaluated.
  [[nodiscard]] Revision revision() const { return revision_; }

  /// The same for displacements and velocities. Lets an integrator that remembers steps know that this is where the
  /// last one ended.
  [[nodiscard]] Revision motion_revision() const { return motion_revision_; }

  /// Back to the rest shape, without motion. Pins, forces and gravity stay.
  void reset();
  /// Sets all velocities to zero.
  COROTET_COLD void stop();

  /// For snapshots.
  COROTET_COLD void visit_state(detail::StateArchive& archive);

  /// For integrators: takes the new state by exchange of buffers, which must be finite and of the body's length.
  void swap_state(Field<Scalar>& displacement, Field<Scalar>& velocity);

  /// For integrators: takes the state of these vertices of another body, one a vertex of this.
  void take_state(const SoftBody& whole, const std::vector<Index>& vertices);

 private:
  [[nodiscard]] COROTET_COLD Result<void> check_field(const char* name, std::span<const Vec3<Scalar>> field) const;

  std::shared_ptr<const Model> model_;
  GravityTerm<Scalar> gravity_;
  NodalForceTerm<Scalar> nodal_force_;
  RayleighDampingTerm<Scalar> damping_;
  Pins<Scalar> pins_;
  Field<Scalar> displacement_, velocity_;
  Vec3<double> shift_ = Vec3<double>::Zero();  // of the origin, m
  Revision revision_ = detail::new_revision();
  Revision motion_revision_ = revision_;
  std::uint64_t force_accesses_ = 0;
};

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
SoftBody<Scalar, Element, LawType>::SoftBody(std::shared_ptr<const Model> model)
    : model_(std::move(model)),
      pins_(vertex_count()),
      displacement_(at(vertex_count()), Vec3<Scalar>::Zero()),
      velocity_(displacement_) {
  nodal_force_.force = displacement_;
  damping_.damping = model_->options().damping;
  if constexpr (Law::has_point_states) static_cast<States&>(*this) = law().states_at_rest();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
Result<SoftBody<Scalar, Element, LawType>> SoftBody<Scalar, Element, LawType>::create(Mesh mesh,
                                                                                      const Materials& materials,
                                                                                      const BodyOptions& options) {
  auto model = Model::create(std::move(mesh), materials, options);
  if (!model) return model.error();
  return SoftBody(*std::move(model));
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
Result<void> SoftBody<Scalar, Element, LawType>::set_displacements(std::span<const Vec3<Scalar>> displacement) {
  if (Result<void> s = check_field("displacements", displacement); !s) return s;
  std::copy(displacement.begin(), displacement.end(), displacement_.begin());
  revision_ = motion_revision_ = detail::new_revision();
  return {};
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
Result<void> SoftBody<Scalar, Element, LawType>::set_velocities(std::span<const Vec3<Scalar>> velocity) {
  if (Result<void> s = check_field("velocities", velocity); !s) return s;
  std::copy(velocity.begin(), velocity.end(), velocity_.begin());
  motion_revision_ = detail::new_revision();
  return {};
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
Result<void> SoftBody<Scalar, Element, LawType>::set_state(std::span<const Vec3<double>> positions,
                                                           std::span<const Vec3<Scalar>> velocity) {
  if (positions.size() != displacement_.size())
    return detail::error(ErrorCode::invalid_argument, {"positions"},
                         {"there are ", positions.size(), " for ", displacement_.size(), " vertices"});
  Vec3<double> mean = Vec3<double>::Zero();
  const auto moved = [&](std::size_t v) -> Vec3<double> {
    return positions[v] - mesh().origin() - mesh().positions()[v].template cast<double>();
  };
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!(positions[v].template cast<Scalar>()).allFinite())
      return detail::error(ErrorCode::non_finite_value, {"positions of vertex ", v},
                           {"is not finite, or too large for this precision"});
    mean += moved(v) / static_cast<double>(positions.size());
  }
  if (Result<void> s = set_velocities(velocity); !s) return s;
  rebase((mean - shift_).template cast<Scalar>());
  for (std::size_t v = 0; v < positions.size(); ++v) displacement_[v] = (moved(v) - shift_).template cast<Scalar>();
  revision_ = motion_revision_ = detail::new_revision();
  return {};
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::rebase() {
  Vec3<double> mean = Vec3<double>::Zero();
  for (const Vec3<Scalar>& u : displacement_) mean += u.template cast<double>();
  rebase((mean / static_cast<double>(displacement_.size())).template cast<Scalar>());
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::rebase(const Vec3<Scalar>& shift) {
  for (Vec3<Scalar>& u : displacement_) u -= shift;
  pins_.translate(-shift);
  shift_ += shift.template cast<double>();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
Result<void> SoftBody<Scalar, Element, LawType>::set_materials(const Materials& materials) {
  auto model = model_->with_materials(materials);
  if (!model) return model.error();
  model_ = *std::move(model);
  revision_ = detail::new_revision();
  return {};
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::reset() {
  for (Field<Scalar>* field : {&displacement_, &velocity_})
    for (Vec3<Scalar>& x : *field) x.setZero();
  if constexpr (Law::has_point_states) static_cast<States&>(*this) = law().states_at_rest();
  revision_ = motion_revision_ = detail::new_revision();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::stop() {
  for (Vec3<Scalar>& v : velocity_) v.setZero();
  motion_revision_ = detail::new_revision();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::visit_state(detail::StateArchive& archive) {
  archive(displacement_);
  archive(shift_);
  archive(velocity_);
  archive(nodal_force_.force);
  archive(gravity_.acceleration);
  archive(pins_);
  if constexpr (Law::has_point_states) archive(static_cast<States&>(*this));
  if (archive.reads()) revision_ = motion_revision_ = detail::new_revision();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::swap_state(Field<Scalar>& displacement, Field<Scalar>& velocity) {
  COROTET_ASSERT(displacement.size() == displacement_.size() && velocity.size() == velocity_.size(),
                 "the buffers belong to another body");
  displacement_.swap(displacement);
  velocity_.swap(velocity);
  revision_ = motion_revision_ = detail::new_revision();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::take_state(const SoftBody& whole, const std::vector<Index>& vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    displacement_[i] = whole.displacement_[at(vertices[i])];
    velocity_[i] = whole.velocity_[at(vertices[i])];
  }
  revision_ = motion_revision_ = detail::new_revision();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
Result<void> SoftBody<Scalar, Element, LawType>::check_field(const char* name,
                                                             std::span<const Vec3<Scalar>> field) const {
  if (field.size() != displacement_.size())
    return detail::error(ErrorCode::invalid_argument, {name},
                         {"there are ", field.size(), " for ", displacement_.size(), " vertices"});
  for (std::size_t v = 0; v < field.size(); ++v)
    if (!field[v].allFinite())
      return detail::error(ErrorCode::non_finite_value, {name, " of vertex ", v}, {"is not finite"});
  return {};
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::set_point_states(const States& states) {
  COROTET_ASSERT(states.size() == point_states().size(), "the states belong to another body");
  static_cast<States&>(*this) = states;
  if constexpr (Law::has_point_states) revision_ = detail::new_revision();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::commit(const typename Law::Evaluation& evaluation) {
  if constexpr (Law::has_point_states) set_point_states(evaluation.trial());
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void SoftBody<Scalar, Element, LawType>::evaluate(const Field<Scalar>& displacement, typename Law::Evaluation& out,
                                                  ExecutorRef executor) const {
  if constexpr (Law::has_point_states)
    law().evaluate(displacement, point_states(), out, executor);
  else
    law().evaluate(displacement, out, executor);
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
double SoftBody<Scalar, Element, LawType>::elastic_energy(const Field<Scalar>& displacement, std::span<double> scratch,
                                                          ExecutorRef executor) const {
  if constexpr (Law::has_point_states)
    return law().energy(displacement, point_states(), executor);
  else
    return law().energy(displacement, scratch, executor);
}

COROTET_INSTANCES_OF_ELEMENT(SoftBody)

}  // namespace corotet::inline v0_1
