// A key of a scene that names a file.
#pragma once

#include <filesystem>
#include <optional>

#include "object_reader.hpp"

namespace corotet::program {

/// The path under `key` relative to `folder`, that of the scene, which must name a file (or a pipe) that is there.
/// Nothing if the key is absent, or after noting a problem.
[[nodiscard]] std::optional<std::filesystem::path> read_file_key(ObjectReader& in, const char* key,
                                                                 const std::filesystem::path& folder);

}  // namespace corotet::program
