// Vertices whose motion is prescribed: held in place, or led along a path.
#pragma once

#include <algorithm>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstdint>
#include <vector>

namespace corotet::inline v0_1 {

/// The components of a vertex's position that a pin prescribes.
struct PinnedAxes {
  bool x = true;  ///< whether the x component is prescribed
  bool y = true;  ///< whether the y component is prescribed
  bool z = true;  ///< whether the z component is prescribed

  /// Whether component i is prescribed.
  [[nodiscard]] bool operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  /// Whether all three are prescribed.
  [[nodiscard]] bool all() const { return x && y && z; }
  friend bool operator==(const PinnedAxes&, const PinnedAxes&) = default;

  /// For snapshots.
  void visit_state(detail::StateArchive& archive) {
    archive(x);
    archive(y);
    archive(z);
  }
};

/// A set of pinned vertices, each with the displacement (m, from rest) that it must have after the next step: in all
/// components, or in some alone (a roller, a sliding edge).
template <std::floating_point Scalar>
class Pins {
 public:
  /// No pins yet, for a body of so many vertices.
  explicit Pins(Index vertices) : slot_(at(vertices), none) {}

  /// Holds `vertex` at a displacement, whose other components than `axes` do not matter; moves it there if it is pinned
  /// already. The first pin of a vertex may allocate. Without any axis it is released.
  COROTET_COLD void pin(Index vertex, const Vec3<Scalar>& displacement, PinnedAxes axes = {}) {
    COROTET_ASSERT(vertex >= 0 && vertex < size_of(slot_), "no such vertex");
    if (vertex < 0 || vertex >= size_of(slot_)) return;
    ++changes_;
    if (!axes.x && !axes.y && !axes.z) return release(vertex);
    if (slot_[at(vertex)] == none) {
      slot_[at(vertex)] = size_of(vertices_);
      vertices_.push_back(vertex);
      targets_.push_back(displacement);
      axes_.push_back(axes);
      revision_ = detail::new_revision();
    }
    const std::size_t slot = at(slot_[at(vertex)]);
    if (!(axes_[slot] == axes)) revision_ = detail::new_revision();
    axes_[slot] = axes;
    targets_[slot] = displacement;
  }

  /// A new target for a pinned vertex: it is there after the next step, and on the way during it.
  void move(Index vertex, const Vec3<Scalar>& displacement) {
    COROTET_ASSERT(is_pinned(vertex), "pin the vertex before moving it");
    if (!is_pinned(vertex)) return;
    ++changes_;
    targets_[at(slot_[at(vertex)])] = displacement;
  }

  /// Lets go of a vertex, which keeps its velocity. Nothing happens if it is free.
  void release(Index vertex) {
    if (!is_pinned(vertex)) return;
    ++changes_;
    const Index slot = slot_[at(vertex)];
    slot_[at(vertices_.back())] = slot;
    vertices_[at(slot)] = vertices_.back();
    targets_[at(slot)] = targets_.back();
    axes_[at(slot)] = axes_.back();
    slot_[at(vertex)] = none;
    vertices_.pop_back();
    targets_.pop_back();
    axes_.pop_back();
    revision_ = detail::new_revision();
  }

  /// Adds `shift` to all targets: for a body whose origin moves.
  void translate(const Vec3<Scalar>& shift) {
    for (Vec3<Scalar>& target : targets_) target += shift;
  }

  /// Whether a component of the vertex is prescribed.
  [[nodiscard]] bool is_pinned(Index vertex) const {
    return vertex >= 0 && vertex < size_of(slot_) && slot_[at(vertex)] != none;
  }

  /// Pinned vertices in no particular order, and the displacement and the axes of each.
  [[nodiscard]] const std::vector<Index>& vertices() const { return vertices_; }
  /// Displacements of the pinned vertices, m, in the order of vertices().
  [[nodiscard]] const Field<Scalar>& targets() const { return targets_; }
  /// Prescribed components, in the order of vertices().
  [[nodiscard]] const std::vector<PinnedAxes>& axes() const { return axes_; }

  /// The axes of a vertex that are pinned: none of one that is free.
  [[nodiscard]] PinnedAxes axes_of(Index vertex) const {
    return is_pinned(vertex) ? axes_[at(slot_[at(vertex)])] : PinnedAxes{false, false, false};
  }

  /// Calls visit(slot, vertex, i) for each component i of each pinned vertex that is pinned.
  template <class Visit>
  void for_each_component(const Visit& visit) const {
    for (std::size_t slot = 0; slot < vertices_.size(); ++slot)
      for (int i = 0; i < 3; ++i)
        if (axes_[slot][i]) visit(slot, vertices_[slot], i);
  }

  /// Another number whenever the set of pinned components is another; targets do not matter.
  [[nodiscard]] Revision revision() const { return revision_; }

  /// How often a pin was set, moved or released.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  /// Bytes on the heap.
  [[nodiscard]] std::size_t bytes() const {
    return detail::bytes_of(slot_) + detail::bytes_of(vertices_) + detail::bytes_of(targets_) + detail::bytes_of(axes_);
  }

  /// For snapshots.
  void visit_state(detail::StateArchive& archive) {
    archive.list(vertices_);
    archive.list(targets_);
    archive.list(axes_);
    if (!archive.reads()) return;
    ++changes_;
    for (Index& slot : slot_) slot = none;
    for (std::size_t slot = 0; slot < vertices_.size(); ++slot)
      if (vertices_[slot] >= 0 && vertices_[slot] < size_of(slot_))
        slot_[at(vertices_[slot])] = static_cast<Index>(slot);
    revision_ = detail::new_revision();
  }

 private:
  static constexpr Index none = -1;
  std::vector<Index> slot_;  // one a vertex
  std::vector<Index> vertices_;
  Field<Scalar> targets_;
  std::vector<PinnedAxes> axes_;
  Revision revision_ = detail::new_revision();
  std::uint64_t changes_ = 0;
};

}  // namespace corotet::inline v0_1
