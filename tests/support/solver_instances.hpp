// The default solver, compiled once for all tests: most of the time that a test of steps takes to compile.
#pragma once

#include <corotet/solve/auto_solver.hpp>

namespace corotet {

extern template class AutoSolver<float>;
extern template class AutoSolver<double>;

}  // namespace corotet
