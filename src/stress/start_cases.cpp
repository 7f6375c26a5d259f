// Bodies that start far from any sensible shape.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "case.hpp"
#include "test_body.hpp"

namespace corotet::program::stress {
namespace {

/// Where a free vertex starts that rests at x.
using Collapse = Vec3<double> (*)(const Vec3<double>& x);

/// Numbers in [0, 1), the same on every platform.
class UniformRandom {
 public:
  explicit UniformRandom(int seed) : random_(static_cast<std::uint64_t>(seed)) {}
  double operator()() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 random_;
};

struct Start {
  const char* suffix;
  const char* words;
  double h;        // s
  double damping;  // 1/s M
  double off;      // by how much each coordinate is off at most, of a body that is 1 m long, m
};
constexpr std::array<Start, 3> starts{{{"60", "h = 1/60, damping 2/s M", 1.0 / 60, 2, 0},
                                       {"10", "h = 1/10, no damping", 1.0 / 10, 0, 0},
                                       {"off", "off by up to 1e-6 m; h = 1/60, damping 2/s M", 1.0 / 60, 2, 1e-6}}};

CaseResult recover(const Configuration& configuration, const Start& start, Collapse collapse) {
  Scene scene = configuration.scene();
  scene.dt = start.h;
  scene.damping.mass = start.damping;
  TestBody trial(scene, fine_block(configuration.order));
  trial.pin(at_left_end);
  UniformRandom unit(1);
  trial.place([&](Index v) {
    const Vec3<double> off{unit() - 0.5, unit() - 0.5, unit() - 0.5};
    return at_left_end(trial.rest(v)) ? trial.rest(v) : (collapse(trial.rest(v)) + 2 * start.off * off);
  });
  trial.run(static_cast<int>(std::lround(10 / start.h)));
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("inverted elements", trial.last().inverted_elements, 0);
  verdict.at_most("rms to rest", trial.rms_to_rest(), 1e-3);
  verdict.note("inside out at a corner", trial.folded_elements());
  return verdict;
}

void add_collapse(std::vector<Case>& cases, const char* name, const char* how, Collapse collapse) {
  for (const Start& start : starts)
    cases.push_back(
        {fmt::format("{}-{}", name, start.suffix),
         fmt::format("block held at one end, the rest of it {}; {}", how, start.words),
         "after 10 s no inverted element, rms to rest <= 1e-3 m", Solvers::all, ratios(Ratios::all),
         [&start, collapse](const Configuration& c, const Effort&) { return recover(c, start, collapse); }});
}

/// A start for each seed. Recovered: back at rest. Stuck: at rest elsewhere, which must show as inverted elements.
CaseResult recover_from_chaos(const Configuration& configuration, const Effort& effort) {
  const Scene scene = configuration.settling_scene();
  CaseResult verdict;
  int recovered = 0, moving = 0, stuck = 0, silent = 0, folded = 0;
  double min_strain = std::numeric_limits<double>::infinity();  // of those that are stuck without an inverted element
  TestBody trial(scene, coarse_block(configuration.order));
  trial.pin(at_left_end);
  for (int seed = 1; seed <= effort.seeds; ++seed) {
    UniformRandom unit(seed);
    trial.push([](Index) { return Vec3<double>::Zero(); });
    trial.place([&](Index v) {
      const Vec3<double> x{unit(), unit() / 2, unit() / 2};  // in this order
      return at_left_end(trial.rest(v)) ? trial.rest(v) : x;
    });
    int quiet = 0;
    trial.run(3600, [&] {
      quiet = trial.max_speed() < 1e-3 ? quiet + 1 : 0;
      return quiet == 20;
    });
    const bool back = trial.rms_to_rest() <= 1e-3 && trial.last().inverted_elements == 0;
    if (back) ++recovered;
    if (quiet < 20) ++moving;
    if (quiet == 20 && !back) ++stuck;
    if (quiet == 20 && !back && trial.last().inverted_elements == 0) {
      ++silent;
      if (trial.folded_elements() > 0) ++folded;
      min_strain = std::min(min_strain, trial.last().max_strain);
    }
    if (!trial.error().empty()) break;
  }
  trial.report_to(verdict);
  verdict.recovered = double(recovered) / effort.seeds;
  verdict.note("recovered", verdict.recovered);
  verdict.note("stuck", double(stuck) / effort.seeds);
  verdict.at_most("still moving after 60 s", double(moving) / effort.seeds, 0);
  verdict.at_most("stuck without an inverted element", double(silent) / effort.seeds, 0);
  verdict.note("of these inside out at a corner", folded);
  if (silent > 0) verdict.note("of these the least of the largest strain", min_strain);
  return verdict;
}

}  // namespace

void add_start_cases(std::vector<Case>& cases) {
  add_collapse(cases, "flat", "pressed into the plane z = 0.25 m",
               [](const Vec3<double>& x) { return Vec3<double>(x.x(), x.y(), 0.25); });
  add_collapse(cases, "line", "pressed onto its axis",
               [](const Vec3<double>& x) { return Vec3<double>(x.x(), 0.25, 0.25); });
  add_collapse(cases, "point", "pressed into a point",
               [](const Vec3<double>&) { return Vec3<double>(0.5, 0.25, 0.25); });
  add_collapse(cases, "mirrored", "reflected at the held face",
               [](const Vec3<double>& x) { return Vec3<double>(-x.x(), x.y(), x.z()); });
  cases.push_back({"random", "block held at one end, all other vertices anywhere in its box; one body a seed",
                   "finite, speed -> 0 within 60 s; what is stuck has inverted elements; the fraction that recovers is "
                   "reported",
                   Solvers::two, ratios(Ratios::all), recover_from_chaos});
}

}  // namespace corotet::program::stress
