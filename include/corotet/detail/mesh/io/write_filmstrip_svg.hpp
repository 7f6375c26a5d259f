// Some frames of an animation side by side in one .svg picture, which any browser shows.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/animation.hpp>
#include <corotet/detail/mesh/creases.hpp>
#include <corotet/detail/mesh/io/animation_view.hpp>
#include <corotet/detail/mesh/io/contours.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/filmstrip_view.hpp>
#include <corotet/detail/mesh/io/shade_image.hpp>
#include <corotet/detail/mesh/io/svg_path.hpp>
#include <corotet/detail/mesh/io/text_writer.hpp>
#include <corotet/detail/mesh/io/xml_text.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/mesh/vertex_normals.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1 {

/// Which frames a picture shows, and how large.
struct FilmstripOptions {
  std::vector<Index> frames{};  ///< which frames, from left to right; empty: four from the first to the last
  double width = 1200;          ///< of the whole picture, pixels; from 100 to 2000
};

namespace detail {

inline constexpr std::string_view filmstrip_style = R"svg(<style>
.corotet-strip { max-width: 100%; height: auto; background: #f6f5f1; }
.corotet-strip text { font-family: system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; fill: #21303a; }
.corotet-strip .quiet { fill: #5c6970; }
.corotet-strip .paper { fill: #f6f5f1; }
.corotet-strip .edge { fill: none; stroke: #0e2c34; stroke-width: 8; stroke-opacity: 0.55; stroke-linejoin: round; }
.corotet-strip .line { fill: none; stroke: #212b40; stroke-width: 7; stroke-opacity: 0.6; stroke-linecap: round; }
.corotet-strip .behind { stroke-opacity: 0.13; }
@media (prefers-color-scheme: dark) {
  .corotet-strip { background: #12181c; }
  .corotet-strip text { fill: #e6ebec; }
  .corotet-strip .quiet { fill: #9caab0; }
  .corotet-strip .paper { fill: #12181c; }
  .corotet-strip .line { stroke: #dbe9ee; }
}
</style>
)svg";

/// The size of a text, px: `size`, or smaller where the text would be longer than `room`.
inline std::string fitting_size(std::string_view words, double size, double room) {
  constexpr double letter_width = 0.6;  // of the size; less in most fonts
  int letters = 1;
  for (const char c : words) letters += (static_cast<unsigned char>(c) & 0xC0) != 0x80;  // a UTF-8 letter's first byte
  return fixed_text((std::min)(size, room / (letter_width * letters)), 1);
}

/// The surface of one frame: bands of brightness, cut out by its outline. Their size does not grow with the number of
/// triangles.
inline void add_surface(TextWriter& text, const ShadeImage& image, Index panel) {
  constexpr int bands = 32;
  const auto path_of = [](const Grid& grid, float level) {
    SvgPath path;
    path.add_loops(contours_of(grid, level));
    return path.take();
  };
  const std::string outline = path_of(image.coverage(), 0.5f);
  if (outline.empty()) return;
  text << "<clipPath id=\"corotet-" << panel << "\"><path d=\"" << outline
       << "\"/></clipPath>\n<g clip-path=\"url(#corotet-" << panel << ")\">\n<path fill=\"" << shade_colour(0.5 / bands)
       << "\" d=\"" << outline << "\"/>\n";
  const Grid brightness = image.brightness();
  for (int band = 1; band < bands; ++band) {
    const std::string path = path_of(brightness, static_cast<float>(band) / bands);
    if (!path.empty()) text << "<path fill=\"" << shade_colour((band + 0.5) / bands) << "\" d=\"" << path << "\"/>\n";
  }
  text << "</g>\n<path class=\"edge\" d=\"" << outline << "\"/>\n";
}

/// The lines of one frame: what lies behind the surface is fainter.
inline void add_lines(TextWriter& text, const Animation& animation, const ShadeImage& image, const FilmstripView& view,
                      Index frame) {
  constexpr double tolerance = 0.002;  // of the longest side: a line that lies in the surface is in front
  constexpr double max_steps = 4000;
  std::array<SvgPath, 2> paths;  // behind, in front
  for (const std::array<Index, 2>& line : animation.lines) {
    const Field<double>& ends = animation.line_frames[at(frame)];
    const PicturePoint p = view(ends[at(line[0])]), q = view(ends[at(line[1])]);
    const auto point = [&](double t) {
      return PicturePoint{p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.depth + t * (q.depth - p.depth)};
    };
    // Outlines are on grid points, half a pixel from the picture's.
    const auto drawn = [&](double t) { return GridPoint{point(t).x + 0.5, point(t).y + 0.5}; };
    const int steps = static_cast<int>(std::clamp(std::ceil(std::hypot(q.x - p.x, q.y - p.y)), 1.0, max_steps));
    int begin = 0;
    for (int i = 0; i < steps; ++i) {
      const bool front = image.is_visible(point((i + 0.5) / steps), tolerance);
      if (i + 1 < steps && image.is_visible(point((i + 1.5) / steps), tolerance) == front) continue;
      SvgPath& path = paths[front ? 1 : 0];
      path.move_to(drawn(static_cast<double>(begin) / steps));
      path.line_to(drawn((i + 1.0) / steps));
      begin = i + 1;
    }
  }
  for (const bool front : {false, true})
    if (const std::string path = paths[front ? 1 : 0].take(); !path.empty())
      text << "<path class=\"line" << (front ? "" : " behind") << "\" d=\"" << path << "\"/>\n";
}

inline ShadeImage image_of(const Animation& animation, const CreasedSurface& creased, const FilmstripView& view,
                           double panel_width, Index frame) {
  SurfaceMesh surface;
  std::vector<PicturePoint> points;
  std::vector<double> shades;
  for (const Index v : creased.source) {
    const Vec3<double>& x = animation.surface_frames[at(frame)][at(v)];
    surface.positions.push_back(view.relative(x));
    points.push_back(view(x));
  }
  surface.triangles = creased.triangles;
  for (const Vec3<double>& normal : vertex_normals(surface)) shades.push_back(view.shade(normal));
  ShadeImage image(static_cast<Index>(std::ceil(panel_width)), static_cast<Index>(std::ceil(view.height())));
  for (const std::array<Index, 3>& t : creased.triangles)
    image.draw({points[at(t[0])], points[at(t[1])], points[at(t[2])]},
               {shades[at(t[0])], shades[at(t[1])], shades[at(t[2])]});
  return image;
}

/// Which frames are drawn. Errors as for `format_filmstrip_svg`.
inline Result<std::vector<Index>> filmstrip_frames(const Animation& animation, const FilmstripOptions& options) {
  const Index count = size_of(animation.surface_frames);
  std::vector<Index> frames = options.frames;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i] < 0 || frames[i] >= count)
      return Error{ErrorCode::index_out_of_range, "frames[" + std::to_string(i) + "]",
                   "it names frame " + std::to_string(frames[i]) + " of " + std::to_string(count)};
  if (frames.empty()) {
    constexpr Index wanted = 4;
    for (Index i = 0; i < wanted; ++i)
      if (const auto frame = static_cast<Index>(std::lround((count - 1.0) * i / (wanted - 1)));
          frames.empty() || frame != frames.back())
        frames.push_back(frame);
  }
  return frames;
}

}  // namespace detail

/// The content of an .svg file: the frames side by side, from the same point and at the same scale, each with its time.
/// Brightness is drawn in bands, so that the file's size goes with the picture's and not with the number of triangles.
/// Triangles are seen from their front only.
/// Errors: those of `validate`; invalid_argument (width; more frames than fit in it; a title that is empty, or a title
/// or caption that holds control characters); index_out_of_range (frames).
[[nodiscard]] inline Result<std::string> format_filmstrip_svg(const Animation& animation,
                                                              const FilmstripOptions& options = {}) {
  if (Result<void> status = validate(animation); !status) return status.error();
  const Result<std::string> title = detail::xml_attribute(animation.title, "title");
  if (!title) return title.error();
  const Result<std::string> caption =
      animation.caption.empty() ? std::string() : detail::xml_attribute(animation.caption, "caption");
  if (!caption) return caption.error();
  if (!(options.width >= 100 && options.width <= 2000))
    return Error{ErrorCode::invalid_argument, "width", "it must be from 100 to 2000 pixels"};
  const Result<std::vector<Index>> frames = detail::filmstrip_frames(animation, options);
  if (!frames) return frames.error();

  constexpr double margin = 24, gap = 20, narrowest = 20;  // pixels
  const auto panels = static_cast<double>(frames->size());
  const double panel_width = (options.width - 2 * margin - (panels - 1) * gap) / panels;
  if (!(panel_width >= narrowest))
    return Error{ErrorCode::invalid_argument, "frames",
                 std::to_string(frames->size()) + " do not fit side by side in the width"};
  const detail::FilmstripView view(animation, *frames, panel_width);
  const detail::CreasedSurface surface = detail::split_at_creases(animation.surface_frames[0], animation.triangles);

  const double top = caption->empty() ? 62 : 86, label = top + view.height() + 30;
  const std::string width = detail::fixed_text(options.width, 0), height = detail::fixed_text(label + 20, 0);
  detail::TextWriter text;
  text << "<svg class=\"corotet-strip\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << ' ' << height
       << "\" width=\"" << width << "\" height=\"" << height
       << "\" role=\"img\" aria-labelledby=\"corotet-title\">\n<title id=\"corotet-title\">" << *title << "</title>\n"
       << detail::filmstrip_style << "<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n";
  const auto add_line = [&](std::string_view plain, std::string_view escaped, std::string_view look, double y,
                            double size) {
    text << "<text x=\"" << margin << "\" y=\"" << y << "\" font-size=\""
         << detail::fitting_size(plain, size, options.width - 2 * margin) << "\" " << look << '>' << escaped
         << "</text>\n";
  };
  add_line(animation.title, *title, "font-weight=\"600\"", 38, 20);
  if (!caption->empty()) add_line(animation.caption, *caption, "class=\"quiet\"", 62, 15);
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const Index frame = (*frames)[i];
    const double left = margin + static_cast<double>(i) * (panel_width + gap);
    const detail::ShadeImage image = detail::image_of(animation, surface, view, panel_width, frame);
    text << "<g transform=\"translate(" << detail::fixed_text(left - 0.5, 2) << ' ' << detail::fixed_text(top - 0.5, 2)
         << ") scale(0.1)\">\n";
    detail::add_surface(text, image, static_cast<Index>(i));
    detail::add_lines(text, animation, image, view, frame);
    text << "</g>\n<text x=\"" << detail::fixed_text(left + panel_width / 2, 1) << "\" y=\""
         << detail::fixed_text(label, 1) << "\" font-size=\"16\" text-anchor=\"middle\">"
         << detail::fixed_text(frame * animation.frame_seconds, detail::time_decimals(animation)) << " s</text>\n";
  }
  text << "</svg>\n";
  return text.take();
}

/// Writes an .svg file. Errors: those of `format_filmstrip_svg`, and file_unreadable.
[[nodiscard]] inline Result<void> write_filmstrip_svg(const FilePath& path, const Animation& animation,
                                                      const FilmstripOptions& options = {}) {
  const Result<std::string> text = format_filmstrip_svg(animation, options);
  return text ? write_file(path, *text) : Result<void>(text.error());
}

}  // namespace corotet::inline v0_1
