// What copies of a body have in common: mesh, elastic law, mass and the pattern of its matrix.
#pragma once

#include <cmath>
#include <concepts>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/assembly/elasticity.hpp>
#include <corotet/detail/assembly/mass.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/instances.hpp>
#include <corotet/detail/core/message.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/wave_transit_time.hpp>
#include <corotet/detail/material/corotated.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstdint>
#include <memory>
#include <utility>

namespace corotet::inline v0_1 {

/// How a body is discretised.
struct BodyOptions {
  MassModel mass = MassModel::lumped;                                ///< lumped or consistent
  RayleighDamping damping = {};                                      ///< 1/s and s; none by default
  VolumetricStrain volumetric_strain = VolumetricStrain::pointwise;  ///< pointwise, or averaged against locking
  /// Vertices that no element couples but a StepTerm shall: a spring between two points of the body, self-contact.
  Stencils couplings = {};
};

/// What copies of a body share: mesh, elastic law, mass and the pattern of the matrix. It is immutable.
///
/// Use it where a scene has several bodies of one mesh and material: each SoftBody of the model holds only its state.
/// For a single body, SoftBody::create makes the model itself.
/// @snippet bodies.cpp model
template <std::floating_point Scalar, ReferenceElement Element = Tet4, ElasticLaw LawType = Polar>
class BodyModel {
 public:
  using Mesh = TetMesh<Scalar, Element>;             ///< of the body
  using Law = Elasticity<Scalar, Element, LawType>;  ///< the elastic law on the mesh
  using Pointer = std::shared_ptr<const BodyModel>;  ///< how bodies hold it

  /// Errors: unsupported for a mean dilatation with another model than the corotated one; invalid_argument for a
  /// material (see Materials::validate), negative damping, or couplings that name no
  /// vertex of the mesh or more than Stencils::max_vertices in a group.
  [[nodiscard]] COROTET_COLD static Result<Pointer> create(Mesh mesh, const Materials& materials,
                                                           const BodyOptions& options = {});

  /// The same body of other materials. Mesh and pattern are shared with this model. Errors as for `create`.
  [[nodiscard]] COROTET_COLD Result<Pointer> with_materials(const Materials& materials) const;

  /// Mesh in the rest configuration.
  [[nodiscard]] const Mesh& mesh() const { return *mesh_; }
  /// Elastic law: forces and energies of elements.
  [[nodiscard]] const Law& law() const { return law_; }
  /// Mass matrix.
  [[nodiscard]] const Mass<Scalar>& mass() const { return mass_; }
  /// Materials, one for the body or one for each element.
  [[nodiscard]] const Materials& materials() const { return materials_; }
  /// The options that it was made with.
  [[nodiscard]] const BodyOptions& options() const { return options_; }
  /// Which vertices the matrices couple.
  [[nodiscard]] const std::shared_ptr<const BlockPattern>& pattern() const { return pattern_; }

  /// How long sound takes through the body where it is thin, s: see hydraulic_diameter.
  [[nodiscard]] double wave_transit_time() const { return wave_transit_time_; }

  /// Memory of the mesh, the law, the pattern and the mass.
  [[nodiscard]] COROTET_COLD std::size_t bytes() const {
    return sizeof(*this) + mesh_->bytes() + law_.bytes() + pattern_->bytes() + mass_.bytes();
  }

  /// The same for models of the same mesh, materials and options alone, in any program: for snapshots.
  [[nodiscard]] std::uint64_t fingerprint() const { return fingerprint_; }

  /// Another than that of any model with other materials or another mesh.
  [[nodiscard]] Revision revision() const { return revision_; }

 private:
  COROTET_COLD BodyModel(Mesh mesh, const Materials& materials, const BodyOptions& options);
  COROTET_COLD BodyModel(const BodyModel& other, const Materials& materials);
  COROTET_COLD void set_fingerprint();
  [[nodiscard]] COROTET_COLD static Result<void> check_couplings(const Stencils& couplings, Index vertices);

  std::shared_ptr<const Mesh> mesh_;
  Materials materials_;
  BodyOptions options_;
  Law law_;
  std::shared_ptr<const BlockPattern> pattern_;
  Mass<Scalar> mass_;
  double hydraulic_diameter_, wave_transit_time_;
  std::uint64_t fingerprint_ = 0;
  Revision revision_ = detail::new_revision();
};

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
BodyModel<Scalar, Element, LawType>::BodyModel(Mesh mesh, const Materials& materials, const BodyOptions& options)
    : mesh_(new Mesh(std::move(mesh))),  // std::make_shared takes several times as long to compile
      materials_(materials),
      options_(options),
      law_(*mesh_, materials, options.volumetric_strain),
      pattern_(new BlockPattern(
          BlockPattern::of(mesh_->elements(), mesh_->vertex_count(), law_.stencils(), options.couplings))),
      mass_(*mesh_, materials, options.mass, *pattern_),
      hydraulic_diameter_(detail::hydraulic_diameter(*mesh_)),
      wave_transit_time_(corotet::detail::wave_transit_time(hydraulic_diameter_, materials, mesh_->element_count())) {
  set_fingerprint();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
BodyModel<Scalar, Element, LawType>::BodyModel(const BodyModel& other, const Materials& materials)
    : mesh_(other.mesh_),
      materials_(materials),
      options_(other.options_),
      law_(other.law_),
      pattern_(other.pattern_),
      mass_(*mesh_, materials, options_.mass, *pattern_),
      hydraulic_diameter_(other.hydraulic_diameter_),
      wave_transit_time_(corotet::detail::wave_transit_time(hydraulic_diameter_, materials, mesh_->element_count())) {
  law_.set_materials(materials);
  set_fingerprint();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
void BodyModel<Scalar, Element, LawType>::set_fingerprint() {
  detail::Fingerprint print;
  for (const Vec3<Scalar>& x : mesh_->positions())
    for (const Scalar each : x) print.add(double(each));
  for (const auto& nodes : mesh_->elements())
    for (const Index v : nodes) print.add(v);
  for (Index e = 0; e < mesh_->element_count(); ++e) {
    const Material& m = materials_.of_element(at(e));
    for (const double each : {m.young, m.poisson, m.density}) print.add(each);
  }
  print.add(static_cast<int>(options_.mass));
  print.add(static_cast<int>(options_.volumetric_strain));
  print.add(options_.damping.mass);
  print.add(options_.damping.stiffness);
  for (const Index v : options_.couplings.vertex) print.add(v);
  fingerprint_ = print.value();
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
Result<std::shared_ptr<const BodyModel<Scalar, Element, LawType>>> BodyModel<Scalar, Element, LawType>::create(
    Mesh mesh, const Materials& materials, const BodyOptions& options) {
  if (Result<void> s = materials.template validate<Scalar>(at(mesh.element_count())); !s) return s.error();
  for (const double damping : {options.damping.mass, options.damping.stiffness})
    if (!std::isfinite(damping) || damping < 0)
      return detail::error(ErrorCode::invalid_argument, "damping", "must be >= 0 and finite");
  if (Result<void> s = check_couplings(options.couplings, mesh.vertex_count()); !s) return s.error();
  if (!Law::has_mean_dilatation && options.volumetric_strain != VolumetricStrain::pointwise)
    return detail::error(ErrorCode::unsupported, {"dilatation"},
                         {"a mean dilatation is for the corotated model, this body's is ", Law::Model::name});
  return Pointer(new BodyModel(std::move(mesh), materials, options));
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
Result<void> BodyModel<Scalar, Element, LawType>::check_couplings(const Stencils& couplings, Index vertices) {
  for (const Index v : couplings.vertex)
    if (v < 0 || v >= vertices)
      return detail::error(ErrorCode::index_out_of_range, {"couplings"}, {"there is no vertex ", v});
  for (Index g = 0; g < couplings.count(); ++g) {
    const Index begin = couplings.start[at(g)], end = couplings.start[at(g) + 1];
    if (begin < 0 || end < begin || end > size_of(couplings.vertex) || end - begin > Stencils::max_vertices)
      return detail::error(ErrorCode::invalid_argument, {"couplings: group ", g},
                           {"must have 0 ... ", Stencils::max_vertices, " vertices of the list"});
  }
  return {};
}

template <std::floating_point Scalar, ReferenceElement Element, ElasticLaw LawType>
Result<std::shared_ptr<const BodyModel<Scalar, Element, LawType>>> BodyModel<Scalar, Element, LawType>::with_materials(
    const Materials& materials) const {
  if (Result<void> s = materials.template validate<Scalar>(at(mesh_->element_count())); !s) return s.error();
  return Pointer(new BodyModel(*this, materials));
}

COROTET_INSTANCES_OF_ELEMENT(BodyModel)

}  // namespace corotet::inline v0_1
