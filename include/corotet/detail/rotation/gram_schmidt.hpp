// The simple rotation of Müller & Gross 2004, section 3.3: orthonormalise the columns of F.
#pragma once

#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/rotation/rotation_extractor.hpp>
#include <limits>

namespace corotet::inline v0_1 {

/// Gram-Schmidt on the columns of F. Cheap, but the result depends on the axes that the element was modelled in, and
/// the force is not the gradient of any energy: it does work over a closed loop and leaves a ghost torque. For
/// comparison; use Polar.
struct GramSchmidt {
  static constexpr bool per_element = false;                ///< each quadrature point has its own
  static constexpr std::string_view name = "gram_schmidt";  ///< as in messages

  /// Sets `r` to the rotation of each lane's F.
  template <std::floating_point Scalar>
  static void extract(const Mat3Lanes<Scalar>& f, Mat3Lanes<Scalar>& r) {
    for (int l = 0; l < lane_count<Scalar>; ++l) r.set_lane(l, rotation_of<Scalar>(f.lane(l)));
  }

 private:
  template <std::floating_point Scalar>
  static Mat3<Scalar> rotation_of(const Mat3<Scalar>& f) {
    const Vec3<Scalar> x = direction<Scalar>(f.col(0), Vec3<Scalar>::UnitX());
    // Where column 1 adds no direction of its own, any perpendicular will do.
    Vec3<Scalar> y = direction<Scalar>(f.col(1), Vec3<Scalar>::Zero());
    y -= x * x.dot(y);
    if (!(y.norm() > Scalar(8) * std::numeric_limits<Scalar>::epsilon())) y = x.unitOrthogonal();
    y.normalize();
    y -= x * x.dot(y);  // twice is enough (Kahan): cancellation above has cost digits
    y.normalize();
    Mat3<Scalar> r;
    r.set_col(0, x);
    r.set_col(1, y);
    r.set_col(2, x.cross(y));
    return r;
  }

  /// v / |v| without over- or underflow; `otherwise` for zero and non-finite v.
  template <std::floating_point Scalar>
  static Vec3<Scalar> direction(const Vec3<Scalar>& v, const Vec3<Scalar>& on_unreliable) {
    const Scalar largest = v.cwiseAbs().maxCoeff();
    if (!(largest > 0) || !std::isfinite(largest) || !v.allFinite()) return on_unreliable;
    return (v / largest).normalized();
  }
};

static_assert(RotationExtractor<GramSchmidt>);

}  // namespace corotet::inline v0_1
