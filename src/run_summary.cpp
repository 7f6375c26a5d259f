#include "run_summary.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <corotet/detail/core/version.hpp>

namespace corotet::program {
namespace {

/// The p-th percentile by nearest rank, 0 < p <= 100; null without samples.
Json percentile(std::vector<double> samples, double p) {
  if (samples.empty()) return nullptr;
  const auto rank = static_cast<std::ptrdiff_t>(p / 100 * static_cast<double>(samples.size()) + 0.9999999);
  const auto place = samples.begin() + std::max<std::ptrdiff_t>(rank, 1) - 1;
  std::nth_element(samples.begin(), place, samples.end());
  return *place;
}

const char* name_of(RotationKind rotation) {
  switch (rotation) {
    case RotationKind::identity:
      return "identity";
    case RotationKind::gram_schmidt:
      return "gram_schmidt";
    case RotationKind::polar:
      break;
  }
  return "polar";
}

}  // namespace

StepStatistics::StepStatistics(int steps) {
  for (auto* samples : {&step_ms_, &assembly_ms_, &solve_ms_}) samples->reserve(at(steps));
}

void StepStatistics::add(const StepReport& report, const PhaseClock& clock, double cpu_s) {
  counts_.add(report);
  if (!report.accepted()) return;
  step_ms_.push_back(clock.total_ms());
  assembly_ms_.push_back(clock.assembly_ms());
  solve_ms_.push_back(clock.solve_ms());
  cpu_s_ += cpu_s;
  iterations_ += report.iterations;
  newton_iterations_ += report.newton_iterations;
  max_newton_iterations_ = std::max(max_newton_iterations_, report.newton_iterations);
  worst_newton_residual_ = std::max(worst_newton_residual_, report.newton_residual);
  sub_steps_ += report.sub_steps;
  max_sub_steps_ = std::max(max_sub_steps_, report.sub_steps);
  worst_residual_ = std::max(worst_residual_, report.residual);
  max_inverted_ = std::max(max_inverted_, report.inverted_elements);
  last_ = report;
}

double StepStatistics::median_step_ms() const {
  const Json median = percentile(step_ms_, 50);
  return median.is_null() ? 0 : median.get<double>();
}

void StepStatistics::write_to(Json& summary) const {
  const auto mean = [&](double sum) { return counts_.accepted == 0 ? Json() : Json(sum / counts_.accepted); };
  summary["steps"] = counts_.accepted;
  summary["step_ms"] = {
      {"median", percentile(step_ms_, 50)}, {"min", percentile(step_ms_, 1e-9)}, {"p99", percentile(step_ms_, 99)}};
  summary["cpu_ms_per_step"] = mean(1000 * cpu_s_);
  summary["assembly_ms"] = percentile(assembly_ms_, 50);
  summary["solve_ms"] = percentile(solve_ms_, 50);
  summary["iterations"] = {{"mean", mean(iterations_)}, {"max", counts_.max_iterations}};
  summary["residual"] = worst_residual_;
  summary["newton"] = {{"iterations", {{"mean", mean(newton_iterations_)}, {"max", max_newton_iterations_}}},
                       {"residual", worst_newton_residual_}};
  summary["sub_steps"] = {{"mean", mean(sub_steps_)}, {"max", max_sub_steps_}};
  summary["inverted_elements"] = last_.inverted_elements;
  summary["inverted_elements_max"] = max_inverted_;
  summary["largest_rotation"] = last_.max_rotation;
  summary["largest_strain"] = last_.max_strain;
  summary["status"] = {{"converged", counts_.accepted - counts_.unconverged}, {"unconverged", counts_.unconverged},
                       {"newton_unconverged", counts_.newton_unconverged},    {"untrusted", counts_.unreliable},
                       {"with_inverted_elements", counts_.inverted},          {"refused", counts_.refused}};
}

void ContactStatistics::add(const ContactReport& report) {
  ++steps_;
  last_ = report;
  passes_ += report.passes;
  max_passes_ = std::max(max_passes_, report.passes);
  deepest_ = std::max(deepest_, report.deepest);
  dropped_ = std::max(dropped_, report.dropped);
  unsettled_ += report.settled ? 0 : 1;
}

Json ContactStatistics::summary(Index points) const {
  return {{"points", points},
          {"touching", last_.touching},
          {"sliding", last_.sliding},
          {"passes", {{"mean", steps_ == 0 ? Json() : Json(passes_ / steps_)}, {"max", max_passes_}}},
          {"deepest", deepest_},
          {"normal_force", last_.normal_force},
          {"dropped", dropped_},
          {"unsettled", unsettled_}};
}

Json summary_head(const Scene& scene, const std::string& stopped_because) {
  Json summary;
  summary["corotet"] = fmt::format("{}.{}.{}", COROTET_VERSION_MAJOR, COROTET_VERSION_MINOR, COROTET_VERSION_PATCH);
  summary["scene"] = scene.file.string();
  summary["completed"] = stopped_because.empty();
  if (!stopped_because.empty()) summary["stopped_because"] = stopped_because;
  return summary;
}

Json summary_of(const Scene& scene, const RunInput& input, const RunFacts& facts, const StepStatistics& steps) {
  Json summary;
  if (scene.name.empty())
    summary = summary_head(scene, facts.stopped_because);
  else
    summary["name"] = scene.name;
  summary["vertices"] = facts.simulation.vertices;
  summary["elements"] = facts.simulation.elements;
  summary["pinned_vertices"] = facts.pinned_vertices;
  summary["body_mass"] = facts.simulation.mass;
  summary["order"] = input.mesh.nodes_per_element == 4 ? 1 : 2;
  summary["scalar"] = scene.scalar == ScalarKind::single_precision ? "float" : "double";
  summary["rotation"] = name_of(scene.rotation);
  summary["rotation_site"] = scene.rotation_site == RotationSite::point ? "point" : "element";
  summary["dilatation"] = scene.volumetric_strain == VolumetricStrain::averaged ? "mean" : "per_element";
  summary["mass"] = scene.mass == MassModel::lumped ? "lumped" : "consistent";
  summary["integrator"] = {{"name", name_of(scene.integrator)},
                           {"dt", scene.dt},
                           {"newton", scene.newton.iterations},
                           {"newton_tolerance", scene.newton.tolerance},
                           {"tangent", name_of(scene.newton.tangent)},
                           {"energy", scene.newton.bounds_energy ? "bounded" : "as_integrated"},
                           {"spin", scene.newton.keeps_angular_momentum ? "kept" : "as_integrated"},
                           {"untrusted", name_of(scene.untrusted)}};
  summary["solver"] = {{"name", facts.simulation.solver}};
  if (!facts.simulation.preconditioner.empty()) summary["solver"]["preconditioner"] = facts.simulation.preconditioner;
  summary["solver"]["tolerance"] = scene.solver.tolerance;
  summary["solver"]["max_iterations"] = scene.solver.max_iterations;
  summary["threads"] = facts.threads;
  summary["setup_ms"] = facts.setup_ms;
  steps.write_to(summary);
  summary["peak_rss_mb"] = facts.peak_rss_mb;
  summary["spmv_us"] = facts.spmv_us;
  if (facts.surface)
    summary["surface"] = {{"vertices", input.surface->positions.size()},
                          {"triangles", input.surface->triangles.size()},
                          {"vertices_outside", facts.surface->outside},
                          {"largest_distance", facts.surface->max_distance}};
  if (facts.contact_points > 0) summary["contact"] = facts.contact.summary(facts.contact_points);
  for (const auto& [x, f] : facts.attachments)
    summary["attachments"].push_back({{"rest", {x[0], x[1], x[2]}}, {"force", {f[0], f[1], f[2]}}});
  summary["probes"] = Json::array();
  for (const Index v : input.probes) {
    const Vec3<double>& x = input.mesh.positions[at(v)];
    summary["probes"].push_back({{"vertex", v}, {"rest", {x[0], x[1], x[2]}}});
  }
  return summary;
}

std::string format_json(const Json& summary) {
  // Paths may hold any bytes; what is not UTF-8 is replaced rather than thrown at.
  return summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace corotet::program
