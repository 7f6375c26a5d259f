// The solvers are compiled once, in solver_instances.cpp, and not again in each file that steps a body.
#pragma once

#include <corotet/solve/auto_solver.hpp>

namespace corotet {

extern template class AutoSolver<float>;
extern template class AutoSolver<double>;

}  // namespace corotet
