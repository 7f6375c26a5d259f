// Vertices whose motion is given: held in place, or led along a path.
#pragma once

#include <algorithm>
#include <corotet/core/assert.hpp>
#include <corotet/core/revision.hpp>
#include <corotet/core/types.hpp>
#include <vector>

namespace corotet::inline v0_1 {

/// A set of pinned vertices, each with the displacement (m, from rest) that it must have after the next step.
template <std::floating_point Scalar>
class Pins {
 public:
  explicit Pins(Index vertices) : slot_(at(vertices), none) {}

  /// Holds `vertex` at a displacement; moves it there if it is pinned already. The first pin of a vertex may allocate.
  void pin(Index vertex, const Vec3<Scalar>& displacement) {
    COROTET_ASSERT(vertex >= 0 && vertex < size_of(slot_), "no such vertex");
    if (vertex < 0 || vertex >= size_of(slot_)) return;
    if (slot_[at(vertex)] == none) {
      slot_[at(vertex)] = size_of(vertices_);
      vertices_.push_back(vertex);
      targets_.push_back(displacement);
      revision_ = new_revision();
    }
    targets_[at(slot_[at(vertex)])] = displacement;
  }

  /// A new target for a pinned vertex: it is there after the next step, and on the way during it.
  void move(Index vertex, const Vec3<Scalar>& displacement) {
    COROTET_ASSERT(is_pinned(vertex), "pin the vertex before moving it");
    if (is_pinned(vertex)) targets_[at(slot_[at(vertex)])] = displacement;
  }

  /// Lets go of a vertex, which keeps its velocity. Nothing happens if it is free.
  void release(Index vertex) {
    if (!is_pinned(vertex)) return;
    const Index slot = slot_[at(vertex)];
    slot_[at(vertices_.back())] = slot;
    vertices_[at(slot)] = vertices_.back();
    targets_[at(slot)] = targets_.back();
    slot_[at(vertex)] = none;
    vertices_.pop_back();
    targets_.pop_back();
    revision_ = new_revision();
  }

  [[nodiscard]] bool is_pinned(Index vertex) const {
    return vertex >= 0 && vertex < size_of(slot_) && slot_[at(vertex)] != none;
  }

  /// Pinned vertices in no particular order, and the displacement of each.
  [[nodiscard]] const std::vector<Index>& vertices() const { return vertices_; }
  [[nodiscard]] const Field<Scalar>& targets() const { return targets_; }

  /// Another number whenever the set of pinned vertices is another; targets do not matter.
  [[nodiscard]] Revision revision() const { return revision_; }

 private:
  static constexpr Index none = -1;
  std::vector<Index> slot_;  // one a vertex
  std::vector<Index> vertices_;
  Field<Scalar> targets_;
  Revision revision_ = new_revision();
};

}  // namespace corotet::inline v0_1
