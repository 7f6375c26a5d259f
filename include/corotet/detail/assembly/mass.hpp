// The mass of a body: lumped on its vertices, or consistent with the shape functions.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/jacobian.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <type_traits>

namespace corotet::inline v0_1 {

/// How the mass of an element is spread over its nodes.
enum class MassModel {
  /// Diagonal of the consistent matrix, scaled to the element's mass (Hinton, Rock & Zienkiewicz 1976). For Tet4 the
  /// same as row sums: a quarter of the element on each node; for Tet10, whose row sums are negative at the corners,
  /// positive everywhere.
  lumped,
  /// Integral of rho N_a N_b: couples neighbours.
  consistent
};

/// M as a scalar factor of the 3x3 identity: one a vertex (lumped) or one a block of the pattern (consistent), kg.
template <std::floating_point Scalar>
class Mass {
 public:
  /// The mass of a mesh; `materials` must pass Materials::validate, and `pattern` be that of the mesh.
  template <ReferenceElement Element>
  COROTET_COLD Mass(const TetMesh<Scalar, Element>& mesh, const Materials& materials, MassModel model,
                    const BlockPattern& pattern)
      : model_(model), row_sum_(at(mesh.vertex_count())) {
    constexpr std::size_t n = Element::nodes;
    detail::Buffer<double> factor(model == MassModel::lumped ? row_sum_.size() : at(pattern.blocks()));
    detail::Buffer<double> row_sum(row_sum_.size());
    for (Index e = 0; e < mesh.element_count(); ++e) {
      const auto& nodes = mesh.element(e);
      const ElementMass<n> m = element_mass(mesh, e, materials.of_element(at(e)).density);
      total_ += m.total;
      double trace = 0;
      for (std::size_t a = 0; a < n; ++a) trace += m.matrix[a][a];
      for (std::size_t a = 0; a < n; ++a) {
        if (model == MassModel::lumped) {
          factor[at(nodes[a])] += m.matrix[a][a] * m.total / trace;
          continue;
        }
        for (std::size_t b = 0; b < n; ++b) {
          factor[at(pattern.slot(nodes[a], nodes[b]))] += m.matrix[a][b];
          row_sum[at(nodes[a])] += m.matrix[a][b];
        }
      }
    }
    factor_ = detail::Buffer<Scalar>(factor.size());
    for (std::size_t k = 0; k < factor.size(); ++k) factor_[k] = static_cast<Scalar>(factor[k]);
    const detail::Buffer<double>& weight = model == MassModel::lumped ? factor : row_sum;
    for (std::size_t v = 0; v < weight.size(); ++v) row_sum_[v] = static_cast<Scalar>(weight[v]);
  }

  /// Lumped or consistent.
  [[nodiscard]] MassModel model() const { return model_; }
  /// Bytes on the heap.
  [[nodiscard]] std::size_t bytes() const { return detail::bytes_of(factor_) + detail::bytes_of(row_sum_); }

  /// Mass of the whole body, kg.
  [[nodiscard]] double total() const { return total_; }

  /// What gravity pulls at: the row sum of M at a vertex, kg. Negative at the corners of a consistent Tet10 mesh.
  [[nodiscard]] Scalar row_sum(Index vertex) const { return row_sum_[at(vertex)]; }

  /// Factor of block (i, j) in slot `slot` of row `row` of the pattern, kg.
  [[nodiscard]] Scalar factor(const BlockPattern& pattern, Index row, Index slot) const {
    if (model_ == MassModel::consistent) return factor_[at(slot)];
    return slot == pattern.diagonal[at(row)] ? factor_[at(row)] : Scalar(0);
  }

  /// (M x) of one vertex.
  [[nodiscard]] Vec3<Scalar> row_product(const BlockPattern& pattern, Index row, const Field<Scalar>& x) const {
    return row_product(pattern, row, [&x](Index j) -> const Vec3<Scalar>& { return x[at(j)]; });
  }
  /// The same of x(j) for each vertex j, in its numbers.
  template <std::regular_invocable<Index> X>
  [[nodiscard]] auto row_product(const BlockPattern& pattern, Index row, const X& x) const {
    using Vector = std::remove_cvref_t<std::invoke_result_t<const X&, Index>>;
    using Number = typename Vector::Scalar;
    const Vector here = x(row);
    Vector sum = static_cast<Number>(row_sum_[at(row)]) * here;
    if (model_ == MassModel::lumped) return sum;
    for (Index k = pattern.row_start[at(row)]; k < pattern.row_start[at(row) + 1]; ++k)
      sum += static_cast<Number>(factor_[at(k)]) * (x(pattern.column[at(k)]) - here);
    return sum;
  }

 private:
  template <std::size_t N>
  struct ElementMass {
    std::array<std::array<double, N>, N> matrix{};
    double total = 0;
  };

  template <ReferenceElement Element>
  COROTET_COLD static ElementMass<std::size_t{Element::nodes}> element_mass(const TetMesh<Scalar, Element>& mesh,
                                                                            Index e, double density) {
    ElementMass<std::size_t{Element::nodes}> m;
    const auto x = mesh.node_positions(e);
    for (const QuadraturePoint& point : Element::mass_points) {
      const auto shape = Element::shape(point.xi);
      const double mass = density * point.weight * detail::jacobian(Element::gradient(point.xi), x).determinant();
      m.total += mass;
      for (std::size_t a = 0; a < shape.size(); ++a)
        for (std::size_t b = 0; b < shape.size(); ++b) m.matrix[a][b] += mass * shape[a] * shape[b];
    }
    return m;
  }

  MassModel model_;
  double total_ = 0;
  detail::Buffer<Scalar> factor_;
  detail::Buffer<Scalar> row_sum_;
};

/// Rayleigh damping D = mass * M + stiffness * K'.
struct RayleighDamping {
  double mass = 0;       ///< 1/s, >= 0: damps slow motion, rigid motion too
  double stiffness = 0;  ///< s, >= 0: damps fast vibration
};

}  // namespace corotet::inline v0_1
