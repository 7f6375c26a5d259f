#include "frame_series.hpp"

#include <fmt/core.h>

#include "failure.hpp"
#include "output_folder.hpp"

namespace corotet::program {

void FrameSeries::add(const std::filesystem::path& folder, double t, const VtuGrid& grid) {
  if (!list_) {
    make_folder(folder / frames_folder);
    list_ = require(PvdWriter::create(folder / (name_ + ".pvd")));
  }
  const std::string name = fmt::format("{}/{}_{:06}.vtu", frames_folder, name_, list_->frame_count());
  require(write_vtu(folder / name, grid));
  require(list_->add_frame(t, name));
}

}  // namespace corotet::program
