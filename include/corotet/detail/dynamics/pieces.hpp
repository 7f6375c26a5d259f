// The pieces of a body that do not touch, as bodies of their own.
#pragma once

#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/fixed_array.hpp>
#include <corotet/detail/core/index_list.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/span_of.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/terms/term_state.hpp>
#include <memory>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Pieces that no element, patch or coupling joins move exactly as each does alone: in the solver's tolerance, in spin,
/// momentum, energy bound and division of steps. So each is a body with an integrator of its own, and what the caller
/// sees is a body that has all vertices. A body of one piece has none of this.
template <class Body>
class Pieces {
 public:
  using Scalar = typename Body::scalar_type;

  COROTET_COLD explicit Pieces(const Body& body) {
    if (!find_pieces(*body.pattern())) return;
    displacement_ = body.displacements();
    velocity_ = displacement_;
    local_.assign(piece_of_.size(), 0);
    make_bodies(body);
  }

  /// 0 for a body of one piece.
  [[nodiscard]] Index count() const { return static_cast<Index>(pieces_.size()); }
  [[nodiscard]] Body& body(Index piece) { return pieces_[at(piece)].body; }
  [[nodiscard]] const Body& body(Index piece) const { return pieces_[at(piece)].body; }
  [[nodiscard]] PieceVertices vertices(Index piece) const { return {span_of(piece_of_), span_of(local_), piece}; }

  /// The whole body's vertex of one of a piece.
  [[nodiscard]] Index whole_vertex(Index piece, Index vertex) const { return pieces_[at(piece)].vertex[at(vertex)]; }

  /// Before a step: what the pieces are to know of the body.
  COROTET_COLD void take_from(const Body& body) {
    if (materials_ != body.material_revision()) take_materials(body);
    if (shift_ != body.origin_shift()) take_shift(body);
    if (motion_ != body.motion_revision()) take_motion(body);
    if (pins_ != body.pins().revision()) release_pins(body);
    for (std::size_t p = 0; p < body.pins().vertices().size(); ++p) {
      const std::size_t v = at(body.pins().vertices()[p]);
      pieces_[at(piece_of_[v])].body.pins().pin(local_[v], body.pins().targets()[p], body.pins().axes()[p]);
    }
    for (Piece& piece : pieces_) {
      piece.body.set_gravity(body.gravity());
      for (std::size_t i = 0; i < piece.vertex.size(); ++i)
        piece.body.external_forces()[i] = body.external_forces()[at(piece.vertex[i])];
    }
  }

  /// After a step that all pieces have accepted.
  void give_to(Body& body) {
    for (const Piece& piece : pieces_)
      for (std::size_t i = 0; i < piece.vertex.size(); ++i) {
        displacement_[at(piece.vertex[i])] = piece.body.displacements()[i];
        velocity_[at(piece.vertex[i])] = piece.body.velocities()[i];
      }
    body.swap_state(displacement_, velocity_);
    motion_ = body.motion_revision();
  }

  /// For snapshots: of a body that has this state.
  COROTET_COLD void visit_state(StateArchive& archive, const Body& body) {
    visit_revision(archive, motion_, body.motion_revision());
    visit_revision(archive, materials_, body.material_revision());
    visit_revision(archive, pins_, body.pins().revision());
    archive(shift_);
    for (Piece& piece : pieces_) piece.body.visit_state(archive);
  }

  /// After one that a piece has refused: the pieces take the body's state anew before the next.
  void forget_motion() { motion_ = {}; }

  [[nodiscard]] COROTET_COLD MemoryUse memory() const {
    MemoryUse use{bytes_of(piece_of_) + bytes_of(local_) + bytes_of(displacement_) + bytes_of(velocity_) +
                      pieces_.capacity() * sizeof(Piece),
                  0};
    for (const Piece& piece : pieces_) {
      use += piece.body.memory();
      use.owned += bytes_of(piece.vertex) + bytes_of(piece.element);
    }
    return use;
  }

 private:
  struct Piece {
    Body body;
    std::vector<Index> vertex;   // of the whole body
    std::vector<Index> element;  // of the whole body

    Piece(const std::shared_ptr<const typename Body::Model>& model, std::vector<Index>& vertices,
          std::vector<Index>& elements)
        : body(model), vertex(std::move(vertices)), element(std::move(elements)) {}
  };

  /// Numbers the pieces by their first vertex. False if there is but one.
  [[nodiscard]] COROTET_COLD bool find_pieces(const BlockPattern& pattern) {
    std::vector<Index> piece_of(at(pattern.rows()), -1), reached;
    for (Index first = 0; first < pattern.rows(); ++first) {
      if (piece_of[at(first)] >= 0) continue;
      piece_of[at(first)] = piece_count_;
      reached.assign(1, first);
      for (std::size_t next = 0; next < reached.size(); ++next)
        for (Index k = pattern.row_start[at(reached[next])]; k < pattern.row_start[at(reached[next]) + 1]; ++k)
          if (Index& piece = piece_of[at(pattern.column[at(k)])]; piece < 0) {
            piece = piece_count_;
            reached.push_back(pattern.column[at(k)]);
          }
      if (size_of(reached) == pattern.rows()) return false;
      ++piece_count_;
    }
    piece_of_ = std::move(piece_of);
    return true;
  }

  COROTET_COLD void make_bodies(const Body& body) {
    std::vector<Index> piece_of_element(at(body.mesh().element_count())), start, element;
    for (std::size_t e = 0; e < piece_of_element.size(); ++e)
      piece_of_element[e] = piece_of_[at(body.mesh().element(static_cast<Index>(e))[0])];
    find_places(piece_of_element.data(), piece_of_element.size(), at(piece_count_), start, element);
    pieces_ = FixedArray<Piece>(at(piece_count_));
    for (std::size_t p = 0; p < at(piece_count_); ++p) {
      std::vector<Index> vertex, of_piece;
      append(of_piece, element.data() + start[p], at(start[p + 1] - start[p]));
      auto mesh = body.mesh().part(of_piece, vertex);
      for (std::size_t i = 0; i < vertex.size(); ++i) local_[at(vertex[i])] = static_cast<Index>(i);
      auto options = body.model()->options();
      options.couplings = part_of(options.couplings, piece_of_[at(vertex.front())]);
      const auto model = Body::Model::create(std::move(mesh), materials_of(body, of_piece), options);
      COROTET_ASSERT(model.ok(), "what the whole body was made of is valid");
      pieces_.emplace_back(*model, vertex, of_piece);
    }
    materials_ = body.material_revision();
  }

  [[nodiscard]] COROTET_COLD static Materials materials_of(const Body& body, const std::vector<Index>& elements) {
    std::vector<Material> materials(elements.size());
    for (std::size_t i = 0; i < elements.size(); ++i)
      materials[i] = body.model()->materials().of_element(at(elements[i]));
    return materials;
  }

  [[nodiscard]] COROTET_COLD Stencils part_of(const Stencils& groups, Index piece) const {
    Stencils part;
    part.start.assign(1, 0);
    for (Index g = 0; g < groups.count(); ++g) {
      const Index begin = groups.start[at(g)], end = groups.start[at(g) + 1];
      if (begin == end || piece_of_[at(groups.vertex[at(begin)])] != piece) continue;
      for (Index k = begin; k < end; ++k) part.vertex.push_back(local_[at(groups.vertex[at(k)])]);
      part.start.push_back(size_of(part.vertex));
    }
    return part;
  }

  COROTET_COLD void take_materials(const Body& body) {
    for (Piece& piece : pieces_) {
      const Result<void> set = piece.body.set_materials(materials_of(body, piece.element));
      COROTET_ASSERT(set.ok(), "they are valid for the whole body");
    }
    materials_ = body.material_revision();
  }

  void take_shift(const Body& body) {
    for (Piece& piece : pieces_) piece.body.rebase((body.origin_shift() - shift_).template cast<Scalar>());
    shift_ = body.origin_shift();
  }

  void take_motion(const Body& body) {
    for (Piece& piece : pieces_) piece.body.take_state(body, piece.vertex);
    motion_ = body.motion_revision();
  }

  void release_pins(const Body& body) {
    for (Piece& piece : pieces_)
      for (Index v = 0; v < piece.body.vertex_count(); ++v)
        if (!body.pins().is_pinned(piece.vertex[at(v)])) piece.body.pins().release(v);
    pins_ = body.pins().revision();
  }

  FixedArray<Piece> pieces_;
  std::vector<Index> piece_of_, local_;  // one a vertex of the whole body
  Field<Scalar> displacement_, velocity_;
  Vec3<double> shift_ = Vec3<double>::Zero();  // of the body's origin, as the pieces know it
  Index piece_count_ = 0;
  Revision motion_, materials_, pins_;  // of the body, as the pieces know it
};

}  // namespace corotet::inline v0_1::detail
