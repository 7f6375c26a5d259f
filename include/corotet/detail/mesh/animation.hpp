// A triangle surface that moves, with lines that move beside it: what the writers of pictures and pages take.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1 {

/// The triangles and the lines stay; their vertices move. Frame k is at time k * `frame_seconds`.
struct Animation {
  std::string title{};                            ///< UTF-8, one line, not empty
  std::string caption{};                          ///< UTF-8, one line, may be empty: what is shown, how many elements
  double frame_seconds = 1.0 / 60;                ///< from one frame to the next, s; > 0
  Vec3<double> up = Vec3<double>(0, 0, 1);        ///< the direction that is drawn upwards; any length but 0
  std::vector<std::array<Index, 3>> triangles{};  ///< counter-clockwise seen from outside; 0-based
  std::vector<Field<double>> surface_frames{};    ///< positions of the surface's vertices in each frame, m
  std::vector<std::array<Index, 2>> lines{};  ///< the ends of each line, such as an edge of an element; may be empty
  std::vector<Field<double>> line_frames{};   ///< positions of the lines' ends in each frame, m; empty without lines
};

namespace detail {

inline Result<void> validate_frames(const std::vector<Field<double>>& frames, const std::string& name) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (frames[k].size() != frames[0].size())
      return Error{ErrorCode::invalid_argument, name + "[" + std::to_string(k) + "]",
                   "it has " + std::to_string(frames[k].size()) + " vertices, but frame 0 has " +
                       std::to_string(frames[0].size())};
    for (std::size_t v = 0; v < frames[k].size(); ++v)
      if (!frames[k][v].allFinite())
        return Error{ErrorCode::non_finite_value, name + "[" + std::to_string(k) + "], vertex " + std::to_string(v),
                     "its position is not a finite number"};
  }
  return {};
}

template <std::size_t Corners>
Result<void> validate_indices(const std::vector<std::array<Index, Corners>>& shapes, std::size_t vertices,
                              std::string_view name) {
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (const Index v : shapes[i])
      if (v < 0 || at(v) >= vertices)
        return Error{ErrorCode::index_out_of_range, std::string(name) + " " + std::to_string(i),
                     "it names vertex " + std::to_string(v) + " of " + std::to_string(vertices)};
  return {};
}

/// The smallest box that holds all vertices of all frames.
struct AnimationBox {
  Vec3<double> low = Vec3<double>(0, 0, 0);     ///< m
  Vec3<double> extent = Vec3<double>(0, 0, 0);  ///< m
  double longest = 0;                           ///< the longest side, m
};

inline AnimationBox box_of(const Animation& animation) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3<double> low(inf, inf, inf), high(-inf, -inf, -inf);
  for (const auto* frames : {&animation.surface_frames, &animation.line_frames})
    for (const Field<double>& frame : *frames)
      for (const Vec3<double>& x : frame)
        for (int i = 0; i < 3; ++i) {
          low[i] = (std::min)(low[i], x[i]);
          high[i] = (std::max)(high[i], x[i]);
        }
  if (!(low[0] <= high[0])) return {};
  AnimationBox box;
  box.low = low;
  box.extent = high - low;
  box.longest = (std::max)({box.extent[0], box.extent[1], box.extent[2]});
  return box;
}

}  // namespace detail

/// Whether the animation can be drawn. Errors: invalid_argument (frame_seconds, up, numbers of frames and of vertices),
/// empty_mesh (no frames, no triangles), unsupported (more triangles than 32-bit indices can number three times),
/// index_out_of_range, non_finite_value (a position; a size beyond the range of double).
[[nodiscard]] inline Result<void> validate(const Animation& animation) {
  if (!(animation.frame_seconds > 0) || !std::isfinite(animation.frame_seconds))
    return Error{ErrorCode::invalid_argument, "frame_seconds", "it must be a finite number greater than 0"};
  if (!animation.up.allFinite() || detail::is_zero(animation.up.cwiseAbs().maxCoeff()))
    return Error{ErrorCode::invalid_argument, "up", "it must be finite and not zero"};
  const std::size_t frames = animation.surface_frames.size();
  if (frames == 0) return Error{ErrorCode::empty_mesh, "surface_frames", "there must be at least one frame"};
  if (animation.triangles.empty()) return Error{ErrorCode::empty_mesh, "triangles", "there must be at least one"};
  if (animation.triangles.size() > at((std::numeric_limits<Index>::max)() / 3))
    return Error{ErrorCode::unsupported, "triangles", "there are more than 32-bit indices can number"};
  if (animation.line_frames.size() != (animation.lines.empty() ? 0 : frames))
    return Error{ErrorCode::invalid_argument, "line_frames",
                 "there are " + std::to_string(animation.line_frames.size()) + " for " + std::to_string(frames) +
                     " frames of the surface and " + std::to_string(animation.lines.size()) +
                     " lines; give as many, or none without lines"};
  if (Result<void> status = detail::validate_frames(animation.surface_frames, "surface_frames"); !status) return status;
  if (Result<void> status = detail::validate_frames(animation.line_frames, "line_frames"); !status) return status;
  if (Result<void> status =
          detail::validate_indices(animation.triangles, animation.surface_frames[0].size(), "triangle");
      !status)
    return status;
  if (!animation.lines.empty())
    if (Result<void> status = detail::validate_indices(animation.lines, animation.line_frames[0].size(), "line");
        !status)
      return status;
  if (!std::isfinite(detail::box_of(animation).longest))
    return Error{ErrorCode::non_finite_value, "surface_frames", "the size of the whole is beyond the range of double"};
  return {};
}

}  // namespace corotet::inline v0_1
