// Sparse Cholesky factorisation and solution on the matrices of steps: BlockCholesky beside Eigen's SimplicialLLT and
// SuiteSparse's CHOLMOD. In double, on one thread (CHOLMOD: if its BLAS uses one). Rows: phase, library, body.
//
// Columns: `products`, processor time in products of the same matrix with a vector; `residual`, |b - A x| / |b|;
// `fill`, numbers of the factor's triangle to those of the matrix's. XS, S and M are the beams of `corotet bench`,
// others are small bodies: cells along the edges, five tetrahedra each.
#include <benchmark/benchmark.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/element/tet10.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/solve/block_cholesky.hpp>
#include <ctime>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#ifdef COROTET_BENCH_CHOLMOD
#include <Eigen/CholmodSupport>
#endif

namespace corotet {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

/// Of this process, s: other processes do not count.
double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

/// M + h^2 K' of a cantilever on its way down, in double.
struct StepMatrix {
  BlockMatrix<double> blocks;
  Sparse numbers;  ///< the lower triangle
  Field<double> right_side;
  double product_seconds = 0;  ///< the best of five runs
};

template <class Element>
std::unique_ptr<StepMatrix> make_matrix(std::array<Index, 3> cells, BlockSplit split) {
  const BlockOptions options{
      .corner = {0, -0.1, -0.1}, .size = {1, 0.2, 0.2}, .cells = cells, .split = split, .order = Element::order};
  using Body = SoftBody<double, Element>;
  Body body = Body::create(TetMesh<double, Element>::create(make_block(options).value()).value(),
                           Material{.young = 5e5, .poisson = 0.3, .density = 1000})
                  .value();
  body.pin_where([](const Vec3<double>& x) { return x.x() < 1e-3; });
  body.set_gravity({0, 0, -9.81});
  const double h = 1.0 / 60;
  {
    ImplicitEuler integrator(body);
    for (int step = 0; step < 10; ++step) integrator.step(body, h);
  }
  auto matrix = std::make_unique<StepMatrix>();
  typename Body::Law::Evaluation evaluation(body.law());
  body.law().evaluate(body.displacements(), evaluation, {});
  matrix->blocks = BlockMatrix<double>(body.pattern());
  assemble(body.law(), evaluation, body.mass(), 1.0, h * h, matrix->blocks, {});
  for (const Index v : body.pins().vertices()) matrix->blocks.isolate(v);

  const BlockPattern& p = *body.pattern();
  std::vector<Eigen::Triplet<double, Index>> lower;
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          if (3 * i + r >= 3 * p.column[at(k)] + c)
            lower.emplace_back(3 * i + r, 3 * p.column[at(k)] + c, matrix->blocks.block(k)(r, c));
  matrix->numbers.resize(3 * p.rows(), 3 * p.rows());
  matrix->numbers.setFromTriplets(lower.begin(), lower.end());

  matrix->right_side.resize(at(p.rows()));
  for (Index i = 0; i < p.rows(); ++i) matrix->right_side[at(i)] = body.mass().row_sum(i) * Vec3<double>(1, -2, 0.5);
  Field<double> y(matrix->right_side.size());
  const int products = 1 + 10'000'000 / p.blocks();
  matrix->product_seconds = std::numeric_limits<double>::infinity();
  for (int run = 0; run < 5; ++run) {
    const double start = processor_seconds();
    for (int i = 0; i < products; ++i) {
      matrix->blocks.apply(matrix->right_side, y, {});
      benchmark::ClobberMemory();
    }
    matrix->product_seconds = (std::min)(matrix->product_seconds, (processor_seconds() - start) / products);
  }
  return matrix;
}

double residual(const StepMatrix& a, const Field<double>& x) {
  Field<double> product(x.size());
  a.blocks.apply(x, product, {});
  return (flat(product) - flat(a.right_side)).norm() / flat(a.right_side).norm();
}

// Each has: analyze, factorize, solve, and the numbers in the factor's triangle.

struct Own {
  BlockCholesky<double> cholesky;
  void analyze(const StepMatrix& a) { cholesky.analyze(a.blocks.pattern()); }
  [[nodiscard]] bool factorize(const StepMatrix& a) { return cholesky.factorize(a.blocks); }
  void solve(const StepMatrix& a, Field<double>& x) { cholesky.solve(a.right_side, x); }
  [[nodiscard]] double factor_numbers() const {
    return 9.0 * double(cholesky.symbolic().blocks) - 3.0 * cholesky.rows();  // of diagonal blocks, 6 of 9
  }
};

template <class Solver>
struct ByEigen {
  Solver solver;
  void analyze(const StepMatrix& a) { solver.analyzePattern(a.numbers); }
  [[nodiscard]] bool factorize(const StepMatrix& a) {
    solver.factorize(a.numbers);
    constexpr Eigen::ComputationInfo success{};
    return solver.info() == success;
  }
  void solve(const StepMatrix& a, Field<double>& x) { flat(x) = solver.solve(flat(a.right_side)); }
};
struct Simplicial : ByEigen<Eigen::SimplicialLLT<Sparse, Eigen::Lower>> {
  [[nodiscard]] double factor_numbers() const { return double(solver.matrixL().nestedExpression().nonZeros()); }
};
#ifdef COROTET_BENCH_CHOLMOD
struct Supernodal : ByEigen<Eigen::CholmodSupernodalLLT<Sparse, Eigen::Lower>> {
  [[nodiscard]] double factor_numbers() const { return 0; }  // supernodes hold zeros as well
};
#endif

template <class Solver>
void add(const std::string& library, const std::string& body,
         const std::shared_ptr<std::unique_ptr<StepMatrix>>& matrix, std::unique_ptr<StepMatrix> (*make)()) {
  using State = benchmark::State;
  // Google Benchmark calls a row several times: what is needed is made once, and first.
  const auto run = [=](State& state, const auto& prepare, const auto& phase) {
    if (*matrix == nullptr) *matrix = make();
    const StepMatrix& a = **matrix;
    Solver solver;
    prepare(solver, a);
    const double start = processor_seconds();
    for (auto _ : state) {
      phase(solver, a);
      benchmark::ClobberMemory();
    }
    state.counters["products"] = (processor_seconds() - start) / double(state.iterations()) / a.product_seconds;
    Field<double> x(a.right_side.size());
    if (!solver.factorize(a)) return state.SkipWithError("the matrix is not positive definite");
    solver.solve(a, x);
    state.counters["residual"] = residual(a, x);
    state.counters["fill"] = solver.factor_numbers() / double(a.numbers.nonZeros());
  };
  const auto name = [&](const char* phase) { return std::string(phase) + "/" + library + "/" + body; };
  benchmark::RegisterBenchmark(name("analyze").c_str(), [=](State& state) {
    run(
        state, [](Solver&, const StepMatrix&) {}, [](Solver& s, const StepMatrix& a) { s.analyze(a); });
  })->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark(name("factorize").c_str(), [=](State& state) {
    run(
        state, [](Solver& s, const StepMatrix& a) { s.analyze(a); },
        [](Solver& s, const StepMatrix& a) { benchmark::DoNotOptimize(s.factorize(a)); });
  })->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark(name("solve").c_str(), [=](State& state) {
    Field<double> x;
    run(
        state,
        [&](Solver& s, const StepMatrix& a) {
          s.analyze(a);
          benchmark::DoNotOptimize(s.factorize(a));
          x.resize(a.right_side.size());
        },
        [&](Solver& s, const StepMatrix& a) { s.solve(a, x); });
  })->Unit(benchmark::kMillisecond);
}

void add_body(const std::string& body, std::unique_ptr<StepMatrix> (*make)()) {
  const auto matrix = std::make_shared<std::unique_ptr<StepMatrix>>();
  add<Own>("corotet", body, matrix, make);
  add<Simplicial>("Eigen", body, matrix, make);
#ifdef COROTET_BENCH_CHOLMOD
  add<Supernodal>("CHOLMOD", body, matrix, make);
#endif
}

[[maybe_unused]] const bool added = [] {
  using enum BlockSplit;
  add_body("5x3x3", [] { return make_matrix<Tet4>({5, 3, 3}, alternating5); });
  add_body("10x1x1_tet10", [] { return make_matrix<Tet10>({10, 1, 1}, alternating5); });
  add_body("XS", [] { return make_matrix<Tet4>({10, 2, 2}, kuhn6); });
  add_body("S", [] { return make_matrix<Tet4>({20, 4, 4}, kuhn6); });
  add_body("M", [] { return make_matrix<Tet4>({50, 10, 10}, kuhn6); });
  return true;
}();

}  // namespace
}  // namespace corotet
