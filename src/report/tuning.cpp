#include "tuning.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "../failure.hpp"

namespace corotet::program {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

std::string describe(const Study& study, const Candidate& c) {
  return fmt::format("{:.3g} % for {:.3g} ms with {} {}, dt {:.4g} s (space {:.2g} %, time {:.2g} %)", 100 * c.error,
                     c.frame_ms, c.configuration.order == 1 ? "Tet4" : "Tet10",
                     study.meshes[c.configuration.level].name, c.configuration.scene.dt, 100 * c.space, 100 * c.time);
}

class Tuner {
 public:
  using Observer = std::function<void(const std::string&, double)>;

  Tuner(const Study& study, const TuningGoal& goal, ThreadPool& threads, TimeBudget& budget, const Observer& observer)
      : study_(study),
        goal_(goal),
        allowance_(budget),
        observer_(observer),
        references_(study, study.reference_level, threads, budget, 0.4) {}

  Tuning tune(const Confirm& confirm) {
    (void)references_.exact();
    const Configuration own{study_.scene, study_.meshes.own, study_.own_order};
    Tuning tuning;
    tuning.as_it_was = measure(own);
    sweep_meshes();
    sweep_time_steps();
    combine();
    for (;;) {
      const auto best = find_best();
      if (best == candidates_.end() || !reaches(*best)) throw Failure(explain(best));
      if (best->measured) {
        tuning.measured = *best;
        tuning.predicted = predictions_[static_cast<std::size_t>(best - candidates_.begin())];
        break;
      }
      observer_("trying what was found", 0.8);
      *best = measure(best->configuration, &*best);
      ++tuning.tried;
    }
    refine(tuning);
    const Configuration picked = tuning.measured.configuration;
    const RunResult confirmed = confirm(picked);
    if (!confirmed.ok()) throw Failure(fmt::format("the scene that was written does not run: {}", confirmed.status));
    tuning.measured = grade(picked, confirmed, &tuning.measured);
    return tuning;
  }

 private:
  [[nodiscard]] bool reaches(const Candidate& c) const {
    return goal_.error ? c.error <= *goal_.error : c.frame_ms <= *goal_.budget_ms;
  }

  /// The cheaper one, or for a budget the more accurate one. Candidates that miss the goal come last.
  [[nodiscard]] bool better(const Candidate& a, const Candidate& b) const {
    if (reaches(a) != reaches(b)) return reaches(a);
    if (!reaches(a)) return goal_.error ? a.error < b.error : a.frame_ms < b.frame_ms;
    return goal_.error ? a.frame_ms < b.frame_ms : a.error < b.error;
  }

  std::vector<Candidate>::iterator find_best() {
    return std::min_element(candidates_.begin(), candidates_.end(),
                            [&](const Candidate& a, const Candidate& b) { return better(a, b); });
  }

  [[nodiscard]] std::string explain(std::vector<Candidate>::iterator best) const {
    const std::string asked = goal_.error ? fmt::format("an error of {:.3g} %", 100 * *goal_.error)
                                          : fmt::format("a step within {:.3g} ms", *goal_.budget_ms);
    if (best == candidates_.end()) return fmt::format("{} is not reached: no settings ran", asked);
    return fmt::format(
        "{} is not reached; the nearest: {}. Finer meshes than {} and shorter steps than {:.3g} s were "
        "not tried; --minutes allows more",
        asked, describe(study_, *best), study_.meshes[references_.level()].name,
        *std::min_element(study_.dts.begin(), study_.dts.end()));
  }

  /// A run with its time and error. `expected` gives the parts that are known already.
  Candidate measure(const Configuration& configuration, const Candidate* expected = nullptr) {
    ThreadPool serial(1);
    return grade(configuration, run(study_, configuration, serial), expected);
  }

  Candidate grade(const Configuration& configuration, const RunResult& result, const Candidate* expected = nullptr) {
    Candidate c;
    if (expected != nullptr) c = *expected;
    c.configuration = configuration;
    c.measured = true;
    c.error = c.frame_ms = infinite;
    if (!result.ok()) return c;
    const ErrorParts parts = references_.parts(configuration, result);
    c.space = parts.space.displacement;
    c.time = parts.time.displacement;
    c.arithmetic = parts.arithmetic.displacement;
    c.error = parts.total.displacement;
    c.frame_ms = result.step_ms * study_.scene.dt / configuration.scene.dt;
    return c;
  }

  /// Error of space and time of a step on each mesh, at the scene's time step.
  void sweep_meshes() {
    const int finest = references_.level();
    for (const int order : {2, 1}) {
      const int last = order == 2 ? finest - 1 : study_.meshes.count() - 1;
      for (int level = 0; level <= last; ++level)
        for (const MassModel mass : {MassModel::lumped, MassModel::consistent}) {
          Configuration c{study_.scene, level, order};
          c.scene.mass = mass;
          observer_(fmt::format("mesh {}, order {}", study_.meshes[level].name, order),
                    0.2 + 0.4 * (level + (order == 1 ? last : 0)) / (2.0 * last + 1));
          if (references_.estimate(c) > allowance_.left()) continue;
          const Candidate measured = measure(c);
          if (measured.error < infinite) meshes_.push_back(measured);
        }
    }
  }

  /// Error of each time step, on the finest mesh.
  void sweep_time_steps() {
    for (const IntegratorKind integrator : study_.integrators) sweep_time_steps(integrator);
  }

  void sweep_time_steps(IntegratorKind integrator) {
    for (const double dt : study_.dts) {
      Configuration c{study_.scene, references_.level(), 2};
      c.scene.integrator = integrator;
      c.scene.dt = dt;
      observer_(fmt::format("dt {:.4g} s", dt), 0.7);
      if (references_.estimate(c) > allowance_.left()) continue;
      Candidate candidate;
      candidate.configuration = c;
      candidate.time =
          references_.norms().between(references_.of(references_.on_finest_mesh(c)), references_.exact()).displacement;
      times_.push_back(candidate);
    }
  }

  void combine() {
    for (const Candidate& mesh : meshes_)
      for (const Candidate& time : times_) {
        Candidate c = mesh;
        const Scene& scene = time.configuration.scene;
        c.configuration.scene.dt = scene.dt;
        c.configuration.scene.integrator = scene.integrator;
        c.time = time.time;
        if (scene.dt != study_.scene.dt || scene.integrator != study_.scene.integrator) {
          c.measured = false;
          c.error = c.space + c.time + c.arithmetic;
          c.frame_ms = mesh.frame_ms * study_.scene.dt / c.configuration.scene.dt;
        }
        candidates_.push_back(c);
        c.measured = false;
        c.error = c.space + c.time + c.arithmetic;
        predictions_.push_back(c);
      }
  }

  /// Other tolerances and preconditioners for what was picked; one that is not faster by more than the noise is not
  /// taken.
  void refine(Tuning& tuning) {
    constexpr double worth_it = 0.93;
    const Configuration picked = tuning.measured.configuration;
    const auto attempt = [&](auto&& change) {
      Configuration c = tuning.measured.configuration;
      change(c.scene.solver);
      observer_("trying other solvers", 0.9);
      if (references_.estimate(c) > allowance_.left()) return;
      const Candidate tried = measure(c, &tuning.measured);
      ++tuning.tried;
      if (reaches(tried) && tried.frame_ms < worth_it * tuning.measured.frame_ms &&
          tried.error < 1.02 * tuning.measured.error + 1e-6)
        tuning.measured = tried;
    };
    for (const auto kind :
         {PreconditionerKind::rigid_aggregates, PreconditionerKind::warped_cholesky, PreconditionerKind::block_jacobi})
      attempt([&](SolverOptions& s) { s.preconditioner = kind; });
    for (const double tolerance : {1e-2, 1e-1})
      if (tolerance > picked.scene.solver.tolerance) attempt([&](SolverOptions& s) { s.tolerance = tolerance; });
  }

  const Study& study_;
  const TuningGoal& goal_;
  TimeBudget& allowance_;
  const Observer& observer_;
  References references_;
  std::vector<Candidate> meshes_, times_, candidates_, predictions_;
};

}  // namespace

Tuning tune(const Study& study, const TuningGoal& goal, ThreadPool& threads, TimeBudget& budget, const Confirm& confirm,
            const std::function<void(const std::string&, double)>& observer) {
  return Tuner(study, goal, threads, budget, observer).tune(confirm);
}

}  // namespace corotet::program
