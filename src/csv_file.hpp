// A table that grows row by row while the program runs.
#pragma once

#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "failure.hpp"

namespace corotet::program {

/// Each function throws a Failure that names the file if it cannot be written.
class CsvFile {
 public:
  /// Replaces the file at `path`; `header` names its columns.
  void open(std::filesystem::path path, std::string_view header) {
    path_ = std::move(path);
    stream_.open(path_, std::ios::binary);
    stream_ << header << '\n' << std::flush;
    if (!stream_) throw Failure(fmt::format("{}: it cannot be written", path_.string()));
  }
  [[nodiscard]] bool is_open() const { return stream_.is_open(); }

  /// Adds rows, each of which ends with '\n'. They are in the file when it returns.
  void add(const std::string& rows) {
    stream_ << rows << std::flush;
    if (!stream_) throw Failure(fmt::format("{}: writing failed", path_.string()));
  }

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
};

}  // namespace corotet::program
