// Parts of the body that move as rigid bodies: the preconditioner for large bodies.
#pragma once

#include <algorithm>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/register.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/aggregates.hpp>
#include <corotet/solve/block_cholesky.hpp>
#include <corotet/solve/block_factor.hpp>
#include <corotet/solve/block_jacobi.hpp>
#include <corotet/solve/renewal.hpp>
#include <corotet/solve/rigid_modes.hpp>
#include <corotet/solve/rotation_of_points.hpp>
#include <corotet/solve/small_cholesky.hpp>
#include <corotet/solve/solver.hpp>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace corotet {

/// z = D^-1 r + P A_c^-1 P^T r: block-Jacobi, and a coarse level whose unknowns are the rigid motions P of boxes of
/// neighbouring vertices. Nothing of P is stored: P^T r is the force and torque on each part. A_c = P^T A P is factored
/// once, in axes that turn with the parts, and so follows the body; it is made again when Renewal says so.
///
/// (Two-level additive Schwarz: Dryja & Widlund 1994; aggregates with rigid modes: Vanek, Mandel & Brezina 1996.)
///
/// With `groups` > 0 there is a level between: parts by their own 6x6 block of A_c alone, and groups of parts by the
/// coupled coarse matrix, whose factor would otherwise be larger than the matrix of the body.
template <std::floating_point Scalar>
class RigidAggregates {
 public:
  static constexpr int error_delay = 0;

  struct Sizes {
    Index parts = 0;
    Index groups = 0;  ///< of parts; 0: none
  };

  /// Parts of 27 vertices do best on small bodies, and the time of a step hardly depends on it; larger ones, of up to
  /// 60, keep the coarse factor small; beyond that a level between is cheaper. (Measured on the beams of
  /// docs/speed.md.)
  [[nodiscard]] static Sizes sizes_for(Index vertices) {
    constexpr Index least = 27, most = 60, most_coupled_parts = 1000;
    if (vertices > most * most_coupled_parts) return {vertices / least, std::min<Index>(vertices / 230, 2000)};
    return {vertices / std::clamp<Index>(vertices / 600, least, most), 0};
  }

  RigidAggregates() = default;

  void analyze(const BlockPattern& pattern, const Field<Scalar>& rest, Sizes sizes) {
    rest_ = rest;
    smoother_ = BlockJacobi<Scalar>(pattern);
    parts_ = Aggregates::of_positions(rest, std::clamp<Index>(sizes.parts, 1, size_of(rest)));
    part_frames_ = RigidFrames<Scalar>(parts_.count());
    set_rest_centers();
    groups_ = sizes.groups == 0 ? single_groups()
                                : Aggregates::of_positions(part_frames_.rest_center,
                                                           std::clamp<Index>(sizes.groups, 1, parts_.count()));
    coupled_parts_ = sizes.groups == 0;
    group_frames_ = RigidFrames<Scalar>(coupled_parts_ ? 0 : groups_.count());
    for (Index g = 0; g < group_frames_.parts(); ++g)
      group_frames_.rest_center[at(g)] = group_mean(g, part_frames_.rest_center);

    const auto coarse_pattern = std::make_shared<const BlockPattern>(coarse_pattern_of(pattern));
    coarse_ = BlockMatrix<double, 6>(coarse_pattern);
    cholesky_.analyze(*coarse_pattern);
    cholesky_.allocate();
    factor_.assign(cholesky_.factor());
    offset_.assign(rest.size(), {});
    moves_.assign(rest.size(), 1);
    load_.assign(at(parts_.count()), SixVector<Scalar>::Zero());
    motion_ = load_;
    group_motion_.assign(at(group_frames_.parts()), SixVector<Scalar>::Zero());
    part_sum_.assign(at(parts_.count()), 0.0);
    if (!coupled_parts_) part_inverse_.assign(at(parts_.count()), Block6::Zero());
  }

  /// Blocks in the coarse factor.
  [[nodiscard]] std::size_t factor_blocks() const { return cholesky_.factor_blocks(); }
  [[nodiscard]] Sizes sizes() const { return {parts_.count(), group_frames_.parts()}; }

  template <Executor E>
  void update(const StepSystem<Scalar>& system, E& executor) {
    smoother_.update(system, executor);
    const bool renew = renewal_.due(system.era);
    if (renew) {
      std::fill(moves_.begin(), moves_.end(), std::uint8_t{1});
      for (const Index v : system.pinned) moves_[at(v)] = 0;
      set_part_sizes();
    }
    place(system.displacement, executor);
    if (renew) factorize(system.matrix, executor);
  }

  template <Executor E>
  double apply(const PaddedField<Scalar>& r, PaddedField<Scalar>& z, E& executor) {
    if (!usable_) return std::numeric_limits<double>::quiet_NaN();
    renewal_.count();
    for_parts(executor, [&](Index part) { part_sum_[at(part)] = smooth_and_gather(part, r, z); });
    if (coupled_parts_)
      solve_parts();
    else
      solve_groups();
    for_parts(executor, [&](Index part) { scatter(part, z); });
    double sum = 0;
    for (Index part = 0; part < parts_.count(); ++part)
      sum += part_sum_[at(part)] + static_cast<double>(load_[at(part)].dot(motion_[at(part)]));
    return sum;
  }

 private:
  using Block6 = Eigen::Matrix<Scalar, 6, 6>;

  [[nodiscard]] std::span<const Index> vertices_of(Index part) const {
    return std::span(parts_.member)
        .subspan(at(parts_.start[at(part)]), at(parts_.start[at(part) + 1] - parts_.start[at(part)]));
  }
  [[nodiscard]] std::span<const Index> parts_of(Index group) const {
    return std::span(groups_.member)
        .subspan(at(groups_.start[at(group)]), at(groups_.start[at(group) + 1] - groups_.start[at(group)]));
  }

  /// Each part alone: with parts coupled directly, groups and parts are the same.
  [[nodiscard]] Aggregates single_groups() const {
    Aggregates each;
    for (Index a = 0; a <= parts_.count(); ++a) each.start.push_back(a);
    for (Index a = 0; a < parts_.count(); ++a) each.member.push_back(a);
    each.of = each.member;
    return each;
  }

  template <Executor E, class Body>
  void for_parts(E& executor, Body&& body) {
    const Index vertices_each = std::max<Index>(1, size_of(rest_) / parts_.count());
    for_ranges(executor, parts_.count(), std::max<Index>(1, RangeSum::grain / vertices_each),
               [&](Index begin, Index end) {
                 for (Index part = begin; part < end; ++part) body(part);
               });
  }

  void set_rest_centers() {
    for (Index part = 0; part < parts_.count(); ++part) {
      Vec3<double> sum = Vec3<double>::Zero();
      for (const Index v : vertices_of(part)) sum += rest_[at(v)].template cast<double>();
      part_frames_.rest_center[at(part)] = (sum / double(vertices_of(part).size())).template cast<Scalar>();
    }
  }
  [[nodiscard]] Vec3<Scalar> group_mean(Index group, const Field<Scalar>& part_value) const {
    Vec3<Scalar> sum = Vec3<Scalar>::Zero();
    for (const Index part : parts_of(group)) sum += part_value[at(part)];
    return sum / static_cast<Scalar>(parts_of(group).size());
  }

  /// Which parts can turn, and how large they are, from the vertices that are free.
  void set_part_sizes() {
    const auto set = [&](RigidFrames<Scalar>& frames, Index count, auto&& for_vertices) {
      for (Index a = 0; a < count; ++a) {
        Index free = 0;
        Vec3<double> mean = Vec3<double>::Zero();
        Mat3<double> moment = Mat3<double>::Zero();
        for_vertices(a, [&](Index v) {
          if (moves_[at(v)] == 0) return;
          const Vec3<double> d = (rest_[at(v)] - frames.rest_center[at(a)]).template cast<double>();
          ++free;
          mean += d;
          moment += d * d.transpose();
        });
        if (free > 0) moment -= mean * mean.transpose() / free;
        frames.set_size(a, free, moment);
      }
    };
    set(part_frames_, parts_.count(), [&](Index part, auto&& visit) {
      for (const Index v : vertices_of(part)) visit(v);
    });
    set(group_frames_, group_frames_.parts(), [&](Index group, auto&& visit) {
      for (const Index part : parts_of(group))
        for (const Index v : vertices_of(part)) visit(v);
    });
  }

  /// Centres, rotations and offsets at a displacement.
  template <Executor E>
  void place(const Field<Scalar>& displacement, E& executor) {
    for_parts(executor, [&](Index part) {
      Vec3<Scalar> mean = Vec3<Scalar>::Zero();
      for (const Index v : vertices_of(part)) mean += displacement[at(v)];
      mean /= static_cast<Scalar>(vertices_of(part).size());
      const Vec3<Scalar>& rest_center = part_frames_.rest_center[at(part)];
      part_frames_.center[at(part)] = rest_center + mean;
      Mat3<Scalar> moment = Mat3<Scalar>::Zero();
      for (const Index v : vertices_of(part)) {
        const Vec3<Scalar> rest = rest_[at(v)] - rest_center, now = rest + (displacement[at(v)] - mean);
        moment += now * rest.transpose();
        const auto moves = static_cast<Scalar>(moves_[at(v)]);
        offset_[at(v)].set((moves * now).eval());
        offset_[at(v)][3] = moves;
      }
      part_frames_.rotation[at(part)] = moment;
    });
    for (Index g = 0; g < group_frames_.parts(); ++g) {
      const Vec3<Scalar> center = group_mean(g, part_frames_.center), rest_center = group_frames_.rest_center[at(g)];
      group_frames_.center[at(g)] = center;
      Mat3<Scalar> moment = Mat3<Scalar>::Zero();
      for (const Index part : parts_of(g)) {
        const auto members = static_cast<Scalar>(vertices_of(part).size());
        moment += part_frames_.rotation[at(part)] + members * (part_frames_.center[at(part)] - center) *
                                                        (part_frames_.rest_center[at(part)] - rest_center).transpose();
      }
      group_frames_.rotation[at(g)] = moment;
    }
    rotations_of_moments(part_frames_.rotation, executor);
    rotations_of_moments(group_frames_.rotation, executor);
  }

  [[nodiscard]] Index group_of(Index vertex) const { return groups_.of[at(parts_.of[at(vertex)])]; }

  [[nodiscard]] BlockPattern coarse_pattern_of(const BlockPattern& fine) const {
    BlockPattern p;
    p.row_start.assign(1, 0);
    std::vector<Index> row;
    for (Index g = 0; g < groups_.count(); ++g) {
      row.clear();
      for (const Index part : parts_of(g))
        for (const Index v : vertices_of(part))
          for (Index k = fine.row_start[at(v)]; k < fine.row_start[at(v) + 1]; ++k)
            if (const Index other = group_of(fine.column[at(k)]); row.empty() || row.back() != other)
              row.push_back(other);
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
      p.diagonal.push_back(size_of(p.column) +
                           static_cast<Index>(std::lower_bound(row.begin(), row.end(), g) - row.begin()));
      p.column.insert(p.column.end(), row.begin(), row.end());
      p.row_start.push_back(size_of(p.column));
    }
    return p;
  }

  /// The coarse matrix and its factor, from the matrix of now, turned back.
  template <Executor E>
  void factorize(const BlockMatrix<Scalar>& matrix, E& executor) {
    const RigidFrames<Scalar>& frames = coupled_parts_ ? part_frames_ : group_frames_;
    const BlockPattern& p = coarse_.pattern();
    const auto group_if_free = [&](Index v) { return moves_[at(v)] == 0 ? -1 : group_of(v); };
    const auto group_offset = [&](Index v) -> Vec3<Scalar> {
      if (coupled_parts_) return offset_[at(v)].vector();
      return offset_[at(v)].vector() +
             (part_frames_.center[at(parts_.of[at(v)])] - group_frames_.center[at(group_of(v))]);
    };
    executor(groups_.count(), [&](Index g) {
      for (Index k = p.row_start[at(g)]; k < p.row_start[at(g) + 1]; ++k) coarse_.block(k).setZero();
      for (const Index part : parts_of(g))
        rigid_row(matrix, vertices_of(part), group_if_free, group_offset,
                  [&](Index other, const auto& block) { coarse_.block(p.slot(g, other)) += block; });
      for (Index k = p.row_start[at(g)]; k < p.row_start[at(g) + 1]; ++k)
        coarse_.block(k) = in_part_axes(frames, g, p.column[at(k)], coarse_.block(k));
      stabilise(coarse_.block(p.diagonal[at(g)]));
    });
    if (cholesky_.factorize(coarse_)) {
      factor_.assign(cholesky_.factor());
      usable_ = true;
    } else {
      renewal_.failed();  // and the last factor that could be made serves on
    }
    if (!coupled_parts_) invert_parts(matrix, executor);
  }

  template <Executor E>
  void invert_parts(const BlockMatrix<Scalar>& matrix, E& executor) {
    for_parts(executor, [&](Index part) {
      Eigen::Matrix<double, 6, 6> diagonal = Eigen::Matrix<double, 6, 6>::Zero();
      rigid_row(
          matrix, vertices_of(part),
          [&](Index v) { return moves_[at(v)] == 0 || parts_.of[at(v)] != part ? -1 : part; },
          [&](Index v) -> Vec3<Scalar> { return offset_[at(v)].vector(); },
          [&](Index, const auto& block) { diagonal += block; });
      diagonal = in_part_axes(part_frames_, part, part, diagonal);
      stabilise(diagonal);
      Eigen::Matrix<double, 6, 6> lower_inverse;
      if (inverse_cholesky(diagonal, lower_inverse))
        part_inverse_[at(part)] = (lower_inverse.transpose() * lower_inverse).template cast<Scalar>();
      else
        part_inverse_[at(part)].setZero();  // then its vertices and its group do what they can
    });
  }

  /// z = D^-1 r on the part, and the force and torque of r on it; returns r . z.
  [[nodiscard]] double smooth_and_gather(Index part, const PaddedField<Scalar>& r, PaddedField<Scalar>& z) {
    using Q = Quad<Scalar>;
    // Column c: sum of (offset, 1) r_c. The last row is the force; the torque is the antisymmetric part of the rest.
    std::array<Q, 3> column{Q(Scalar(0)), Q(Scalar(0)), Q(Scalar(0))};
    Q product(Scalar(0));
    for (const Index v : vertices_of(part)) {
      const PaddedVector<Scalar>& rv = r[at(v)];
      const Q smooth = smoother_.apply_to(v, rv);
      z[at(v)].set(smooth);
      product += smooth * rv.quad();
      const Q offset = offset_[at(v)].quad();
      COROTET_UNROLL
      for (std::size_t c = 0; c < 3; ++c) column[c] += offset * Q(rv[c]);
    }
    std::array<std::array<Scalar, 4>, 3> m;
    COROTET_UNROLL
    for (std::size_t c = 0; c < 3; ++c) column[c].store(m[c].data());
    std::array<Scalar, 4> sum;
    product.store(sum.data());
    load_[at(part)] << m[0][3], m[1][3], m[2][3], m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1];
    return static_cast<double>(sum[0] + sum[1] + sum[2]);
  }

  /// z += t + w x offset.
  void scatter(Index part, PaddedField<Scalar>& z) const {
    using Q = Quad<Scalar>;
    const SixVector<Scalar>& m = motion_[at(part)];
    const auto column = [](Scalar x, Scalar y, Scalar zz) {
      const std::array<Scalar, 4> c{x, y, zz, Scalar(0)};
      return Q::load(c.data());
    };
    const Q x = column(0, m[5], -m[4]), y = column(-m[5], 0, m[3]), w = column(m[4], -m[3], 0),
            t = column(m[0], m[1], m[2]);
    for (const Index v : vertices_of(part)) {
      const PaddedVector<Scalar>& d = offset_[at(v)];
      z[at(v)].set(z[at(v)].quad() + x * Q(d[0]) + y * Q(d[1]) + w * Q(d[2]) + t * Q(d[3]));
    }
  }

  [[nodiscard]] static SixVector<Scalar> world_motion(const RigidFrames<Scalar>& frames, Index part,
                                                      const SixVector<Scalar>& y) {
    SixVector<Scalar> m;
    m << frames.translation(part, y), frames.turn(part, y);
    return m;
  }

  void solve_parts() {
    for (Index a = 0; a < parts_.count(); ++a)
      motion_[at(a)] = part_frames_.to_part(a, load_[at(a)].template head<3>(), load_[at(a)].template tail<3>());
    factor_.solve(motion_.front().data(), motion_.front().data());
    for (Index a = 0; a < parts_.count(); ++a) motion_[at(a)] = world_motion(part_frames_, a, motion_[at(a)]);
  }

  void solve_groups() {
    const auto arm = [&](Index part, Index group) -> Vec3<Scalar> {
      return part_frames_.center[at(part)] - group_frames_.center[at(group)];
    };
    for (Index g = 0; g < group_frames_.parts(); ++g) {
      Vec3<Scalar> force = Vec3<Scalar>::Zero(), torque = force;
      for (const Index a : parts_of(g)) {
        const Vec3<Scalar> f = load_[at(a)].template head<3>(), t = load_[at(a)].template tail<3>();
        force += f;
        torque += t + arm(a, g).cross(f);
        motion_[at(a)] = world_motion(part_frames_, a, part_inverse_[at(a)] * part_frames_.to_part(a, f, t));
      }
      group_motion_[at(g)] = group_frames_.to_part(g, force, torque);
    }
    factor_.solve(group_motion_.front().data(), group_motion_.front().data());
    for (Index g = 0; g < group_frames_.parts(); ++g) {
      const SixVector<Scalar> m = world_motion(group_frames_, g, group_motion_[at(g)]);
      const Vec3<Scalar> turn = m.template tail<3>();
      for (const Index a : parts_of(g)) {
        motion_[at(a)].template head<3>() += m.template head<3>() + turn.cross(arm(a, g));
        motion_[at(a)].template tail<3>() += turn;
      }
    }
  }

  Field<Scalar> rest_;
  BlockJacobi<Scalar> smoother_;
  Aggregates parts_, groups_;
  bool coupled_parts_ = true;
  RigidFrames<Scalar> part_frames_, group_frames_;
  PaddedField<Scalar> offset_;  // from the centre of the vertex's part, and 1; zeros if it is pinned
  std::vector<std::uint8_t> moves_;
  std::vector<SixVector<Scalar>, Eigen::aligned_allocator<SixVector<Scalar>>> load_, motion_, group_motion_;
  std::vector<Block6, Eigen::aligned_allocator<Block6>> part_inverse_;
  std::vector<double> part_sum_;
  BlockMatrix<double, 6> coarse_;
  BlockCholesky<double, 6> cholesky_;
  BlockFactor<Scalar, 6> factor_;
  Renewal renewal_;
  bool usable_ = false;
};

static_assert(Preconditioner<RigidAggregates<float>, float>);

}  // namespace corotet
