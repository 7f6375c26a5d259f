// What each kernel of a step costs, against the time that a plain copy takes to move the bytes which the kernel cannot
// do without. In float, one thread, on beams of 1 x 0.2 x 0.2 m. Rows: kernel, element, cells along the beam.
//
// Columns: bytes and flops a second, both counted by hand below; `floor`, the time of the copy, s; `of_floor`, the time
// in units of that. Below 1 is possible: a copy writes as much as it reads, and a cache reads faster than it writes.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <corotet/detail/assembly/assemble.hpp>
#include <corotet/detail/contact/contact_points.hpp>
#include <corotet/detail/contact/contacts.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/contact/sleep.hpp>
#include <corotet/detail/core/thread_pool.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/dynamics/step_bodies.hpp>
#include <corotet/detail/element/tet10.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/solve/block_jacobi.hpp>
#include <corotet/detail/solve/initial_guess.hpp>
#include <corotet/detail/solve/rigid_aggregates.hpp>
#include <corotet/detail/solve/warped_cholesky.hpp>
#include <cstddef>
#include <cstring>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "plain_product.hpp"

namespace corotet {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Bytes a second that a copy moves, reads and writes both counted, when both its arrays together are `size` bytes
/// long: as long as a kernel's data, so that they come from the same cache. The best of five runs.
double copy_bandwidth(double size) {
  static std::map<std::size_t, double> known;
  const auto length = std::max<std::size_t>(4096, static_cast<std::size_t>(size / 2));
  double& best = known[length];
  if (best > 0) return best;
  std::vector<std::byte> from(length, std::byte{1}), to(length, std::byte{2});
  const std::size_t copies = 1 + 10'000'000 / length;
  for (int run = 0; run < 5; ++run) {
    const auto start = Clock::now();
    for (std::size_t i = 0; i < copies; ++i) {
      std::memcpy(to.data(), from.data(), length);
      benchmark::ClobberMemory();
    }
    best = std::max(best, 2.0 * double(length * copies) / seconds_since(start));
  }
  return best;
}

/// The least that a kernel must do. Numbers are 4 bytes; so is an Index.
struct Work {
  double bytes;  ///< read and written; twice where a second pass must wait for the end of the first
  double flops;  ///< without those that only fill registers
  double floor;  ///< s

  /// `data`: bytes that lie in memory, each counted once.
  [[nodiscard]] static Work on(double data, double bytes, double flops) {
    return {bytes, flops, bytes / copy_bandwidth(data)};
  }
  [[nodiscard]] static Work once(double bytes, double flops) { return on(bytes, bytes, flops); }

  friend Work operator+(const Work& a, const Work& b) {
    return {a.bytes + b.bytes, a.flops + b.flops, a.floor + b.floor};
  }
  friend Work operator*(double n, const Work& a) { return {n * a.bytes, n * a.flops, n * a.floor}; }
};

/// Runs a kernel as often as Google Benchmark asks for; returns the seconds that one run takes.
template <class Kernel>
double measure(benchmark::State& state, Kernel&& kernel) {
  const auto start = Clock::now();
  for (auto _ : state) {
    kernel();
    benchmark::ClobberMemory();
  }
  return seconds_since(start) / double(state.iterations());
}

void report(benchmark::State& state, const Work& work, double seconds) {
  state.counters["bytes"] = benchmark::Counter(work.bytes, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["flops"] = benchmark::Counter(work.flops, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["floor"] = work.floor;
  state.counters["of_floor"] = seconds / work.floor;
}

template <class Kernel>
void measure(benchmark::State& state, const Work& work, Kernel&& kernel) {
  report(state, work, measure(state, kernel));
}

constexpr float time_step = 1.0F / 60;

/// A cantilever on its way down, the matrix of its next step, and the work of each kernel that a step consists of.
template <ReferenceElement Element>
struct Beam {
  using Body = SoftBody<float, Element>;
  static constexpr double nodes = Element::nodes, points = double(Element::stiffness_points.size());

  explicit Beam(Index cells) : body(make_body(cells)) {
    for (int step = 0; step < 10; ++step) integrator.step(body, time_step, serial);
    body.law().evaluate(body.displacements(), evaluation, serial);
    assemble_into(matrix);
    for (const Index v : body.pins().vertices()) matrix.isolate(v);
    for (std::size_t v = 0; v < x.size(); ++v) x[v].set(body.velocities()[v]);
    rigid.analyze(body.pattern(), body.mesh().positions());
  }

  static Body make_body(Index cells) {
    MeshData data = make_block({.corner = {0, -0.1, -0.1},
                                .size = {1, 0.2, 0.2},
                                .cells = {cells, cells / 5, cells / 5},
                                .split = BlockSplit::kuhn6,
                                .order = Element::order})
                        .value();
    auto made = Body::create(TetMesh<float, Element>::create(std::move(data)).value(),
                             Material{.young = 5e5, .poisson = 0.3, .density = 1000});
    made.value().pin_where([](const Vec3<float>& x) { return x.x() < 1e-3F; });
    made.value().set_gravity({0, 0, -9.81F});
    return std::move(made).value();
  }

  void assemble_into(BlockMatrix<float>& result) {
    assemble(body.law(), evaluation, body.mass(), 1.0F, time_step * time_step, result, serial);
  }
  [[nodiscard]] StepSystem<float> system() const {
    return {matrix, body.velocities(), body.displacements(), body.pins().vertices(), 1};  // any right side would do
  }

  // Reads the inverse Jacobian, sqrt(mu V), lambda / mu, the node numbers and the displacements; writes the force and,
  // for each point, the gradient of each node with a fourth number behind it. Operations: the rotation and 310 a point,
  // and for Tet10 three sums over nodes, of 18 operations a node.
  [[nodiscard]] Work evaluate_work() const {
    const double bytes = elements * (points * (36 + 4) + 4 + 4 * nodes + 16 * nodes * (1 + points)) + 12 * vertices;
    return Work::once(bytes, elements * points * (360 + 310 + (Element::order == 2 ? 54 * nodes : 0)));
  }
  // Reads the gradients, the list of contributions (4 bytes each), and where each upper block lies (slot, mirror, start
  // of its contributions, row); writes all blocks. 39 operations a contribution and point, 40 an upper block.
  [[nodiscard]] Work assemble_work() const {
    const double upper = (blocks + vertices) / 2, contributions = elements * nodes * (nodes + 1) / 2;
    const double bytes = 16 * nodes * points * elements + 4 * contributions + 16 * upper + 36 * blocks + 4 * vertices;
    return Work::once(bytes, 39 * points * contributions + 40 * upper);
  }
  // The blocks with their columns, starts of rows, and two vectors.
  [[nodiscard]] Work product_work(double bytes_a_vector) const {
    return Work::once(40 * blocks + (4 + 2 * bytes_a_vector) * vertices, 18 * blocks);
  }
  // Down: the inverse, r, z, the offset and the vertex number. Up: z twice, the offset and the number. Between them the
  // coarse factor, 6x6 and a row number each block, forward and backward. What there is once a part is left out.
  [[nodiscard]] Work rigid_work() const {
    const double factor = 148.0 * double(rigid.factor_blocks());
    return Work::on(factor + 100 * vertices, 2 * factor + 152 * vertices, 0.97 * factor + 63 * vertices);
  }
  // Twice the factor (3x3 and a row number each block), rotations and order; r, z, and the unknowns in each pass.
  [[nodiscard]] Work warped_work() const {
    const double factor = 40.0 * double(symbolic->blocks);
    return Work::on(factor + 104 * vertices, 2 * factor + 176 * vertices, 0.9 * factor + 36 * vertices);
  }
  // The matrix once; two old solutions and their products, each twice; b, x, and r three times.
  [[nodiscard]] Work guess_work() const {
    return Work::on(40 * blocks + 112 * vertices, 40 * blocks + 208 * vertices, 36 * blocks + 54 * vertices);
  }
  // A step, each kernel from its own cache: assembly, forces, right side (a product), guess, iterations (x, r and p
  // from one to the next: 144 bytes a vertex), a residual and two more applications, the new state evaluated; and 350
  // bytes a vertex for what the preconditioner takes from the state and for the update of positions and velocities.
  [[nodiscard]] Work step_work(double iterations) const {
    const bool small = integrator.solver().preconditioner() == PreconditionerKind::warped_cholesky;
    return assemble_work() + product_work(12) + Work::once(20 * nodes * elements, 3 * nodes * elements) + guess_work() +
           iterations * (product_work(16) + Work::on(80 * vertices, 144 * vertices, 18 * vertices)) + product_work(16) +
           (iterations + 2) * (small ? warped_work() : rigid_work()) + evaluate_work() +
           Work::once(350 * vertices, 110 * vertices);
  }

  SerialExecutor serial;
  Body body;
  ImplicitEuler<Body> integrator{body};
  detail::ElasticEvaluation<float, Element> evaluation{body.law()};
  BlockMatrix<float> matrix{body.pattern()};
  PaddedField<float> x = PaddedField<float>(at(body.vertex_count()));  // the velocities
  RigidAggregates<float> rigid;
  detail::Shared<detail::SymbolicFactor> symbolic = detail::Shared<detail::SymbolicFactor>::make(*body.pattern());
  const double vertices = body.vertex_count(), elements = body.law().element_count(), blocks = body.pattern()->blocks();
};

/// F at each quadrature point of each batch.
template <class Element>
std::vector<Mat3Lanes<float>> deformations(const Beam<Element>& b) {
  std::vector<Mat3Lanes<float>> f;
  for (const auto& batch : b.body.law().batches()) {
    std::array<Vec3Lanes<float>, Element::nodes> u;
    batch.gather(b.body.displacements().data(), u);
    for (std::size_t q = 0; q < batch.points; ++q) {
      batch.displacement_gradient(q, u, f.emplace_back());
      for (int i = 0; i < 3; ++i) f.back()(i, i) += 1;
    }
  }
  return f;
}

template <class Element, class P>
void apply(benchmark::State& state, Beam<Element>& b, P&& preconditioner, const Work& work) {
  preconditioner.update(b.system(), b.serial);
  PaddedField<float> z(b.x.size());
  measure(state, work, [&] { benchmark::DoNotOptimize(preconditioner.apply(b.x, z, b.serial)); });
}

template <class Element>
void add_rows(const std::string& element, const std::vector<Index>& all_cells) {
  using B = Beam<Element>;
  using State = benchmark::State;
  static std::map<Index, std::unique_ptr<B>> beams;  // Google Benchmark calls each kernel several times
  const auto add = [&](const char* name, void (*kernel)(State&, B&), Index max_cells = 1000) {
    for (const Index cells : all_cells)
      if (const std::string row = std::string(name) + "/" + element + "/" + std::to_string(cells); cells <= max_cells)
        benchmark::RegisterBenchmark(row.c_str(), [kernel, cells](State& state) {
          if (!beams[cells]) beams[cells] = std::make_unique<B>(cells);
          kernel(state, *beams[cells]);
        })->Unit(benchmark::kMicrosecond);
  };
  add("rotations", [](State& state, B& b) {
    const std::vector<Mat3Lanes<float>> f = deformations(b);
    std::vector<Mat3Lanes<float>> r(f.size());
    // A 3x3 matrix in and one out; three steps of Newton, 15 operations each, and 315 besides.
    measure(state, Work::once(72.0 * B::points * b.elements, 360.0 * B::points * b.elements), [&] {
      for (std::size_t i = 0; i < f.size(); ++i) Polar::extract(f[i], r[i]);
    });
  });
  add("evaluate", [](State& state, B& b) {
    measure(state, b.evaluate_work(), [&] { b.body.law().evaluate(b.body.displacements(), b.evaluation, b.serial); });
  });
  add("assemble", [](State& state, B& b) {
    BlockMatrix<float> matrix(b.body.pattern());
    measure(state, b.assemble_work(), [&] { b.assemble_into(matrix); });
  });
  add("product", [](State& state, B& b) {
    PaddedField<float> y(b.x.size());
    measure(state, b.product_work(16), [&] {
      for (Index i = 0; i < size_of(y); ++i) y[at(i)].set(b.matrix.row_product(i, b.x));
    });
  });
  add("plain_product", [](State& state, B& b) {
    Field<float> y(b.x.size());
    measure(state, b.product_work(12), [&] { program::plain_product(b.matrix, b.body.velocities(), y); });
  });
  add("block_jacobi", [](State& state, B& b) {  // the inverse (4 x 3 numbers), r and z; z and r . z
    BlockJacobi<float> jacobi;
    jacobi.analyze(b.body.pattern(), b.body.mesh().positions());
    apply(state, b, jacobi, Work::once(80 * b.vertices, (15 + 6) * b.vertices));
  });
  add("rigid_aggregates", [](State& state, B& b) { apply(state, b, b.rigid, b.rigid_work()); });
  const auto warped = [](State& state, B& b) {
    WarpedCholesky<float> preconditioner;
    preconditioner.analyze(b.body.pattern(), b.body.mesh().positions(), b.symbolic);
    apply(state, b, preconditioner, b.warped_work());
  };
  add("warped_cholesky", warped, 20);  // the factors of larger beams are too large
  add("initial_guess", [](State& state, B& b) {
    detail::InitialGuess<float> guess(b.body.vertex_count());
    PaddedField<float> x = b.x, other = x, r = x, p = x, q = x;
    for (auto& v : other) std::swap(v[0], v[1]);  // another direction
    guess.remember(x);
    guess.remember(other);
    measure(state, b.guess_work(), [&] {
      benchmark::DoNotOptimize(guess.start(b.system(), x, r, {&p, &q}, b.serial));
    });
  });
  add("step", [](State& state, B& b) {
    auto body = b.body;
    auto integrator = b.integrator;
    double iterations = 0;
    const double seconds = measure(state, [&] { iterations += integrator.step(body, time_step, b.serial).iterations; });
    iterations /= double(state.iterations());
    report(state, b.step_work(iterations), seconds);
    state.counters["iterations"] = iterations;
  });
}

/// 200 bodies of 216 elements, each of another material, so that none waits for the others' solutions. Time a body.
template <class Element>
void step_many(benchmark::State& state) {
  using Body = SoftBody<float, Element>;
  std::vector<Body> bodies;
  std::vector<ImplicitEuler<Body>> integrators;
  for (int i = 0; i < 200; ++i) {
    MeshData data = make_block({.corner = {0, 0, 0},
                                .size = {0.6, 0.6, 0.2},
                                .cells = {6, 3, 2},
                                .split = BlockSplit::kuhn6,
                                .order = Element::order})
                        .value();
    bodies.push_back(Body::create(TetMesh<float, Element>::create(std::move(data)).value(),
                                  Material{.young = 5e5 * (1 + 0.01 * i), .poisson = 0.3, .density = 1000})
                         .value());
    bodies.back().pin_where([](const Vec3<float>& x) { return x.x() < 1e-3F; });
    bodies.back().set_gravity({0, 0, -9.81F});
    integrators.emplace_back(bodies.back(), SolverOptions{.tolerance = 1.5e-3});
  }
  std::vector<StepReport> reports(bodies.size());
  ThreadPool pool(static_cast<int>(state.range(0)));
  double iterations = 0, steps = 0;
  const auto step = [&] {
    step_bodies(std::span(integrators), std::span(bodies), time_step, std::span(reports), pool);
  };
  for (int i = 0; i < 20; ++i) step();  // until factors are made and solutions known
  for (auto _ : state) {
    step();
    for (const StepReport& report : reports) iterations += report.iterations;
    steps += double(reports.size());
  }
  state.counters["iterations"] = iterations / steps;
  state.counters["a_body"] = benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(step_many<Tet4>)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(step_many<Tet10>)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

/// 200 blocks of 162 elements that rest on a floor, stepped (0) or asleep (1). Time a body.
template <class Element>
void rest_many(benchmark::State& state) {
  using Body = SoftBody<float, Element>;
  const bool sleeps = state.range(0) == 1;
  Obstacles obstacles;
  obstacles.add(HalfSpace{});
  Sleep sleep(obstacles);
  MeshData data =
      make_block({.size = {0.3, 0.3, 0.3}, .cells = {3, 3, 3}, .split = BlockSplit::kuhn6, .order = Element::order})
          .value();
  const auto model =
      BodyModel<float, Element>::create(TetMesh<float, Element>::create(std::move(data)).value(), Material{}).value();
  std::vector<Body> bodies(200, Body(model));
  std::vector<ImplicitEuler<Body>> integrators;
  std::vector<Contacts<float>> contacts;
  const auto points = ContactPoints::boundary(model->mesh()).value();
  for (Body& body : bodies) {
    body.set_gravity({0, 0, -9.81F});
    integrators.emplace_back(body, SolverOptions{.tolerance = 1.5e-3});
    contacts.emplace_back(points, obstacles, ContactOptions{.friction = 0.5});
    sleep.add();
  }
  const auto step = [&] {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      StepContext<float> context;
      context.terms = contacts[i];
      if (sleeps)
        sleep.step(static_cast<Index>(i), integrators[i], bodies[i], time_step, context);
      else
        integrators[i].step(bodies[i], time_step, context);
    }
    obstacles.advance(double(time_step));
  };
  for (int i = 0; i < 200; ++i) step();
  double steps = 0;
  for (auto _ : state) {
    step();
    steps += double(bodies.size());
  }
  state.counters["a_body"] = benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(rest_many<Tet4>)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

/// A copy of a body and of its integrator, which a game spawns, while up to 1,000 are held.
template <class Element>
void spawn_by_copy(benchmark::State& state) {
  using Body = SoftBody<float, Element>;
  struct Spawned {
    Body body;
    ImplicitEuler<Body> integrator;
  };
  const BlockOptions options{
      .size = {1, 0.2F, 0.2F},
      .cells = Element::order == 1 ? std::array<Index, 3>{5, 3, 3} : std::array<Index, 3>{10, 1, 1},
      .order = Element::order};
  Body body = Body::create(TetMesh<float, Element>::create(make_block(options).value()).value(), Material{}).value();
  body.set_gravity({0, 0, -9.81F});
  ImplicitEuler<Body> integrator(body);
  for (int i = 0; i < 3; ++i) integrator.step(body, time_step);
  constexpr std::size_t most = 1000;
  std::vector<Spawned> held;
  held.reserve(most);
  for (auto _ : state) {
    if (held.size() == most) {
      state.PauseTiming();
      held.clear();
      state.ResumeTiming();
    }
    held.push_back({body, integrator});
    benchmark::DoNotOptimize(held.back());
  }
}
BENCHMARK(spawn_by_copy<Tet4>)->Unit(benchmark::kMicrosecond);
BENCHMARK(spawn_by_copy<Tet10>)->Unit(benchmark::kMicrosecond);

[[maybe_unused]] const bool added = (add_rows<Tet4>("tet4", {20, 50, 100}), add_rows<Tet10>("tet10", {10}), true);

}  // namespace
}  // namespace corotet
