// A body in a step in which it may touch other soft bodies: where it is, and how forces of contact act on it.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/contact/contact_surface.hpp>
#include <corotet/detail/contact/moving_surface.hpp>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/joint_pcg.hpp>
#include <corotet/detail/terms/piecewise_term.hpp>
#include <corotet/detail/terms/term_state.hpp>
#include <cstddef>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// A point of one body near a triangle of another one, or of the same. All of PointContact is of the motion of the
/// point against the place on the triangle: `obstacle` numbers the pair of bodies, nothing is led.
struct SoftContact : PointContact {
  Index side = 0, other = 0, triangle = 0;  ///< bodies, and the triangle of the other one
  std::array<double, 3> weights{};          ///< the place: shares of the triangle's corners
  /// Impulses on the corners of the triangle that sum to zero, N s: see JointContacts::balance_moment.
  std::array<Vec3<double>, 3> couple{Vec3<double>::Zero(), Vec3<double>::Zero(), Vec3<double>::Zero()};
};

/// One of the bodies.
template <std::floating_point Scalar>
struct SoftSide {
  Index body;
  MovingSurface surface;
  bool touches_itself;
  JointPcgFields<Scalar> fields;
  std::vector<double> share;  ///< sum of the weights that contacts have on a vertex

  // Of the step.
  PassSystem<Scalar>* system = nullptr;        ///< while it is solved
  TermState<Scalar> state;                     ///< where its forces are linearised
  Vec3<double> centre = Vec3<double>::Zero();  ///< of mass, at the start, m
  Vec3<double> flown = Vec3<double>::Zero();   ///< how far that goes, m
  double h = 0;                                ///< s

  COROTET_COLD SoftSide(Index number, ContactSurface of, bool itself)
      : body(number), surface(std::move(of)), touches_itself(itself), share(at(surface.points().vertex_count()), 0) {}

  /// Takes the state at the start of a step.
  void begin_step(const TermState<Scalar>& start) {
    state = start;
    h = double(start.h);
    centre = centre_of_mass([&](Index v) { return start.position(v).template cast<double>(); });
    const ContactPoints& points = surface.points();
    const auto place = [&](Index p) -> Vec3<double> {
      return points.interpolate(p, [&](Index v) { return start.position(v); }) + start.origin;
    };
    surface.begin_step(place, [&](Index p) -> Vec3<double> {
      return place(p) + h * points.interpolate(p, [&](Index v) { return start.velocity(v); });
    });
  }
  /// Takes that at its end. Returns the largest speed of a point, m/s.
  double end_step(const TermState<Scalar>& end) {
    const ContactPoints& points = surface.points();
    double fastest = 0;
    for (Index p = 0; p < points.size(); ++p) {
      surface.set_end(p, points.interpolate(p, [&](Index v) { return end.position(v); }) + end.origin);
      fastest = (std::max)(fastest, points.interpolate(p, [&](Index v) { return end.velocity(v); }).norm());
    }
    return fastest;
  }
  /// How far its centre of mass goes by the solution.
  void find_flight() {
    flown = centre_of_mass([&](Index v) { return end_of_vertex(v); }) - centre;
  }

  [[nodiscard]] Vec3<double> in_space(const Vec3<double>& v) const {
    return state.frame.turns ? state.frame.rotation.template cast<double>() * v : v;
  }
  [[nodiscard]] Vec3<double> in_frame(const Vec3<double>& v) const {
    return state.frame.turns ? state.frame.rotation.template cast<double>().transpose() * v : v;
  }
  /// Calls visit(vertex, weight) for the vertices of this body that carry a contact; what moves the triangle has
  /// negative weights.
  template <class Visit>
  void for_carriers(const SoftContact& contact, const Visit& visit) const {
    const ContactPoints& points = surface.points();
    const auto visit_point = [&](Index p, double share_of_point) {
      for (Index e = points.first(p); e < points.last(p); ++e)
        visit(points.vertex(e), share_of_point * points.weight(e));
    };
    if (contact.side == body) visit_point(contact.point, 1);
    if (contact.other != body) return;
    for (std::size_t k = 0; k < 3; ++k) visit_point(surface.triangles()[at(contact.triangle)][k], -contact.weights[k]);
  }
  /// Calls visit(vertex, impulse) for what contacts give the vertices of this body, N s, in space.
  template <class Visit>
  void for_impulses(const std::vector<SoftContact>& contacts, const Visit& visit) const {
    const ContactPoints& points = surface.points();
    for (const SoftContact& contact : contacts) {
      for_carriers(contact, [&](Index v, double weight) { visit(v, Vec3<double>(weight * contact.given)); });
      if (contact.other != body) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index p = surface.triangles()[at(contact.triangle)][k];
        for (Index e = points.first(p); e < points.last(p); ++e)
          visit(points.vertex(e), Vec3<double>(points.weight(e) * contact.couple[k]));
      }
    }
  }
  /// Of places of its vertices, `place(vertex)`.
  template <class Place>
  [[nodiscard]] Vec3<double> centre_of_mass(const Place& place) const {
    Vec3<double> sum = Vec3<double>::Zero();
    for (Index v = 0; v < size_of(state.rest); ++v) sum += double(state.mass->row_sum(v)) * place(v);
    return sum / state.mass->total();
  }
  /// Where a point ends by the solution, in the world, m.
  [[nodiscard]] Vec3<double> end_of(Index point) const {
    return surface.points().interpolate(point, [&](Index v) { return end_of_vertex(v); }) + state.origin;
  }
  [[nodiscard]] Vec3<double> end_of_vertex(Index v) const {
    Vec3<double> change = system->change[state.index(v)].template cast<double>();
    if (system->guess != nullptr) change += (*system->guess)[state.index(v)].template cast<double>();
    return state.position(v).template cast<double>() + double(state.gamma) * in_space(change);
  }
  /// This body's share in the relative motion at a contact, of a field in its frame, in space.
  template <class Vectors>
  [[nodiscard]] Vec3<double> value(const SoftContact& contact, const Vectors& field) const {
    Vec3<double> sum = Vec3<double>::Zero();
    for_carriers(contact, [&](Index v, double weight) { sum += weight * vector_of(field[state.index(v)]); });
    return in_space(sum);
  }

 private:
  [[nodiscard]] static Vec3<double> vector_of(const Vec3<Scalar>& v) { return v.template cast<double>(); }
  [[nodiscard]] static Vec3<double> vector_of(const PaddedVector<Scalar>& v) { return vector_of(v.vector()); }
};

}  // namespace corotet::inline v0_1::detail
