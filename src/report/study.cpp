#include "study.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include "../failure.hpp"
#include "../local_origin.hpp"
#include "../momenta.hpp"
#include "../phase_clock.hpp"
#include "../run_input.hpp"
#include "../run_setup.hpp"
#include "../timing.hpp"

namespace corotet::program {
namespace {

/// The points at which runs are compared, bound to a simulation's mesh.
class Sampler {
 public:
  Sampler(const Study& study, Simulation& simulation, ThreadPool& pool)
      : simulation_(simulation), points_(study.meshes[study.sample_level].linear.positions) {
    samples_ = points_.size();
    points_.insert(points_.end(), study.probes.begin(), study.probes.end());
    SurfaceMesh surface;
    surface.positions = points_;
    (void)require(simulation.bind(surface, pool));
  }

  /// False if a point is not finite.
  bool add_to(RunResult& result) {
    Field<double> displacements = simulation_.surface().positions;
    for (std::size_t p = 0; p < points_.size(); ++p) displacements[p] -= points_[p];
    const auto middle = displacements.begin() + static_cast<std::ptrdiff_t>(samples_);
    result.probes.emplace_back(middle, displacements.end());
    displacements.resize(samples_);
    result.track.push_back(std::move(displacements));
    return std::all_of(result.track.back().begin(), result.track.back().end(),
                       [](const Vec3<double>& u) { return u.allFinite(); });
  }

 private:
  Simulation& simulation_;
  Field<double> points_;
  std::size_t samples_ = 0;
};

class Runner {
 public:
  Runner(const Study& study, const Scene& scene, RunInput input, ThreadPool& pool)
      : study_(study), scene_(scene), pool_(pool), input_(std::move(input)) {
    const auto start = std::chrono::steady_clock::now();
    simulation_ = make_simulation(scene_, input_.mesh);
    (void)set_up(*simulation_, scene_, input_);
    result_.setup_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    result_.facts = simulation_->facts();
    const auto [least, most] = Bounds::of(input_.mesh);
    size_ = (most - least).norm();
  }

  RunResult run() {
    Sampler sampler(study_, *simulation_, pool_);
    const int steps = study_.steps(scene_.dt);
    const int every = std::max(1, static_cast<int>(std::lround(study_.sample_interval / scene_.dt)));
    const Index vertices = result_.facts.vertices;
    result_.angular_momentum_first = angular_momentum(*simulation_, vertices, Vec3<double>::Zero());
    for (int step = 1; step <= steps && result_.ok(); ++step) {
      move_pins(*simulation_, input_, step * scene_.dt);
      if (!advance(scene_.dt)) break;
      if (!study_.at_rest && step % every == 0 && !sampler.add_to(result_)) result_.status = "not finite";
    }
    result_.angular_momentum_last = angular_momentum(*simulation_, vertices, Vec3<double>::Zero());
    if (study_.at_rest && result_.ok()) {
      settle();
      if (!sampler.add_to(result_)) result_.status = "not finite";
    }
    finish();
    return std::move(result_);
  }

 private:
  /// A step. False if it was refused.
  bool advance(double h) {
    clock_.start();
    const StepReport report = simulation_->step(h, pool_, clock_);
    clock_.stop();
    if (!report.accepted()) {
      result_.status = fmt::format("refused at step {}: {}", result_.steps + 1, report.advice());
      return false;
    }
    ++result_.steps;
    // The first makes the factors: it belongs to the set-up.
    if (result_.steps == 1) result_.setup_ms += clock_.total_ms();
    if (result_.steps > 1 || study_.steps(h) == 1) times_.push_back(clock_.total_ms());
    iterations_ += report.iterations;
    if (!(report.converged && report.newton_converged)) ++unconverged_;
    inverted_ = report.inverted_elements;
    return true;
  }

  void settle() {
    const StaticReport report = simulation_->solve_static(pool_);
    result_.steps += report.steps;
    iterations_ += report.iterations;
    inverted_ = report.last.inverted_elements;
    if (!report.converged) result_.status = fmt::format("not at rest: {}", report.advice());
  }

  void finish() {
    if (!times_.empty()) result_.step_ms = median_of(times_);
    if (result_.steps > 0) result_.iterations = iterations_ / result_.steps;
    double farthest = 0;
    for (const Field<double>& field : result_.track)
      for (const Vec3<double>& u : field) farthest = std::max(farthest, u.norm());
    if (result_.ok() && inverted_ > 0) result_.status = fmt::format("{} elements inverted at the end", inverted_);
    if (result_.ok() && unconverged_ > result_.steps / 2)
      result_.status = fmt::format("unconverged in {} of {} steps", unconverged_, result_.steps);
    else if (unconverged_ > 0)
      result_.remarks = fmt::format("{} of {} steps unconverged", unconverged_, result_.steps);
    if (result_.ok() && farthest > 1e3 * size_) result_.status = fmt::format("diverged: it moved {:.2g} m", farthest);
  }

  const Study& study_;
  const Scene& scene_;
  ThreadPool& pool_;
  RunInput input_;
  std::unique_ptr<Simulation> simulation_;
  PhaseClock clock_;
  RunResult result_;
  std::vector<double> times_;  // ms
  double iterations_ = 0;
  int unconverged_ = 0;
  Index inverted_ = 0;
  double size_ = 0;  // m
};

}  // namespace

int Study::steps(double dt) const { return std::max(1, static_cast<int>(std::lround(duration / dt))); }

RunResult run(const Study& study, const Scene& scene, RunInput input, ThreadPool& pool) {
  return Runner(study, scene, std::move(input), pool).run();
}

RunResult run(const Study& study, const Configuration& configuration, ThreadPool& pool) {
  try {
    RunInput input = match_input(configuration.scene, study.meshes.mesh(configuration.level, configuration.order));
    return run(study, configuration.scene, std::move(input), pool);
  } catch (const std::exception& error) {  // a mesh on which the scene has no meaning, or too little memory
    RunResult result;
    result.status = error.what();
    return result;
  }
}

}  // namespace corotet::program
