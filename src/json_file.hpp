// JSON text from a file, with errors that name the line.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace corotet::program {

/// In the order of the file, so that problems are listed in that order.
using Json = nlohmann::ordered_json;

/// Throws a Failure that names the file and the line for text that is not JSON, or an object that names a key twice.
[[nodiscard]] Json read_json(const std::filesystem::path& path);

}  // namespace corotet::program
