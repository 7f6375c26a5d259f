// One rotation for a whole element instead of one at each quadrature point.
#pragma once

#include <corotet/detail/rotation/rotation_extractor.hpp>

namespace corotet::inline v0_1 {

/// `PerElement<Polar>` with Tet10: a quarter of the rotations, less accurate in large bending, and the force is no
/// longer exactly the gradient of an energy. docs/benchmarks/elements.md has the numbers. The same as `Model` for Tet4.
template <RotationExtractor Model>
struct PerElement : Model {
  static constexpr bool per_element = true;  ///< one rotation, of the mean F of an element
};

}  // namespace corotet::inline v0_1
