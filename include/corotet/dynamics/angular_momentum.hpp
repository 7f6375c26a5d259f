// A body that nothing holds keeps its angular momentum.
#pragma once

#include <cmath>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <corotet/rotation/polar_robust.hpp>
#include <corotet/solve/range_sum.hpp>
#include <limits>
#include <span>

namespace corotet {

/// Implicit integrators brake spin: after x' = xbar + c v', M v' = M vbar + c f, where f has no torque about x', the
/// angular momentum is sum xbar x M v', and that lacks sum c v' x M vbar. This gives it back by the change of velocity
/// that is smallest in the norm of M, a rotation about the centre of mass (projection onto the level set of a first
/// integral: Hairer, Lubich & Wanner 2006, section IV.4). As sum xbar x M v' is linear in v', it does so to rounding.
/// What the solver's tolerance has left, and torques of forces that have no energy, go with it.
template <class Body>
class AngularMomentum {
 public:
  using Scalar = typename Body::scalar_type;

  explicit AngularMomentum(Index vertices) : sums_(vertices) {}

  /// Turns `velocity` (m/s, after a step of `h` seconds that ends at xbar + c velocity) until the angular momentum
  /// about the centre of mass is `decay` times what it was at the body's present state, and what forces besides gravity
  /// do to it in the step. `position`: xbar, as displacement from rest, m. For bodies without pins.
  template <Executor E>
  void restore(const Body& body, const Field<Scalar>& position, Scalar h, double decay, Field<Scalar>& velocity,
               E& executor) {
    const auto& rest = body.mesh().positions();
    // Relative to the first vertex: sums stay small in flight and far from the origin.
    const auto in_double = [](std::span<const Vec3<Scalar>> field) {
      return [field](Index i) -> Vec3<double> { return (field[at(i)] - field[0]).template cast<double>(); };
    };
    const auto placed = [&](const Field<Scalar>& displacement) {
      return [&, moved = in_double(displacement)](Index i) -> Vec3<double> {
        return (rest[at(i)] - rest[0]).template cast<double>() + moved(i);
      };
    };
    const auto x = placed(body.displacements()), xbar = placed(position);
    const auto v = in_double(body.velocities()), new_v = in_double(velocity);
    const Sums sums = sums_(executor, [&](Index begin, Index end) {
      Sums part{};
      Columns sum(part.data());
      for (Index i = begin; i < end; ++i) {
        const auto mass_times = [&](const auto& field) { return body.mass().row_product(*body.pattern(), i, field); };
        const double mass = double(body.mass().row_sum(i));
        sum.col(mass_x) += mass * x(i);
        sum.col(mass_v) += mass * v(i);
        sum.col(spin) += x(i).cross(mass_times(v));
        sum.col(mass_xbar) += mass * xbar(i);
        sum.col(mass_new_v) += mass * new_v(i);
        sum.col(new_spin) += xbar(i).cross(mass_times(new_v));
        const Vec3<double> force = body.external_forces()[at(i)].template cast<double>();
        sum.col(all_force) += force;
        sum.col(torque) += (x(i) + double(h) / 2 * v(i)).cross(force);
        sum.template rightCols<3>() += xbar(i) * mass_times(xbar).transpose();
      }
      return part;
    });
    const Eigen::Map<const ColumnMatrix> sum(sums.data());
    const double total = body.mass().total();
    const Vec3<double> centre = sum.col(mass_x) / total, new_centre = sum.col(mass_xbar) / total;
    const Vec3<double> had = sum.col(spin) - centre.cross(sum.col(mass_v));
    const Vec3<double> has = sum.col(new_spin) - new_centre.cross(sum.col(mass_new_v));
    const Vec3<double> midway = centre + double(h) / 2 * sum.col(mass_v) / total;
    const Vec3<double> turned = double(h) * (sum.col(torque) - midway.cross(sum.col(all_force)));
    const Mat3<double> second = sum.template rightCols<3>() - total * new_centre * new_centre.transpose();

    const Vec3<Scalar> turn = angular_velocity(second, decay * had + std::sqrt(decay) * turned - has);
    const Vec3<Scalar> about = new_centre.template cast<Scalar>();
    for_ranges(executor, body.vertex_count(), RangeSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        velocity[at(i)] += turn.cross(rest[at(i)] - rest[0] + (position[at(i)] - position[0]) - about);
    });
  }

 private:
  enum Column { mass_x, mass_v, spin, mass_xbar, mass_new_v, new_spin, all_force, torque };
  using Sums = RangeSums<33>::Sums;
  using ColumnMatrix = Eigen::Matrix<double, 3, 11>;  // the last three: sum xbar (M xbar)^T
  using Columns = Eigen::Map<ColumnMatrix>;

  /// w of the angular momentum (tr(S) - S) w, rad/s, where S are the second moments, kg m^2. None about an axis on
  /// which all mass lies.
  [[nodiscard]] static Vec3<Scalar> angular_velocity(const Mat3<double>& second, const Vec3<double>& momentum) {
    Eigen::Matrix4d inertia = Eigen::Matrix4d::Zero();  // the fourth axis has none
    inertia.topLeftCorner<3, 3>() = second.trace() * Mat3<double>::Identity() - (second + second.transpose()) / 2;
    const Eigen::Matrix4d axes = detail::diagonalise<double>(inertia);
    const double least = std::numeric_limits<Scalar>::epsilon() * inertia.diagonal().maxCoeff();
    Vec3<double> turn = Vec3<double>::Zero();
    for (int k = 0; k < 4; ++k) {
      const Vec3<double> axis = axes.col(k).head<3>();
      if (inertia(k, k) > least) turn += axis.dot(momentum) / inertia(k, k) * axis;
    }
    const Vec3<Scalar> w = turn.template cast<Scalar>();
    return w.allFinite() ? w : Vec3<Scalar>::Zero().eval();
  }

  RangeSums<33> sums_;
};

}  // namespace corotet
