// A scene file made from another one.
#pragma once

#include <filesystem>
#include <string>

#include "../json_file.hpp"
#include "configuration.hpp"

namespace corotet::program {

/// The text of the scene at `original` with the configuration's settings in place of its own, for a file in `folder`:
/// paths in it are made relative to that. `mesh` is the path of the mesh. The scene lasts as long as before; frames
/// come as often.
[[nodiscard]] std::string format_scene(const std::filesystem::path& original, const Configuration& configuration,
                                       const std::filesystem::path& mesh, const std::filesystem::path& folder);

}  // namespace corotet::program
