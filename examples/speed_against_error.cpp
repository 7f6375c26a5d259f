// Time of a step beside its error: the table of README.md, and those of docs/benchmarks/elements.md.
//
//   speed_against_error [readme | elements | quick]
//
// Beam 1 x 0.1 x 0.1 m under its own weight, q = 8 (the tip drops by 0.65 m), poisson 0.3. One thread.
//   ms a step   median over one second of the fall from rest: float, backward Euler at 1/60 s, solver tolerance 1e-3
//   in SpMV     the same, in products of the body's 3x3-block float matrix with a vector, timed in the same run
//   tip error   of the drop at rest, in double, solver tolerance 1e-8, against the converged 3D solution: space alone
//   algebra     largest difference of the float tip's path to one in double with tolerance 1e-10, of the length
#include <corotet/integrators.hpp>
#include <corotet/models.hpp>
#include <cstdio>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "self_weight_beam.hpp"

using namespace corotet;

namespace {

constexpr double h = 1.0 / 60;  // s
constexpr int steps = 60;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Processor time, which a busy machine lengthens less than the time on the wall. One thread, so the two mean the same.
template <class Work>
double milliseconds(Work&& work) {
  const std::clock_t start = std::clock();
  work();
  return 1e3 * double(std::clock() - start) / CLOCKS_PER_SEC;
}

/// A product of the body's matrix with a vector, ms.
template <class Body>
double spmv(const Body& body) {
  using Scalar = typename Body::scalar_type;
  BlockMatrix<Scalar> matrix(body.pattern());
  for (Index k = 0; k < body.pattern()->blocks(); ++k)
    matrix.block(k) = Mat3<Scalar>::Constant(Scalar(1) / Scalar(k + 1));
  Field<Scalar> x(at(body.vertex_count()), Vec3<Scalar>::Ones()), y(x);
  SerialExecutor serial;
  std::vector<double> times;
  const int repetitions = 1 + 200'000 / body.pattern()->blocks();  // long enough for a clock of microseconds
  for (int i = 0; i < 51; ++i)
    times.push_back(milliseconds([&] {
                      for (int k = 0; k < repetitions; ++k) matrix.apply(x, y, serial);
                    }) /
                    repetitions);
  return y[0].allFinite() ? median(times) : 0;
}

/// One second of the fall: the tip after each step, and how long each took.
struct Fall {
  std::vector<Vec3<double>> tip;
  double step_ms = 0, spmv_ms = 0, iterations = 0;
  bool direct = false;
};

template <class Body>
Fall fall(Body body, double tolerance) {
  using Scalar = typename Body::scalar_type;
  const Index tip = beam::hang(body);
  ImplicitEuler euler(body, SolverOptions{.tolerance = tolerance});
  Fall out;
  std::vector<double> times;
  for (int i = 0; i < steps; ++i) {
    StepReport report;
    times.push_back(milliseconds([&] { report = euler.step(body, Scalar(h)); }));
    out.iterations += double(report.iterations) / steps;
    out.tip.push_back(body.displacements()[at(tip)].template cast<double>());
    if (!report.ok()) std::fprintf(stderr, "step %d: %s\n", i, report.advice());
  }
  out.step_ms = median(times);
  out.spmv_ms = spmv(body);
  out.direct = euler.solver().method() == SolverMethod::cholesky;
  return out;
}

/// A row: `algebra` costs a second fall in double.
template <class Element, class Rotation = Polar>
bool row(const char* name, std::array<Index, 3> cells, BlockSplit split = BlockSplit::alternating5,
         MassModel mass = MassModel::lumped) {
  const auto single_mesh = beam::mesh<float, Element>(cells, split);
  const auto double_mesh = beam::mesh<double, Element>(cells, split);
  if (!single_mesh || !double_mesh) return false;
  const Material material = beam::material(8, 0.3);
  const auto single = SoftBody<float, Element, Rotation>::create(*single_mesh, material, {.mass = mass, .damping = {}});
  auto precise = SoftBody<double, Element, Rotation>::create(*double_mesh, material, {.mass = mass, .damping = {}});
  if (!single || !precise) return false;

  const Fall fast = fall(*single, 1e-3), exact = fall(*precise, 1e-10);
  double algebra = 0;
  for (std::size_t i = 0; i < steps; ++i) algebra = std::max(algebra, (fast.tip[i] - exact.tip[i]).norm());

  const Index tip = beam::hang(*precise);
  if (!solve_static(*precise, {.tolerance = 1e-8}).converged)
    return std::fprintf(stderr, "%s does not come to rest\n", name), false;
  const double drop = -precise->displacements()[at(tip)].z();
  std::printf("| %-34s | %6d | %6d | %8.3f | %5.0f | %s | %+6.1f %% | %.3f %% |\n", name, single->vertex_count(),
              single->mesh().element_count(), fast.step_ms, fast.step_ms / fast.spmv_ms,
              fast.direct ? "direct" : (std::to_string(int(fast.iterations + 0.5)) + " CG").c_str(),
              100 * (drop / beam::reference_drop - 1), 100 * algebra / beam::length);
  std::fflush(stdout);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "readme";
  std::printf(
      "| mesh | vertices | elements | ms a step | in SpMV | solver | tip error | algebra |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  if (what == "quick") return row<Tet10>("Tet10, 10x1x1 cells", {10, 1, 1}) ? 0 : 1;
  if (what == "readme")
    return row<Tet4>("Tet4, 20x2x2 cells", {20, 2, 2}) && row<Tet4>("Tet4, 40x4x4 cells", {40, 4, 4}) &&
                   row<Tet4>("Tet4, 60x6x6 cells", {60, 6, 6}) && row<Tet10>("Tet10, 10x1x1 cells", {10, 1, 1}) &&
                   row<Tet10>("Tet10, 20x2x2 cells", {20, 2, 2})
               ? 0
               : 1;
  if (what == "elements") {
    constexpr auto kuhn = BlockSplit::kuhn6, alternating = BlockSplit::alternating5;
    constexpr auto consistent = MassModel::consistent;
    return row<Tet4>("Tet4, 40x4x4, alternating", {40, 4, 4}) && row<Tet4>("Tet4, 40x4x4, Kuhn", {40, 4, 4}, kuhn) &&
                   row<Tet10>("Tet10, 10x1x1, Kuhn", {10, 1, 1}, kuhn) &&
                   row<Tet10, PerElement<Polar>>("Tet10, 10x1x1, Kuhn, R an element", {10, 1, 1}, kuhn) &&
                   row<Tet10>("Tet10, 10x1x1", {10, 1, 1}) &&
                   row<Tet10, PerElement<Polar>>("Tet10, 10x1x1, R an element", {10, 1, 1}) &&
                   row<Tet10>("Tet10, 10x1x1, consistent mass", {10, 1, 1}, alternating, consistent) &&
                   row<Tet10>("Tet10, 20x2x2, Kuhn", {20, 2, 2}, kuhn) && row<Tet10>("Tet10, 20x2x2", {20, 2, 2}) &&
                   row<Tet10, PerElement<Polar>>("Tet10, 20x2x2, R an element", {20, 2, 2}) &&
                   row<Tet10>("Tet10, 20x2x2, consistent mass", {20, 2, 2}, alternating, consistent)
               ? 0
               : 1;
  }
  std::fprintf(stderr, "speed_against_error [readme | elements | quick]\n");
  return 2;
}
