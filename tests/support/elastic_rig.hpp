// A mesh with its elastic law, evaluated on demand.
#pragma once

#include <corotet/detail/assembly/add_twist.hpp>
#include <corotet/detail/assembly/assemble.hpp>
#include <corotet/detail/assembly/elasticity.hpp>
#include <corotet/detail/assembly/mass.hpp>
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <memory>
#include <utility>

namespace corotet::testing {

inline constexpr Material rubber{.young = 3e4, .poisson = 0.35, .density = 900};

template <class Scalar, class Element, class Law>
struct ElasticOf {
  using type = Law;
};
template <class Scalar, class Element, ElasticLaw Law>
struct ElasticOf<Scalar, Element, Law> {
  using type = Elasticity<Scalar, Element, Law>;
};

/// `Law`: an ElasticModel or a rotation law, or a class with the interface of Elasticity.
template <class Scalar, class Element, class Law = Polar>
struct Rig {
  TetMesh<Scalar, Element> mesh;
  using Elastic = typename ElasticOf<Scalar, Element, Law>::type;
  Elastic law;
  std::shared_ptr<const BlockPattern> pattern;
  typename Elastic::Evaluation state;
  SerialExecutor serial;

  explicit Rig(TetMesh<Scalar, Element> m, const Materials& materials = rubber,
               VolumetricStrain volumetric_strain = VolumetricStrain::pointwise, Tangent tangent = Tangent::warped)
      : mesh(std::move(m)),
        law(mesh, materials, volumetric_strain),
        pattern(std::make_shared<const BlockPattern>(
            BlockPattern::of(mesh.elements(), mesh.vertex_count(), law.stencils()))),
        state(law, tangent) {}

  Field<Scalar> force(const Field<Scalar>& u) {
    law.evaluate(u, state, serial);
    Field<Scalar> f;
    for (Index v = 0; v < mesh.vertex_count(); ++v) f.push_back(state.vertex_force(*pattern, v));
    return f;
  }

  BlockMatrix<Scalar> stiffness(const Field<Scalar>& u) {
    law.evaluate(u, state, serial);
    const Mass<Scalar> mass(mesh, rubber, MassModel::lumped, *pattern);
    BlockMatrix<Scalar> k(pattern);
    assemble(law, state, mass, Scalar(0), Scalar(1), k, serial);
    if (state.twist.active_share() > 0) detail::add_twist(law, state, Scalar(1), k, serial);
    return k;
  }

  Eigen::MatrixXd dense_stiffness(const Field<Scalar>& u) {
    const BlockMatrix<Scalar> k = stiffness(u);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * k.rows(), 3 * k.rows());
    for (Index i = 0; i < k.rows(); ++i)
      for (Index s = pattern->row_start[at(i)]; s < pattern->row_start[at(i) + 1]; ++s)
        dense.block<3, 3>(3 * i, 3 * pattern->column[at(s)]) = as_eigen(k.block(s)).template cast<double>();
    return dense;
  }
};

}  // namespace corotet::testing
