#include "support/solver_instances.hpp"

namespace corotet {

template void AutoSolver<float>::analyze(const std::shared_ptr<const BlockPattern>&, const Field<float>&);
template void AutoSolver<double>::analyze(const std::shared_ptr<const BlockPattern>&, const Field<double>&);
template SolveReport AutoSolver<float>::solve(const StepSystem<float>&, Field<float>&, SerialExecutor&);
template SolveReport AutoSolver<double>::solve(const StepSystem<double>&, Field<double>&, SerialExecutor&);

}  // namespace corotet
