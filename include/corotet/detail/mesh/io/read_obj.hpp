// Reads the polygons of Wavefront .obj files ("Advanced Visualizer Manual", appendix B1).
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/mesh/io/surface_mesh_builder.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {
namespace detail {

class ObjReader {
 public:
  ObjReader(std::string_view text, std::string_view name) : in_(text, name, {.comment = '#'}) {}

  Result<SurfaceMesh> read() {
    while (!in_.at_end()) {
      const std::string_view keyword = token();
      if (keyword == "v") {
        sink_.add_vertex(in_, point());
        weights_ = weights_ || !token().empty();
      } else if (keyword == "vn") {
        normals_.push_back(point());
      } else if (keyword == "f" || keyword == "fo") {  // fo: the face of old versions
        read_face();
      } else {
        ignore(keyword);
      }
      skip_line();
    }
    check_references();
    if (!in_.ok()) return in_.error();
    assign_normals();
    if (weights_) sink_.note("ignored weights or colours of vertices");
    if (ignored_texture_ > 0) sink_.note("ignored texture coordinates");
    if (ignored_groups_ > 0) sink_.note("ignored groups, materials and smoothing");
    if (ignored_curves_ > 0) sink_.note("ignored points, lines and free-form curves and surfaces");
    return sink_.finish(in_.name());
  }

 private:
  /// The next token of the line; a backslash at its end goes on with the next line.
  std::string_view token() {
    for (;;) {
      std::string_view found = in_.token_on_line();
      if (found.empty() || found.back() != '\\' || !in_.at_line_end()) return found;
      in_.rest_of_line();
      found.remove_suffix(1);
      if (!found.empty()) return found;
    }
  }

  void skip_line() {
    for (;;) {
      const std::string_view rest = in_.rest_of_line();
      if (rest.empty() || rest.back() != '\\' || in_.remaining() == 0) return;
    }
  }

  Vec3<double> point() {
    Vec3<double> x;
    for (double& coordinate : x) coordinate = in_.to_number(token(), "a coordinate");
    return x;
  }

  /// A reference counts from 1, or backwards from the last item so far if negative. The result counts from 0 and may
  /// lie beyond the items so far: `farthest` remembers where.
  struct Farthest {
    std::int64_t index = -1;
    std::size_t line = 0;
  };
  Index reference(std::string_view text, std::size_t count, const char* what, Farthest& farthest) {
    constexpr std::int64_t most = (std::numeric_limits<Index>::max)();
    const std::int64_t number = in_.to_integer(text, what, -most, most);
    if (!in_.ok()) return 0;
    const std::int64_t index = number < 0 ? static_cast<std::int64_t>(count) + number : number - 1;
    if (index < 0) {
      in_.fail(std::string(what) + " is " + quoted(text) + ", out of range", ErrorCode::index_out_of_range);
      return 0;
    }
    if (index > farthest.index) farthest = {index, in_.line()};
    return static_cast<Index>(index);
  }

  /// Corners are v, v/vt, v//vn or v/vt/vn.
  void read_face() {
    corners_.clear();
    for (std::string_view corner = token(); in_.ok() && !corner.empty(); corner = token()) {
      const std::size_t first = corner.find('/'), second = first == npos ? npos : corner.find('/', first + 1);
      corners_.push_back(
          reference(corner.substr(0, first), sink_.mesh.positions.size(), "a vertex number", farthest_vertex_));
      if (first == npos) continue;
      const std::string_view texture = corner.substr(first + 1, second == npos ? npos : second - first - 1);
      if (!texture.empty() || second == npos) in_.to_integer(texture, "a texture number", least, greatest);
      if (second == npos) continue;
      const Index normal = reference(corner.substr(second + 1), normals_.size(), "a normal number", farthest_normal_);
      corner_normals_.emplace_back(corners_.back(), normal);
    }
    if (in_.ok()) sink_.add_polygon(in_, corners_);
  }

  void ignore(std::string_view keyword) {
    constexpr std::array<std::string_view, 9> groups{"g",      "o",      "s",      "mg", "usemtl",
                                                     "mtllib", "usemap", "maplib", "lod"};
    constexpr std::array<std::string_view, 28> curves{
        "p",        "l",        "vp",         "cstype",    "deg",  "bmat", "step", "curv",  "curv2", "surf",
        "parm",     "trim",     "hole",       "scrv",      "sp",   "end",  "con",  "ctech", "stech", "bevel",
        "c_interp", "d_interp", "shadow_obj", "trace_obj", "call", "csh",  "bsp",  "bzp"};
    if (keyword == "vt")
      ++ignored_texture_;
    else if (std::find(groups.begin(), groups.end(), keyword) != groups.end())
      ++ignored_groups_;
    else if (std::find(curves.begin(), curves.end(), keyword) != curves.end())
      ++ignored_curves_;
    else if (!keyword.empty())
      in_.fail(quoted(keyword) + " is not a keyword of .obj files");
  }

  void check_references() {
    const auto require_within = [&](const Farthest& farthest, std::size_t count, const char* what) {
      if (farthest.index < static_cast<std::int64_t>(count)) return;
      in_.adopt(Error{ErrorCode::index_out_of_range, std::string(in_.name()) + ":" + std::to_string(farthest.line),
                      std::string("a face names ") + what + " " + std::to_string(farthest.index + 1) +
                          ", but there are " + std::to_string(count)});
    };
    require_within(farthest_vertex_, sink_.mesh.positions.size(), "vertex");
    require_within(farthest_normal_, normals_.size(), "normal");
  }

  /// The file has normals per corner; they become normals per vertex if its corners agree.
  void assign_normals() {
    if (normals_.empty()) return;
    Field<double> assigned(sink_.mesh.positions.size(), Vec3<double>::Zero());
    for (const auto& [vertex, normal] : corner_normals_) {
      Vec3<double>& mine = assigned[at(vertex)];
      if (mine != Vec3<double>::Zero() && mine != normals_[at(normal)])
        return sink_.note("ignored normals: faces that share a vertex give it different ones");
      mine = normals_[at(normal)];
    }
    sink_.mesh.normals = std::move(assigned);
  }

  static constexpr std::size_t npos = std::string_view::npos;
  static constexpr std::int64_t least = (std::numeric_limits<std::int64_t>::min)();
  static constexpr std::int64_t greatest = (std::numeric_limits<std::int64_t>::max)();

  TextScanner in_;
  SurfaceMeshBuilder sink_;
  Field<double> normals_;
  std::vector<Index> corners_;
  std::vector<std::pair<Index, Index>> corner_normals_;  // vertex, normal
  Farthest farthest_vertex_, farthest_normal_;
  bool weights_ = false;
  std::size_t ignored_texture_ = 0, ignored_groups_ = 0, ignored_curves_ = 0;
};

}  // namespace detail

/// The faces of an .obj file. Polygons are split; normals are used where the faces at each vertex agree on one; texture
/// coordinates, groups, materials, lines and curves are ignored. `notes` says which of these happened.
[[nodiscard]] inline Result<SurfaceMesh> read_obj(std::string_view text, std::string_view name) {
  return detail::ObjReader(text, name).read();
}

}  // namespace corotet::inline v0_1
