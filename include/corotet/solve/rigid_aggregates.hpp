// Parts of the body that move as rigid bodies: the preconditioner for large bodies.
#pragma once

#include <algorithm>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/buffer.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/register.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/block_cholesky.hpp>
#include <corotet/solve/block_factor.hpp>
#include <corotet/solve/block_jacobi.hpp>
#include <corotet/solve/renewal.hpp>
#include <corotet/solve/rigid_modes.hpp>
#include <corotet/solve/rigid_parts.hpp>
#include <corotet/solve/small_cholesky.hpp>
#include <corotet/solve/solver.hpp>
#include <cstddef>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

namespace corotet::inline v0_1 {

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

  /// Parts of 27 vertices do best on small bodies, and the time of a step hardly depends on it on one thread; larger
  /// ones, of up to 60, keep the coarse solve short, which only one thread does; beyond that a level between is
  /// cheaper. (Measured on the beams of docs/speed.md.)
  [[nodiscard]] static Sizes sizes_for(Index vertices) {
    constexpr Index least = 27, most = 60, most_coupled_parts = 1000;
    if (vertices > most * most_coupled_parts) return {vertices / least, std::min<Index>(vertices / 230, 2000)};
    return {vertices / std::clamp<Index>(vertices / 150, least, most), 0};
  }

  RigidAggregates() = default;

  COROTET_COLD void analyze(const BlockPattern& pattern, const Field<Scalar>& rest, Sizes sizes) {
    body_ = RigidParts<Scalar>(rest, sizes.parts, sizes.groups);
    smoother_ = BlockJacobi<Scalar>(pattern);
    const auto coarse_pattern = std::make_shared<const BlockPattern>(coarse_pattern_of(pattern));
    coarse_ = BlockMatrix<double, 6>(coarse_pattern);
    cholesky_.analyze(*coarse_pattern);
    cholesky_.allocate();
    factor_.assign(cholesky_.factor());
    load_.assign(at(body_.parts.count()), SixVector<Scalar>::Zero());
    motion_ = load_;
    group_motion_.assign(at(body_.group_frames.parts()), SixVector<Scalar>::Zero());
    part_sum_.assign(at(body_.parts.count()), 0.0);
    if (!body_.coupled) part_inverse_.assign(at(body_.parts.count()), Block6::Zero());
  }

  /// Blocks in the coarse factor.
  [[nodiscard]] std::size_t factor_blocks() const { return cholesky_.factor_blocks(); }
  [[nodiscard]] Sizes sizes() const { return {body_.parts.count(), body_.group_frames.parts()}; }

  void update(const StepSystem<Scalar>& system, ExecutorRef executor) {
    smoother_.update(system, executor);
    const bool renew = renewal_.due(system.era);
    if (renew) body_.pin(system.pinned);
    body_.place(system.displacement, executor);
    if (renew) factorize(system.matrix, executor);
  }

  double apply(const PaddedField<Scalar>& r, PaddedField<Scalar>& z, ExecutorRef executor) {
    if (!usable_) return std::numeric_limits<double>::quiet_NaN();
    renewal_.count();
    body_.for_parts(executor, [&](Index part) {
      part_sum_[at(part)] = smooth_and_gather(part, r, z);
      if (body_.coupled) motion_[at(part)] = in_axes_of(part);
    });
    if (body_.coupled)
      factor_.solve(motion_.front().data(), motion_.front().data());
    else
      solve_groups(executor);
    body_.for_parts(executor, [&](Index part) {
      if (body_.coupled) motion_[at(part)] = world_motion(body_.part_frames, part, motion_[at(part)]);
      part_sum_[at(part)] += static_cast<double>(load_[at(part)].dot(motion_[at(part)]));
      scatter(part, z);
    });
    return std::accumulate(part_sum_.begin(), part_sum_.end(), 0.0);
  }

 private:
  using Block6 = Matrix<Scalar, 6, 6>;

  [[nodiscard]] COROTET_COLD BlockPattern coarse_pattern_of(const BlockPattern& fine) const {
    BlockPattern p;
    p.row_start.assign(1, 0);
    std::vector<Index> row;
    for (Index g = 0; g < body_.groups.count(); ++g) {
      row.clear();
      for (const Index part : body_.parts_of(g))
        for (const Index v : body_.vertices_of(part))
          for (Index k = fine.row_start[at(v)]; k < fine.row_start[at(v) + 1]; ++k)
            if (const Index other = body_.group_of(fine.column[at(k)]); row.empty() || row.back() != other)
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
  COROTET_COLD void factorize(const BlockMatrix<Scalar>& matrix, ExecutorRef executor) {
    const RigidFrames<Scalar>& frames = body_.coupled ? body_.part_frames : body_.group_frames;
    const BlockPattern& p = coarse_.pattern();
    const auto group_if_free = [&](Index v) { return body_.moves[at(v)] == 0 ? -1 : body_.group_of(v); };
    const auto group_offset = [&](Index v) -> Vec3<Scalar> {
      if (body_.coupled) return body_.offset[at(v)].vector();
      return body_.offset[at(v)].vector() + body_.arm[at(body_.parts.of[at(v)])];
    };
    for_ranges(executor, body_.groups.count(), 1, [&](Index g, Index) {
      for (Index k = p.row_start[at(g)]; k < p.row_start[at(g) + 1]; ++k) coarse_.block(k).setZero();
      for (const Index part : body_.parts_of(g))
        rigid_row(matrix, body_.vertices_of(part), group_if_free, group_offset,
                  [&](Index other, const auto& block) { coarse_.block(p.slot(g, other)) += block; });
      for (Index k = p.row_start[at(g)]; k < p.row_start[at(g) + 1]; ++k)
        coarse_.block(k) = in_part_axes<Scalar>(frames, g, p.column[at(k)], coarse_.block(k));
      Matrix<double, 6, 6> diagonal = coarse_.block(p.diagonal[at(g)]);
      stabilise(diagonal);
      coarse_.block(p.diagonal[at(g)]) = diagonal;
    });
    if (cholesky_.factorize(coarse_)) {
      factor_.assign(cholesky_.factor());
      usable_ = true;
    } else {
      renewal_.failed();  // and the last factor that could be made serves on
    }
    if (!body_.coupled) invert_parts(matrix, executor);
  }

  COROTET_COLD void invert_parts(const BlockMatrix<Scalar>& matrix, ExecutorRef executor) {
    body_.for_parts(executor, [&](Index part) {
      Matrix<double, 6, 6> diagonal = Matrix<double, 6, 6>::Zero();
      rigid_row(
          matrix, body_.vertices_of(part),
          [&](Index v) { return body_.moves[at(v)] == 0 || body_.parts.of[at(v)] != part ? -1 : part; },
          [&](Index v) -> Vec3<Scalar> { return body_.offset[at(v)].vector(); },
          [&](Index, const auto& block) { diagonal += block; });
      diagonal = in_part_axes(body_.part_frames, part, part, diagonal);
      stabilise(diagonal);
      Matrix<double, 6, 6> lower_inverse;
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
    for (const Index v : body_.vertices_of(part)) {
      const PaddedVector<Scalar>& rv = r[at(v)];
      const Q smooth = smoother_.apply_to(v, rv);
      z[at(v)].set(smooth);
      product += smooth * rv.quad();
      const Q offset = body_.offset[at(v)].quad();
      COROTET_UNROLL
      for (std::size_t c = 0; c < 3; ++c) column[c] += offset * Q(rv[c]);
    }
    std::array<std::array<Scalar, 4>, 3> m;
    COROTET_UNROLL
    for (std::size_t c = 0; c < 3; ++c) column[c].store(m[c].data());
    std::array<Scalar, 4> sum;
    product.store(sum.data());
    load_[at(part)] =
        six_vector<Scalar>({m[0][3], m[1][3], m[2][3]}, {m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]});
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
    for (const Index v : body_.vertices_of(part)) {
      const PaddedVector<Scalar>& d = body_.offset[at(v)];
      z[at(v)].set(z[at(v)].quad() + x * Q(d[0]) + y * Q(d[1]) + w * Q(d[2]) + t * Q(d[3]));
    }
  }

  [[nodiscard]] static SixVector<Scalar> world_motion(const RigidFrames<Scalar>& frames, Index part,
                                                      const SixVector<Scalar>& y) {
    return six_vector<Scalar>(frames.translation(part, y), frames.turn(part, y));
  }

  /// The load on a part in its own axes.
  [[nodiscard]] SixVector<Scalar> in_axes_of(Index part) const {
    const SixVector<Scalar>& load = load_[at(part)];
    return body_.part_frames.to_part(part, load.template head<3>(), load.template tail<3>());
  }

  /// Parts by their own blocks, and the rigid motions of groups on top.
  void solve_groups(ExecutorRef executor) {
    const Index groups = body_.group_frames.parts();
    for_ranges(executor, groups, group_grain, [&](Index begin, Index end) {
      for (Index g = begin; g < end; ++g) {
        Vec3<Scalar> force = Vec3<Scalar>::Zero(), torque = force;
        for (const Index a : body_.parts_of(g)) {
          const Vec3<Scalar> f = load_[at(a)].template head<3>(), t = load_[at(a)].template tail<3>();
          force += f;
          torque += t + body_.arm[at(a)].cross(f);
          motion_[at(a)] = world_motion(body_.part_frames, a, part_inverse_[at(a)] * in_axes_of(a));
        }
        group_motion_[at(g)] = body_.group_frames.to_part(g, force, torque);
      }
    });
    factor_.solve(group_motion_.front().data(), group_motion_.front().data());
    for_ranges(executor, groups, group_grain, [&](Index begin, Index end) {
      for (Index g = begin; g < end; ++g) {
        const SixVector<Scalar> m = world_motion(body_.group_frames, g, group_motion_[at(g)]);
        const Vec3<Scalar> move = m.template head<3>(), turn = m.template tail<3>();
        for (const Index a : body_.parts_of(g))
          motion_[at(a)] += six_vector<Scalar>(move + turn.cross(body_.arm[at(a)]), turn);
      }
    });
  }

  static constexpr Index group_grain = 64;  // groups a task: some hundred parts

  RigidParts<Scalar> body_;
  BlockJacobi<Scalar> smoother_;
  detail::Buffer<SixVector<Scalar>> load_, motion_, group_motion_;
  detail::Buffer<Block6> part_inverse_;
  detail::Buffer<double> part_sum_;
  BlockMatrix<double, 6> coarse_;
  BlockCholesky<double, 6> cholesky_;
  BlockFactor<Scalar, 6> factor_;
  Renewal renewal_;
  bool usable_ = false;
};

}  // namespace corotet::inline v0_1
