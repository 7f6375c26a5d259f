// A soft body: what it is made of, where it is, how fast it moves, what holds it and what pulls at it.
#pragma once

#include <cmath>
#include <concepts>
#include <corotet/assembly/block_pattern.hpp>
#include <corotet/assembly/elasticity.hpp>
#include <corotet/assembly/mass.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/instances.hpp>
#include <corotet/core/message.hpp>
#include <corotet/core/result.hpp>
#include <corotet/core/revision.hpp>
#include <corotet/core/types.hpp>
#include <corotet/dynamics/crossing_time.hpp>
#include <corotet/dynamics/pins.hpp>
#include <corotet/material/material.hpp>
#include <corotet/mesh/tet_mesh.hpp>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

struct BodyOptions {
  MassModel mass = MassModel::lumped;
  RayleighDamping damping;
  Dilatation dilatation = Dilatation::per_element;
};

/// The state is a displacement from rest and a velocity, not a world position, so that float keeps its digits wherever
/// the rest shape lies: all positions are relative to `mesh().origin()`. (A body that then travels many times its size
/// has a large displacement, and loses them again.) An integrator (ImplicitEuler) moves it.
template <std::floating_point Scalar, ReferenceElement Element = Tet4, RotationExtractor Rotation = Polar>
class SoftBody {
 public:
  using scalar_type = Scalar;
  using element_type = Element;
  using Mesh = TetMesh<Scalar, Element>;
  using Law = Elasticity<Scalar, Element, Rotation>;

  /// A body at rest in its rest shape, free of pins, gravity and forces.
  /// Errors: invalid_argument for a material (see Materials::check) or negative damping.
  [[nodiscard]] COROTET_COLD static Result<SoftBody> create(Mesh mesh, const Materials& materials,
                                                            const BodyOptions& options = {});

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] const Law& law() const { return law_; }
  [[nodiscard]] const Mass<Scalar>& mass() const { return mass_; }
  [[nodiscard]] const RayleighDamping& damping() const { return damping_; }
  [[nodiscard]] const std::shared_ptr<const BlockPattern>& pattern() const { return pattern_; }
  [[nodiscard]] Index vertex_count() const { return mesh_.vertex_count(); }

  /// m and m/s, one a vertex.
  [[nodiscard]] const Field<Scalar>& displacements() const { return displacement_; }
  [[nodiscard]] const Field<Scalar>& velocities() const { return velocity_; }

  /// Where a vertex is now, m, relative to `mesh().origin()`.
  [[nodiscard]] Vec3<Scalar> position(Index vertex) const { return mesh_.position(vertex) + displacement_[at(vertex)]; }

  /// Replaces the state. Errors: invalid_argument (length), non_finite_value (names the vertex); nothing changes then.
  COROTET_COLD Result<void> set_displacements(std::span<const Vec3<Scalar>> displacement);
  COROTET_COLD Result<void> set_velocities(std::span<const Vec3<Scalar>> velocity);

  /// Vertices held in place or led along a path.
  [[nodiscard]] Pins<Scalar>& pins() { return pins_; }
  [[nodiscard]] const Pins<Scalar>& pins() const { return pins_; }

  /// Pins each vertex whose rest position (relative to the origin) satisfies `predicate`, where it is now. Returns how
  /// many.
  template <std::predicate<const Vec3<Scalar>&> Predicate>
  Index pin_where(Predicate&& predicate) {
    Index count = 0;
    for (Index v = 0; v < vertex_count(); ++v)
      if (predicate(mesh_.position(v))) {
        pins_.pin(v, displacement_[at(v)]);
        ++count;
      }
    return count;
  }

  /// Leads a pinned vertex: it will be at `position` (m, relative to the origin) after the next step.
  void move_pin(Index vertex, const Vec3<Scalar>& position) {
    COROTET_ASSERT(pins_.is_pinned(vertex), "pin the vertex before moving it");
    if (pins_.is_pinned(vertex)) pins_.move(vertex, position - mesh_.position(vertex));
  }

  /// m/s^2.
  void set_gravity(const Vec3<Scalar>& gravity) { gravity_ = gravity; }
  [[nodiscard]] const Vec3<Scalar>& gravity() const { return gravity_; }

  /// Force on each vertex, N, besides gravity; zero until the caller writes to it, and kept from step to step.
  [[nodiscard]] std::span<Vec3<Scalar>> external_forces() { return external_force_; }
  [[nodiscard]] std::span<const Vec3<Scalar>> external_forces() const { return external_force_; }

  /// New materials. The mass follows. Errors as for `create`; nothing changes then.
  COROTET_COLD Result<void> set_materials(const Materials& materials);

  /// How long sound takes through the body where it is thin, s: see thickness.
  [[nodiscard]] double crossing_time() const { return crossing_time_; }

  /// Another than that of any body with other materials or another mesh.
  [[nodiscard]] Revision material_revision() const { return material_revision_; }

  /// Stands for these displacements and materials: no other state of any body with this mesh has it, but
  /// copies of this one. Lets an integrator keep what it evaluated.
  [[nodiscard]] Revision revision() const { return revision_; }

  /// The same for displacements and velocities. Lets an integrator that remembers steps know that this is where the
  /// last one ended.
  [[nodiscard]] Revision motion_revision() const { return motion_revision_; }

  /// For integrators: takes the new state by exchange of buffers, which must be finite and of the body's length.
  void swap_state(Field<Scalar>& displacement, Field<Scalar>& velocity);

 private:
  COROTET_COLD SoftBody(Mesh mesh, const Materials& materials, const BodyOptions& options);

  [[nodiscard]] COROTET_COLD Result<void> check_field(const char* name, std::span<const Vec3<Scalar>> field) const;

  Mesh mesh_;
  Law law_;
  std::shared_ptr<const BlockPattern> pattern_;
  Mass<Scalar> mass_;
  RayleighDamping damping_;
  double thickness_, crossing_time_;
  Pins<Scalar> pins_;
  Field<Scalar> displacement_, velocity_, external_force_;
  Vec3<Scalar> gravity_ = Vec3<Scalar>::Zero();
  Revision revision_ = new_revision();
  Revision material_revision_ = revision_;
  Revision motion_revision_ = revision_;
};

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <std::floating_point Scalar, ReferenceElement Element, RotationExtractor Rotation>
SoftBody<Scalar, Element, Rotation>::SoftBody(Mesh mesh, const Materials& materials, const BodyOptions& options)
    : mesh_(std::move(mesh)),
      law_(mesh_, materials, options.dilatation),
      pattern_(std::make_shared<const BlockPattern>(
          BlockPattern::of(mesh_.elements(), mesh_.vertex_count(), law_.vertex_groups()))),
      mass_(mesh_, materials, options.mass, *pattern_),
      damping_(options.damping),
      thickness_(thickness(mesh_)),
      crossing_time_(corotet::crossing_time(thickness_, materials, mesh_.element_count())),
      pins_(mesh_.vertex_count()),
      displacement_(at(mesh_.vertex_count()), Vec3<Scalar>::Zero()),
      velocity_(displacement_),
      external_force_(displacement_) {}

template <std::floating_point Scalar, ReferenceElement Element, RotationExtractor Rotation>
Result<SoftBody<Scalar, Element, Rotation>> SoftBody<Scalar, Element, Rotation>::create(Mesh mesh,
                                                                                        const Materials& materials,
                                                                                        const BodyOptions& options) {
  if (Result<void> s = materials.template validate<Scalar>(at(mesh.element_count())); !s) return s.error();
  for (const double damping : {options.damping.mass, options.damping.stiffness})
    if (!std::isfinite(damping) || damping < 0)
      return detail::error(ErrorCode::invalid_argument, {"damping"}, {"must be >= 0 and finite"});
  return SoftBody(std::move(mesh), materials, options);
}

template <std::floating_point Scalar, ReferenceElement Element, RotationExtractor Rotation>
Result<void> SoftBody<Scalar, Element, Rotation>::set_displacements(std::span<const Vec3<Scalar>> displacement) {
  if (Result<void> s = check_field("displacements", displacement); !s) return s;
  displacement_.assign(displacement.begin(), displacement.end());
  revision_ = motion_revision_ = new_revision();
  return {};
}

template <std::floating_point Scalar, ReferenceElement Element, RotationExtractor Rotation>
Result<void> SoftBody<Scalar, Element, Rotation>::set_velocities(std::span<const Vec3<Scalar>> velocity) {
  if (Result<void> s = check_field("velocities", velocity); !s) return s;
  velocity_.assign(velocity.begin(), velocity.end());
  motion_revision_ = new_revision();
  return {};
}

template <std::floating_point Scalar, ReferenceElement Element, RotationExtractor Rotation>
Result<void> SoftBody<Scalar, Element, Rotation>::set_materials(const Materials& materials) {
  if (Result<void> s = materials.template validate<Scalar>(at(mesh_.element_count())); !s) return s;
  law_.set_materials(materials);
  mass_ = Mass<Scalar>(mesh_, materials, mass_.model(), *pattern_);
  crossing_time_ = corotet::crossing_time(thickness_, materials, mesh_.element_count());
  revision_ = material_revision_ = new_revision();
  return {};
}

template <std::floating_point Scalar, ReferenceElement Element, RotationExtractor Rotation>
void SoftBody<Scalar, Element, Rotation>::swap_state(Field<Scalar>& displacement, Field<Scalar>& velocity) {
  COROTET_ASSERT(displacement.size() == displacement_.size() && velocity.size() == velocity_.size(),
                 "the buffers belong to another body");
  displacement_.swap(displacement);
  velocity_.swap(velocity);
  revision_ = motion_revision_ = new_revision();
}

template <std::floating_point Scalar, ReferenceElement Element, RotationExtractor Rotation>
Result<void> SoftBody<Scalar, Element, Rotation>::check_field(const char* name,
                                                              std::span<const Vec3<Scalar>> field) const {
  if (field.size() != displacement_.size())
    return detail::error(ErrorCode::invalid_argument, {name},
                         {"there are ", field.size(), " for ", displacement_.size(), " vertices"});
  for (std::size_t v = 0; v < field.size(); ++v)
    if (!field[v].allFinite())
      return detail::error(ErrorCode::non_finite_value, {name, " of vertex ", v}, {"is not finite"});
  return {};
}

COROTET_INSTANCES_OF_ELEMENT(SoftBody)

}  // namespace corotet::inline v0_1
