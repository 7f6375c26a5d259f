// Writes gmsh's .msh files, versions 2.2 and 4.1, text and binary (reference manual, "MSH file format").
#pragma once

#include <algorithm>
#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/core/message.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/msh_input.hpp>
#include <corotet/detail/mesh/io/tet_mesh_builder.hpp>
#include <corotet/detail/mesh/io/text_writer.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/validate.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace corotet::inline v0_1 {

/// The version and encoding of a gmsh file.
struct MshOptions {
  int version = 41;     ///< 22 or 41
  bool binary = false;  ///< binary files have the byte order of this machine, which they state
};

namespace detail {

class MshWriter {
 public:
  MshWriter(const MeshData& mesh, MshOptions options)
      : mesh_(mesh),
        regions_(distinct(mesh.regions)),
        binary_(options.binary),
        version22_(options.version == 22),
        step_(static_cast<std::size_t>(mesh.nodes_per_element)) {
    out_.reserve(mesh.positions.size() * 64 + mesh.connectivity.size() * 12);
    out_ << "$MeshFormat\n" << (version22_ ? "2.2 " : "4.1 ") << (binary_ ? "1 8\n" : "0 8\n");
    if (binary_) {
      out_.raw(std::int32_t{1});
      out_ << '\n';
    }
    out_ << "$EndMeshFormat\n";
    version22_ ? write22() : write41();
  }

  std::string take() { return out_.take(); }

 private:
  void write22() {
    out_ << "$Nodes\n" << mesh_.positions.size() << '\n';
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
      integer(static_cast<Index>(i + 1));
      point(mesh_.positions[i]);
      end_line();
    }
    end_section("$EndNodes");
    out_ << "$Elements\n" << elements() << '\n';
    if (binary_ && elements() != 0) {  // one header for all: type, number of elements, number of tags
      integer(type());
      integer(static_cast<Index>(elements()));
      integer(2);
    }
    for (std::size_t e = 0; e < elements(); ++e) {
      integer(static_cast<Index>(e + 1));
      if (!binary_) out_ << type() << " 2 ";
      integer(region(e));
      integer(entity(e));
      nodes(e);
    }
    end_section("$EndElements");
  }

  void write41() {
    write_entities();
    out_ << "$Nodes\n";
    size(1);
    size(mesh_.positions.size());
    size(1);
    size(mesh_.positions.size());
    end_line();
    block(1, 0, mesh_.positions.size());
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
      size(i + 1);
      end_line();
    }
    for (const Vec3<double>& x : mesh_.positions) {
      point(x);
      end_line();
    }
    end_section("$EndNodes");

    // One block for each run of elements of one region keeps the order of the elements.
    std::vector<std::size_t> starts;
    for (std::size_t e = 0; e < elements(); ++e)
      if (e == 0 || region(e) != region(e - 1)) starts.push_back(e);
    starts.push_back(elements());
    out_ << "$Elements\n";
    size(starts.size() - 1);
    size(elements());
    size(1);
    size(elements());
    end_line();
    for (std::size_t b = 0; b + 1 < starts.size(); ++b) {
      block(entity(starts[b]), type(), starts[b + 1] - starts[b]);
      for (std::size_t e = starts[b]; e < starts[b + 1]; ++e) {
        size(e + 1);
        nodes(e);
      }
    }
    end_section("$EndElements");
  }

  /// One volume for each region, in the physical group of the region's tag; region 0 is in no group.
  void write_entities() {
    Vec3<double> least = Vec3<double>::Zero(), most = least;
    if (!mesh_.positions.empty()) least = most = mesh_.positions.front();
    for (const Vec3<double>& x : mesh_.positions) {
      least = least.cwiseMin(x);
      most = most.cwiseMax(x);
    }
    out_ << "$Entities\n";
    for (int dimension = 0; dimension < 3; ++dimension) size(0);
    size(regions_.size());
    end_line();
    for (std::size_t r = 0; r < regions_.size(); ++r) {
      integer(static_cast<Index>(r + 1));
      point(least);
      point(most);
      size(regions_[r] == 0 ? 0 : 1);
      if (regions_[r] != 0) integer(regions_[r]);
      size(0);  // bounding surfaces
      end_line();
    }
    end_section("$EndEntities");
  }

  /// Header of a block of nodes or elements on a volume: dimension, tag, flag or type, length.
  void block(Index tag, Index kind, std::size_t length) {
    integer(3);
    integer(tag);
    integer(kind);
    size(length);
    end_line();
  }

  void nodes(std::size_t e) {
    for (std::size_t k = 0; k < step_; ++k) {
      const Index node = mesh_.connectivity[e * step_ + gmsh_order[k]] + 1;
      // Version 2 has 4-byte node numbers, version 4 has 8-byte ones.
      version22_ ? integer(node) : size(static_cast<std::size_t>(node));
    }
    end_line();
  }

  static std::vector<int> distinct(std::vector<int> regions) {
    if (regions.empty()) return {0};
    std::sort(regions.begin(), regions.end());
    regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
    return regions;
  }

  [[nodiscard]] std::size_t elements() const { return mesh_.connectivity.size() / step_; }
  [[nodiscard]] Index type() const { return static_cast<Index>(step_ == 4 ? msh_tet4 : msh_tet10); }
  [[nodiscard]] int region(std::size_t e) const { return mesh_.regions.empty() ? 0 : mesh_.regions[e]; }
  [[nodiscard]] Index entity(std::size_t e) const {
    return static_cast<Index>(std::lower_bound(regions_.begin(), regions_.end(), region(e)) - regions_.begin()) + 1;
  }

  void integer(Index value) { binary_ ? out_.raw(value) : void(out_ << value << ' '); }
  void size(std::size_t value) { binary_ ? out_.raw(std::uint64_t{value}) : void(out_ << value << ' '); }
  void point(const Vec3<double>& x) {
    for (int k = 0; k < 3; ++k) binary_ ? out_.raw(x[k]) : void(out_ << x[k] << ' ');
  }
  void end_line() {
    if (!binary_) out_ << '\n';
  }
  void end_section(std::string_view keyword) {
    if (binary_) out_ << '\n';
    out_ << keyword << '\n';
  }

  const MeshData& mesh_;
  TextWriter out_;
  std::vector<int> regions_;  // distinct, ascending
  bool binary_;
  bool version22_;
  std::size_t step_;
};

}  // namespace detail

/// The content of a .msh file: vertices numbered from 1 in order, regions as physical groups. Reading it back gives the
/// same arrays exactly (regions that are all 0 read back as none). Errors: those of broken arrays, as in
/// TetMesh::create; non_finite_value; invalid_argument for another version. Vertices without an element are allowed.
[[nodiscard]] inline Result<std::string> format_msh(const MeshData& mesh, MshOptions options = {}) {
  if (options.version != 22 && options.version != 41)
    return Error{ErrorCode::invalid_argument, "version", "must be 22 or 41, is " + std::to_string(options.version)};
  if (mesh.nodes_per_element != 4 && mesh.nodes_per_element != 10)
    return Error{ErrorCode::invalid_argument, "mesh", "its elements must have 4 or 10 nodes"};
  const Result<void> arrays = detail::check_arrays(mesh, mesh.nodes_per_element);
  if (!arrays && arrays.error().code != ErrorCode::unreferenced_vertex) return arrays.error();
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!mesh.positions[at(v)].allFinite())
      return detail::error(ErrorCode::non_finite_value, {"vertex ", v}, {"its position is not finite"});
  return detail::MshWriter(mesh, options).take();
}

/// Writes that content to a file.
[[nodiscard]] inline Result<void> write_msh(const FilePath& path, const MeshData& mesh, MshOptions options = {}) {
  const Result<std::string> content = format_msh(mesh, options);
  if (!content) return content.error();
  return write_file(path, *content);
}

}  // namespace corotet::inline v0_1
