// Which element of a mesh holds a point, and with which weights its vertices move it.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/shared.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/embed/bind.hpp>
#include <corotet/detail/embed/body_point.hpp>
#include <corotet/detail/embed/element_map.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <corotet/detail/mesh/check_connectivity.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <cstddef>
#include <span>
#include <utility>

namespace corotet::inline v0_1 {

/// What a query found. A point outside the mesh belongs to the nearest element: its weights are those of the linear
/// extension at the nearest point, so that they give the point itself, as for a vertex of an EmbeddedSurface.
template <TetrahedralElement Element>
struct LocatedPoint : BodyPoint<Element> {
  static constexpr Index none = -1;  ///< of `element`: the point is in none
  Index element = none;              ///< that contains the point, or is nearest
  double distance_outside = 0;       ///< from the mesh, m; 0 inside to rounding

  /// False where the point asked for was not finite, or its distance left the range of numbers.
  [[nodiscard]] bool found() const { return element != none; }
};

/// Finds points of a mesh at rest.
///
/// Use it to grab, strike or follow a place of a body. For a deformed body, as what a ray has hit, use
/// DeformedPointLocator; for all vertices of a surface EmbeddedSurface.
/// @snippet queries.cpp points
/// Made once, O(elements log elements); a query looks at O(log elements) boxes and
/// allocates nothing. Copies share one constant tree; any number of threads may ask. The mesh is copied.
template <std::floating_point Scalar, TetrahedralElement Element = Tet4>
class PointLocator {
 public:
  using Mesh = TetMesh<Scalar, Element>;  ///< of the body
  using Point = LocatedPoint<Element>;    ///< what it finds

  /// Of a mesh at rest; keeps a copy of it.
  explicit PointLocator(Mesh mesh) : rest_(detail::Shared<Rest>::make(std::move(mesh))) {}

  /// The mesh that it was made for.
  [[nodiscard]] const Mesh& mesh() const { return rest_->mesh; }

  /// Of a point given in rest coordinates relative to mesh().origin(), m: where SoftBody::position is at rest.
  [[nodiscard]] Point locate(const Vec3<double>& p) const;
  /// The same for a point in float.
  template <std::same_as<float> Number>
  [[nodiscard]] Point locate(const Vec3<Number>& p) const {
    return locate(p.template cast<double>());
  }

 private:
  template <std::floating_point, TetrahedralElement>
  friend class DeformedPointLocator;

  struct Rest {
    Mesh mesh;
    detail::BoxTree tree;
    double rounding;  // of positions, m

    explicit Rest(Mesh m)
        : mesh(std::move(m)),
          tree(detail::element_tree(mesh)),
          rounding(detail::position_rounding<Scalar>(tree.bounds())) {}
  };

  detail::Shared<Rest> rest_;
};

template <std::floating_point Scalar, TetrahedralElement Element>
PointLocator(TetMesh<Scalar, Element>) -> PointLocator<Scalar, Element>;

/// Finds points of a deformed mesh, such as what a ray has hit: of the element that is there now. `update` follows the
/// body, O(elements), and allocates nothing; queries are as those of a PointLocator. Where elements overlap, one of
/// those that hold the point is found. A point outside an element that is flat or inverted gets the weights of the
/// nearest point.
template <std::floating_point Scalar, TetrahedralElement Element = Tet4>
class DeformedPointLocator {
 public:
  using Point = LocatedPoint<Element>;  ///< what it finds

  /// At rest.
  explicit DeformedPointLocator(const PointLocator<Scalar, Element>& rest)
      : rest_(rest.rest_),
        tree_(rest_->tree),
        rounding_(rest_->rounding),
        boxes_(at(rest_->mesh.element_count())),
        positions_(at(rest_->mesh.vertex_count())) {
    for (Index v = 0; v < rest_->mesh.vertex_count(); ++v) positions_[at(v)] = rest_->mesh.position(v);
  }

  /// The mesh is now displaced by `u`, m, one a vertex, finite: SoftBody::displacements.
  void update(std::span<const Vec3<Scalar>> u, ExecutorRef executor = {});

  /// Of a point given in present coordinates relative to the body's origin, m: where SoftBody::position is.
  [[nodiscard]] Point locate(const Vec3<double>& p) const;
  /// The same for a point in float.
  template <std::same_as<float> Number>
  [[nodiscard]] Point locate(const Vec3<Number>& p) const {
    return locate(p.template cast<double>());
  }

 private:
  [[nodiscard]] detail::NodePositions<Element> positions_of(Index e) const;

  detail::Shared<typename PointLocator<Scalar, Element>::Rest> rest_;
  detail::BoxTree tree_;
  double rounding_;
  detail::Buffer<Box> boxes_;
  detail::Buffer<Vec3<Scalar>> positions_;
};

namespace detail {

/// Whether queries at `p` stay in the range of numbers.
[[nodiscard]] inline bool can_be_located(const Vec3<double>& p) {
  return p.allFinite() && p.cwiseAbs().maxCoeff() <= max_coordinate;
}

template <TetrahedralElement Element>
[[nodiscard]] LocatedPoint<Element> located(const std::array<Index, std::size_t{Element::nodes}>& vertices,
                                            const BoundPoint& bound) {
  LocatedPoint<Element> point;
  point.vertices = vertices;
  point.weights = extended_weights<Element>(bound.xi, bound.step);
  point.element = bound.element;
  point.distance_outside = bound.distance;
  return point;
}

}  // namespace detail

// Below the classes, and so compiled where they are instantiated.
template <std::floating_point Scalar, TetrahedralElement Element>
LocatedPoint<Element> PointLocator<Scalar, Element>::locate(const Vec3<double>& p) const {
  if (!detail::can_be_located(p)) return {};
  const detail::BoundPoint bound = detail::bind_point(rest_->mesh, rest_->tree, rest_->rounding, p);
  return detail::located<Element>(rest_->mesh.element(bound.element), bound);
}

template <std::floating_point Scalar, TetrahedralElement Element>
void DeformedPointLocator<Scalar, Element>::update(std::span<const Vec3<Scalar>> u, ExecutorRef executor) {
  COROTET_ASSERT(u.size() == positions_.size(), "displacements need one entry per mesh vertex");
  constexpr Index grain = 1024;
  for_ranges(executor, size_of(positions_), grain, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v) positions_[at(v)] = rest_->mesh.position(v) + u[at(v)];
  });
  for_ranges(executor, size_of(boxes_), grain, [&](Index begin, Index end) {
    for (Index e = begin; e < end; ++e) boxes_[at(e)] = detail::element_box<Element>(positions_of(e));
  });
  tree_.refit({boxes_.data(), boxes_.size()});
  rounding_ = (std::max)(rest_->rounding, detail::position_rounding<Scalar>(tree_.bounds()));
}

template <std::floating_point Scalar, TetrahedralElement Element>
LocatedPoint<Element> DeformedPointLocator<Scalar, Element>::locate(const Vec3<double>& p) const {
  if (!detail::can_be_located(p)) return {};
  detail::BoundPoint bound =
      detail::nearest_point<Element>(tree_, rounding_, p, [&](Index e) { return positions_of(e); });
  if (bound.element < 0) return {};
  const detail::NodePositions<Element> x = positions_of(bound.element);
  const auto map = detail::ElementField<double, Element::edge_nodes>::from_nodes([&](int a) { return x[at(a)]; });
  const Mat3<double> gradient = map.gradient(bound.xi);
  const double size = gradient.cwiseAbs().maxCoeff(), least = 1e-3 * size * size * size;  // m^3
  bound.step = gradient.determinant() > least ? Vec3<double>(gradient.inverse() * (p - map.value(bound.xi)))
                                              : Vec3<double>(Vec3<double>::Zero());
  return detail::located<Element>(rest_->mesh.element(bound.element), bound);
}

template <std::floating_point Scalar, TetrahedralElement Element>
detail::NodePositions<Element> DeformedPointLocator<Scalar, Element>::positions_of(Index e) const {
  detail::NodePositions<Element> x;
  for (std::size_t a = 0; a < x.size(); ++a) x[a] = positions_[at(rest_->mesh.element(e)[a])].template cast<double>();
  return x;
}

}  // namespace corotet::inline v0_1
