// Where a point of a soft body is, how fast it moves, and forces and impulses at it.
#pragma once

#include <concepts>
#include <corotet/detail/core/message.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/pins.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/embed/body_point.hpp>
#include <cstddef>

namespace corotet::inline v0_1 {
namespace detail {

template <std::floating_point Scalar, ReferenceElement Element>
[[nodiscard]] Vec3<Scalar> value_at(const Field<Scalar>& field, const BodyPoint<Element>& point) {
  return point.interpolate([&](Index v) { return field[at(v)]; }).template cast<Scalar>();
}

}  // namespace detail

/// The point's present position, m, relative to body.origin().
template <class Body>
[[nodiscard]] Vec3<typename Body::scalar_type> position_at(const Body& body,
                                                           const BodyPoint<typename Body::element_type>& point) {
  return point.interpolate([&](Index v) { return body.position(v); }).template cast<typename Body::scalar_type>();
}

/// Its displacement from rest, m.
template <class Body>
[[nodiscard]] Vec3<typename Body::scalar_type> displacement_at(const Body& body,
                                                               const BodyPoint<typename Body::element_type>& point) {
  return detail::value_at(body.displacements(), point);
}

/// Its velocity, m/s.
template <class Body>
[[nodiscard]] Vec3<typename Body::scalar_type> velocity_at(const Body& body,
                                                           const BodyPoint<typename Body::element_type>& point) {
  return detail::value_at(body.velocities(), point);
}

/// Adds a force, N, that acts at the point to the body's external forces, which stay until the caller changes them:
/// weights[a] * force to each carrying vertex, the transpose of interpolation. So the vertices' forces have the same
/// sum, the same torque about every point, and the same power as the force at the point.
template <class Body>
void add_force_at(Body& body, const BodyPoint<typename Body::element_type>& point,
                  const Vec3<typename Body::scalar_type>& force) {
  using Scalar = typename Body::scalar_type;
  for (std::size_t a = 0; a < point.weights.size(); ++a)
    body.external_forces()[at(point.vertices[a])] +=
        (point.weights[a] * force.template cast<double>()).template cast<Scalar>();
}

namespace detail {

/// `x` without the components in which a vertex is pinned.
template <class Body>
[[nodiscard]] Vec3<double> free_part(const Body& body, Index v, Vec3<double> x) {
  const PinnedAxes axes = body.pins().axes_of(v);
  for (int i = 0; i < 3; ++i)
    if (axes[i]) x[i] = 0;
  return x;
}

/// Solves M x = b for the free components, x = 0 at pinned ones, by conjugate gradients with the diagonal as
/// preconditioner, which bounds the condition of M on every mesh (Wathen 1987). b becomes the residual. Allocates.
template <class Body>
void solve_consistent_mass(const Body& body, Field<double>& b, Field<double>& x) {
  constexpr int max_iterations = 200;
  constexpr double tolerance = 1e-14;
  const BlockPattern& pattern = *body.pattern();
  const Index n = body.vertex_count();
  Field<double> p(at(n), Vec3<double>::Zero()), mp(p), z(p);
  const auto precondition = [&](Index v) -> Vec3<double> {
    return b[at(v)] / static_cast<double>(body.mass().factor(pattern, v, pattern.diagonal[at(v)]));
  };
  x.assign(at(n), Vec3<double>::Zero());
  double rz = 0;
  for (Index v = 0; v < n; ++v) {
    b[at(v)] = free_part(body, v, b[at(v)]);
    p[at(v)] = precondition(v);
    rz += b[at(v)].dot(p[at(v)]);
  }
  const double first = rz;
  for (int i = 0; i < max_iterations && rz > tolerance * tolerance * first; ++i) {
    double curvature = 0;
    for (Index v = 0; v < n; ++v) {
      const auto at_vertex = [&](Index j) -> const Vec3<double>& { return p[at(j)]; };
      mp[at(v)] = free_part(body, v, body.mass().row_product(pattern, v, at_vertex));
      curvature += p[at(v)].dot(mp[at(v)]);
    }
    const double length = rz / curvature;
    double next = 0;
    for (Index v = 0; v < n; ++v) {
      x[at(v)] += length * p[at(v)];
      b[at(v)] -= length * mp[at(v)];
      z[at(v)] = precondition(v);
      next += b[at(v)].dot(z[at(v)]);
    }
    for (Index v = 0; v < n; ++v) p[at(v)] = z[at(v)] + (next / rz) * p[at(v)];
    rz = next;
  }
}

}  // namespace detail

/// Changes velocities by what an impulse J, N s, at the point does at once: M dv = weights[a] J. The momentum of a body
/// without pins grows by J, its angular momentum by r x J, r = position_at. A pin takes up the share of its vertex,
/// whose velocity stays, in the axes that it holds. `scratch`: any field; a call allocates nothing once it has the
/// body's length and the mass is lumped. O(vertices). Errors: non_finite_value, of the impulse or a velocity; nothing
/// changes then.
template <class Body>
Result<void> apply_impulse_at(Body& body, const BodyPoint<typename Body::element_type>& point,
                              const Vec3<typename Body::scalar_type>& impulse,
                              Field<typename Body::scalar_type>& scratch) {
  using Scalar = typename Body::scalar_type;
  if (!impulse.allFinite()) return detail::error(ErrorCode::non_finite_value, "impulse", "is not finite");
  const Vec3<double> j = impulse.template cast<double>();
  scratch.assign(body.velocities().begin(), body.velocities().end());
  if (body.mass().model() == MassModel::lumped) {
    for (std::size_t a = 0; a < point.weights.size(); ++a) {
      const Index v = point.vertices[a];
      const Vec3<double> change = point.weights[a] / static_cast<double>(body.mass().row_sum(v)) * j;
      scratch[at(v)] += detail::free_part(body, v, change).template cast<Scalar>();
    }
  } else {
    Field<double> b(scratch.size(), Vec3<double>::Zero()), change;
    for (std::size_t a = 0; a < point.weights.size(); ++a) b[at(point.vertices[a])] += point.weights[a] * j;
    detail::solve_consistent_mass(body, b, change);
    for (std::size_t v = 0; v < scratch.size(); ++v) scratch[v] += change[v].template cast<Scalar>();
  }
  return body.set_velocities(scratch);
}
/// The same with scratch of its own, which it allocates.
template <class Body>
Result<void> apply_impulse_at(Body& body, const BodyPoint<typename Body::element_type>& point,
                              const Vec3<typename Body::scalar_type>& impulse) {
  Field<typename Body::scalar_type> scratch;
  return apply_impulse_at(body, point, impulse, scratch);
}

}  // namespace corotet::inline v0_1
