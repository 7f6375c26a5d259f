// Whole files to and from memory, without exceptions.
#pragma once

#include <sys/stat.h>
#include <sys/types.h>

#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/core/result.hpp>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {
namespace detail {

enum class FileKind { none, regular, pipe, directory, other };

[[nodiscard]] inline FileKind kind_of_file(const FilePath& path) {
#if defined(_WIN32)
  struct _stat64 status;
  if (_wstat64(wide(path.text()).c_str(), &status) != 0) return FileKind::none;
#else
  struct stat status;
  if (stat(path.text().c_str(), &status) != 0) return FileKind::none;
#endif
  const unsigned type = unsigned{status.st_mode} & unsigned{S_IFMT};
  if (type == static_cast<unsigned>(S_IFREG)) return FileKind::regular;
  if (type == static_cast<unsigned>(S_IFDIR)) return FileKind::directory;
#if defined(S_IFIFO)
  if (type == static_cast<unsigned>(S_IFIFO)) return FileKind::pipe;
#endif
  return FileKind::other;
}

}  // namespace detail

/// The content of a file. Errors: file_not_found; file_unreadable for a directory, a device or a failed read.
[[nodiscard]] inline Result<std::string> read_file(const FilePath& path) {
  const detail::FileKind kind = detail::kind_of_file(path);
  if (kind == detail::FileKind::none) return Error{ErrorCode::file_not_found, path.text(), "there is no such file"};
  if (kind == detail::FileKind::directory) return Error{ErrorCode::file_unreadable, path.text(), "it is a directory"};
  // A device such as /dev/zero may never end.
  if (kind == detail::FileKind::other)
    return Error{ErrorCode::file_unreadable, path.text(), "it is not a regular file"};

  const detail::File file = detail::open_file(path, "rb");
  if (!file) return Error{ErrorCode::file_not_found, path.text(), "it cannot be opened for reading"};
  // Until its end, whatever its size is said to be: the file may be a pipe, or grow.
  std::string bytes;
  std::vector<char> block(std::size_t{1} << 16);
  for (;;) {
    const std::size_t count = std::fread(block.data(), 1, block.size(), file.get());
    bytes.append(block.data(), count);
    if (count < block.size()) break;
  }
  if (std::ferror(file.get()) != 0) return Error{ErrorCode::file_unreadable, path.text(), "reading failed"};
  return bytes;
}

namespace detail {

/// Writes at the present place and closes: a full disk shows in one of the two.
[[nodiscard]] inline Result<void> write_and_close(File file, const FilePath& path, std::string_view bytes) {
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
  const bool closed = std::fclose(file.release()) == 0;
  if (!written || !closed) return Error{ErrorCode::file_unreadable, path.text(), "writing failed"};
  return {};
}

}  // namespace detail

/// Writes `bytes` as the whole content of a file, replacing what was there. Errors: file_unreadable.
[[nodiscard]] inline Result<void> write_file(const FilePath& path, std::string_view bytes) {
  detail::File file = detail::open_file(path, "wb");
  if (!file) return Error{ErrorCode::file_unreadable, path.text(), "it cannot be opened for writing"};
  return detail::write_and_close(std::move(file), path, bytes);
}

}  // namespace corotet::inline v0_1
