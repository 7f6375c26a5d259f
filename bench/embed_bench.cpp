// What an embedded surface costs: a frame, against a plain copy of the vertex buffer, and binding.
#include <benchmark/benchmark.h>

#include <cmath>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <cstddef>
#include <cstring>
#include <vector>

namespace corotet {
namespace {

constexpr Index rows = 400;  // a skin of rows x rows vertices around the beam

/// A wavy tube just under the beam's surface, in the order in which a modeller would number it.
void make_skin(std::vector<Vec3<double>>& positions, std::vector<Vec3<double>>& normals) {
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < rows; ++j) {
      const double along = (i + 0.5) / rows, angle = 6.283185307179586 * j / rows;
      const Vec3<double> outwards(0, std::cos(angle), std::sin(angle));
      positions.push_back(Vec3<double>(4 * along, 0.5, 0.5) + (0.4 + 0.05 * std::sin(40 * along)) * outwards);
      normals.push_back(outwards);
    }
}

template <std::floating_point Scalar, ReferenceElement Element>
TetMesh<Scalar, Element> make_beam(Index cells, bool curved) {
  BlockOptions options;
  options.size = {4, 1, 1};
  options.cells = {4 * cells, cells, cells};
  options.order = Element::order;
  MeshData data = make_block(options).value();
  if (curved)
    for (Vec3<double>& x : data.positions) x[2] += 0.05 * std::sin(6 * x[0]);
  return TetMesh<Scalar, Element>::create(std::move(data)).value();
}

/// Time a vertex: read it in nanoseconds ("20n").
void report_vertices(benchmark::State& state, std::size_t count) {
  state.counters["s/vertex"] =
      benchmark::Counter(double(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// One frame: positions and normals into a buffer of 24 bytes a vertex.
template <std::floating_point Scalar, ReferenceElement Element>
void update(benchmark::State& state) {
  const auto mesh = make_beam<Scalar, Element>(static_cast<Index>(state.range(0)), false);
  std::vector<Vec3<double>> positions, normals;
  make_skin(positions, normals);
  auto surface = EmbeddedSurface<Scalar, Element>::bind(mesh, positions, normals).value();
  Field<Scalar> u;
  for (const Vec3<Scalar>& x : mesh.positions()) u.push_back(Scalar(0.1) * x.cwiseProduct(x));
  std::vector<std::byte> bytes(24 * positions.size());
  const VertexBuffer buffer{bytes.data(), 24, size_of(positions), 0, 12};
  for (auto _ : state) {
    surface.update(u, buffer);
    benchmark::ClobberMemory();
  }
  state.counters["elements"] = double(mesh.element_count());
  report_vertices(state, positions.size());
}

/// The floor: the same bytes copied.
void copy(benchmark::State& state) {
  constexpr std::size_t vertices = std::size_t{rows} * rows;
  std::vector<std::byte> from(24 * vertices), to(24 * vertices);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), from.size());
    benchmark::ClobberMemory();
  }
  report_vertices(state, vertices);
}

template <std::floating_point Scalar, ReferenceElement Element, bool curved>
void bind(benchmark::State& state) {
  const auto mesh = make_beam<Scalar, Element>(static_cast<Index>(state.range(0)), curved);
  std::vector<Vec3<double>> positions, normals;
  make_skin(positions, normals);
  Index outside = 0;
  std::int64_t boxes = 0;
  for (auto _ : state) {
    const auto surface = EmbeddedSurface<Scalar, Element>::bind(mesh, positions, normals).value();
    outside = surface.outside_count();
    boxes = surface.boxes_visited();
  }
  state.counters["outside"] = outside;
  state.counters["boxes/vertex"] = double(boxes) / double(positions.size());
  report_vertices(state, positions.size());
}

BENCHMARK(copy);
BENCHMARK(update<float, Tet4>)->Arg(4)->Arg(16);
BENCHMARK(update<double, Tet4>)->Arg(4)->Arg(16);
BENCHMARK(update<float, Tet10>)->Arg(2)->Arg(8);
BENCHMARK(update<double, Tet10>)->Arg(2)->Arg(8);
BENCHMARK(bind<float, Tet4, false>)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(bind<float, Tet10, false>)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(bind<float, Tet10, true>)->Arg(4)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace corotet
