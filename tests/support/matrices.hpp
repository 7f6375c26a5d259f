// Matrices from their numbers.
#pragma once

#include <corotet/detail/core/types.hpp>

namespace corotet::testing {

inline Mat3<double> diagonal(const Vec3<double>& d) {
  Mat3<double> m = Mat3<double>::Zero();
  for (int i = 0; i < 3; ++i) m(i, i) = d[i];
  return m;
}

inline Mat3<double> of_rows(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  Mat3<double> m;
  m.set_row(0, a.transpose());
  m.set_row(1, b.transpose());
  m.set_row(2, c.transpose());
  return m;
}

}  // namespace corotet::testing
