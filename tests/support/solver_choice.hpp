// Which preconditioner the tests of steps run with.
#pragma once

#include <corotet/detail/solve/auto_solver.hpp>
#include <cstdlib>
#include <string_view>

namespace corotet::testing {

/// `options`, with the preconditioner that the environment names in COROTET_TEST_PRECONDITIONER if it names one: so the
/// same tests run with each (tests/CMakeLists.txt).
[[nodiscard]] inline SolverOptions solver(SolverOptions options = {}) {
  const char* const wanted = std::getenv("COROTET_TEST_PRECONDITIONER");
  if (wanted == nullptr) return options;
  using enum PreconditionerKind;
  for (const PreconditionerKind kind : {jacobi, block_jacobi, rigid_aggregates, warped_cholesky})
    if (name_of(kind) == std::string_view(wanted)) {
      options.method = SolverMethod::pcg;
      options.preconditioner = kind;
      return options;
    }
  std::abort();  // a name that means nothing must not pass
}

}  // namespace corotet::testing
