// A series of .vtu files in the folder "frames", and the .pvd file that lists them.
#pragma once

#include <corotet/detail/mesh/io/write_pvd.hpp>
#include <corotet/detail/mesh/io/write_vtu.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace corotet::program {

/// The folder of frames, in that of the results.
inline constexpr const char* frames_folder = "frames";

class FrameSeries {
 public:
  /// `name`: of the .pvd file, and what the names of frames begin with.
  explicit FrameSeries(std::string name) : name_(std::move(name)) {}

  /// Adds a frame at time t, s, to the results in `folder`. The first makes what is not there. Throws a Failure that
  /// names the file that cannot be written.
  void add(const std::filesystem::path& folder, double t, const VtuGrid& grid);

 private:
  std::string name_;
  std::optional<PvdWriter> list_;
};

}  // namespace corotet::program
