#include "error_norms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../failure.hpp"
#include "../loads.hpp"

namespace corotet::program {
namespace {

Field<double> moved(const Field<double>& rest, const Field<double>& displacement) {
  Field<double> positions(rest);
  for (std::size_t v = 0; v < rest.size(); ++v) positions[v] += displacement[v];
  return positions;
}

double largest(const Track& track) {
  double most = 0;
  for (const Field<double>& field : track)
    for (const Vec3<double>& u : field) most = std::max(most, u.norm());
  return most;
}

}  // namespace

ErrorNorms::ErrorNorms(const Study& study, const RunResult& reference) : reference_(reference.track) {
  const MeshData& mesh = study.meshes[study.sample_level].linear;
  weight_ = vertex_volumes(mesh);
  rest_ = mesh.positions;
  Scene scene = study.scene;
  scene.scalar = ScalarKind::double_precision;
  scene.rotation = RotationKind::polar;
  body_ = make_simulation(scene, mesh);

  for (const Field<double>& field : reference_)
    for (std::size_t v = 0; v < field.size(); ++v) displacement_size_ += weight_[v] * field[v].squaredNorm();
  probe_size_ = largest(reference.probes);
  // The energy norm takes a matrix each time: some of the times are enough.
  constexpr std::size_t enough = 8;
  const std::size_t every = (reference_.size() + enough - 1) / enough;
  for (std::size_t t = reference_.size(); t-- > 0;)
    if ((reference_.size() - 1 - t) % every == 0) energy_times_.push_back(t);
  for (const std::size_t t : energy_times_) {
    require(body_->set_positions(moved(rest_, reference_[t])));
    energy_size_ += 2 * body_->elastic_energy();
  }
}

double ErrorNorms::energy_of(const Track& a, const Track& b) const {
  double sum = 0;
  for (const std::size_t t : energy_times_) {
    require(body_->set_positions(moved(rest_, reference_[t])));
    Field<double> difference(a[t]);
    for (std::size_t v = 0; v < difference.size(); ++v) difference[v] -= b[t][v];
    sum += body_->stiffness_product(difference);
  }
  return std::sqrt(std::max(sum, 0.0) / energy_size_);
}

Errors ErrorNorms::between(const RunResult& a, const RunResult& b) const {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (a.track.size() != reference_.size() || b.track.size() != reference_.size()) return {none, none, none};
  Errors errors;
  for (std::size_t t = 0; t < reference_.size(); ++t) {
    for (std::size_t v = 0; v < weight_.size(); ++v)
      errors.displacement += weight_[v] * (a.track[t][v] - b.track[t][v]).squaredNorm();
    for (std::size_t p = 0; p < a.probes[t].size(); ++p)
      errors.probe = std::max(errors.probe, (a.probes[t][p] - b.probes[t][p]).norm());
  }
  errors.displacement = std::sqrt(errors.displacement / displacement_size_);
  errors.probe /= probe_size_;
  errors.energy = std::isfinite(errors.displacement) ? energy_of(a.track, b.track) : none;
  return errors;
}

}  // namespace corotet::program
