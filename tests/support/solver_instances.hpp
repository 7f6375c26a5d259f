// The default solver, serial, compiled once for all tests: most of the time that a test of steps takes to compile.
#pragma once

#include <corotet/core/executor.hpp>
#include <corotet/solve/auto_solver.hpp>
#include <memory>

namespace corotet {

extern template void AutoSolver<float>::analyze(const std::shared_ptr<const BlockPattern>&, const Field<float>&);
extern template void AutoSolver<double>::analyze(const std::shared_ptr<const BlockPattern>&, const Field<double>&);
extern template SolveReport AutoSolver<float>::solve(const StepSystem<float>&, Field<float>&, SerialExecutor&);
extern template SolveReport AutoSolver<double>::solve(const StepSystem<double>&, Field<double>&, SerialExecutor&);

}  // namespace corotet
