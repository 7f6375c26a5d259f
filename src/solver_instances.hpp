// The solvers are compiled once, in solver_instances.cpp, and not again in each file that steps a body.
#pragma once

#include <corotet/solve/auto_solver.hpp>
#include <memory>

#include "thread_pool.hpp"

namespace corotet {

extern template void AutoSolver<float>::analyze(const std::shared_ptr<const BlockPattern>&, const Field<float>&);
extern template void AutoSolver<double>::analyze(const std::shared_ptr<const BlockPattern>&, const Field<double>&);
extern template SolveReport AutoSolver<float>::solve(const StepSystem<float>&, Field<float>&, program::ThreadPool&);
extern template SolveReport AutoSolver<double>::solve(const StepSystem<double>&, Field<double>&, program::ThreadPool&);

}  // namespace corotet
