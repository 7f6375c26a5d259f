// Random input for property tests: seeded, so that a failure can be replayed.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <random>

namespace corotet::testing {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  /// Uniform in [low, high).
  double uniform(double low = 0, double high = 1) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  double normal() { return normal_(engine_); }

  Vec3<double> vector(double size = 1) {
    const double x = normal(), y = normal(), z = normal();
    return size * Vec3<double>(x, y, z);
  }

  Mat3<double> matrix(double size = 1) {
    Mat3<double> m;
    for (int k = 0; k < 9; ++k) m(k) = size * normal();
    return m;
  }

  /// Uniform over the rotation group.
  Mat3<double> rotation() {
    const double w = normal(), x = normal(), y = normal(), z = normal();
    return rotation_of(Matrix<double, 4, 1>(w, x, y, z).normalized());
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace corotet::testing
