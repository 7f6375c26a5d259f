// A body cut into parts that may move as rigid bodies, and those into groups: where they are.
#pragma once

#include <algorithm>
#include <corotet/core/buffer.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/register.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/aggregates.hpp>
#include <corotet/solve/range_sum.hpp>
#include <corotet/solve/rigid_modes.hpp>
#include <corotet/solve/rotation_of_points.hpp>
#include <cstdint>
#include <span>

namespace corotet::inline v0_1 {

/// What RigidAggregates knows of geometry. Without groups each part is a group of its own, and `group_frames` is empty.
/// Parts turn as their rest shapes would, not as they are now: it is those motions that the warped stiffness of a
/// strained part resists least, and a part that is collapsed to a line or a point still has them all.
template <std::floating_point Scalar>
struct RigidParts {
  Field<Scalar> rest;        ///< m
  Aggregates parts, groups;  ///< of vertices; of parts
  bool coupled = true;       ///< there are no groups: parts are coupled directly
  RigidFrames<Scalar> part_frames, group_frames;
  PaddedField<Scalar> offset;  ///< of each vertex from its part's centre at rest, turned, and 1; zeros if pinned
  Field<Scalar> arm;           ///< of each part's centre from its group's at rest, turned; empty without groups
  detail::Buffer<std::uint8_t> moves;  ///< 0: pinned

  RigidParts() = default;
  COROTET_COLD RigidParts(const Field<Scalar>& rest_positions, Index part_count, Index group_count)
      : rest(rest_positions),
        parts(Aggregates::of_positions(rest, std::clamp<Index>(part_count, 1, size_of(rest)))),
        coupled(group_count == 0),
        part_frames(parts.count()),
        offset(rest.size()),
        moves(rest.size(), 1) {
    set_rest_centers();
    groups = coupled
                 ? single_groups()
                 : Aggregates::of_positions(part_frames.rest_center, std::clamp<Index>(group_count, 1, parts.count()));
    group_frames = RigidFrames<Scalar>(coupled ? 0 : groups.count());
    arm.assign(at(coupled ? 0 : parts.count()), Vec3<Scalar>::Zero());
    for (Index g = 0; g < group_frames.parts(); ++g)
      group_frames.rest_center[at(g)] = group_mean(g, part_frames.rest_center);
  }

  [[nodiscard]] std::span<const Index> vertices_of(Index part) const { return parts.members(part); }
  [[nodiscard]] std::span<const Index> parts_of(Index group) const { return groups.members(group); }
  [[nodiscard]] Index group_of(Index vertex) const { return groups.of[at(parts.of[at(vertex)])]; }

  /// Calls `body(part)` for each part, some of them a task.
  template <class Body>
  void for_parts(ExecutorRef executor, Body&& body) const {
    const Index vertices_each = std::max<Index>(1, size_of(rest) / parts.count());
    for_ranges(executor, parts.count(), std::max<Index>(1, RangeSum::grain / vertices_each),
               [&](Index begin, Index end) {
                 for (Index part = begin; part < end; ++part) body(part);
               });
  }

  /// Says which vertices do not move; after that, which parts can turn, and how large they are, from the others.
  COROTET_COLD void pin(std::span<const Index> pinned) {
    std::fill(moves.begin(), moves.end(), std::uint8_t{1});
    for (const Index v : pinned) moves[at(v)] = 0;
    set_sizes();
  }

  /// Centres, rotations and offsets at a displacement.
  void place(const Field<Scalar>& displacement, ExecutorRef executor) {
    for_parts(executor, [&](Index part) {
      Vec3<Scalar> mean = Vec3<Scalar>::Zero();
      for (const Index v : vertices_of(part)) mean += displacement[at(v)];
      mean /= static_cast<Scalar>(vertices_of(part).size());
      const Vec3<Scalar>& rest_center = part_frames.rest_center[at(part)];
      part_frames.center[at(part)] = rest_center + mean;
      Mat3<Scalar> moment = Mat3<Scalar>::Zero();
      for (const Index v : vertices_of(part)) {
        const Vec3<Scalar> before = rest[at(v)] - rest_center, now = before + (displacement[at(v)] - mean);
        moment += now * before.transpose();
      }
      part_frames.rotation[at(part)] = moment;
    });
    for (Index g = 0; g < group_frames.parts(); ++g) {
      const Vec3<Scalar> center = group_mean(g, part_frames.center), rest_center = group_frames.rest_center[at(g)];
      group_frames.center[at(g)] = center;
      Mat3<Scalar> moment = Mat3<Scalar>::Zero();
      for (const Index part : parts_of(g)) {
        const auto members = static_cast<Scalar>(vertices_of(part).size());
        moment += part_frames.rotation[at(part)] + members * (part_frames.center[at(part)] - center) *
                                                       (part_frames.rest_center[at(part)] - rest_center).transpose();
      }
      group_frames.rotation[at(g)] = moment;
    }
    rotations_of_moments(part_frames.rotation, executor);
    rotations_of_moments(group_frames.rotation, executor);
    for_parts(executor, [&](Index part) {
      for (const Index v : vertices_of(part)) {
        const auto free = static_cast<Scalar>(moves[at(v)]);
        const Vec3<Scalar> from_center = free * (rest[at(v)] - part_frames.rest_center[at(part)]);
        offset[at(v)].set(part_frames.rotation[at(part)] * from_center);
        offset[at(v)][3] = free;
      }
    });
    for (Index g = 0; g < group_frames.parts(); ++g)
      for (const Index part : parts_of(g))
        arm[at(part)] =
            group_frames.rotation[at(g)] * (part_frames.rest_center[at(part)] - group_frames.rest_center[at(g)]);
  }

 private:
  /// Each part alone: with parts coupled directly, groups and parts are the same.
  [[nodiscard]] COROTET_COLD Aggregates single_groups() const {
    Aggregates each;
    for (Index a = 0; a <= parts.count(); ++a) each.start.push_back(a);
    for (Index a = 0; a < parts.count(); ++a) each.member.push_back(a);
    each.of = each.member;
    return each;
  }

  COROTET_COLD void set_rest_centers() {
    for (Index part = 0; part < parts.count(); ++part) {
      Vec3<double> sum = Vec3<double>::Zero();
      for (const Index v : vertices_of(part)) sum += rest[at(v)].template cast<double>();
      part_frames.rest_center[at(part)] = (sum / double(vertices_of(part).size())).template cast<Scalar>();
    }
  }
  [[nodiscard]] Vec3<Scalar> group_mean(Index group, const Field<Scalar>& part_value) const {
    Vec3<Scalar> sum = Vec3<Scalar>::Zero();
    for (const Index part : parts_of(group)) sum += part_value[at(part)];
    return sum / static_cast<Scalar>(parts_of(group).size());
  }

  /// Which parts can turn, and how large they are, from the vertices that are free.
  COROTET_COLD void set_sizes() {
    const auto set = [&](RigidFrames<Scalar>& frames, Index count, auto&& for_vertices) {
      for (Index a = 0; a < count; ++a) {
        Index free = 0;
        Vec3<double> mean = Vec3<double>::Zero();
        Mat3<double> moment = Mat3<double>::Zero();
        for_vertices(a, [&](Index v) {
          if (moves[at(v)] == 0) return;
          const Vec3<double> d = (rest[at(v)] - frames.rest_center[at(a)]).template cast<double>();
          ++free;
          mean += d;
          moment += d * d.transpose();
        });
        if (free > 0) moment -= mean * mean.transpose() / free;
        frames.set_size(a, free, moment);
      }
    };
    set(part_frames, parts.count(), [&](Index part, auto&& visit) {
      for (const Index v : vertices_of(part)) visit(v);
    });
    set(group_frames, group_frames.parts(), [&](Index group, auto&& visit) {
      for (const Index part : parts_of(group))
        for (const Index v : vertices_of(part)) visit(v);
    });
  }
};

}  // namespace corotet::inline v0_1
