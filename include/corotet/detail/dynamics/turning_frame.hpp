// A body that nothing holds turns without growing, and keeps its angular momentum.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/elementary.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/term_sum.hpp>
#include <corotet/detail/dynamics/time_step.hpp>
#include <corotet/detail/rotation/polar_robust.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/small_cholesky.hpp>
#include <corotet/detail/terms/term_state.hpp>
#include <limits>

namespace corotet::inline v0_1::detail {

/// The frame in which a step of a body without pins is solved, and the projection of its angular momentum.
///
/// The frame turns about the centre of mass at the angular velocity w of the body's angular momentum and inertia. Along
/// straight lines the body would grow by sqrt(1 + (h w)^2) a step. In the frame the velocity u = v - w x r of a vertex
/// at r turns by -2 h w (Coriolis) and gains -g w x (w x r): docs/theory.md, equation 16.
///
/// The projection restores the angular momentum, which implicit integrators damp, by the change of velocity that is
/// smallest in the norm of M: a rotation about the centre of mass (Hairer, Lubich & Wanner 2006, section IV.4).
template <class Body>
class TurningFrame {
 public:
  using Scalar = typename Body::scalar_type;

  explicit TurningFrame(Index vertices) : before_sums_(vertices), after_sums_(vertices), finite_(vertices) {}

  /// Before a step: what the body's angular momentum about its centre of mass will be after it, from what it is, what
  /// mass damping (1/s) leaves of that (to the order of the scheme), and what nodal forces do to it.
  void begin(const Body& body, const TimeStep<Scalar>& step, double mass_damping, ExecutorRef executor) {
    const auto h = double(step.h);
    const auto x = placed(body, body.displacements());
    const auto v = relative(body.velocities());
    const auto sums = before_sums_(executor, [&](Index begin, Index end) {
      auto sum = Matrix<double, 3, 8>::Zero();
      for (Index i = begin; i < end; ++i) {
        add_motion(body, i, x, v, sum);
        const Vec3<double> force = body.external_forces()[at(i)].template cast<double>();
        add_to_column(sum, 6, force);
        add_to_column(sum, 7, (x(i) + h / 2 * v(i)).cross(force));
      }
      return sums_of<24>(sum);
    });
    prepare(body, step, mass_damping, Matrix<double, 3, 8>::load(sums.data()));
  }

  /// Enters the frame for the step that has begun: `velocity` is the body's as seen from it, m/s.
  void enter(const Body& body, Scalar h, Field<Scalar>& velocity, ExecutorRef executor) {
    const Vec3<double> w = turn_rate_ = angular_velocity(before_.second, before_.momentum);
    turn_ = double(h) * w;
    const Mat3<double> coriolis = rotation_by(-2 * turn_);
    const double g = double(h) / detail::square_root(1 + turn_.squaredNorm());
    const auto x = placed(body, body.displacements());
    const auto v = relative(body.velocities());
    const Vec3<double> flight = body.velocities()[0].template cast<double>() + before_.velocity;
    for_ranges(executor, body.vertex_count(), DeterministicSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const Vec3<double> around = w.cross(x(i) - before_.centre);
        const Vec3<double> seen = coriolis * (v(i) - before_.velocity - around) - g * w.cross(around);
        velocity[at(i)] = (flight + seen).template cast<Scalar>();
      }
    });
  }

  /// Once in the frame: where its points are in space after the step.
  [[nodiscard]] TurningPlacement<Scalar> placement() const {
    return {.rotation = rotation_by(turn_).template cast<Scalar>(),
            .pivot = pivot_.template cast<Scalar>(),
            .pivot_velocity = pivot_velocity_.template cast<Scalar>(),
            .angular_velocity = turn_rate_.template cast<Scalar>(),
            .turns = true};
  }

  /// Leaves the frame, if it was entered, and gives the body its angular momentum: turns the solution of a step, with
  /// x' = x_history + gamma v'. Implicit terms add the moments of their impulses, and resist the correction; the body
  /// is then where they saw it, and its velocities alone are corrected. `linearized`: the state of these terms. False
  /// if a number is not finite.
  [[nodiscard]] COROTET_COLD bool leave(const Body& body, Scalar gamma, TermSum<Scalar>& terms,
                                        const TermState<Scalar>& linearized, Field<Scalar>& displacement,
                                        Field<Scalar>& velocity, ExecutorRef executor) {
    const bool implicit = terms.is_implicit();
    Matrix<double, 3, 8> sums = sums_after(body, gamma, terms, displacement, velocity, executor);
    if (implicit && share_correction(body, double(gamma), sums, terms, linearized, displacement, velocity)) {
      sums = sums_after(body, gamma, terms, displacement, velocity, executor);
      if (terms.has_piecewise()) {
        const Vec3<double> moved =
            resultant(placed(body, displacement), motion(body, sums).centre, terms.piecewise_impulses(linearized))
                .template tail<3>();
        sums.set_col(7, sums.col(7) + held_moment_ - moved);
      }
    }
    const Departure to = departure(body, gamma, sums, implicit, displacement, velocity);
    const auto x = placed(body, displacement);
    const auto v = relative(velocity);
    const double not_finite = finite_(executor, [&](Index begin, Index end) {
      bool finite = true;
      for (Index i = begin; i < end; ++i) {
        const Vec3<double> before = x(i) - to.centre, after = to.turn * before;
        displacement[at(i)] += (to.shift + (after - before)).template cast<Scalar>();
        velocity[at(i)] = (to.flight + to.turn * (v(i) - to.velocity) + to.spin.cross(after)).template cast<Scalar>();
        finite = finite && displacement[at(i)].allFinite() && velocity[at(i)].allFinite();
      }
      return finite ? 0.0 : 1.0;
    });
    return is_zero(not_finite);
  }

  [[nodiscard]] MemoryUse memory() const { return before_sums_.memory() + after_sums_.memory() + finite_.memory(); }

 private:
  /// Of a whole body, relative to its first vertex: sums stay small in flight and far from the origin.
  struct Motion {
    Vec3<double> centre, velocity;  ///< of mass, m and m/s
    Vec3<double> momentum;          ///< angular, about the centre, kg m^2/s
    Mat3<double> second;            ///< moments of the mass about the centre, kg m^2
  };

  /// How a solution leaves the frame: x' = x + shift + (turn - 1) r, v' = flight + turn (v - velocity) + spin x turn r,
  /// with r = x - centre.
  struct Departure {
    Vec3<double> centre, velocity, shift, flight, spin;
    Mat3<double> turn;
  };

  COROTET_COLD void prepare(const Body& body, const TimeStep<Scalar>& step, double mass_damping,
                            const Matrix<double, 3, 8>& sum) {
    const auto h = double(step.h);
    before_ = motion(body, sum);
    const double damping = h * mass_damping;
    const double decay = step.is_first_order() ? 1 / (1 + damping) : exponential(-damping);
    const Vec3<double> midway = before_.centre + h / 2 * before_.velocity;
    goal_ = decay * before_.momentum + h * detail::square_root(decay) * (sum.col(7) - midway.cross(sum.col(6)));
    turn_rate_.setZero();
    turn_.setZero();
    // Where the centre of mass would be without forces: about that the frame turns.
    pivot_velocity_ =
        (body.velocities()[0].template cast<double>() + before_.velocity) / (1 + double(step.gamma) * mass_damping);
    pivot_ = origin(body, body.displacements()) + before_.centre + double(step.gamma) * pivot_velocity_;
  }

  [[nodiscard]] COROTET_COLD Departure departure(const Body& body, Scalar gamma, const Matrix<double, 3, 8>& sum,
                                                 bool implicit, const Field<Scalar>& displacement,
                                                 const Field<Scalar>& velocity) {
    const Motion solved = motion(body, sum);
    const Mat3<double> turn = rotation_by(turn_);
    if (implicit) goal_ = goal_ + turn * (sum.col(7) - solved.centre.cross(sum.col(6)));
    const Vec3<double> still = velocity[0].template cast<double>() + solved.velocity;
    const Vec3<double> arm = origin(body, displacement) + solved.centre - pivot_;
    const Vec3<double> shift = turn * arm - arm;
    const Vec3<double> flight = pivot_velocity_ + turn * (still - pivot_velocity_);
    Mat3<double> q = turn;  // and on, by what the solution lacks besides the frame's own turn
    if (!implicit)
      q *= rotation_by(double(gamma) *
                       (angular_velocity(solved.second, q.transpose() * goal_ - solved.momentum) - turn_rate_));
    const Vec3<double> w = angular_velocity(q * solved.second * q.transpose(), goal_ - q * solved.momentum);
    return {solved.centre, solved.velocity, shift, flight, w, q};
  }

  /// Of a solution: add_motion's, and of implicit terms the impulses and their moments.
  [[nodiscard]] Matrix<double, 3, 8> sums_after(const Body& body, Scalar gamma, const TermSum<Scalar>& terms,
                                                const Field<Scalar>& displacement, const Field<Scalar>& velocity,
                                                ExecutorRef executor) {
    const auto x = placed(body, displacement);
    const auto v = relative(velocity);
    const bool implicit = terms.is_implicit();
    const auto sums = after_sums_(executor, [&](Index begin, Index end) {
      auto sum = Matrix<double, 3, 8>::Zero();
      for (Index i = begin; i < end; ++i) {
        add_motion(body, i, x, v, sum);
        if (!implicit) continue;
        const Vec3<double> impulse = terms.impulse(i, gamma).template cast<double>();
        add_to_column(sum, 6, impulse);
        add_to_column(sum, 7, x(i).cross(impulse));
      }
      return sums_of<24>(sum);
    });
    return Matrix<double, 3, 8>::load(sums.data());
  }

  /// Moves a solution by the part of the spin that it lacks to which its terms give way: the Galerkin projection onto
  /// rigid motions, with the terms' stiffness and the body's inertia. The rest of it the terms get as impulses, so that
  /// all momentum is kept. A body that is pressed hard would else be spun the more, the harder it is pressed. False if
  /// nothing was moved.
  COROTET_COLD bool share_correction(const Body& body, double gamma, const Matrix<double, 3, 8>& sums,
                                     TermSum<Scalar>& terms, const TermState<Scalar>& linearized,
                                     Field<Scalar>& displacement, Field<Scalar>& velocity) {
    const Motion solved = motion(body, sums);
    const Mat3<double> inertia =
        solved.second.trace() * Mat3<double>::Identity() - (solved.second + solved.second.transpose()) / 2;
    const Vec3<double> moment = sums.col(7) - solved.centre.cross(sums.col(6));
    const Vec3<double> lacking =  // turn_rate_ is the same in the frame
        rotation_by(turn_).transpose() * goal_ + moment - solved.momentum - inertia * turn_rate_;
    // What turns a body by less than positions are rounded is not worth it.
    if (gamma * lacking.norm() <= double(std::numeric_limits<Scalar>::epsilon()) * inertia.trace() / 3) return false;
    const auto x = placed(body, displacement);
    using Vec6 = Matrix<double, 6, 1>;
    const auto rigid_motion = [&x, &solved](const Vec6& twist) {
      return [&x, &solved, twist](Index i) -> Vec3<Scalar> {
        const Vec3<double> about = twist.tail<3>();
        return (twist.head<3>() + about.cross(x(i) - solved.centre)).template cast<Scalar>();
      };
    };
    Matrix<double, 6, 6> resistance = Matrix<double, 6, 6>::Zero();
    for (int k = 0; k < 6; ++k) {
      const Vec6 mode = Matrix<double, 6, 6>::Identity().col(k);
      resistance.set_col(k, resultant(x, solved.centre, terms.stiffness_product(linearized, rigid_motion(mode))));
    }
    // Impulses of springs go with their points. Those of contacts stay with the obstacles.
    const Field<Scalar>& of_pieces = terms.piecewise_impulses(linearized);
    Mat3<double> moments = Mat3<double>::Zero();
    for (Index i = 0; i < body.vertex_count(); ++i) {
      const Vec3<Scalar> impulse = terms.impulse(i, static_cast<Scalar>(gamma)) - of_pieces[at(i)];
      moments += (x(i) - solved.centre) * impulse.template cast<double>().transpose();
    }
    const Mat3<double> turning = gamma * (moments - moments.trace() * Mat3<double>::Identity());
    resistance.set_block(3, 3, Mat3<double>(resistance.template block<3, 3>(3, 3) + inertia - turning));
    for (int i = 0; i < 3; ++i) resistance(i, i) += body.mass().total();

    Vec6 change = Vec6::Zero();
    for (int i = 0; i < 3; ++i) change[3 + i] = lacking[i];
    Matrix<double, 6, 6> root;
    if (!inverse_cholesky(Matrix<double, 6, 6>(0.5 * (resistance + resistance.transpose())), root)) return false;
    change = root.transpose() * (root * change);
    const Field<Scalar>& move = terms.move(linearized, rigid_motion(change));
    held_moment_ = resultant(x, solved.centre, terms.piecewise_impulses(linearized)).template tail<3>();
    for (Index i = 0; i < body.vertex_count(); ++i) {
      displacement[at(i)] += static_cast<Scalar>(gamma) * move[at(i)];
      velocity[at(i)] += move[at(i)];
    }
    return true;
  }

  /// Sum of a field of impulses, and of their moments about a centre.
  template <class Place>
  [[nodiscard]] static Matrix<double, 6, 1> resultant(const Place& x, const Vec3<double>& centre,
                                                      const Field<Scalar>& impulse) {
    Vec3<double> sum = Vec3<double>::Zero(), moment = sum;
    for (Index i = 0; i < size_of(impulse); ++i) {
      const Vec3<double> p = impulse[at(i)].template cast<double>();
      sum += p;
      moment += (x(i) - centre).cross(p);
    }
    Matrix<double, 6, 1> both;
    both.set_block(0, 0, sum);
    both.set_block(3, 0, moment);
    return both;
  }

  [[nodiscard]] static auto relative(const Field<Scalar>& field) {
    return
        [&field, first = field[0]](Index i) -> Vec3<double> { return (field[at(i)] - first).template cast<double>(); };
  }
  [[nodiscard]] static auto placed(const Body& body, const Field<Scalar>& displacement) {
    return [&rest = body.mesh().positions(), moved = relative(displacement)](Index i) -> Vec3<double> {
      return (rest[at(i)] - rest[0]).template cast<double>() + moved(i);
    };
  }

  /// Where the first vertex is, m.
  [[nodiscard]] static Vec3<double> origin(const Body& body, const Field<Scalar>& displacement) {
    return body.mesh().position(0).template cast<double>() + displacement[0].template cast<double>();
  }

  /// Columns: mass x, mass v, x cross mass v, and three of x (mass x)^T.
  template <class Place, class Speed, class Columns>
  static void add_motion(const Body& body, Index i, const Place& x, const Speed& v, Columns& sum) {
    const auto mass_times = [&](const auto& field) { return body.mass().row_product(*body.pattern(), i, field); };
    const double mass = double(body.mass().row_sum(i));
    const Mat3<double> second = x(i) * mass_times(x).transpose();
    add_to_column(sum, 0, mass * x(i));
    add_to_column(sum, 1, mass * v(i));
    add_to_column(sum, 2, x(i).cross(mass_times(v)));
    for (int k = 0; k < 3; ++k) add_to_column(sum, 3 + k, second.col(k));
  }
  template <class Columns>
  static void add_to_column(Columns& sum, int column, const Vec3<double>& v) {
    for (int i = 0; i < 3; ++i) sum(i, column) += v[i];
  }
  template <std::size_t n, class Columns>
  [[nodiscard]] static std::array<double, n> sums_of(const Columns& sum) {
    std::array<double, n> sums;
    std::copy(sum.begin(), sum.end(), sums.begin());
    return sums;
  }
  template <class Columns>
  [[nodiscard]] static Motion motion(const Body& body, const Columns& sum) {
    const double mass = body.mass().total();
    const Vec3<double> centre = sum.col(0) / mass;
    return {centre, sum.col(1) / mass, sum.col(2) - centre.cross(sum.col(1)),
            sum.template block<3, 3>(0, 3) - mass * centre * centre.transpose()};
  }

  /// w of the angular momentum (tr(S) - S) w, rad/s, where S are the second moments, kg m^2. None about an axis on
  /// which all mass lies.
  [[nodiscard]] COROTET_COLD static Vec3<double> angular_velocity(const Mat3<double>& second,
                                                                  const Vec3<double>& momentum) {
    Matrix<double, 4, 4> inertia = Matrix<double, 4, 4>::Zero();  // the fourth axis has none
    inertia.set_block(0, 0, second.trace() * Mat3<double>::Identity() - (second + second.transpose()) / 2);
    const Matrix<double, 4, 4> axes = diagonalise<double>(inertia);
    const double least = static_cast<double>(std::numeric_limits<Scalar>::epsilon()) * inertia.diagonal().maxCoeff();
    Vec3<double> w = Vec3<double>::Zero();
    for (int k = 0; k < 4; ++k) {
      const Vec3<double> axis = axes.col(k).head<3>();
      if (inertia(k, k) > least) w += axis.dot(momentum) / inertia(k, k) * axis;
    }
    return w.allFinite() ? w : Vec3<double>::Zero();
  }

  Motion before_{};
  Vec3<double> goal_ = Vec3<double>::Zero();       // angular momentum after the step
  Vec3<double> turn_rate_ = Vec3<double>::Zero();  // angular velocity of the frame, rad/s, 0 if it was not entered
  Vec3<double> turn_ = Vec3<double>::Zero();       // the angle of that in the step, rad
  Vec3<double> pivot_ = Vec3<double>::Zero(), pivot_velocity_ = pivot_;
  Vec3<double> held_moment_ = Vec3<double>::Zero();  // of piecewise terms, where they saw the body
  DeterministicReduction<24> before_sums_, after_sums_;
  DeterministicSum finite_;
};

}  // namespace corotet::inline v0_1::detail
