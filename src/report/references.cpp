#include "references.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "../failure.hpp"

namespace corotet::program {
namespace {

/// (4 fine - coarse) / 3 at each point and time.
Track extrapolate(const Track& fine, const Track& coarse) {
  Track track(fine);
  for (std::size_t t = 0; t < track.size(); ++t)
    for (std::size_t p = 0; p < track[t].size(); ++p) track[t][p] += (fine[t][p] - coarse[t][p]) / 3;
  return track;
}

}  // namespace

References::References(const Study& study, int level, ThreadPool& pool, TimeBudget& budget, double share)
    : study_(study), pool_(pool), allowance_(budget), level_(level) {
  (void)of(tight({study_.scene, study_.base_level, 2}));  // tells the allowance what this machine can do
  const auto cost = [&] {
    Configuration finest{study_.scene, level_, 2};
    constexpr double solves = 3;  // of Newton's method, a step
    double sum = 0;
    if (!study_.at_rest)
      for (finest.scene.dt = shortest_dt() / 2; finest.scene.dt < study_.sample_interval * 1.01; finest.scene.dt *= 2)
        sum += (finest.scene.dt < 1.5 * shortest_dt() ? solves : 2) *
               allowance_.estimate(TimeBudget::Kind::tight_tet10, elements(finest), steps(finest));
    else
      sum = allowance_.estimate(TimeBudget::Kind::tight_tet10, elements(finest), steps(finest));
    return sum;
  };
  while (level_ > 0 && cost() > share * allowance_.left()) --level_;
}

double References::shortest_dt() const { return *std::min_element(study_.dts.begin(), study_.dts.end()); }

double References::elements(const Configuration& c) const { return study_.meshes[c.level].linear.element_count(); }

double References::steps(const Configuration& c) const {
  constexpr double settling = 60;
  return study_.steps(c.scene.dt) + (study_.at_rest ? settling : 0);
}

const RunResult& References::of(const Configuration& configuration) {
  const auto [place, is_new] = runs_.try_emplace(key_of(configuration));
  if (!is_new) return place->second;
  const auto start = std::chrono::steady_clock::now();
  place->second = run(study_, configuration, pool_);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (place->second.steps > 0)
    allowance_.learn(TimeBudget::kind(configuration.order, true), elements(configuration), place->second.steps,
                     seconds);
  return place->second;
}

Configuration References::tight(const Configuration& configuration) const {
  Configuration c = tightened(configuration);
  if (study_.at_rest) c.scene.dt = study_.scene.dt;  // it says only how the fall was timed
  return c;
}

Configuration References::on_finest_mesh(Configuration configuration) const {
  configuration = tight(configuration);
  // Lumping 10-node elements spreads their weight with an error of second order, where they have one of third.
  configuration.scene.mass = MassModel::consistent;
  configuration.scene.volumetric_strain = study_.scene.volumetric_strain;
  configuration.level = level_;
  configuration.order = 2;
  return configuration;
}

const RunResult& References::exact() {
  if (exact_) return *exact_;
  Configuration finest = on_finest_mesh({study_.scene, level_, 2});
  const auto require_ok = [&](const RunResult& result) -> const RunResult& {
    if (!result.ok())
      throw Failure(fmt::format("{}: the reference (mesh {}, 10-node elements, double) is of no use: {}", study_.name,
                                study_.meshes[level_].name, result.status));
    return result;
  };
  if (study_.at_rest) return exact_.emplace(require_ok(of(finest)));
  finest = converged(finest);
  finest.scene.integrator = IntegratorKind::bdf2;
  finest.scene.dt = shortest_dt();
  const RunResult& coarse = require_ok(of(finest));
  finest.scene.dt /= 2;
  exact_.emplace(require_ok(of(finest)));
  exact_->track = extrapolate(exact_->track, coarse.track);
  exact_->probes = extrapolate(exact_->probes, coarse.probes);
  return *exact_;
}

const ErrorNorms& References::norms() {
  if (!norms_) norms_.emplace(study_, exact());
  return *norms_;
}

double References::own_error() {
  if (level_ == 0) return std::numeric_limits<double>::quiet_NaN();
  const Configuration finest = on_finest_mesh({study_.scene, level_, 2});
  Configuration coarser = finest;
  --coarser.level;
  return norms().between(of(coarser), of(finest)).displacement / 3;
}

ErrorParts References::parts(const Configuration& configuration, const RunResult& result) {
  const RunResult& exact_run = exact();
  const RunResult& own = of(tight(configuration));
  const RunResult& fine = of(on_finest_mesh(configuration));
  return {norms().between(result, exact_run), norms().between(own, fine), norms().between(fine, exact_run),
          norms().between(result, own)};
}

double References::estimate(const Configuration& c) const {
  double sum = allowance_.estimate(TimeBudget::kind(c.order, false), elements(c), steps(c));
  if (!runs_.contains(key_of(tight(c))))
    sum += allowance_.estimate(TimeBudget::kind(c.order, true), elements(c), steps(c));
  const Configuration fine = on_finest_mesh(c);
  if (!runs_.contains(key_of(fine))) sum += allowance_.estimate(TimeBudget::kind(2, true), elements(fine), steps(fine));
  return sum;
}

}  // namespace corotet::program
