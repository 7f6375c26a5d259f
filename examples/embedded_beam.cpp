// A surface of 47,000 triangles moves with 50 quadratic tetrahedra: a helical gear of rubber, held at one end, falls.
// Writes DIR/beam.html, which any browser plays, and DIR/beam.svg, a picture of four of its frames; for ParaView,
// DIR/surface.pvd (what is drawn) and DIR/body.pvd (the tetrahedra), with a .vtu file for each frame.
//
//   embedded_beam [DIR, default "."] [frames, default 60]
#include <cmath>
#include <corotet/integrators.hpp>
#include <corotet/io.hpp>
#include <corotet/mesh.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/surface.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>

using namespace corotet;

namespace {

constexpr double length = 1, thickness = 0.2;  // m

/// The radius of the bar at `x` along it and at an angle: six rounded teeth that wind round it as on a helical gear,
/// fine grooves across them, and a plain collar where it is held.
double radius(double x, double angle) {
  const double s = x / length, turn = 2 * std::numbers::pi;
  const double teeth = std::tanh(2.5 * std::cos(6 * (angle - turn * s))) / std::tanh(2.5);
  const double grooves = std::pow(std::cos(0.5 * turn * 40 * s), 8);
  const double cut = 1 / (1 + std::exp(-(s - 0.1) / 0.003));  // 0 on the collar, 1 on the teeth
  return thickness * (0.46 * (1 - cut) + cut * (0.385 + 0.07 * teeth - 0.008 * grooves));
}

/// The surface at rest, around the x axis.
SurfaceMesh make_gear() {
  constexpr Index rings = 240, sides = 96;
  SurfaceMesh gear;
  const auto add_ring = [&](double x, double scale) {
    for (Index j = 0; j < sides; ++j) {
      const double angle = 2 * std::numbers::pi * j / sides, r = scale * radius(x, angle);
      gear.positions.emplace_back(x, r * std::cos(angle), r * std::sin(angle));
    }
  };
  for (Index i = 0; i <= rings; ++i) add_ring(length * i / rings, 1);
  for (const double scale : {0.98, 0.5, 0.01}) add_ring(length, scale);  // the flat end
  for (Index i = 0; i < rings + 3; ++i)
    for (Index j = 0; j < sides; ++j) {
      const Index a = i * sides + j, b = i * sides + (j + 1) % sides;
      gear.triangles.push_back({a, b, a + sides});
      gear.triangles.push_back({b, b + sides, a + sides});
    }
  return gear;
}

/// A coarse beam around the bar.
Result<TetMesh<float, Tet10>> make_cage() {
  const auto block = make_block({.corner = {0, -thickness / 2, -thickness / 2},
                                 .size = {length, thickness, thickness},
                                 .cells = {10, 1, 1},
                                 .order = 2});
  if (!block) return block.error();
  return TetMesh<float, Tet10>::create(*block);
}

Field<double> in_double(const Field<float>& field) {
  Field<double> result;
  for (const Vec3<float>& x : field) result.emplace_back(x.x(), x.y(), x.z());
  return result;
}

bool run(const std::string& folder, int frames) {
  const auto complain = [](const Error& error) { return std::fprintf(stderr, "%s\n", error.message().c_str()), false; };
  const auto cage = make_cage();
  if (!cage) return complain(cage.error());
  auto body = SoftBody<float, Tet10>::create(*cage, Material{.young = 1e6, .poisson = 0.4, .density = 1000});
  if (!body) return complain(body.error());
  body->pin_where([](const Vec3<float>& x) { return x.x() < 1e-6f; });
  body->set_gravity({0, 0, -9.81f});

  // Bound once; afterwards each frame is one call that fills a vertex buffer, as a renderer has it.
  const SurfaceMesh gear = make_gear();
  auto surface = EmbeddedSurface<float, Tet10>::bind(*cage, gear);
  if (!surface) return complain(surface.error());
  struct Vertex {
    Vec3<float> position, normal;
  };
  std::vector<Vertex> vertices(gear.positions.size());
  const VertexBuffer buffer{.data = reinterpret_cast<std::byte*>(vertices.data()),
                            .stride = sizeof(Vertex),
                            .count = size_of(vertices),
                            .position_offset = offsetof(Vertex, position),
                            .normal_offset = offsetof(Vertex, normal)};
  std::printf("%zu triangles on %d vertices, in %d quadratic tetrahedra; %d vertices outside, by at most %.2g m\n",
              gear.triangles.size(), surface->vertex_count(), cage->element_count(), surface->outside_count(),
              surface->max_distance());

  std::error_code ignored;  // an unusable folder shows when a file is written
  std::filesystem::create_directories(folder, ignored);
  auto surface_series = PvdWriter::create(folder + "/surface.pvd");
  if (!surface_series) return complain(surface_series.error());
  auto body_series = PvdWriter::create(folder + "/body.pvd");
  if (!body_series) return complain(body_series.error());

  constexpr float h = 1.0f / 120;
  constexpr int steps_per_frame = 2;
  constexpr int frames_per_picture = 2;  // of beam.html, which interpolates
  Animation animation{
      .title = "A helical gear of rubber, held at one end, falls",
      .caption = std::to_string(gear.triangles.size()) + " triangles carried by " +
                 std::to_string(cage->element_count()) + " quadratic tetrahedra",
      .frame_seconds = double(frames_per_picture) * steps_per_frame * h,
      .triangles = gear.triangles,
      .lines = element_lines(*cage),
  };
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
    if (frame % frames_per_picture == 0) {
      animation.surface_frames.push_back(in_double(positions));
      animation.line_frames.push_back(in_double(nodes));
    }
    const std::string number = std::to_string(1000 + frame).substr(1) + ".vtu";
    const double time = double(frame) * steps_per_frame * h;
    for (const Result<void>& s :
         {write_vtu(folder + "/surface_" + number,
                    {.points = positions, .cells = vtu_cells(gear), .point_data = {{"normal", normals}}}),
          write_vtu(folder + "/body_" + number, {.points = nodes, .cells = vtu_cells(*cage)}),
          surface_series->add_frame(time, "surface_" + number), body_series->add_frame(time, "body_" + number)})
      if (!s) return complain(s.error());
    if (frame % 15 == 0)
      std::printf("%.2f s: tip at (%.3f, %.3f, %.3f) m\n", time, nodes[at(tip)].x(), nodes[at(tip)].y(),
                  nodes[at(tip)].z());
  }
  std::printf("%d frames in %s: open surface.pvd and body.pvd with ParaView\n", frames + 1, folder.c_str());

  const std::string page = folder + "/beam.html", picture = folder + "/beam.svg";
  const Index last = size_of(animation.surface_frames) - 1;  // of the pictures; it has swung down by half of them
  for (const Result<void>& s : {write_animation_html(page, animation),
                                write_filmstrip_svg(picture, animation, {.frames = {0, last / 6, last / 3, last / 2}})})
    if (!s) return complain(s.error());
  std::printf("To see it move, open %s in a browser; %s is a picture of four of its frames\n", page.c_str(),
              picture.c_str());
  return true;
}

}  // namespace

int main(int argc, char** argv) { return run(argc > 1 ? argv[1] : ".", argc > 2 ? std::atoi(argv[2]) : 60) ? 0 : 1; }
