// The files that a run leaves behind. docs/program.md describes them.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "csv_file.hpp"
#include "frame_series.hpp"
#include "run_input.hpp"
#include "simulation.hpp"

namespace corotet::program {

/// Makes a folder, with those above it, if it is not there. Throws a Failure that names it if it cannot be made.
void make_folder(const std::filesystem::path& folder);

/// The folder of one of several bodies, in that of the results.
[[nodiscard]] std::string body_folder(const std::string& name);

/// An attachment after a step.
struct AttachmentState {
  Vec3<double> place;  ///< of the point that is tied, m
  Vec3<double> force;  ///< on the body, N
};

/// Each function throws a Failure that names the file if it cannot be written. Whatever is there is readable at any
/// time, also after the program was stopped: probes come line by line, series list only frames that are complete, and
/// final.txt and summary.json appear whole or not at all.
class OutputFolder {
 public:
  /// Makes the folder, or takes an earlier run's files out of it.
  explicit OutputFolder(std::filesystem::path folder);

  /// One row for each probe: t (s), its number, its position (m).
  void add_probes(double t, const Simulation& simulation, const std::vector<Index>& probes);

  /// One row for each attachment: t (s), its number, where its point is (m), its force on the body (N). Without
  /// attachments there is no file.
  void add_attachments(double t, const std::vector<AttachmentState>& attachments);

  /// One .vtu of the volume and, if `surface` is there, one of it, listed in volume.pvd and surface.pvd.
  void add_frame(double t, Simulation& simulation, const MeshData& mesh, const SurfaceMesh* surface);

  void write_final(const Simulation& simulation, Index vertices);
  void write_summary(const std::string& json);

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  void write_whole(const char* name, const std::string& bytes) const;

  std::filesystem::path folder_;
  CsvFile probes_, attachments_;
  FrameSeries volume_{"volume"}, surface_{"surface"};
};

}  // namespace corotet::program
