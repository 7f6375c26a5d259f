// A copy of a solver costs its numbers alone, knows how many bytes they are, and goes on bit for bit.
#include <corotet/detail/solve/auto_solver.hpp>
#include <corotet/detail/solve/block_jacobi.hpp>
#include <corotet/detail/solve/pcg_solver.hpp>
#include <corotet/detail/solve/rigid_aggregates.hpp>
#include <corotet/detail/solve/warped_cholesky.hpp>
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "solve/step_matrices.hpp"
#include "support/count_allocations.hpp"

namespace corotet::solver_memory_test {
namespace {

using testing::BeamSystem;

constexpr std::size_t alignment = detail::RawBuffer::alignment;

template <class T>
class SolverMemory : public ::testing::Test {};
TYPED_TEST_SUITE(SolverMemory, testing::AllCases);

template <class T>
bool same_bits(const Field<T>& a, const Field<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

struct Requests {
  long bytes, count;
};
template <class F>
Requests requests_of(F&& f) {
  const long bytes = testing::allocated_bytes, count = testing::allocation_count;
  f();
  return {testing::allocated_bytes - bytes, testing::allocation_count - count};
}

/// `memory()` says what a copy asks of the heap, to the rounding of aligned sizes; and a hundred copies ask for a
/// hundred times as much, none of it for what is shared.
template <class Solver>
void expect_honest(const Solver& solver, const char* name) {
  SCOPED_TRACE(name);
  const MemoryUse use = solver.memory();
  EXPECT_GT(use.owned, 0U);
  std::vector<Solver> copies;
  copies.reserve(101);
  const auto expect_owned = [&](const Requests& seen, long times) {
    EXPECT_GE(seen.bytes, times * static_cast<long>(use.owned));
    EXPECT_LE(seen.bytes, times * static_cast<long>(use.owned) + static_cast<long>(alignment) * seen.count);
  };
  expect_owned(requests_of([&] { copies.push_back(solver); }), 1);
  expect_owned(requests_of([&] {
                 for (int i = 0; i < 100; ++i) copies.push_back(copies.front());
               }),
               100);
  EXPECT_EQ(copies.back().memory().owned, use.owned);
  EXPECT_EQ(copies.back().memory().shared, use.shared);
}

template <class Scalar, class Element, class Visit>
void for_each_solver(const BeamSystem<Scalar, Element>& beam, Visit&& visit) {
  const auto analyzed = [&](auto solver, const char* name) {
    solver.analyze(beam.matrix.shared_pattern(), beam.rest());
    visit(solver, name);
  };
  analyzed(AutoSolver<Scalar>(), "auto");
  analyzed(AutoSolver<Scalar>({.method = SolverMethod::cholesky}), "cholesky");
  analyzed(AutoSolver<Scalar>({.preconditioner = PreconditionerKind::warped_cholesky}), "auto, warped");
  analyzed(PcgSolver<BlockJacobi<Scalar>>(), "block-Jacobi");
  analyzed(PcgSolver<RigidAggregates<Scalar>>(), "rigid aggregates");
  analyzed(PcgSolver<RigidAggregates<Scalar>>({}, RigidAggregates<Scalar>({12, 4})), "rigid aggregates, three levels");
  analyzed(PcgSolver<WarpedCholesky<Scalar>>(), "warped Cholesky");
}

TYPED_TEST(SolverMemory, IsWhatACopyAsksFor) {
  using Scalar = typename TypeParam::Scalar;
  BeamSystem<Scalar, typename TypeParam::Element> beam({8, 2, 2});
  for_each_solver(beam, [&](auto& solver, const char* name) {
    expect_honest(solver, name);
    Field<Scalar> x(beam.right_side.size());
    for (int i = 0; i < 3; ++i) solver.solve(beam.system(), x, {});
    expect_honest(solver, name);
  });
}

/// What analysis asks for, with what it needs on the way, is no less than what it keeps.
TYPED_TEST(SolverMemory, SharedAndOwnedWereAskedFor) {
  using Scalar = typename TypeParam::Scalar;
  BeamSystem<Scalar, typename TypeParam::Element> beam({8, 2, 2});
  for_each_solver(beam, [&](auto& solver, const char* name) {
    SCOPED_TRACE(name);
    const auto pattern = beam.matrix.shared_pattern();
    const Requests seen = requests_of([&] { solver.analyze(pattern, beam.rest()); });
    const MemoryUse use = solver.memory();
    EXPECT_LE(use.owned + use.shared, static_cast<std::size_t>(seen.bytes));
    EXPECT_GT(10 * (use.owned + use.shared), static_cast<std::size_t>(seen.bytes));
  });
}

/// The numbers of the factor once, in double, and some vectors: whatever a small body's solver may choose.
TYPED_TEST(SolverMemory, TheDefaultSolverOwnsOneFactorAndAFewVectors) {
  using Scalar = typename TypeParam::Scalar;
  const BeamSystem<Scalar, typename TypeParam::Element> beam({6, 3, 3});
  AutoSolver<Scalar> solver;
  solver.analyze(beam.matrix.shared_pattern(), beam.rest());
  const detail::SymbolicFactor factor(beam.matrix.pattern());
  const std::size_t vector = sizeof(PaddedVector<Scalar>) * beam.rest().size();
  EXPECT_LT(solver.memory().owned, 9 * sizeof(double) * factor.blocks + 20 * vector + 10000);
}

/// The original and its copy solve the same sequence of systems to the same bits, from any point of it; what one solves
/// the other does not notice.
TYPED_TEST(SolverMemory, ACopyGoesOnAsTheOriginal) {
  using Scalar = typename TypeParam::Scalar;
  BeamSystem<Scalar, typename TypeParam::Element> beam({8, 2, 2}, 5e8);  // stiff: `auto` changes its preconditioner
  for_each_solver(beam, [&](auto& solver, const char* name) {
    SCOPED_TRACE(name);
    Field<Scalar> x(beam.right_side.size()), y = x;
    const auto next_system = [&](int i) {
      beam.right_side = testing::random_field<Scalar>(beam.matrix.rows(), 1, unsigned(i));
      for (const Index v : beam.pinned) beam.right_side[at(v)].setZero();
    };
    for (int copied_at : {0, 1, 15, 18}) {
      solver.analyze(beam.matrix.shared_pattern(), beam.rest());
      for (int i = 0; i < copied_at; ++i) {
        next_system(i);
        solver.solve(beam.system(), x, {});
      }
      auto copy = solver;
      std::vector<Field<Scalar>> solutions;
      for (int i = copied_at; i < copied_at + 4; ++i) {
        next_system(i);
        EXPECT_EQ(solver.solve(beam.system(), x, {}).status, SolveStatus::converged);
        solutions.push_back(x);
      }
      for (int i = copied_at; i < copied_at + 4; ++i) {
        next_system(i);
        copy.solve(beam.system(), y, {});
        EXPECT_TRUE(same_bits(y, solutions[std::size_t(i - copied_at)])) << "copied after " << copied_at << ", " << i;
      }
    }
  });
}

}  // namespace
}  // namespace corotet::solver_memory_test
