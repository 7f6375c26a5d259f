// Where a file is, and how it is opened: without <filesystem> and streams, which take a tenth of an include each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace corotet::inline v0_1 {

/// The name of a file: text, in UTF-8 on Windows too, or a std::filesystem::path.
class FilePath {
 public:
  // NOLINTBEGIN(google-explicit-constructor): as a path
  /// Of a path in UTF-8.
  FilePath(std::string text) : text_(std::move(text)) {}
  FilePath(std::string_view text) : text_(text) {}  ///< of a path in UTF-8
  FilePath(const char* text) : text_(text) {}       ///< of a path in UTF-8, ended by a zero
  /// Of a std::filesystem::path.
  template <class Path>
    requires requires(const Path& path) { path.u8string().c_str(); }
  FilePath(const Path& path) {
    const auto bytes = path.u8string();
    text_.assign(bytes.begin(), bytes.end());
  }
  // NOLINTEND(google-explicit-constructor)

  /// The path in UTF-8.
  [[nodiscard]] const std::string& text() const { return text_; }

  /// From the last point in the name of the file on, the point included: ".vtu"; "" if there is none, or nothing before
  /// it.
  [[nodiscard]] std::string_view extension() const { return std::string_view(text_).substr(end_of_stem()); }
  /// The path with another extension, given with its dot.
  [[nodiscard]] FilePath with_extension(std::string_view extension) const {
    return text_.substr(0, end_of_stem()) + std::string(extension);
  }

 private:
  [[nodiscard]] std::size_t end_of_stem() const {
#if defined(_WIN32)
    const std::size_t slash = text_.find_last_of("/\\:");
#else
    const std::size_t slash = text_.find_last_of('/');
#endif
    const std::size_t begin = slash == std::string::npos ? 0 : slash + 1, point = text_.find_last_of('.');
    const bool is_dots = text_.find_first_not_of('.', begin) == std::string::npos;
    return point == std::string::npos || point <= begin || is_dots ? text_.size() : point;
  }

  std::string text_;
};

namespace detail {

#if defined(_WIN32)
/// UTF-16 of UTF-8; what is malformed becomes U+FFFD.
[[nodiscard]] inline std::wstring wide(std::string_view text) {
  std::wstring out;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    const int more = lead < 0x80 ? 0 : lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : -1;
    std::uint32_t code = more < 0 ? 0xFFFD : more == 0 ? lead : lead & (0x3Fu >> more);
    for (int k = 0; k < more; ++k) {
      if (i == text.size() || (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) {
        code = 0xFFFD;
        break;
      }
      code = code << 6 | (static_cast<unsigned char>(text[i++]) & 0x3Fu);
    }
    if (code >= 0x10000) {
      out += static_cast<wchar_t>(0xD7C0 + (code >> 10));
      code = 0xDC00 + (code & 0x3FF);
    }
    out += static_cast<wchar_t>(code);
  }
  return out;
}
#endif

struct CloseFile {
  void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

/// As std::fopen; null if it cannot be opened.
[[nodiscard]] inline File open_file(const FilePath& path, const char* mode) {
#if defined(_WIN32)
  std::FILE* file = nullptr;
  return File(_wfopen_s(&file, wide(path.text()).c_str(), wide(mode).c_str()) == 0 ? file : nullptr);
#else
  return File(std::fopen(path.text().c_str(), mode));
#endif
}

}  // namespace detail
}  // namespace corotet::inline v0_1
