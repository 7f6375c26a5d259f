// Contact scenes for a comparison with other engines: writes them, steps them by corotet, measures any engine's motion.
#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/contact.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/integrators.hpp>
#include <corotet/mesh.hpp>
#include <corotet/sleep.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/soft_contact.hpp>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace {

using corotet::Index;
using V = corotet::Vec3<double>;

constexpr int frame_steps = 15;  // between two frames that are kept

/// Copies of one mesh above planes.
struct Scene {
  int steps = 180;
  double h = 1.0 / 60, young = 1e5, poisson = 0.3, density = 1000, friction = 0.3;
  V gravity{0, 0, -9.81};
  std::vector<corotet::HalfSpace> planes{{}};
  corotet::MeshData mesh;
  std::vector<std::vector<V>> bodies;  // their vertices

  [[nodiscard]] std::size_t vertices() const { return mesh.positions.size(); }
  [[nodiscard]] std::size_t tets() const { return mesh.connectivity.size() / 4; }
  [[nodiscard]] std::array<std::size_t, 4> tet(std::size_t e) const {
    std::array<std::size_t, 4> nodes{};
    for (std::size_t c = 0; c < 4; ++c) nodes[c] = static_cast<std::size_t>(mesh.connectivity[4 * e + c]);
    return nodes;
  }
};

void stop(const std::string& why) {
  std::fprintf(stderr, "contact_peers: %s\n", why.c_str());
  std::exit(1);
}

// ---- Scenes ----

Scene slope(double tangent) {
  Scene s;
  s.young = 5e5;
  const double angle = std::atan(tangent);
  s.gravity = V(9.81 * std::sin(angle), 0, -9.81 * std::cos(angle));
  s.mesh = *corotet::make_block({.size = V::Constant(0.2), .cells = {4, 4, 4}});
  s.bodies.push_back(s.mesh.positions);
  return s;
}

V turned(const V& x, const V& rotation) {  // Rodrigues
  const double angle = rotation.norm();
  if (angle < 1e-12) return x;
  const V axis = rotation / angle;
  return std::cos(angle) * x + std::sin(angle) * axis.cross(x) + (1 - std::cos(angle)) * axis.dot(x) * axis;
}

/// n × n × layers small cubes, turned a little each, that fall into a box of four walls.
Scene heap(int n, int layers) {
  Scene s;
  s.friction = 0.4;
  s.mesh = *corotet::make_block({.size = V::Constant(0.1), .cells = {2, 2, 2}});
  constexpr double pitch = 0.165;
  const double far = n * pitch + 0.02;
  for (const auto& [normal, offset] :
       {std::pair{V(1, 0, 0), -0.05}, {V(-1, 0, 0), -far}, {V(0, 1, 0), -0.05}, {V(0, -1, 0), -far}})
    s.planes.push_back({.normal = normal, .offset = offset});
  std::minstd_rand engine(1);
  const auto random = [&engine] { return double(engine()) / double(std::minstd_rand::max()); };
  for (int l = 0; l < layers; ++l)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const V place(i * pitch + 0.01 * random(), j * pitch + 0.01 * random(), 0.04 + l * pitch);
        const V rotation(0.3 * random(), 0.3 * random(), 0.3 * random());
        auto& body = s.bodies.emplace_back();
        for (const V& x : s.mesh.positions)
          body.push_back(turned(x - V::Constant(0.05), rotation) + V::Constant(0.05) + place);
      }
  return s;
}

/// As many cubes that touch the floor alone.
Scene spread(int count) {
  Scene s;
  s.friction = 0.4;
  s.mesh = *corotet::make_block({.size = V::Constant(0.1), .cells = {2, 2, 2}});
  for (int i = 0; i < count; ++i) {
    auto& body = s.bodies.emplace_back();
    for (const V& x : s.mesh.positions) body.push_back(x + V(0.2 * (i % 20), 0.2 * (i / 20), 0.01));
  }
  return s;
}

void write(const Scene& s, const std::string& path) {
  std::ofstream file(path);
  file.precision(17);
  const auto put = [&file](const V& v) { file << v.x() << ' ' << v.y() << ' ' << v.z() << '\n'; };
  file << s.steps << ' ' << s.h << ' ' << s.young << ' ' << s.poisson << ' ' << s.density << ' ' << s.friction << '\n';
  put(s.gravity);
  file << s.planes.size() << '\n';
  for (const auto& plane : s.planes)
    file << plane.normal.x() << ' ' << plane.normal.y() << ' ' << plane.normal.z() << ' ' << plane.offset << '\n';
  file << s.vertices() << ' ' << s.tets() << '\n';
  for (const V& x : s.mesh.positions) put(x);
  for (std::size_t e = 0; e < s.tets(); ++e) {
    for (const std::size_t v : s.tet(e)) file << v << ' ';
    file << '\n';
  }
  file << s.bodies.size() << '\n';
  for (const auto& body : s.bodies)
    for (const V& x : body) put(x);
  if (!file) stop("cannot write " + path);
}

V get(std::istream& file) {
  double x = 0, y = 0, z = 0;
  file >> x >> y >> z;
  return {x, y, z};
}

Scene read(const std::string& path) {
  std::ifstream file(path);
  Scene s;
  std::size_t planes = 0, vertices = 0, tets = 0, bodies = 0;
  file >> s.steps >> s.h >> s.young >> s.poisson >> s.density >> s.friction;
  s.gravity = get(file);
  file >> planes;
  s.planes.resize(planes);
  for (auto& plane : s.planes) {
    plane.normal = get(file);
    file >> plane.offset;
  }
  file >> vertices >> tets;
  s.mesh = *corotet::make_block({});
  s.mesh.positions.resize(vertices);
  for (V& x : s.mesh.positions) x = get(file);
  s.mesh.connectivity.resize(4 * tets);
  for (Index& node : s.mesh.connectivity) file >> node;
  file >> bodies;
  s.bodies.assign(bodies, std::vector<V>(vertices));
  for (auto& body : s.bodies)
    for (V& x : body) x = get(file);
  if (!file) stop("cannot read " + path);
  return s;
}

// ---- Motion: times of all steps, bodies asleep, and frames of positions and velocities ----

struct Frame {
  int step = 0;
  std::vector<V> positions, velocities;
};
struct Motion {
  std::vector<double> ms;
  std::size_t asleep = 0;
  std::vector<Frame> frames;
};

void write(const Motion& m, const std::string& path) {
  std::ofstream file(path);
  file.precision(9);
  file << m.ms.size() << ' ' << m.asleep << ' ' << m.frames.size() << '\n';
  for (const double ms : m.ms) file << ms << '\n';
  for (const Frame& f : m.frames) {
    file << f.step << '\n';
    for (std::size_t v = 0; v < f.positions.size(); ++v) {
      const V &x = f.positions[v], &u = f.velocities[v];
      file << x.x() << ' ' << x.y() << ' ' << x.z() << ' ' << u.x() << ' ' << u.y() << ' ' << u.z() << '\n';
    }
  }
  if (!file) stop("cannot write " + path);
}

Motion read_motion(const std::string& path, std::size_t vertices) {
  std::ifstream file(path);
  Motion m;
  std::size_t steps = 0, frames = 0;
  file >> steps >> m.asleep >> frames;
  m.ms.resize(steps);
  for (double& ms : m.ms) file >> ms;
  m.frames.resize(frames);
  for (Frame& f : m.frames) {
    file >> f.step;
    for (std::size_t v = 0; v < vertices; ++v) {
      f.positions.push_back(get(file));
      f.velocities.push_back(get(file));
    }
  }
  if (!file) stop("cannot read " + path);
  return m;
}

// ---- corotet ----

using Body = corotet::SoftBody<float, corotet::Tet4>;
using Integrator = corotet::ImplicitEuler<Body, corotet::AutoSolver<float>>;

struct Member {
  Body body;
  Integrator integrator;
  corotet::Contacts<float> contacts;
};

/// Time that the process has taken of a processor: other load on the machine does not count.
double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

Motion run(const Scene& s, bool sleeps, int substeps) {
  const double h = s.h / substeps;
  const corotet::ContactOptions options{.friction = s.friction};
  corotet::Obstacles obstacles;
  for (const auto& plane : s.planes) obstacles.add(plane);
  obstacles.gravity = s.gravity;
  corotet::SoftContacts<float> soft(options);
  corotet::Sleep sleep(obstacles);
  std::vector<std::unique_ptr<Member>> members;
  for (const auto& vertices : s.bodies) {
    auto data = s.mesh;
    data.positions = vertices;
    auto body = *Body::create(*corotet::TetMesh<float, corotet::Tet4>::create(data),
                              corotet::Material{.young = s.young, .poisson = s.poisson, .density = s.density});
    body.set_gravity(s.gravity.cast<float>());
    auto surface = *corotet::ContactSurface::boundary(body.mesh());
    corotet::Contacts<float> contacts(surface.points(), obstacles, options);
    soft.add(std::move(surface), false);
    sleep.add();
    Integrator integrator(body, corotet::SolverOptions{.tolerance = 1e-3});
    members.push_back(std::make_unique<Member>(Member{std::move(body), std::move(integrator), std::move(contacts)}));
  }
  const bool touch = members.size() > 1 && !sleeps;  // bodies that touch each other do not sleep
  const auto one = [&](Index i, corotet::StepTerm<float>* between) {
    Member& m = *members[static_cast<std::size_t>(i)];
    const std::array<corotet::StepTerm<float>*, 2> terms{&m.contacts, between};
    corotet::StepContext<float> context;
    context.terms =
        corotet::Terms<float>(std::span<corotet::StepTerm<float>* const>(terms).first(between != nullptr ? 2 : 1));
    const auto report = sleeps ? sleep.step(i, m.integrator, m.body, static_cast<float>(h), context)
                               : m.integrator.step(m.body, static_cast<float>(h), context);
    if (!report.accepted()) stop("a step failed");
  };
  Motion motion;
  for (int step = 0; step < s.steps; ++step) {
    const double start = cpu_ms();
    for (int substep = 0; substep < substeps; ++substep) {
      if (touch)
        soft.step([&](Index i, corotet::StepTerm<float>& term) { one(i, &term); });
      else
        for (std::size_t i = 0; i < members.size(); ++i) one(static_cast<Index>(i), nullptr);
      obstacles.advance(h);
    }
    motion.ms.push_back(cpu_ms() - start);
    if ((step + 1) % frame_steps != 0) continue;
    Frame& frame = motion.frames.emplace_back();
    frame.step = step + 1;
    for (const auto& m : members)
      for (Index v = 0; v < m->body.vertex_count(); ++v) {
        frame.positions.push_back(m->body.position(v).cast<double>() + m->body.origin());
        frame.velocities.push_back(m->body.velocities()[static_cast<std::size_t>(v)].cast<double>());
      }
  }
  if (sleeps)
    for (Index i = 0; i < sleep.size(); ++i) motion.asleep += sleep.is_asleep(i) ? 1 : 0;
  return motion;
}

// ---- Measures: the same for all engines ----

/// Of the faces that one tetrahedron has.
std::vector<std::array<std::size_t, 3>> boundary(const Scene& s) {
  std::vector<std::array<std::size_t, 3>> faces, sorted;
  for (std::size_t e = 0; e < s.tets(); ++e) {
    const auto t = s.tet(e);
    faces.insert(faces.end(), {{t[0], t[1], t[2]}, {t[0], t[1], t[3]}, {t[0], t[2], t[3]}, {t[1], t[2], t[3]}});
  }
  for (auto f : faces) {
    std::sort(f.begin(), f.end());
    sorted.push_back(f);
  }
  std::vector<std::array<std::size_t, 3>> alone;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (std::count(sorted.begin(), sorted.end(), sorted[i]) == 1) alone.push_back(faces[i]);
  return alone;
}

double volume6(const V& a, const V& b, const V& c, const V& d) { return (b - a).cross(c - a).dot(d - a); }

bool lies_in(const V& p, const V& a, const V& b, const V& c, const V& d) {
  const double all = volume6(a, b, c, d);
  const std::array<double, 4> parts{volume6(p, b, c, d), volume6(a, p, c, d), volume6(a, b, p, d), volume6(a, b, c, p)};
  return std::all_of(parts.begin(), parts.end(), [all](double part) { return part * all > 0; });
}

V closest(const V& p, const V& a, const V& b, const V& c) {  // Ericson 2005, 5.1.5
  const V ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const V bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const V cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + vb / (va + vb + vc) * ab + vc / (va + vb + vc) * ac;
}

/// How deep any vertex lies in another body, m.
double overlap(const Scene& s, const std::vector<V>& x, const std::vector<std::array<std::size_t, 3>>& faces) {
  const std::size_t n = s.vertices(), count = s.bodies.size();
  std::vector<V> low(count, V::Constant(1e9)), high(count, V::Constant(-1e9));
  for (std::size_t v = 0; v < x.size(); ++v) {
    low[v / n] = low[v / n].cwiseMin(x[v]);
    high[v / n] = high[v / n].cwiseMax(x[v]);
  }
  double deepest = 0;
  for (std::size_t v = 0; v < x.size(); ++v)
    for (std::size_t b = 0; b < count; ++b) {
      const V& p = x[v];
      if (b == v / n || (p - low[b]).minCoeff() < 0 || (high[b] - p).minCoeff() < 0) continue;
      const auto at = [&](std::size_t k) -> const V& { return x[b * n + k]; };
      bool inside = false;
      for (std::size_t e = 0; e < s.tets() && !inside; ++e) {
        const auto t = s.tet(e);
        inside = lies_in(p, at(t[0]), at(t[1]), at(t[2]), at(t[3]));
      }
      if (!inside) continue;
      double depth = 1e9;
      for (const auto& f : faces) depth = std::min(depth, (p - closest(p, at(f[0]), at(f[1]), at(f[2]))).norm());
      deepest = std::max(deepest, depth);
    }
  return deepest;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Prints one line: fall ms, rest ms, asleep, depth in planes, depth in bodies, kinetic energy, fastest, a, creep.
void measure(const Scene& s, const Motion& m) {
  const std::size_t n = s.vertices();
  std::vector<double> mass(n, 0);
  for (std::size_t e = 0; e < s.tets(); ++e) {
    const auto t = s.tet(e);
    const auto& x = s.mesh.positions;
    for (const std::size_t v : t) mass[v] += s.density * volume6(x[t[0]], x[t[1]], x[t[2]], x[t[3]]) / 24;
  }
  const auto faces = boundary(s);
  double in_planes = 0, in_bodies = 0, last_in_bodies = 0, kinetic = 0, fastest = 0;
  std::vector<double> where, speed;  // of the centre of mass, along x
  for (const Frame& f : m.frames) {
    kinetic = fastest = 0;
    double all = 0, place = 0, momentum = 0;
    for (std::size_t v = 0; v < f.positions.size(); ++v) {
      for (const auto& plane : s.planes)
        in_planes = std::max(in_planes, plane.offset - plane.normal.dot(f.positions[v]));
      kinetic += 0.5 * mass[v % n] * f.velocities[v].squaredNorm();
      fastest = std::max(fastest, f.velocities[v].norm());
      all += mass[v % n];
      place += mass[v % n] * f.positions[v].x();
      momentum += mass[v % n] * f.velocities[v].x();
    }
    where.push_back(place / all);
    speed.push_back(momentum / all);
    last_in_bodies = overlap(s, f.positions, faces);
    in_bodies = std::max(in_bodies, last_in_bodies);
  }
  const std::size_t last = m.frames.size() - 1, first = m.frames.size() / 3 - 1;
  const double time = s.h * (m.frames[last].step - m.frames[first].step);
  const auto third = static_cast<std::ptrdiff_t>(m.ms.size() / 3), tail = static_cast<std::ptrdiff_t>(m.ms.size() / 6);
  std::printf("%.5g %.5g %zu %.3g %.3g %.3g %.3g %.3g %.6g %.3g\n", median({m.ms.begin(), m.ms.begin() + third}),
              median({m.ms.end() - tail, m.ms.end()}), m.asleep, in_planes, in_bodies, last_in_bodies, kinetic, fastest,
              (speed[last] - speed[first]) / time, (where[last] - where[first]) / time);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 4 && words[0] == "write") {
    write(slope(0.5), words[1] + "/slides.txt");
    write(slope(0.2), words[1] + "/holds.txt");
    write(heap(std::stoi(words[2]), std::stoi(words[3])), words[1] + "/heap.txt");
    write(spread(200), words[1] + "/spread.txt");
  } else if (words.size() == 5 && words[0] == "run") {
    write(run(read(words[1]), words[3] == "sleep", std::stoi(words[4])), words[2]);
  } else if (words.size() == 3 && words[0] == "measure") {
    const Scene scene = read(words[1]);
    measure(scene, read_motion(words[2], scene.vertices() * scene.bodies.size()));
  } else {
    std::fputs(
        "Usage: contact_peers write FOLDER N LAYERS | run SCENE MOTION awake|sleep SUBSTEPS | measure SCENE MOTION\n"
        "bench/peers/README.md says what for.\n",
        stderr);
    return 2;
  }
}
