// A cushion with a detailed skin falls on a floor, a crate of 10 kg falls on it, and a hand pulls at its side.
// Writes DIR/contact.html, which any browser plays, and DIR/contact.svg, a picture of four of its frames.
//
//   contact [DIR, default "."] [frames, default 240]
#include <array>
#include <cmath>
#include <corotet/attachment.hpp>
#include <corotet/contact.hpp>
#include <corotet/integrators.hpp>
#include <corotet/io.hpp>
#include <corotet/mesh.hpp>
#include <corotet/points.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/surface.hpp>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>

using namespace corotet;

namespace {

const Vec3<double> half = {0.3, 0.3, 0.1}, crate_half = {0.1, 0.1, 0.1};  // m
constexpr double height = 0.4;                                            // of the cushion's middle at first, m

/// Quadratic tetrahedra around the cushion.
Result<TetMesh<float, Tet10>> make_cage() {
  const auto block =
      make_block({.corner = Vec3<double>(0, 0, height) - half, .size = 2.0 * half, .cells = {6, 6, 2}, .order = 2});
  if (!block) return block.error();
  return TetMesh<float, Tet10>::create(*block);
}

/// The skin: a rounded box with a quilted pattern.
SurfaceMesh make_cushion() {
  constexpr Index rings = 64, sides = 128;
  const auto rounded = [](double x) { return std::copysign(std::pow(std::fabs(x), 0.35), x); };
  SurfaceMesh skin;
  for (Index i = 0; i <= rings; ++i)
    for (Index j = 0; j < sides; ++j) {
      const double polar = std::numbers::pi * (i + 1e-9) / (rings + 2e-9), angle = 2 * std::numbers::pi * j / sides;
      const double x = rounded(std::sin(polar)) * rounded(std::cos(angle));
      const double y = rounded(std::sin(polar)) * rounded(std::sin(angle));
      const double stitch = 0.05 * std::pow(std::cos(6 * x) * std::cos(6 * y), 4);
      skin.positions.emplace_back(half.x() * x, half.y() * y,
                                  height + half.z() * (1 - stitch) * rounded(std::cos(polar)));
    }
  for (Index i = 0; i < rings; ++i)
    for (Index j = 0; j < sides; ++j) {
      const Index a = i * sides + j, b = i * sides + (j + 1) % sides;
      skin.triangles.push_back({a, a + sides, b});
      skin.triangles.push_back({b, a + sides, b + sides});
    }
  return skin;
}

/// The eight corners of a box, and its faces.
void add_box(SurfaceMesh& surface, const Vec3<double>& centre, const Vec3<double>& extent) {
  const Index first = size_of(surface.positions);
  for (const int corner : {0, 1, 2, 3, 4, 5, 6, 7})
    surface.positions.push_back(centre + Vec3<double>(corner & 1 ? extent.x() : -extent.x(),
                                                      corner & 2 ? extent.y() : -extent.y(),
                                                      corner & 4 ? extent.z() : -extent.z()));
  constexpr std::array<std::array<Index, 4>, 6> faces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : faces) {
    surface.triangles.push_back({first + a, first + b, first + c});
    surface.triangles.push_back({first + a, first + c, first + d});
  }
}

bool run(const std::string& folder, int frames) {
  const auto complain = [](const Error& error) { return std::fprintf(stderr, "%s\n", error.message().c_str()), false; };
  const auto cage = make_cage();
  if (!cage) return complain(cage.error());
  auto body = SoftBody<float, Tet10>::create(*cage, Material{.young = 6e4, .poisson = 0.4, .density = 300},
                                             {.damping = {.mass = 1}});
  if (!body) return complain(body.error());
  body->set_gravity({0, 0, -9.81f});
  SurfaceMesh drawn = make_cushion();
  auto skin = EmbeddedSurface<float, Tet10>::bind(*cage, drawn);
  if (!skin) return complain(skin.error());

  Obstacles obstacles;
  obstacles.gravity = {0, 0, -9.81};
  obstacles.add(HalfSpace{});
  const Index crate = obstacles.add(OrientedBox{crate_half}, {.pose = {.position = {0.02, 0.01, 0.75}}, .mass = 10});
  Contacts<float> contacts(ContactPoints(*skin, body->mesh()), obstacles, {.friction = 0.8});

  const auto side = PointLocator(*cage).locate(Vec3<double>(0, -half.y(), height));
  Attachment<float> hand(side, {.stiffness = 1e3, .damping = 50});
  hand.enabled = false;
  const std::array<StepTerm<float>*, 2> terms{&contacts, &hand};
  StepContext<float> context;
  context.terms = Terms<float>(terms);
  ImplicitEuler euler(*body);

  const Index skin_vertices = skin->vertex_count();
  add_box(drawn, {0, 0, 0}, crate_half);
  add_box(drawn, {0, 0, -0.02}, {0.5, 0.5, 0.02});  // the floor
  Animation animation;
  animation.title = "A cushion, a floor, a crate and a hand";
  animation.frame_seconds = 4.0 / 60;
  animation.triangles = drawn.triangles;
  std::vector<Vec3<float>> positions(at(skin_vertices));
  int most_passes = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const double pull = (frame - 150) / 60.0;  // s
    hand.enabled = pull > 0;
    hand.set_target({0, -half.y() - 0.1 * pull, half.z() + 0.1 * pull}, {0, -0.1, 0.1});
    const StepReport report = euler.step(*body, 1.0f / 60, context);
    if (!report.ok()) std::fprintf(stderr, "frame %d: %s\n", frame, report.advice());
    if (!report.accepted()) return false;
    obstacles.advance(1.0 / 60);
    most_passes = std::max(most_passes, contacts.report().passes);
    if (frame % 4 != 0) continue;

    Field<double> now;
    skin->positions(body->displacements(), positions);
    for (const Vec3<float>& x : positions) now.push_back(x.cast<double>());
    const Obstacle& box = obstacles[crate];
    for (Index v = skin_vertices; v < size_of(drawn.positions); ++v) {
      const Vec3<double>& x = drawn.positions[at(v)];
      now.push_back(v < skin_vertices + 8 ? Vec3<double>(box.pose().position + box.to_world(x)) : x);
    }
    animation.surface_frames.push_back(std::move(now));
  }
  const double crate_height = obstacles[crate].pose().position.z();
  std::printf("%d points of the skin touch, at most %d solves a step; the crate lies at z = %.2f m\n",
              contacts.report().touching, most_passes, crate_height);
  if (const auto written = write_animation_html(folder + "/contact.html", animation); !written)
    return complain(written.error());
  if (const auto written = write_filmstrip_svg(folder + "/contact.svg", animation); !written)
    return complain(written.error());
  return true;
}

}  // namespace

int main(int count, char** values) {
  const std::string folder = count > 1 ? values[1] : ".";
  const int frames = count > 2 ? std::atoi(values[2]) : 240;
  return frames > 0 && run(folder, frames) ? 0 : 1;
}
