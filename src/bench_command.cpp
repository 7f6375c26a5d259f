// `corotet bench`: what a step costs on this machine, with its error beside it.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench_contact.hpp"
#include "command.hpp"
#include "failure.hpp"
#include "process_usage.hpp"
#include "simulation.hpp"
#include "timing.hpp"

namespace corotet::program {
namespace {

struct BenchOptions {
  std::vector<std::string> meshes{"S", "M", "L"};
  double young = 5e5, poisson = 0.3;
  int order = 1;
  int steps = 60;
  int samples = 4;  // steps whose error is measured
  int threads = 1;
  double tolerance = 1.5e-3;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
  VolumetricStrain volumetric_strain = VolumetricStrain::pointwise;
  std::string csv;
  bool contact = false;
};

std::map<std::string, PreconditionerKind> preconditioners() {
  using enum PreconditionerKind;
  std::map<std::string, PreconditionerKind> named;
  for (const auto kind : {automatic, jacobi, block_jacobi, rigid_aggregates, warped_cholesky})
    named.emplace(name_of(kind), kind);
  return named;
}

/// Cells of the beam along its length; 1 x 0.2 x 0.2 m, five times fewer across.
const std::map<std::string, Index> beams{{"XS", 10}, {"S", 20}, {"M", 50}, {"L", 100}, {"XL", 200}};

MeshData make_mesh(const std::string& name, int order) {
  MeshData mesh;
  if (const auto beam = beams.find(name); beam != beams.end()) {
    const Index n = beam->second;
    mesh = require(make_block(
        {.corner = {0, -0.1, -0.1}, .size = {1, 0.2, 0.2}, .cells = {n, n / 5, n / 5}, .split = BlockSplit::kuhn6}));
  } else {
    mesh = require(read_mesh(name));
  }
  return order == 2 ? raise_order(std::move(mesh)) : lower_order(std::move(mesh));
}

/// The vertices at the least x, which the bench holds: 0.1 % of the length thick.
std::vector<Index> clamped(const MeshData& mesh) {
  double least = mesh.positions.front().x(), most = least;
  for (const Vec3<double>& x : mesh.positions) {
    least = std::min(least, x.x());
    most = std::max(most, x.x());
  }
  std::vector<Index> vertices;
  for (Index v = 0; v < size_of(mesh.positions); ++v)
    if (mesh.positions[at(v)].x() <= least + 1e-3 * (most - least)) vertices.push_back(v);
  return vertices;
}

/// A state, and what one step made of its velocities.
struct Sample {
  Field<double> positions, velocities, next_velocities;
};

struct Row {
  std::string mesh;
  SimulationFacts facts;
  double spmv_us = 0, step_ms = 0, solve_ms = 0, setup_ms = 0, memory_mb = 0;
  double iterations = 0;
  int unconverged = 0;
  double error = 0;  // largest of the samples
  KernelTimes kernels;
};

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

template <class Function>
Field<double> of_each_vertex(Index count, Function&& function) {
  Field<double> field;
  field.reserve(at(count));
  for (Index v = 0; v < count; ++v) field.push_back(function(v));
  return field;
}

/// |dv - dv'| / |dv'| in the norm of the mass, dv the change of velocity in the sampled step and dv' that of a step
/// from the same state in double, solved to 1e-10. The largest of all samples.
double max_error(const Scene& scene, const MeshData& mesh, const std::vector<Index>& pins,
                 const std::vector<Sample>& samples) {
  Scene exact = scene;
  exact.scalar = ScalarKind::double_precision;
  exact.solver.tolerance = 1e-10;
  ThreadPool pool(1);
  PhaseClock clock;
  const auto reference = make_simulation(exact, mesh);
  for (const Index v : pins) reference->pin(v);
  double largest = 0;
  for (const Sample& sample : samples) {
    require(reference->set_positions(sample.positions));
    require(reference->set_velocities(sample.velocities));
    if (!reference->step(scene.dt, pool, clock).ok()) throw Failure("bench: the reference step in double failed");
    double error = 0, size = 0;
    for (Index v = 0; v < size_of(mesh.positions); ++v) {
      const Vec3<double> right = reference->velocity(v);
      const double mass = reference->vertex_mass(v);
      error += mass * (sample.next_velocities[at(v)] - right).squaredNorm();
      size += mass * (right - sample.velocities[at(v)]).squaredNorm();
    }
    largest = std::max(largest, std::sqrt(error / size));
  }
  return largest;
}

Scene scene_of(const BenchOptions& options, const std::string& name) {
  Scene scene;
  scene.mesh = name;
  scene.order = options.order;
  scene.material = {options.young, options.poisson, 1000};
  scene.volumetric_strain = options.volumetric_strain;
  scene.solver.preconditioner = options.preconditioner;
  scene.solver.tolerance = options.tolerance;
  return scene;
}

Row measure(const BenchOptions& options, const std::string& name) {
  const Scene scene = scene_of(options, name);
  Row row;
  row.mesh = name;
  MeshData mesh = make_mesh(name, options.order);
  // Rounded to float here, so that the reference in double has the same rest shape.
  for (Vec3<double>& x : mesh.positions) x = x.cast<float>().cast<double>();
  const std::vector<Index> pins = clamped(mesh);
  ThreadPool pool(options.threads);
  PhaseClock clock;

  const double memory_before = current_rss_mb();
  reset_peak_rss();
  const Clock::time_point start = Clock::now();
  auto simulation = make_simulation(scene, mesh);
  for (const Index v : pins) simulation->pin(v);
  const Index vertices = size_of(mesh.positions);
  std::vector<double> step_ms, solve_ms, iterations;
  std::vector<Sample> samples;
  for (int step = 0; step < options.steps; ++step) {
    const bool sampled =
        step > 0 && (step + 1) * options.samples / options.steps > step * options.samples / options.steps;
    if (sampled)
      samples.push_back({of_each_vertex(vertices, [&](Index v) { return simulation->position(v); }),
                         of_each_vertex(vertices, [&](Index v) { return simulation->velocity(v); }),
                         {}});
    clock.start();
    const StepReport report = simulation->step(scene.dt, pool, clock);
    clock.stop();
    if (!report.accepted()) throw Failure(fmt::format("bench: {}: step {}: {}", name, step, report.advice()));
    if (!report.converged) ++row.unconverged;
    if (step == 0) {
      row.setup_ms = ms_since(start);
      row.memory_mb = std::max(0.0, peak_rss_mb() - memory_before);
      continue;  // it belongs to the set-up: factors are made in it
    }
    step_ms.push_back(clock.total_ms());
    solve_ms.push_back(clock.solve_ms());
    iterations.push_back(report.iterations);
    if (sampled)
      samples.back().next_velocities = of_each_vertex(vertices, [&](Index v) { return simulation->velocity(v); });
  }
  row.facts = simulation->facts();
  row.step_ms = median_of(step_ms);
  row.solve_ms = median_of(solve_ms);
  for (const double i : iterations) row.iterations += i / double(iterations.size());
  row.spmv_us = simulation->measure_spmv_us();
  row.kernels = simulation->measure_kernels(pool);
  simulation.reset();
  row.error = max_error(scene, mesh, pins, samples);
  return row;
}

struct Column {
  const char* name;
  const char* unit;
  std::string (*value)(const Row&);
};

const Column columns[] = {
    {"mesh", "", [](const Row& r) { return r.mesh; }},
    {"elements", "", [](const Row& r) { return fmt::format("{}", r.facts.elements); }},
    {"vertices", "", [](const Row& r) { return fmt::format("{}", r.facts.vertices); }},
    {"SpMV", "us", [](const Row& r) { return fmt::format("{:.4g}", r.spmv_us); }},
    {"step", "ms", [](const Row& r) { return fmt::format("{:.3g}", r.step_ms); }},
    {"step", "SpMV", [](const Row& r) { return fmt::format("{:.1f}", 1e3 * r.step_ms / r.spmv_us); }},
    {"error", "", [](const Row& r) { return fmt::format("{:.1e}", r.error); }},
    {"iterations", "mean", [](const Row& r) { return fmt::format("{:.1f}", r.iterations); }},
    {"evaluate", "SpMV", [](const Row& r) { return fmt::format("{:.1f}", r.kernels.evaluate_us / r.spmv_us); }},
    {"assemble", "SpMV", [](const Row& r) { return fmt::format("{:.1f}", r.kernels.assemble_us / r.spmv_us); }},
    {"solve", "SpMV", [](const Row& r) { return fmt::format("{:.1f}", 1e3 * r.solve_ms / r.spmv_us); }},
    {"predicted", "SpMV",
     [](const Row& r) {
       if (r.facts.predicted_products == 0) return std::string("-");
       return fmt::format("{:.1f}", r.facts.predicted_products * r.kernels.product_us / r.spmv_us);
     }},
    {"product", "SpMV", [](const Row& r) { return fmt::format("{:.2f}", r.kernels.product_us / r.spmv_us); }},
    {"set-up", "steps", [](const Row& r) { return fmt::format("{:.0f}", r.setup_ms / r.step_ms); }},
    {"memory", "MiB", [](const Row& r) { return fmt::format("{:.1f}", r.memory_mb); }},
    {"solver", "",
     [](const Row& r) { return r.facts.preconditioner.empty() ? r.facts.solver : r.facts.preconditioner; }}};

void print_table(const std::vector<Row>& rows) {
  for (int line = 0; line < int(rows.size()) + 2; ++line) {
    std::string text;
    for (const Column& column : columns) {
      std::size_t width = std::max(std::string(column.name).size(), std::string(column.unit).size());
      for (const Row& row : rows) width = std::max(width, column.value(row).size());
      const std::string cell = line == 0 ? column.name : line == 1 ? column.unit : column.value(rows[at(line - 2)]);
      text += fmt::format("{:>{}}  ", cell, width);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    fmt::print("{}\n", text);
  }
}

void write_csv(const std::string& path, const std::vector<Row>& rows) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) throw Failure(fmt::format("--csv {}: cannot be written", path));
  const auto line = [&](auto&& cell) {
    for (const Column& column : columns)
      fmt::print(file, "{}{}", cell(column), &column == &columns[std::size(columns) - 1] ? "\n" : ",");
  };
  line([](const Column& c) { return *c.unit == 0 ? std::string(c.name) : fmt::format("{}_{}", c.name, c.unit); });
  for (const Row& row : rows) line([&](const Column& c) { return c.value(row); });
  const bool written = std::ferror(file) == 0;
  if (std::fclose(file) != 0 || !written) throw Failure(fmt::format("--csv {}: cannot be written", path));
}

int bench_contact(const BenchOptions& options) {
  std::vector<ContactCost> rows;
  for (const std::string& mesh : options.meshes)
    for (ContactCost& row :
         measure_contact(mesh, scene_of(options, mesh), make_mesh(mesh, options.order), options.steps))
      rows.push_back(std::move(row));
  fmt::print("{}", format_text(rows));
  if (!options.csv.empty()) require(write_file(options.csv, format_csv(rows)));
  return 0;
}

int bench(const BenchOptions& options) {
  if (options.contact) return bench_contact(options);
  std::vector<Row> rows;
  int unconverged = 0;
  for (const std::string& mesh : options.meshes) {
    rows.push_back(measure(options, mesh));
    unconverged += rows.back().unconverged;
    if (rows.back().unconverged > 0)
      fmt::print(stderr, "corotet: bench: {}: {} steps stopped before their tolerance\n", mesh,
                 rows.back().unconverged);
  }
  print_table(rows);
  if (!options.csv.empty()) write_csv(options.csv, rows);
  return unconverged == 0 ? 0 : 1;
}

}  // namespace

Command add_bench_command(CLI::App& app) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* syntax = app.add_subcommand("bench", "Time steps on this machine, with their error");
  syntax->add_option("mesh", options->meshes,
                     "Mesh files, or XS, S, M, L, XL: the beam of 1 x 0.2 x 0.2 m in 240 to 1,920,000 tetrahedra "
                     "(S M L)");
  syntax->add_option("--young", options->young, "Young's modulus, Pa (5e5)")->check(CLI::PositiveNumber);
  syntax->add_option("--poisson", options->poisson, "Poisson's ratio (0.3)")->check(CLI::Range(-0.99, 0.4999));
  syntax->add_option("--order", options->order, "1: 4-node, 2: 10-node tetrahedra (1)")->check(CLI::Range(1, 2));
  syntax->add_option("--steps", options->steps, "Steps of 1/60 s, >= 8 (60)")->check(CLI::Range(8, 1000000));
  syntax->add_option("--threads", options->threads, "Threads, >= 1 (1)")->check(CLI::Range(1, 1024));
  syntax->add_option("--tolerance", options->tolerance, "Of the solver, in the energy norm (1.5e-3)")
      ->check(CLI::Range(1e-12, 0.5));
  syntax->add_option("--preconditioner", options->preconditioner, "As in a scene (auto)")
      ->transform(CLI::CheckedTransformer(preconditioners()));
  syntax->add_option("--dilatation", options->volumetric_strain, "per_element or mean, as in a scene (per_element)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, VolumetricStrain>{
          {"per_element", VolumetricStrain::pointwise}, {"mean", VolumetricStrain::averaged}}));
  syntax->add_flag("--contact", options->contact,
                   "Steps of the body on a floor, beside those of the same body whose bottom is pinned");
  syntax->add_option("--csv", options->csv, "Also write the table to this file");
  syntax->footer(
      "The body is held at its least x and falls under gravity along z, in float, density 1000 kg/m^3, lumped mass,\n"
      "backward Euler at 1/60 s. \"SpMV\" is one product of the step's matrix with a vector, plain and unvectorised,\n"
      "in the same run: times in it say as much on another machine. \"predicted\" is what the solver expected of a\n"
      "solve when it chose its preconditioner. The error is that of the change of velocity in\n"
      "the norm of the mass, against steps from the same states in double solved to 1e-10, the largest of four.\n"
      "Build with the preset `native` for what this machine can do.\n\n"
      "Examples:\n"
      "  corotet bench\n"
      "  corotet bench M --young 5e7 --preconditioner rigid_aggregates\n"
      "  corotet bench bunny.msh --threads 2 --csv bunny.csv\n"
      "  corotet bench --contact S M");
  return {syntax, [options] { return bench(*options); }};
}

}  // namespace corotet::program
