// A surface of 46,000 triangles moves with 60 quadratic tetrahedra: a turned column that is let go and falls over.
// Writes DIR/surface.pvd (what is drawn) and DIR/body.pvd (the tetrahedra), with a .vtu file for each frame.
//
//   embedded_beam [DIR, default "."] [frames, default 60]
#include <cmath>
#include <corotet/dynamics/implicit_euler.hpp>
#include <corotet/embed/embedded_surface.hpp>
#include <corotet/mesh/io/write_pvd.hpp>
#include <corotet/mesh/io/write_vtu.hpp>
#include <corotet/mesh/make_block.hpp>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

using namespace corotet;

namespace {

constexpr double length = 1, root = 0.2, end = 0.11;  // m; the tetrahedra taper from `root` to `end` in thickness

double thickness(double x) { return root + (end - root) * x / length; }

/// The column's radius at `x` along it and at an angle: four twisted lobes, fine flutes between collars, a knob.
double radius(double x, double angle) {
  const double s = x / length, turn = 2 * std::numbers::pi;
  const auto bump = [](double d, double width) { return std::exp(-d * d / (width * width)); };
  const double collars = bump(s - 0.03, 0.012) + bump(s - 0.075, 0.009) + bump(s - 0.86, 0.009);
  const double shaft = 1 / (1 + std::exp(-(s - 0.1) / 0.008)) / (1 + std::exp((s - 0.84) / 0.008));
  const double lobes = 0.15 * std::cos(4 * (angle - 0.9 * turn * s));
  const double flutes = 0.035 * std::cos(16 * (angle + 0.45 * turn * s));
  const double knob = std::sqrt(std::max(0.0, 1 - std::pow((s - 0.93) / 0.07, 2)));
  const double profile = s < 0.875 ? 0.72 + 0.2 * collars + shaft * (lobes + flutes) : 0.97 * knob;
  return std::max(profile, s < 0.99 ? 0.3 : 0.0) * thickness(x) / 2;
}

/// The surface at rest, around the x axis.
SurfaceMesh make_column() {
  constexpr Index rings = 240, sides = 96;
  SurfaceMesh column;
  for (Index i = 0; i <= rings; ++i)
    for (Index j = 0; j < sides; ++j) {
      const double x = length * i / rings, angle = 2 * std::numbers::pi * j / sides, r = radius(x, angle);
      column.positions.emplace_back(x, r * std::cos(angle), r * std::sin(angle));
    }
  for (Index i = 0; i < rings; ++i)
    for (Index j = 0; j < sides; ++j) {
      const Index a = i * sides + j, b = i * sides + (j + 1) % sides;
      column.triangles.push_back({a, b, a + sides});
      column.triangles.push_back({b, b + sides, a + sides});
    }
  return column;
}

/// A coarse beam around the column, tapered like it.
Result<TetMesh<float, Tet10>> make_cage() {
  auto block = make_block({.corner = {0, -0.5, -0.5}, .size = {length, 1, 1}, .cells = {12, 1, 1}, .order = 2});
  if (!block) return block.error();
  for (Vec3<double>& x : block->positions) x.tail<2>() *= thickness(x.x());
  return TetMesh<float, Tet10>::create(*block);
}

bool run(const std::string& folder, int frames) {
  const auto complain = [](const Error& error) { return std::fprintf(stderr, "%s\n", error.message().c_str()), false; };
  const auto cage = make_cage();
  if (!cage) return complain(cage.error());
  auto body = SoftBody<float, Tet10>::create(*cage, Material{.young = 6e5, .poisson = 0.4, .density = 1000});
  if (!body) return complain(body.error());
  body->pin_where([](const Vec3<float>& x) { return x.x() < 1e-6f; });
  body->set_gravity({0, 0, -9.81f});

  // Bound once; afterwards each frame is one call that fills a vertex buffer, as a renderer has it.
  const SurfaceMesh column = make_column();
  auto surface = EmbeddedSurface<float, Tet10>::bind(*cage, column);
  if (!surface) return complain(surface.error());
  struct Vertex {
    Vec3<float> position, normal;
  };
  std::vector<Vertex> vertices(column.positions.size());
  const VertexBuffer buffer{.data = reinterpret_cast<std::byte*>(vertices.data()),
                            .stride = sizeof(Vertex),
                            .count = size_of(vertices),
                            .position_offset = offsetof(Vertex, position),
                            .normal_offset = offsetof(Vertex, normal)};
  std::printf("%zu triangles on %d vertices, in %d quadratic tetrahedra; %d vertices outside, by at most %.2g m\n",
              column.triangles.size(), surface->vertex_count(), cage->element_count(), surface->outside_count(),
              surface->largest_distance());

  std::error_code ignored;  // an unusable folder shows when a file is written
  std::filesystem::create_directories(folder, ignored);
  auto surface_series = PvdWriter::create(folder + "/surface.pvd");
  if (!surface_series) return complain(surface_series.error());
  auto body_series = PvdWriter::create(folder + "/body.pvd");
  if (!body_series) return complain(body_series.error());

  constexpr float h = 1.0f / 120;
  constexpr int steps_per_frame = 2;
  ImplicitEuler euler(*body);
  const Index tip = cage->nearest_vertex({length, 0, 0});
  Field<float> positions(vertices.size()), normals(vertices.size()), nodes(at(body->vertex_count()));
  for (int frame = 0; frame <= frames; ++frame) {
    for (int i = 0; frame > 0 && i < steps_per_frame; ++i)
      if (const StepReport report = euler.step(*body, h); !report.ok())
        std::printf("frame %d: %s\n", frame, report.advice());
    surface->update(body->displacements(), buffer);

    for (std::size_t v = 0; v < vertices.size(); ++v) {
      positions[v] = vertices[v].position;
      normals[v] = vertices[v].normal;
    }
    for (Index v = 0; v < body->vertex_count(); ++v) nodes[at(v)] = body->position(v);
    const std::string number = std::to_string(1000 + frame).substr(1) + ".vtu";
    const double time = double(frame) * steps_per_frame * h;
    for (const Status& s :
         {write_vtu(folder + "/surface_" + number,
                    {.points = positions, .cells = vtu_cells(column), .point_data = {{"normal", normals}}}),
          write_vtu(folder + "/body_" + number, {.points = nodes, .cells = vtu_cells(*cage)}),
          surface_series->add_frame(time, "surface_" + number), body_series->add_frame(time, "body_" + number)})
      if (!s) return complain(s.error());
    if (frame % 15 == 0)
      std::printf("%.2f s: tip at (%.3f, %.3f, %.3f) m\n", time, nodes[at(tip)].x(), nodes[at(tip)].y(),
                  nodes[at(tip)].z());
  }
  std::printf("%d frames in %s: open surface.pvd and body.pvd with ParaView\n", frames + 1, folder.c_str());
  return true;
}

}  // namespace

int main(int argc, char** argv) { return run(argc > 1 ? argv[1] : ".", argc > 2 ? std::atoi(argv[2]) : 60) ? 0 : 1; }
