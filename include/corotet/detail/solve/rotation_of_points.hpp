// How far groups of points have turned: the rotation that fits them best.
#pragma once

#include <algorithm>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/rotation/polar.hpp>

namespace corotet::inline v0_1 {

/// Replaces each moment sum of x (x) X, with x and X the present and the rest offsets of a group's points from their
/// mean, by the rotation R that makes sum |x - R X|^2 least: the polar factor of the moment (Müller, Heidelberger,
/// Teschner & Gross 2005, "Meshless deformations based on shape matching", section 3.3). A group whose points lie on a
/// line, or coincide, gets one of the rotations that fit.
template <std::floating_point Scalar>
void rotations_of_moments(detail::Buffer<Mat3<Scalar>>& moment, ExecutorRef executor) {
  constexpr Index lanes = lane_count<Scalar>;
  for_ranges(executor, size_of(moment), 8 * lanes, [&](Index begin, Index end) {
    for (Index first = begin; first < end; first += lanes) {
      const Index used = (std::min)(lanes, end - first);
      Mat3Lanes<Scalar> f, r;
      for (Index l = 0; l < lanes; ++l) f.set_lane(l, moment[at(first + (std::min)(l, used - 1))]);
      Polar::extract(f, r);
      for (Index l = 0; l < used; ++l) moment[at(first + l)] = r.lane(l);
    }
  });
}

}  // namespace corotet::inline v0_1
