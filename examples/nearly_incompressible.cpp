// Volumetric locking and its cure: the tables of docs/benchmarks/elements.md.
//
//   nearly_incompressible [quick | solid | MESH...]
//
// Beam 1 x 0.1 x 0.1 m, held at one end, with each element's own dilatation and with its mean over several. Without
// arguments on structured meshes; MESH: any mesh of that box, 0 <= x <= 1, -0.05 <= y, z <= 0.05, as 4-node elements.
//   deflection   under its own small weight at rest, as a share of the converged 3D solid's (double, tolerance 1e-8):
//                the error of the mesh alone. `solid` prints what that is compared with, some minutes.
//   ms a step    median over one second of a fall at poisson 0.499, where the solid hangs down by 0.65 m: float,
//                backward Euler at 1/60 s, solver tolerance 1e-3, one thread; and the iterations of a solve
//   short        steps of the 60 in which float's rounding kept the solver from its tolerance
#include <corotet/integrators.hpp>
#include <corotet/io.hpp>
#include <corotet/mesh.hpp>
#include <cstdio>
#include <ctime>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "self_weight_beam.hpp"

using namespace corotet;

namespace {

struct Ratio {
  double poisson;
  double solid;  // tip deflection of the converged solid over weight length^4 / 8 E I, +-0.0005
};
/// 10-node elements with six cells through the thickness. They fall because the clamp, which keeps the section from
/// shrinking sideways, holds the firmer.
constexpr Ratio ratios[] = {{0.3, 1.0005}, {0.45, 0.9893}, {0.499, 0.9838}, {0.4999, 0.9837}};

template <class Scalar, class Element>
std::optional<SoftBody<Scalar, Element>> make_beam(const MeshData& data, double q, double poisson,
                                                   VolumetricStrain volumetric_strain) {
  const auto mesh = TetMesh<Scalar, Element>::create(data);
  if (!mesh) return std::nullopt;
  auto body = SoftBody<Scalar, Element>::create(
      *mesh, beam::material(q, poisson),
      {.mass = MassModel::lumped, .damping = {}, .volumetric_strain = volumetric_strain});
  if (!body) return std::nullopt;
  return *body;
}

/// Tip deflection over weight length^4 / 8 E I, or nothing if the beam does not come to rest.
template <class Element>
std::optional<double> deflection(const MeshData& data, double poisson, VolumetricStrain volumetric_strain) {
  const double q = 0.05;
  auto body = make_beam<double, Element>(data, q, poisson, volumetric_strain);
  if (!body) return std::nullopt;
  const Index tip = beam::hang(*body);
  if (!solve_static(*body).converged) return std::nullopt;
  return -body->displacements()[at(tip)].z() / (q / 8 * beam::length);
}

struct Cost {
  double step_ms = 0, iterations = 0;
  int stopped_short = 0;
};

template <class Element>
std::optional<Cost> fall(const MeshData& data, VolumetricStrain volumetric_strain) {
  auto body = make_beam<float, Element>(data, 8, 0.499, volumetric_strain);
  if (!body) return std::nullopt;
  beam::hang(*body);
  ImplicitEuler euler(*body, SolverOptions{.tolerance = 1e-3});
  Cost cost;
  std::vector<double> times;
  constexpr int steps = 60;
  for (int i = 0; i < steps; ++i) {
    const std::clock_t start = std::clock();
    const StepReport report = euler.step(*body, 1.0F / 60);
    times.push_back(1e3 * double(std::clock() - start) / CLOCKS_PER_SEC);
    cost.iterations += double(report.iterations) / steps;
    if (!report.converged) ++cost.stopped_short;
  }
  std::sort(times.begin(), times.end());
  cost.step_ms = times[steps / 2];
  return cost;
}

template <class Element>
bool rows(const char* name, const MeshData& data) {
  for (const VolumetricStrain volumetric_strain : {VolumetricStrain::pointwise, VolumetricStrain::averaged}) {
    std::printf("| %-26s | %-11s |", name, volumetric_strain == VolumetricStrain::averaged ? "mean" : "per element");
    for (const auto& [poisson, solid] : ratios) {
      const auto drop = deflection<Element>(data, poisson, volumetric_strain);
      if (!drop) return std::fprintf(stderr, "%s does not come to rest\n", name), false;
      std::printf(" %.3f |", *drop / solid);
      std::fflush(stdout);
    }
    const auto cost = fall<Element>(data, volumetric_strain);
    if (!cost) return false;
    std::printf(" %.2f | %.0f CG | %d |\n", cost->step_ms, cost->iterations, cost->stopped_short);
  }
  return true;
}

template <class Element>
MeshData block(std::array<Index, 3> cells, BlockSplit split = BlockSplit::alternating5) {
  const auto mesh = beam::mesh<double, Element>(cells, split);
  return mesh ? mesh->data() : MeshData{};
}

bool converged_solid() {
  for (const Index n : {4, 6}) {
    std::printf("Tet10, %dx%dx%d:", 10 * n, n, n);
    for (const auto& [poisson, solid] : ratios) {
      const auto drop = deflection<Tet10>(block<Tet10>({10 * n, n, n}), poisson, VolumetricStrain::averaged);
      if (!drop) return false;
      std::printf(" nu %g: %.4f", poisson, *drop);
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  return true;
}

bool table(const std::string_view what, std::span<char*> files) {
  std::printf("| mesh | dilatation | nu 0.3 | 0.45 | 0.499 | 0.4999 | ms a step | solver | short |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  constexpr auto kuhn = BlockSplit::kuhn6;
  if (what == "quick") return rows<Tet4>("Tet4, 20x2x2, Kuhn", block<Tet4>({20, 2, 2}, kuhn));
  for (const char* file : files) {
    const auto data = read_mesh(file);
    if (!data) return std::fprintf(stderr, "%s\n", data.error().message().c_str()), false;
    if (!rows<Tet4>(file, lower_order(*data))) return false;
  }
  return !files.empty() || (rows<Tet4>("Tet4, 20x2x2, Kuhn", block<Tet4>({20, 2, 2}, kuhn)) &&
                            rows<Tet4>("Tet4, 20x2x2", block<Tet4>({20, 2, 2})) &&
                            rows<Tet4>("Tet4, 40x4x4, Kuhn", block<Tet4>({40, 4, 4}, kuhn)) &&
                            rows<Tet4>("Tet4, 40x4x4", block<Tet4>({40, 4, 4})) &&
                            rows<Tet10>("Tet10, 10x1x1, Kuhn", block<Tet10>({10, 1, 1}, kuhn)) &&
                            rows<Tet10>("Tet10, 10x1x1", block<Tet10>({10, 1, 1})) &&
                            rows<Tet10>("Tet10, 20x2x2", block<Tet10>({20, 2, 2})));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "solid") return converged_solid() ? 0 : 1;
  return table(what, std::span(argv, std::size_t(argc)).subspan(1)) ? 0 : 1;
}
