// The files that a run leaves of its obstacles. docs/program.md describes them.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <filesystem>

#include "csv_file.hpp"
#include "frame_series.hpp"
#include "obstacle_run.hpp"

namespace corotet::program {

/// obstacles.csv, and frames of the obstacles. Each function throws a Failure that names the file if it cannot be
/// written. Without obstacles there are no files.
class ObstacleOutput {
 public:
  /// In a folder that is there. `centre` and `size` (m): where bodies begin, for half-spaces to be drawn there.
  ObstacleOutput(std::filesystem::path folder, const Vec3<double>& centre, double size);

  /// One row for each obstacle: t (s), its number, its pose, and the force (N) and torque (N m) that bodies exerted on
  /// it in the last step, of h s.
  void add_rows(double t, double h, const ObstacleRun& run);
  void add_frame(double t, const ObstacleRun& obstacles);

 private:
  std::filesystem::path folder_;
  Vec3<double> centre_;
  double size_;
  CsvFile rows_;
  FrameSeries frames_{"obstacles"};
};

}  // namespace corotet::program
