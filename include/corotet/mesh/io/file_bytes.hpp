// Whole files to and from memory, without exceptions.
#pragma once

#include <corotet/core/result.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace corotet::inline v0_1 {

/// The content of a file. Errors: file_not_found; file_unreadable for a directory, a device or a failed read.
[[nodiscard]] inline Result<std::string> read_file(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (status.type() == fs::file_type::not_found)
    return Error{ErrorCode::file_not_found, path.string(), "there is no such file"};
  if (fs::is_directory(status)) return Error{ErrorCode::file_unreadable, path.string(), "it is a directory"};
  // A device such as /dev/zero may never end.
  if (!fs::is_regular_file(status) && !fs::is_fifo(status))
    return Error{ErrorCode::file_unreadable, path.string(), code ? code.message() : "it is not a regular file"};

  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorCode::file_not_found, path.string(), "it cannot be opened for reading"};
  std::string bytes;
  const std::uintmax_t size = fs::file_size(path, code);
  if (!code && fs::is_regular_file(status)) bytes.reserve(static_cast<std::size_t>(size) + 1);
  // The size is a hint only: the file may be a pipe, or grow.
  std::vector<char> block(std::size_t{1} << 16);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    bytes.append(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) return Error{ErrorCode::file_unreadable, path.string(), "reading failed"};
  return bytes;
}

/// Writes `bytes` as the whole content of a file, replacing what was there. Errors: file_unreadable.
[[nodiscard]] inline Result<void> write_file(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) return Error{ErrorCode::file_unreadable, path.string(), "it cannot be opened for writing"};
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();  // flushes; a full disk shows here
  if (!file) return Error{ErrorCode::file_unreadable, path.string(), "writing failed"};
  return {};
}

}  // namespace corotet::inline v0_1
