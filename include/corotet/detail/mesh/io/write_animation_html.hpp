// An animation as one .html file that any browser plays: no network, no other file, nothing to install.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/animation.hpp>
#include <corotet/detail/mesh/creases.hpp>
#include <corotet/detail/mesh/io/animation_controls_script.hpp>
#include <corotet/detail/mesh/io/animation_page.hpp>
#include <corotet/detail/mesh/io/animation_script.hpp>
#include <corotet/detail/mesh/io/animation_view.hpp>
#include <corotet/detail/mesh/io/base64.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/text_writer.hpp>
#include <corotet/detail/mesh/io/xml_text.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1 {
namespace detail {

/// Steps into which each side of the box of an animation is divided.
inline constexpr double position_steps = 65535;

/// Little-endian 16-bit numbers, x y z of each vertex of each frame: 0 and 65535 are the two sides of the box.
inline std::string quantised_positions(const std::vector<Field<double>>& frames, const AnimationBox& box) {
  std::string bytes;
  bytes.reserve(frames.empty() ? 0 : frames.size() * frames[0].size() * 6);
  for (const Field<double>& frame : frames)
    for (const Vec3<double>& x : frame)
      for (int i = 0; i < 3; ++i) {
        const double share = box.extent[i] > 0 ? (x[i] - box.low[i]) / box.extent[i] : 0;
        const auto q = static_cast<std::uint16_t>(std::lround(position_steps * std::clamp(share, 0.0, 1.0)));
        bytes += static_cast<char>(q & 255);
        bytes += static_cast<char>(q >> 8);
      }
  return bytes;
}

inline void append_index(std::string& bytes, Index index) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes += static_cast<char>((static_cast<std::uint32_t>(index) >> shift) & 255);
}

template <std::size_t Corners>
std::string index_bytes(const std::vector<std::array<Index, Corners>>& shapes) {
  std::string bytes;
  for (const std::array<Index, Corners>& shape : shapes)
    for (const Index v : shape) append_index(bytes, v);
  return bytes;
}

/// Numbers about the data and the first view, as JSON.
inline std::string animation_info(const Animation& animation, const AnimationBox& box) {
  const auto list = [](const auto& v) {
    TextWriter text;
    text << '[' << v[0] << ',' << v[1] << ',' << v[2] << ']';
    return text.take();
  };
  const AnimationAxes axes = axes_of(animation, box);
  TextWriter text;
  text << "{\"frames\":" << animation.surface_frames.size() << ",\"seconds\":" << animation.frame_seconds
       << ",\"decimals\":" << time_decimals(animation) << ",\"vertices\":" << animation.surface_frames[0].size()
       << ",\"lineVertices\":" << (animation.line_frames.empty() ? 0 : animation.line_frames[0].size())
       << ",\"low\":" << list(box.low) << ",\"extent\":" << list(box.extent) << ",\"axes\":[" << list(axes.along) << ','
       << list(axes.across) << ',' << list(axes.up) << "],\"azimuth\":" << view_azimuth
       << ",\"elevation\":" << view_elevation << ",\"light\":" << list(view_light) << '}';
  return text.take();
}

}  // namespace detail

/// The content of an .html file that plays the animation in a loop: it turns and zooms by mouse, touch and keys, has a
/// time slider, shows the lines or not, and follows the reader's choice of light or dark.
///
/// Positions are stored as 16-bit numbers over the box of the whole animation. Each coordinate is off by at most half a
/// step, (side of the box)/65535/2, and rounding. Between frames, positions are interpolated linearly. The file has
/// about 8 bytes a vertex and frame, and 20 a triangle. Errors: those of `validate`; invalid_argument for a title that
/// is empty, or a title or caption that holds control characters.
[[nodiscard]] inline Result<std::string> format_animation_html(const Animation& animation) {
  if (Result<void> status = validate(animation); !status) return status.error();
  const Result<std::string> title = detail::xml_attribute(animation.title, "title");
  if (!title) return title.error();
  const Result<std::string> caption =
      animation.caption.empty() ? std::string() : detail::xml_attribute(animation.caption, "caption");
  if (!caption) return caption.error();

  const detail::AnimationBox box = detail::box_of(animation);
  const detail::CreasedSurface surface = detail::split_at_creases(animation.surface_frames[0], animation.triangles);
  std::string source;
  for (const Index v : surface.source) detail::append_index(source, v);

  detail::TextWriter text;
  text << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
          "style-src 'unsafe-inline'; img-src data:\">\n<link rel=\"icon\" href=\"data:,\">\n<title>"
       << *title << "</title>\n"
       << detail::page_style << "</head>\n<body>\n<header>\n<h1 id=\"title\">" << *title << "</h1>\n";
  if (!caption->empty()) text << "<p>" << *caption << "</p>\n";
  text << "</header>\n" << detail::page_controls;
  const auto add_data = [&](std::string_view id, std::string_view content) {
    text << "<script type=\"text/plain\" id=\"" << id << "\">" << content << "</script>\n";
  };
  add_data("info", detail::animation_info(animation, box));
  add_data("source", detail::to_base64(source));
  add_data("triangles", detail::to_base64(detail::index_bytes(surface.triangles)));
  add_data("lines", detail::to_base64(detail::index_bytes(animation.lines)));
  add_data("line-positions", detail::to_base64(detail::quantised_positions(animation.line_frames, box)));
  add_data("surface-positions", detail::to_base64(detail::quantised_positions(animation.surface_frames, box)));
  text << "<script>" << detail::page_script_data << detail::page_script_view << detail::page_script_hands
       << "</script>\n</body>\n</html>\n";
  return text.take();
}

/// Writes an .html file. Errors: those of `format_animation_html`, and file_unreadable.
[[nodiscard]] inline Result<void> write_animation_html(const FilePath& path, const Animation& animation) {
  const Result<std::string> text = format_animation_html(animation);
  return text ? write_file(path, *text) : Result<void>(text.error());
}

}  // namespace corotet::inline v0_1
