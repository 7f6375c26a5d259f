// Energy that comes from nowhere.
#pragma once

#include <algorithm>
#include <cmath>

namespace corotet::program::stress {

/// How far a body's energy has ever risen above its least before, J. An energy that is not a number is a rise that no
/// limit allows.
class EnergyWatch {
 public:
  explicit EnergyWatch(double energy) : least_(energy), rise_(energy - energy) {}

  void see(double energy) {
    rise_ = std::isnan(energy) ? energy : std::max(rise_, energy - least_);
    least_ = std::min(least_, energy);
  }

  [[nodiscard]] double rise() const { return rise_; }
  [[nodiscard]] double least() const { return least_; }

 private:
  double least_, rise_;
};

}  // namespace corotet::program::stress
