#include "support/solver_instances.hpp"

namespace corotet {

template class AutoSolver<float>;
template class AutoSolver<double>;

}  // namespace corotet
