// How far two runs of a study are apart.
#pragma once

#include <memory>
#include <vector>

#include "study.hpp"

namespace corotet::program {

/// Each relative to the size of the reference's displacements in the same measure, over all times together.
struct Errors {
  double displacement = 0;  ///< in the norm of the mass, at the sample points
  double energy = 0;        ///< sqrt(sum e . K' e / sum 2 W): K' the stiffness of the reference, W its elastic energy
  double probe = 0;         ///< of the probe and time where it is largest
};

/// Measures against one reference.
class ErrorNorms {
 public:
  /// `reference` must be a complete run of the study.
  ErrorNorms(const Study& study, const RunResult& reference);

  /// |a - b|; not a number if one of the runs is not complete.
  [[nodiscard]] Errors between(const RunResult& a, const RunResult& b) const;

 private:
  [[nodiscard]] double energy_of(const Track& a, const Track& b) const;

  std::vector<double> weight_;  // volume around each sample point
  std::vector<std::size_t> energy_times_;
  Track reference_;
  std::unique_ptr<Simulation> body_;  // Tet4, double, on the sample points
  Field<double> rest_;
  double displacement_size_ = 0, energy_size_ = 0, probe_size_ = 0;
};

}  // namespace corotet::program
