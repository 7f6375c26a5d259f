// Compiled for another instruction set and without assertions: see layout.hpp.
#include "one_program/layout.hpp"

namespace corotet::one_program {

std::vector<std::pair<std::size_t, std::size_t>> layout_elsewhere() { return layout(); }
std::unique_ptr<Bundle<Tet4>> linear_elsewhere() { return make_bundle<Tet4>(); }
std::unique_ptr<Bundle<Tet10>> quadratic_elsewhere() { return make_bundle<Tet10>(); }
double step_elsewhere(Bundle<Tet4>& bundle) { return step_and_compare(bundle); }
double step_elsewhere(Bundle<Tet10>& bundle) { return step_and_compare(bundle); }

}  // namespace corotet::one_program
