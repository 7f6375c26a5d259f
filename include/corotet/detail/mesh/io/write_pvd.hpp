// ParaView's .pvd: a time series of .vtu files.
#pragma once

#include <cmath>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/text_writer.hpp>
#include <corotet/detail/mesh/io/xml_text.hpp>
#include <string>
#include <string_view>
#include <utility>

namespace corotet::inline v0_1 {

/// Lists frames as they are made. The file is complete after `create` and after every `add_frame`, so that a run which
/// is interrupted leaves a series that opens. A frame costs the same however many there are.
class PvdWriter {
 public:
  /// Starts an empty series, replacing a file that is there. Errors: file_unreadable.
  [[nodiscard]] static Result<PvdWriter> create(FilePath path) {
    if (Result<void> status = write_file(path, std::string(head) + std::string(tail)); !status) return status.error();
    return PvdWriter(std::move(path));
  }

  /// Adds the file of one frame, already written, at `time` (s). `file` is relative to the folder of the .pvd, in
  /// UTF-8. Errors: non_finite_value; invalid_argument for a name that is empty or holds control characters;
  /// file_unreadable. After an error the series is as it was, unless the disk failed.
  [[nodiscard]] Result<void> add_frame(double time, std::string_view file) {
    if (!std::isfinite(time)) return Error{ErrorCode::non_finite_value, "time", "it must be a finite number"};
    const Result<std::string> name = detail::xml_attribute(file, "file");
    if (!name) return name.error();

    // The new entry and the new tail go over the old tail in one write: a reader sees the series with or without it.
    detail::TextWriter text;
    text << "    <DataSet timestep=\"" << time << "\" part=\"0\" file=\"" << *name << "\"/>\n";
    const std::string entry = text.take();
    const std::string bytes = entry + std::string(tail);
    detail::File stream = detail::open_file(path_, "r+b");
    if (!stream || std::fseek(stream.get(), end_of_entries_, SEEK_SET) != 0)
      return Error{ErrorCode::file_unreadable, path_.text(), "it cannot be opened for writing"};
    if (Result<void> written = detail::write_and_close(std::move(stream), path_, bytes); !written) return written;
    end_of_entries_ += static_cast<long>(entry.size());
    ++frame_count_;
    return {};
  }

  /// Frames written so far.
  [[nodiscard]] Index frame_count() const { return frame_count_; }

 private:
  static constexpr std::string_view head =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n";
  static constexpr std::string_view tail = "  </Collection>\n</VTKFile>\n";

  explicit PvdWriter(FilePath path) : path_(std::move(path)) {}

  FilePath path_;
  long end_of_entries_ = static_cast<long>(head.size());
  Index frame_count_ = 0;
};

}  // namespace corotet::inline v0_1
