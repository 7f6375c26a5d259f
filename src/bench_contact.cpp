#include "bench_contact.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/rotation/quaternion.hpp>
#include <functional>
#include <memory>
#include <utility>

#include "failure.hpp"
#include "stress/test_body.hpp"

namespace corotet::program {
namespace {

using stress::TestBody;

/// A body on a floor, and the same without a floor whose bottom is pinned.
struct Situation {
  const char* name;
  double friction = 0.5;
  double slope = 0;     ///< tangent, of gravity
  double speed = 0;     ///< down, at the start, m/s
  double turn = 0;      ///< about y, at the start, rad
  double height = 0;    ///< of the lowest point above the floor, m
  bool pinned = false;  ///< both are
  bool settles = true;  ///< steps are not timed until it is at rest, or slides steadily
};

constexpr Situation situations[] = {
    {.name = "out of reach", .height = 1, .pinned = true},
    {.name = "rest"},
    {.name = "sliding", .friction = 0.3, .slope = 0.36},
    {.name = "drop on an edge", .speed = 1, .turn = 0.3, .height = 0.05, .settles = false},
    {.name = "flat impact", .speed = 2, .height = 0.01, .settles = false},
};

/// Times and counts of the steps of one body; the least time of each step in all repetitions.
class StepSeries {
 public:
  void add(std::size_t step, const TestBody& body) {
    if (step >= ms_.size()) {
      ms_.resize(step + 1, body.step_ms());
      iterations_ += body.last().iterations;
    }
    ms_[step] = std::min(ms_[step], body.step_ms());
  }

  [[nodiscard]] double mean_ms() const {
    double sum = 0;
    for (const double ms : ms_) sum += ms;
    return sum / double(ms_.size());
  }
  [[nodiscard]] double worst_ms() const { return *std::max_element(ms_.begin(), ms_.end()); }
  [[nodiscard]] double iterations() const { return iterations_ / double(ms_.size()); }

 private:
  std::vector<double> ms_;
  double iterations_ = 0;  // in the first repetition: the others have the same
};

std::unique_ptr<TestBody> make_body(const Scene& scene, const MeshData& mesh, const Situation& s, bool touches) {
  Scene own = scene;
  const double angle = std::atan(s.slope);
  own.gravity = {9.81 * std::sin(angle), 0, -9.81 * std::cos(angle)};
  auto body = std::make_unique<TestBody>(own, mesh);
  double least = mesh.positions.front().z();
  for (const Vec3<double>& x : mesh.positions) least = std::min(least, x.z());
  if (touches) {
    body->touch({.friction = s.friction});
    body->obstacles.add(HalfSpace{});
    const Mat3<double> turn = rotation_by({0, s.turn, 0});
    double low = 1e300;
    for (Index v = 0; v < body->vertices(); ++v) low = std::min(low, (turn * body->rest(v)).z());
    body->place([&](Index v) { return Vec3<double>(turn * body->rest(v) + Vec3<double>(0, 0, s.height - low)); });
  }
  if (!touches || s.pinned) {
    const double thin = 1e-6 * (mesh.positions.back() - mesh.positions.front()).norm();
    const auto pinned = body->pin([&](const Vec3<double>& x) { return x.z() <= least + thin; });
    if (pinned.empty()) throw Failure("bench: no vertex to pin");
  }
  if (s.speed > 0)
    body->push([&](Index v) {
      const bool is_held = !touches && body->rest(v).z() <= least + 1e-6;
      return Vec3<double>(0, 0, is_held ? 0 : -s.speed);
    });
  return body;
}

void step(TestBody& body) {
  if (!body.step()) throw Failure("bench: " + body.error());
}

ContactCost measure(const std::string& name, const Scene& scene, const MeshData& mesh, const Situation& s, int steps) {
  constexpr int repetitions = 3, settling = 90;
  ContactCost row{.mesh = name, .situation = s.name};
  StepSeries touching, pinned;
  double passes = 0;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const auto body = make_body(scene, mesh, s, true), other = make_body(scene, mesh, s, false);
    row.vertices = body->vertices();
    // The first step makes factors.
    const int before = s.settles ? settling : 0;
    for (int i = 0; i < before; ++i) {
      step(*body);
      step(*other);
    }
    for (int i = 0; i < steps; ++i) {
      step(*body);
      step(*other);
      if (!s.settles && i == 0) continue;
      const auto number = static_cast<std::size_t>(s.settles ? i : i - 1);
      touching.add(number, *body);
      pinned.add(number, *other);
      const ContactReport contact = body->contact();
      row.contacts = std::max(row.contacts, contact.touching);
      row.max_passes = std::max(row.max_passes, contact.passes);
      if (repetition == 0) passes += contact.passes;
    }
  }
  row.step_ms = touching.mean_ms();
  row.free_ms = pinned.mean_ms();
  row.worst_ms = touching.worst_ms();
  row.iterations = touching.iterations();
  row.free_iterations = pinned.iterations();
  row.passes = passes / (s.settles ? steps : steps - 1);
  return row;
}

}  // namespace

std::vector<ContactCost> measure_contact(const std::string& name, const Scene& scene, const MeshData& mesh, int steps) {
  std::vector<ContactCost> rows;
  for (const Situation& s : situations) rows.push_back(measure(name, scene, mesh, s, steps));
  return rows;
}

std::string format_text(const std::vector<ContactCost>& rows) {
  std::string text =
      fmt::format("{:8}{:>9}  {:16}{:>9}{:>10}{:>10}{:>8}{:>8}{:>12}{:>10}{:>8}{:>6}\n", "mesh", "vertices", "",
                  "contacts", "free, ms", "step, ms", "ratio", "worst", "iterations", "free", "passes", "most");
  for (const ContactCost& r : rows)
    text += fmt::format("{:8}{:>9}  {:16}{:>9}{:>10.3g}{:>10.3g}{:>8.2f}{:>8.2f}{:>12.1f}{:>10.1f}{:>8.2f}{:>6}\n",
                        r.mesh, r.vertices, r.situation, r.contacts, r.free_ms, r.step_ms, r.step_ms / r.free_ms,
                        r.worst_ms / r.free_ms, r.iterations, r.free_iterations, r.passes, r.max_passes);
  return text;
}

std::string format_csv(const std::vector<ContactCost>& rows) {
  std::string text =
      "mesh,vertices,situation,contacts,free_ms,step_ms,worst_ms,ratio,worst_ratio,iterations,free_iterations,passes,"
      "max_passes\n";
  for (const ContactCost& r : rows)
    text += fmt::format("{},{},{},{},{:.4g},{:.4g},{:.4g},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{}\n", r.mesh, r.vertices,
                        r.situation, r.contacts, r.free_ms, r.step_ms, r.worst_ms, r.step_ms / r.free_ms,
                        r.worst_ms / r.free_ms, r.iterations, r.free_iterations, r.passes, r.max_passes);
  return text;
}

}  // namespace corotet::program
