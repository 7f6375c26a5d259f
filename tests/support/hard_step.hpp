// A step that needs several solves, and how each comes nearer to its solution.
#pragma once

#include <gtest/gtest.h>

#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <vector>

#include "support/bodies.hpp"

namespace corotet::testing {

/// Puts a bar along x, 1 m long and held at x = 0, far from rest and in motion; one of its pins moves.
template <class Body>
void make_step_hard(Body& body) {
  must(body.set_displacements(displacement_of(body.mesh(), [](const Vec3<double>& x) {
    return Vec3<double>(1.15 * x.x(), x.y() * (1 + 0.1 * x.x()), x.z() + 0.2 * x.x() * x.x());
  })));
  must(body.set_velocities(displacement_of(body.mesh(), [](const Vec3<double>& x) {
    return Vec3<double>(x.x(), x.y() + 2 * x.x(), x.z() - 4 * x.x() * x.x());
  })));
  const Index led = body.pins().vertices().front();
  body.move_pin(led, body.position(led) + Vec3<double>(0.01, 0.01, 0));
}

/// The distance of k solves of a step from the solution, k = 1 ... most.
template <class Body>
std::vector<double> errors_of_solves(const Body& start, Tangent tangent, int most) {
  const auto after = [&](int solves) {
    Body body = start;
    ImplicitEuler euler(body, SolverOptions{.method = SolverMethod::cholesky, .tolerance = 1e-12},
                        {.iterations = solves, .tolerance = 1e-15, .tangent = tangent});
    EXPECT_TRUE(euler.step(body, 1.0 / 60).accepted());
    return body;
  };
  const Body solution = after(60);
  std::vector<double> errors;
  for (int k = 1; k <= most; ++k)
    errors.push_back((flat(after(k).displacements()) - flat(solution.displacements())).norm());
  return errors;
}

/// From the second solve on each error is at most a multiple of the square of that before.
inline void expect_quadratic(const std::vector<double>& errors) {
  EXPECT_GT(errors[1], 1e-5) << "so near that nothing shows";
  for (std::size_t k = 1; k + 1 < errors.size(); ++k)
    EXPECT_LT(errors[k + 1], 20 * errors[k] * errors[k] + 1e-14) << k + 1 << " solves";
}

}  // namespace corotet::testing
