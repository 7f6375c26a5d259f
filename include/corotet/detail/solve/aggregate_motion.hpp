// The rigid motions of a body's aggregates, from a displacement.
#pragma once

#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/aggregate_hierarchy.hpp>
#include <corotet/detail/solve/rigid_modes.hpp>
#include <corotet/detail/solve/rotation_of_points.hpp>
#include <cstdint>
#include <span>

namespace corotet::inline v0_1::detail {

/// The frames of all aggregates and the offsets of their members: those of the rest configuration, turned, not those of
/// now. The warped stiffness of a strained aggregate resists the turned rest offsets least. And an aggregate that is
/// collapsed to a line or a point still has all its motions.
template <std::floating_point Scalar>
struct AggregateMotion {
  using Hierarchy = AggregateHierarchy<Scalar>;

  RigidFrames<Scalar> fine, coarse;  ///< coarse: empty without a coarse level
  PaddedField<Scalar> offset;        ///< of each vertex from its aggregate's centre, and 1; zeros if pinned
  Buffer<Vec3<Scalar>> arm;          ///< of each aggregate's centre from its coarse aggregate's; or empty
  Buffer<std::uint8_t> moves;        ///< 0: pinned

  AggregateMotion() = default;
  COROTET_COLD explicit AggregateMotion(const Hierarchy& h)
      : fine(h.fine.count()),
        coarse(h.coarse_count()),
        offset(h.rest.size()),
        arm(at(h.two_levels ? 0 : h.fine.count())),
        moves(h.rest.size(), 1) {}

  /// Sets the pinned vertices, and from the others which aggregates can turn, and the size of each.
  COROTET_COLD void pin(const Hierarchy& h, std::span<const Index> pinned) {
    for (std::uint8_t& free : moves) free = 1;
    for (const Index v : pinned) moves[at(v)] = 0;
    for (Index a = 0; a < fine.count(); ++a) set_size(h, fine, a, h.fine_center[at(a)], {&a, 1});
    for (Index c = 0; c < coarse.count(); ++c) set_size(h, coarse, c, h.coarse_center[at(c)], h.fine_of(c));
  }

  /// Sets centres, rotations and offsets to those of a displacement.
  COROTET_COLD void place(const Hierarchy& h, const Field<Scalar>& displacement, ExecutorRef executor) {
    h.for_fine(executor, [&](Index a) {
      Vec3<Scalar> mean = Vec3<Scalar>::Zero();
      for (const Index v : h.vertices_of(a)) mean += displacement[at(v)];
      mean /= static_cast<Scalar>(h.vertices_of(a).size());
      const Vec3<Scalar>& rest_center = h.fine_center[at(a)];
      fine.center[at(a)] = rest_center + mean;
      Mat3<Scalar> moment = Mat3<Scalar>::Zero();
      for (const Index v : h.vertices_of(a)) {
        const Vec3<Scalar> before = h.rest[at(v)] - rest_center, now = before + (displacement[at(v)] - mean);
        moment += now * before.transpose();
      }
      fine.rotation[at(a)] = moment;
    });
    for (Index c = 0; c < coarse.count(); ++c) {
      const Vec3<Scalar> center = h.mean_of_fine(c, fine.center), rest_center = h.coarse_center[at(c)];
      coarse.center[at(c)] = center;
      Mat3<Scalar> moment = Mat3<Scalar>::Zero();
      for (const Index a : h.fine_of(c)) {
        const auto members = static_cast<Scalar>(h.vertices_of(a).size());
        moment += fine.rotation[at(a)] +
                  members * (fine.center[at(a)] - center) * (h.fine_center[at(a)] - rest_center).transpose();
      }
      coarse.rotation[at(c)] = moment;
    }
    rotations_of_moments(fine.rotation, executor);
    rotations_of_moments(coarse.rotation, executor);
    h.for_fine(executor, [&](Index a) {
      for (const Index v : h.vertices_of(a)) {
        const auto free = static_cast<Scalar>(moves[at(v)]);
        const Vec3<Scalar> from_center = free * (h.rest[at(v)] - h.fine_center[at(a)]);
        offset[at(v)].set(fine.rotation[at(a)] * from_center);
        offset[at(v)][3] = free;
      }
    });
    for (Index c = 0; c < coarse.count(); ++c)
      for (const Index a : h.fine_of(c))
        arm[at(a)] = coarse.rotation[at(c)] * (h.fine_center[at(a)] - h.coarse_center[at(c)]);
  }

  [[nodiscard]] std::size_t bytes() const {
    return fine.bytes() + coarse.bytes() + bytes_of(offset) + bytes_of(arm) + bytes_of(moves);
  }

  /// What `pin` has set; the rest follows from `place`.
  COROTET_COLD void visit_state(StateArchive& archive) {
    archive(moves);
    archive(fine.inverse_size);
    archive(coarse.inverse_size);
  }

 private:
  /// From the free vertices of these fine aggregates.
  COROTET_COLD void set_size(const Hierarchy& h, RigidFrames<Scalar>& frames, Index aggregate,
                             const Vec3<Scalar>& center, std::span<const Index> members) {
    Index free = 0;
    Vec3<double> mean = Vec3<double>::Zero();
    Mat3<double> moment = Mat3<double>::Zero();
    for (const Index a : members)
      for (const Index v : h.vertices_of(a)) {
        if (moves[at(v)] == 0) continue;
        const Vec3<double> d = (h.rest[at(v)] - center).template cast<double>();
        ++free;
        mean += d;
        moment += d * d.transpose();
      }
    if (free > 0) moment -= mean * mean.transpose() / free;
    frames.set_size(aggregate, free, moment);
  }
};

}  // namespace corotet::inline v0_1::detail
