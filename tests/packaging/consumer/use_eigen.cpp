#include <corotet/eigen.hpp>

// Runs before main; a wrong result ends the program, which the test sees.
static const bool fields_are_vectors = [] {
  const corotet::Field<float> field(2, corotet::Vec3<float>(1, 2, 3));
  return corotet::flat(field).sum() == 12 ? true : (__builtin_trap(), false);
}();
