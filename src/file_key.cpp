#include "file_key.hpp"

#include <fmt/core.h>

#include <string>
#include <system_error>

namespace corotet::program {

namespace fs = std::filesystem;

std::optional<fs::path> read_file_key(ObjectReader& in, const char* key, const fs::path& folder) {
  std::string text;
  if (!in.text(key, text)) return std::nullopt;
  if (text.empty()) {
    in.problems().add(in.path_of(key), "must name a file");
    return std::nullopt;
  }
  fs::path path = folder / text;
  std::error_code code;
  if (!fs::exists(path, code)) {
    in.problems().add(in.path_of(key), fmt::format("there is no file {}", path.string()));
    return std::nullopt;
  }
  return path;
}

}  // namespace corotet::program
