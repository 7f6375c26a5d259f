#include "contact_cases.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <exception>
#include <numbers>
#include <utility>

#include "../failure.hpp"
#include "../stress/test_body.hpp"

namespace corotet::program {
namespace {

using Vec = Vec3<double>;
using Map = std::function<Vec(const Vec&)>;

constexpr double gravity = 9.81;  // m/s^2
constexpr double density = 1000;  // kg/m^3

/// A block, and how many cells it has in 4-node elements; with 10-node elements half as many each way.
struct Blank {
  Vec corner, size;
  std::array<Index, 3> coarse, fine;
  Map warp = {};  ///< where corners of elements go; edges stay straight
};

struct TrialOptions {
  double poisson = 0.3;
  double friction = 0;
  Vec gravity = Vec::Zero();  ///< m/s^2
  bool settles = false;       ///< the body shall come to rest
};

/// A run of a case: a body whose steps are counted and timed.
class ContactTrial {
 public:
  ContactTrial(ContactRow& row, const Blank& blank, const TrialOptions& options)
      : row_(row), body_(scene_of(row.setting, options), mesh_of(row, blank)) {
    row.vertices = body_.vertices();
    row.elements = body_.mesh().element_count();
    body_.touch({.friction = options.friction});
  }
  ContactTrial(const ContactTrial&) = delete;
  ContactTrial& operator=(const ContactTrial&) = delete;
  ~ContactTrial() = default;

  [[nodiscard]] stress::TestBody& body() { return body_; }
  [[nodiscard]] Obstacles& obstacles() { return body_.obstacles; }
  [[nodiscard]] double mass() { return body_.body().facts().mass; }
  [[nodiscard]] double dt() const { return row_.setting.dt; }
  [[nodiscard]] bool is_bdf2() const { return row_.setting.integrator == IntegratorKind::bdf2; }
  [[nodiscard]] double wave_speed() const { return std::sqrt(row_.setting.young / density); }

  /// For so many seconds. `before(t)` is called before each step, with the time at its end.
  void run(double seconds, const std::function<void(double)>& before = nullptr,
           const std::function<void()>& after = nullptr) {
    const auto steps = static_cast<int>(std::lround(seconds / dt()));
    for (int i = 1; i <= steps; ++i) {
      if (before) before(i * dt());
      if (!body_.step()) throw Failure(body_.error());
      add_step();
      if (after) after();
    }
  }

  /// Once all steps are done.
  void finish(std::vector<ContactQuantity> quantities) {
    row_.quantities = std::move(quantities);
    if (row_.steps > 0) {
      row_.step_ms /= row_.steps;
      row_.iterations /= row_.steps;
      row_.passes /= row_.steps;
    }
    row_.frame_ms = row_.step_ms / (60 * dt());
    const bool is_known = std::all_of(row_.quantities.begin(), row_.quantities.end(),
                                      [](const ContactQuantity& q) { return std::isfinite(q.measured); });
    if (!body_.finite() || !is_known) row_.status = "not finite";
  }

 private:
  static Scene scene_of(const ContactSetting& setting, const TrialOptions& options) {
    Scene scene;
    scene.order = setting.order;
    scene.material = {setting.young, options.poisson, density};
    scene.gravity = options.gravity;
    scene.integrator = setting.integrator;
    scene.dt = setting.dt;
    // Backward Euler needs nothing to come to rest; the second order formula keeps slow motion.
    if (options.settles && setting.integrator == IntegratorKind::bdf2) scene.damping.mass = 10;
    return scene;
  }

  static MeshData mesh_of(ContactRow& row, const Blank& blank) {
    auto cells = row.setting.fine ? blank.fine : blank.coarse;
    if (row.setting.order == 2)
      for (Index& n : cells) n = (n + 1) / 2;
    row.mesh = fmt::format("{} {}x{}x{}", row.setting.order == 1 ? "Tet4" : "Tet10", cells[0], cells[1], cells[2]);
    MeshData mesh = require(make_block({.corner = blank.corner, .size = blank.size, .cells = cells}));
    if (blank.warp)
      for (Vec& x : mesh.positions) x = blank.warp(x);
    return row.setting.order == 2 ? raise_order(std::move(mesh)) : mesh;
  }

  void add_step() {
    ++row_.steps;
    row_.step_ms += body_.step_ms();
    row_.iterations += body_.last().iterations;
    const ContactReport contact = body_.contact();
    row_.passes += contact.passes;
    row_.max_passes = std::max(row_.max_passes, contact.passes);
    row_.most_touching = std::max(row_.most_touching, contact.touching);
    row_.unsettled += contact.settled ? 0 : 1;
  }

  ContactRow& row_;
  stress::TestBody body_;
};

double mean_sag(ContactTrial& trial, double top) {
  double sum = 0;
  Index count = 0;
  for (Index v = 0; v < trial.body().vertices(); ++v)
    if (trial.body().rest(v).z() > top - 1e-9) {
      sum -= trial.body().body().displacement(v).z();
      ++count;
    }
  return sum / count;
}

void rest(ContactRow& row) {
  constexpr double height = 0.4;
  ContactTrial trial(row, {Vec::Zero(), {0.2, 0.2, height}, {2, 2, 4}, {4, 4, 8}},
                     {.poisson = 0, .friction = 0.5, .gravity = {0, 0, -gravity}, .settles = true});
  trial.obstacles().add(HalfSpace{});
  trial.run(trial.is_bdf2() ? 8 : 4);
  trial.finish(
      {{"sag of the top, m", density * gravity * height * height / (2 * row.setting.young), mean_sag(trial, height)},
       {"force of the floor, N", trial.mass() * gravity, trial.body().contact().normal_force}});
}

const Blank slider{Vec::Zero(), {0.4, 0.4, 0.1}, {4, 4, 2}, {8, 8, 2}};
constexpr double slider_friction = 0.5;

/// The angle of a slope whose tangent is `ratio` times the friction's coefficient.
double slope_of(double ratio) { return std::atan(slider_friction * ratio); }
/// On a slope: gravity that is not normal to the floor.
TrialOptions on_slope(double slope, bool settles = false) {
  return {.friction = slider_friction,
          .gravity = {gravity * std::sin(slope), 0, -gravity * std::cos(slope)},
          .settles = settles};
}

void incline_holds(ContactRow& row) {
  const double slope = slope_of(0.99);
  ContactTrial trial(row, slider, on_slope(slope, true));
  trial.obstacles().add(HalfSpace{});
  trial.run(trial.is_bdf2() ? 6 : 2);
  const Vec before = trial.body().centre();
  trial.run(1);
  trial.finish({{"way in 1 s, m", 0, (trial.body().centre() - before).norm(), gravity * std::sin(slope) / 2}});
}

void incline_slides(ContactRow& row) {
  const double slope = slope_of(1.2);
  ContactTrial trial(row, slider, on_slope(slope));
  trial.obstacles().add(HalfSpace{});
  trial.run(trial.is_bdf2() ? 2 : 1);
  const double before = trial.body().momentum().x();
  trial.run(1);
  trial.finish({{"acceleration, m/s^2", gravity * (std::sin(slope) - slider_friction * std::cos(slope)),
                 (trial.body().momentum().x() - before) / trial.mass()}});
}

void stopping(ContactRow& row) {
  constexpr double speed = 2;
  ContactTrial trial(row, slider, on_slope(0));
  trial.obstacles().add(HalfSpace{}, {.friction = 0});
  trial.run(2);
  trial.obstacles()[0].friction = slider_friction;
  const double start = trial.body().centre().x();
  trial.body().push([](Index) { return Vec(speed, 0, 0); });
  trial.run(1);
  trial.finish({{"way, m", speed * speed / (2 * slider_friction * gravity), trial.body().centre().x() - start}});
}

void bar(ContactRow& row) {
  constexpr double length = 1, thickness = 0.2, speed = 1;
  ContactTrial trial(row, {Vec::Zero(), {thickness, thickness, length}, {2, 2, 20}, {4, 4, 40}}, {.poisson = 0});
  trial.obstacles().add(HalfSpace{});
  trial.body().push([](Index) { return Vec(0, 0, -speed); });
  const double contact_time = 2 * length / trial.wave_speed();
  double touched = 0, impulse = 0;
  trial.run(4 * contact_time + 20 * trial.dt(), nullptr, [&] {
    if (trial.body().contact().touching > 0) touched += trial.dt();
    impulse += trial.dt() * trial.body().contact().normal_force;
  });
  trial.finish({{"speed after, m/s", speed, trial.body().momentum().z() / trial.mass()},
                {"contact time, s", contact_time, touched},
                {"mean force while it touches, N", density * trial.wave_speed() * speed * thickness * thickness,
                 impulse / touched}});
}

/// Displacement of a half-space z < 0 by a force P on it along -z in the origin (Boussinesq 1885).
Vec boussinesq(const Vec& x, double force, double young, double poisson) {
  const double r = x.norm(), depth = -x.z();
  const double factor = force * (1 + poisson) / (2 * std::numbers::pi * young * r);
  const double outwards = depth / (r * r) - (1 - 2 * poisson) / (r + depth);
  return {factor * outwards * x.x(), factor * outwards * x.y(),
          -factor * (depth * depth / (r * r) + 2 * (1 - poisson))};
}

void hertz(ContactRow& row) {
  constexpr double radius = 0.5, depth = 0.0025, poisson = 0.3, half = 0.35, press = 0.25;
  const auto graded = [](double s) { return s * std::fabs(s); };
  ContactTrial trial(row,
                     {{-1, -1, -1},
                      {2, 2, 1},
                      {16, 16, 8},
                      {24, 24, 12},
                      [&](const Vec& s) -> Vec { return half * Vec(graded(s.x()), graded(s.y()), graded(s.z())); }},
                     {.poisson = poisson, .settles = true});
  const double modulus = row.setting.young / (1 - poisson * poisson);
  const double force = 4.0 / 3 * modulus * std::sqrt(radius) * std::pow(depth, 1.5);
  const auto is_held = [&](const Vec& x) {
    return std::max({std::fabs(x.x()), std::fabs(x.y()), -x.z()}) > half - 1e-9;
  };
  const std::vector<Index> held = trial.body().pin(is_held);
  trial.obstacles().add(Sphere{radius}, {.pose = {.position = {0, 0, radius}}});
  trial.run(press, [&](double t) {
    trial.obstacles()[0].velocity = {0, 0, -depth / press};
    const double now = force * std::pow(std::min(1.0, t / press), 1.5);
    for (const Index v : held)
      trial.body().body().move_pin(v, boussinesq(trial.body().rest(v), now, row.setting.young, poisson));
  });
  trial.obstacles()[0].velocity.setZero();
  trial.run(1);
  trial.finish({{"force, N", force, trial.body().contact().normal_force}});
}

void cantilever(ContactRow& row) {
  constexpr double length = 1, thickness = length / 20, free_drop = 0.02, gap = free_drop / 2;
  const double bending = row.setting.young * std::pow(thickness, 4) / 12;  // E I
  const double load = 8 * bending * free_drop / std::pow(length, 4);       // N/m
  ContactTrial trial(row, {{0, -thickness / 2, -thickness / 2}, {length, thickness, thickness}, {40, 2, 2}, {80, 4, 4}},
                     {.poisson = 0, .gravity = {0, 0, -load / (density * thickness * thickness)}, .settles = true});
  trial.body().pin(stress::at_left_end);
  trial.obstacles().add(HalfSpace{{0, 0, 1}, -thickness / 2 - gap});
  trial.run(60);
  trial.finish({{"force at the tip, N", 3 * bending / std::pow(length, 3) * (free_drop - gap),
                 trial.body().contact().normal_force}});
}

void box_on_column(ContactRow& row) {
  constexpr double height = 0.8, side = 0.4, strain = 0.0049;
  ContactTrial trial(row, {Vec::Zero(), {side, side, height}, {2, 2, 4}, {4, 4, 8}},
                     {.poisson = 0, .friction = 0.5, .settles = true});
  const double mass = strain * row.setting.young * side * side / gravity;
  trial.body().pin([](const Vec& x) { return x.z() < 1e-9; });
  trial.obstacles().gravity = {0, 0, -gravity};
  trial.obstacles().add(OrientedBox{{0.25, 0.25, 0.1}},
                        {.pose = {.position = {side / 2, side / 2, height + 0.1}}, .mass = mass});
  trial.run(5);
  trial.finish({{"sag, m", strain * height, height + 0.1 - trial.obstacles()[0].pose().position.z()},
                {"force, N", mass * gravity, trial.body().contact().normal_force}});
}

void strike(ContactRow& row) {
  constexpr double mass = 10, speed = 3;
  ContactTrial trial(row, {Vec::Zero(), Vec::Constant(0.4), {3, 3, 3}, {6, 6, 6}}, {.friction = 0.5});
  const Obstacle& ball = trial.obstacles()[trial.obstacles().add(
      Sphere{0.1}, {.pose = {.position = {0.28, 0.22, 0.52}}, .velocity = {0.5, 0, -speed}, .mass = mass})];
  const auto momentum = [&] { return Vec(trial.body().momentum() + mass * ball.velocity); };
  const auto moment = [&] {  // about the origin
    return Vec(trial.body().angular_momentum() + trial.body().centre().cross(trial.body().momentum()) +
               mass * ball.pose().position.cross(ball.velocity) + ball.inertia() * ball.angular_velocity);
  };
  const Vec p = momentum(), l = moment();
  trial.run(1);
  trial.finish({{"change of the momentum, kg m/s", 0, (momentum() - p).norm(), p.norm()},
                {"change of the angular momentum, kg m^2/s", 0, (moment() - l).norm(), mass * speed * 0.5}});
}

void rolling(ContactRow& row) {
  constexpr double radius = 0.2, speed = 2;
  const Map round = [](const Vec& x) -> Vec {
    const double r = x.norm();
    return r > 0 ? Vec(x * (x.cwiseAbs().maxCoeff() / r)) : x;
  };
  ContactTrial trial(row, {Vec::Constant(-radius), Vec::Constant(2 * radius), {8, 8, 8}, {12, 12, 12}, round},
                     {.friction = 0.5, .gravity = {0, 0, -gravity}});
  trial.obstacles().add(HalfSpace{{0, 0, 1}, -radius});
  trial.run(1);
  const Vec centre = trial.body().centre();
  trial.body().push([&](Index v) {
    return Vec(Vec(speed, 0, 0) + Vec(0, speed / radius, 0).cross(trial.body().body().position(v) - centre));
  });
  trial.run(1);
  trial.finish({{"speed after 1 s, m/s", speed, trial.body().momentum().x() / trial.mass()}});
}

void mark_frontier(std::vector<ContactRow>& rows) {
  for (ContactRow& row : rows)
    row.frontier = row.status == "ok" && std::none_of(rows.begin(), rows.end(), [&](const ContactRow& other) {
                     if (other.status != "ok" || other.setting.young != row.setting.young) return false;
                     return other.frame_ms < row.frame_ms && other.quantities[0].error() <= row.quantities[0].error();
                   });
}

}  // namespace

std::vector<ContactCase> contact_cases() {
  using enum IntegratorKind;
  std::vector<ContactCase> cases;
  const auto add = [&](const char* name, const char* title, const char* known_from,
                       void (*run)(ContactRow&)) -> ContactCase& {
    ContactCase& each = cases.emplace_back();
    each.name = name;
    each.title = title;
    each.known_from = known_from;
    each.run = run;
    return each;
  };
  add("rest", "A column of 0.4 m stands on a floor (ν = 0)", "ρ g H² / 2E, and the weight", rest);
  add("incline_holds", "A block on a slope whose tangent is 0.99 of its friction, μ = 0.5",
      "it sticks; errors in the way that it would slide without friction", incline_holds);
  add("incline_slides", "The same at 1.2", "g (sin θ − μ cos θ)", incline_slides);
  add("stopping", "A block slides on a floor at 2 m/s until it stops, μ = 0.5", "v² / 2μg", stopping);
  add("bar", "A bar of 1 m meets a wall with its end at 1 m/s (ν = 0)",
      "one wave (Saint-Venant): speed v, time 2L/c, force ρ c v A with c = √(E/ρ)", bar)
      .dts = {1.0 / 60, 1.0 / 240, 1.0 / 1000, 1.0 / 4000};
  ContactCase& sphere = add("hertz", "A rigid sphere of 0.5 m is pressed 2.5 mm into a half-space (ν = 0.3)",
                            "4/3 E* √R δ^1.5 (Hertz 1881); the mesh ends at 10 contact radii, where it is held as a "
                            "point force displaces it (Boussinesq 1885)",
                            hertz);
  sphere.dts = {1.0 / 60};
  sphere.integrators = {implicit_euler};
  ContactCase& beam = add("cantilever", "A beam under its weight rests with its tip on a floor (L/h = 20, ν = 0)",
                          "3EI/L³ (qL⁴/8EI − gap): Euler–Bernoulli with a Signorini condition", cantilever);
  beam.dts = {0.1};
  beam.youngs = {5e5};
  beam.integrators = {implicit_euler};
  add("box_on_column", "A free rigid box lies on a column of 0.8 m that it presses by 0.49 % (ν = 0)",
      "m g H / (E A), and its weight", box_on_column);
  add("strike", "A free rigid ball of 10 kg strikes a free block of 64 kg beside its middle at 3 m/s",
      "momenta are kept", strike);
  add("rolling", "A ball of 0.2 m rolls on a floor at 2 m/s, μ = 0.5", "it goes on", rolling);
  return cases;
}

std::vector<ContactRow> run_contact_case(const ContactCase& contact_case, bool quick,
                                         const std::function<void(double)>& observer) {
  std::vector<ContactRow> rows;
  for (const double young : contact_case.youngs)
    for (const int order : {1, 2})
      for (const bool fine : {false, true})
        for (const IntegratorKind integrator : contact_case.integrators)
          for (const double dt : contact_case.dts)
            if (!quick || (young == contact_case.youngs.front() && !fine))
              rows.emplace_back().setting = {order, fine, integrator, dt, young};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    observer(double(i) / double(rows.size()));
    try {
      contact_case.run(rows[i]);
    } catch (const std::exception& error) {
      rows[i].status = error.what();
    }
  }
  mark_frontier(rows);
  return rows;
}

}  // namespace corotet::program
