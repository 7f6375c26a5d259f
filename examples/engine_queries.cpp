// What an engine asks for: buffers in its own coordinates, one binding for all copies of a body, points to grab and to
// strike, stresses, the forces of pins. A rubber tongue, held at one end, once at rest and once struck. Modelled in
// metres with y up, as glTF has it, and drawn by an engine in centimetres, left-handed, z up. See docs/engine.md.
//
//   engine_queries
#include <algorithm>
#include <corotet/integrators.hpp>
#include <corotet/measures.hpp>
#include <corotet/mesh.hpp>
#include <corotet/points.hpp>
#include <corotet/surface.hpp>
#include <corotet/thread_pool.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <vector>

using namespace corotet;

namespace {

using Body = SoftBody<float, Tet10>;
using Surface = EmbeddedSurface<float, Tet10>;

struct Vertex {  // as the engine's shader reads it
  float position[3], normal[3];
};

/// A body and what is drawn of it.
struct Tongue {
  Body body;
  ImplicitEuler<Body> euler;
  Surface surface;  // a copy: the binding is shared
  std::vector<Vertex> vertices;
};

bool run() {
  const auto block = make_block({.size = {0.1, 0.02, 0.04}, .cells = {8, 2, 3}, .order = 2});
  if (!block) return false;
  const auto mesh = TetMesh<float, Tet10>::create(*block);
  if (!mesh) return false;
  auto body = Body::create(*mesh, Material{.young = 1e6, .poisson = 0.4, .density = 1000},
                           {.damping = {.mass = 8, .stiffness = 0}});
  const auto boundary = extract_boundary(*block);
  if (!body || !boundary) return false;
  const SurfaceMesh skin = compact_surface(*boundary, block->positions).surface;
  body->pin_where([](const Vec3<float>& x) { return x.x() == 0; });
  body->set_gravity({0, -9.81f, 0});

  const auto surface = Surface::bind(*mesh, skin);
  if (!surface) return false;
  std::vector<Tongue> tongues;
  for (int i = 0; i < 2; ++i)
    tongues.push_back({*body, ImplicitEuler(*body), *surface, std::vector<Vertex>(skin.positions.size())});
  std::printf("%zu bytes of binding, %zu for each copy\n", surface->memory().shared, surface->memory().owned);

  const auto to_engine = CoordinateConversion::between(coordinates::gltf, coordinates::unreal);
  std::vector<std::uint32_t> indices(3 * skin.triangles.size());
  write_indices(skin.triangles, to_engine, std::span(indices));

  const PointLocator locator(*mesh);
  const LocatedPoint<Tet10> tip = locator.locate({0.1, 0.02, 0.02});
  if (!apply_impulse_at(tongues[1].body, tip, {0, 0, 1e-4f}).ok()) return false;
  std::printf("the struck tip moves at %.2f m/s\n", velocity_at(tongues[1].body, tip).z());

  ThreadPool pool(2);
  const auto jobs = [&](Index count, TaskRef task) { pool(count, task); };  // or your job system's parallel loop
  const auto update = [&](Index i) {                                        // one task a body
    Tongue& t = tongues[at(i)];
    t.surface.update(t.body.displacements(), {.data = reinterpret_cast<std::byte*>(t.vertices.data()),
                                              .stride = sizeof(Vertex),
                                              .count = size_of(t.vertices),
                                              .position_offset = offsetof(Vertex, position),
                                              .normal_offset = offsetof(Vertex, normal),
                                              .conversion = to_engine});
  };
  for (int frame = 0; frame < 180; ++frame) {
    for (Tongue& t : tongues)
      if (const StepReport report = t.euler.step(t.body, 1.0f / 60, jobs); !report.ok()) std::puts(report.advice());
    pool(size_of(tongues), update);
  }

  const Body& still = tongues[0].body;
  const Vec3<float> hit = to_engine.position(position_at(still, tip));  // where a ray hits it, cm
  DeformedPointLocator now(locator);
  now.update(still.displacements());
  const LocatedPoint<Tet10> grabbed = now.locate(to_engine.position_to_source(hit));
  std::printf("the tip at (%.2f, %.2f, %.2f) cm belongs to element %d\n", hit.x(), hit.y(), hit.z(), grabbed.element);

  std::vector<ElementMeasures<float>> measures(at(mesh->element_count()));
  element_measures(still, std::span(measures), pool);
  float largest = 0;
  for (const ElementMeasures<float>& m : measures) largest = std::max(largest, m.von_mises);
  std::printf("the largest stress is %.0f Pa\n", largest);

  PinReactions reactions(still);
  reactions.evaluate_static(still, pool);
  std::printf("the pins hold %.3f N of %.3f N\n", reactions.total_force().y(), 9.81 * still.mass().total());

  add_force_at(tongues[0].body, grabbed, {0, 0.5f, 0});  // N, until it is taken away
  for (int frame = 0; frame < 180; ++frame) tongues[0].euler.step(tongues[0].body, 1.0f / 60, pool);
  reactions.evaluate_static(still, pool);
  std::printf("and %.3f N of a tongue that is pulled up by 0.5 N\n", reactions.total_force().y());
  return true;
}

}  // namespace

int main() { return run() ? 0 : 1; }
