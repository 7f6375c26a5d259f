// Aggregates of vertices that move as rigid bodies: the preconditioner for large bodies.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/shared.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/aggregate_hierarchy.hpp>
#include <corotet/detail/solve/aggregate_motion.hpp>
#include <corotet/detail/solve/block_cholesky.hpp>
#include <corotet/detail/solve/block_jacobi.hpp>
#include <corotet/detail/solve/refactorization_policy.hpp>
#include <corotet/detail/solve/rigid_modes.hpp>
#include <corotet/detail/solve/small_cholesky.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <cstddef>
#include <limits>
#include <memory>

namespace corotet::inline v0_1 {

/// z = D^-1 r + P A_c^-1 P^T r: block-Jacobi, and a coarse level whose unknowns are the rigid motions P of boxes of
/// neighbouring vertices. Nothing of P is stored: P^T r is the force and torque on each aggregate. A_c = P^T A P is
/// factored once, in axes that turn with the aggregates, and so follows the body; RefactorizationPolicy says when it is
/// made again.
///
/// (Two-level additive Schwarz: Dryja & Widlund 1994; aggregates with rigid modes: Vanek, Mandel & Brezina 1996.)
///
/// With a coarse level there are three: aggregates by their own 6x6 block of A_c alone, and aggregates of aggregates by
/// the coupled coarse matrix, whose factor would otherwise be larger than the matrix of the body.
template <std::floating_point Scalar>
class RigidAggregates {
 public:
  using scalar_type = Scalar;                ///< of the matrix
  static constexpr int estimator_delay = 0;  ///< its error estimate needs no delay

  struct Sizes {
    Index aggregates = 0;  ///< of vertices; 0: as `sizes_for` says
    Index coarse = 0;      ///< aggregates of these; 0: none
  };

  /// Aggregates of 27 vertices do best on small bodies, and the time of a step hardly depends on it on one thread;
  /// larger ones, of up to 60, keep the coarse solve short, which only one thread does; beyond that a level between is
  /// cheaper. (Measured on the beams of docs/benchmarks/speed.md.)
  [[nodiscard]] static Sizes sizes_for(Index vertices) {
    constexpr Index least = 27, most = 60, max_coupled = 1000;
    if (vertices > most * max_coupled) return {vertices / least, std::min<Index>(vertices / 230, 2000)};
    return {vertices / std::clamp<Index>(vertices / 150, least, most), 0};
  }

  /// Numbers of aggregates; 0: as the number of vertices asks.
  explicit RigidAggregates(const Sizes& sizes = {}) : wanted_(sizes) {}

  /// See Preconditioner.
  COROTET_COLD void analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& rest) {
    const Sizes sizes = wanted_.aggregates > 0 ? wanted_ : sizes_for(pattern->rows());
    model_ = detail::Shared<Model>::make(*pattern, rest, sizes);
    const Hierarchy& h = model_->hierarchy;
    motion_ = detail::AggregateMotion<Scalar>(h);
    smoother_.analyze(pattern, rest);
    cholesky_.analyze(model_->coarse_pattern);
    load_ = detail::Scratch<detail::SixVector<Scalar>>(at(h.fine.count()));
    answer_ = load_;
    coarse_answer_ = detail::Scratch<detail::SixVector<Scalar>>(at(h.coarse_count()));
    product_ = detail::Scratch<double>(at(h.fine.count()));
    own_inverse_ = detail::Buffer<Block6>(at(h.two_levels ? 0 : h.fine.count()));
    policy_ = {};
  }

  /// Blocks in the coarse factor.
  [[nodiscard]] std::size_t factor_blocks() const { return cholesky_.symbolic().blocks; }
  /// Numbers of aggregates in use.
  [[nodiscard]] Sizes sizes() const { return {hierarchy().fine.count(), hierarchy().coarse_count()}; }

  /// See Preconditioner.
  COROTET_COLD void update(const StepSystem<Scalar>& system, ExecutorRef executor) {
    smoother_.update(system, executor);
    const bool refactor = policy_.should_refactor(system.lag_key);
    if (refactor) motion_.pin(hierarchy(), system.pinned);
    motion_.place(hierarchy(), system.displacement, executor);
    if (refactor) factorize(system.matrix, executor);
  }

  /// See Preconditioner.
  double apply(const PaddedField<Scalar>& r, PaddedField<Scalar>& z, ExecutorRef executor) {
    if (!cholesky_.has_factor()) return std::numeric_limits<double>::quiet_NaN();
    policy_.count();
    const Hierarchy& h = hierarchy();
    h.for_fine(executor, [&](Index a) {
      product_[at(a)] = smooth_and_gather(a, r, z);
      if (h.two_levels) answer_[at(a)] = in_axes_of(a);
    });
    if (h.two_levels)
      cholesky_.solve(answer_.front().data(), answer_.front().data());
    else
      solve_coarse(executor);
    h.for_fine(executor, [&](Index a) {
      if (h.two_levels) answer_[at(a)] = world_motion(motion_.fine, a, answer_[at(a)]);
      product_[at(a)] += static_cast<double>(load_[at(a)].dot(answer_[at(a)]));
      scatter(a, z);
    });
    double sum = 0;
    for (const double product : product_) sum += product;
    return sum;
  }

  /// Bytes of its own, and those that copies share.
  [[nodiscard]] MemoryUse memory() const {
    MemoryUse use = smoother_.memory() + cholesky_.memory();
    use.owned += motion_.bytes() + detail::bytes_of(load_) + detail::bytes_of(answer_) +
                 detail::bytes_of(coarse_answer_) + detail::bytes_of(own_inverse_) + detail::bytes_of(product_);
    if (model_) use.shared += model_->hierarchy.bytes() + model_->coarse_pattern.bytes();
    return use;
  }

  /// For snapshots.
  COROTET_COLD void visit_state(detail::StateArchive& archive) {
    motion_.visit_state(archive);
    cholesky_.visit_state(archive);
    archive(own_inverse_);
    policy_.visit_state(archive);
  }

 private:
  using Hierarchy = detail::AggregateHierarchy<Scalar>;
  using Block6 = Matrix<Scalar, 6, 6>;
  using WideBlock6 = Matrix<double, 6, 6>;

  struct Model {
    Hierarchy hierarchy;
    BlockPattern coarse_pattern;

    COROTET_COLD Model(const BlockPattern& pattern, const Field<Scalar>& rest, const Sizes& sizes)
        : hierarchy(rest, sizes.aggregates, sizes.coarse), coarse_pattern(hierarchy.coarse_pattern(pattern)) {}
  };

  [[nodiscard]] const Hierarchy& hierarchy() const { return model_->hierarchy; }

  COROTET_COLD void factorize(const BlockMatrix<Scalar>& matrix, ExecutorRef executor) {
    if (!hierarchy().two_levels) invert_blocks(matrix, executor);
    for (const double shift : RefactorizationPolicy::shifts)
      if (factorize_coarse(matrix, shift, executor)) return;
    policy_.failed();
  }

  /// The factor of the coarse matrix, from the matrix of now, turned back, with `shift` times its diagonal more.
  COROTET_COLD bool factorize_coarse(const BlockMatrix<Scalar>& matrix, double shift, ExecutorRef executor) {
    const Hierarchy& h = hierarchy();
    const detail::RigidFrames<Scalar>& frames = h.two_levels ? motion_.fine : motion_.coarse;
    const BlockPattern& p = model_->coarse_pattern;
    cholesky_.begin();
    for_ranges(executor, h.coarse.count(), 1, [&](Index c, Index) {
      for (const Index a : h.fine_of(c)) add_rows(matrix, a, c, nullptr);
      for (Index k = p.row_start[at(c)]; k < p.row_start[at(c) + 1]; ++k) {
        if (!cholesky_.takes(k)) continue;
        WideBlock6 block = detail::in_own_axes<Scalar>(frames, c, p.column[at(k)], cholesky_.entry(k));
        if (k == p.diagonal[at(c)]) detail::stabilise(block, shift);
        cholesky_.entry(k) = block;
      }
    });
    return cholesky_.factorize();
  }

  COROTET_COLD void invert_blocks(const BlockMatrix<Scalar>& matrix, ExecutorRef executor) {
    hierarchy().for_fine(executor, [&](Index a) {
      WideBlock6 diagonal = WideBlock6::Zero();
      add_rows(matrix, a, -1, &diagonal);
      diagonal = detail::in_own_axes(motion_.fine, a, a, diagonal);
      detail::stabilise(diagonal);
      WideBlock6 lower_inverse;
      if (detail::inverse_cholesky(diagonal, lower_inverse))
        own_inverse_[at(a)] = (lower_inverse.transpose() * lower_inverse).template cast<Scalar>();
      else
        own_inverse_[at(a)].setZero();  // then its vertices and its coarse aggregate do what they can
    });
  }

  /// Adds the rows of the vertices of one aggregate to P^T A P, in the axes of the world: to the row of the coarse
  /// aggregate `c`, or the aggregate's own block to `own`.
  COROTET_COLD void add_rows(const BlockMatrix<Scalar>& matrix, Index aggregate, Index c, WideBlock6* own) {
    const Hierarchy& h = hierarchy();
    const BlockPattern& p = matrix.pattern();
    const auto cross = [&](Index v) {  // of the offset
      Vec3<double> d = motion_.offset[at(v)].vector().template cast<double>();
      if (own == nullptr && !h.two_levels) d += motion_.arm[at(h.fine.aggregate_of[at(v)])].template cast<double>();
      Mat3<double> m;
      m.set_col(0, {0, d.z(), -d.y()});
      m.set_col(1, {-d.z(), 0, d.x()});
      m.set_col(2, {d.y(), -d.x(), 0});
      return m;
    };
    for (const Index i : h.vertices_of(aggregate)) {
      if (motion_.moves[at(i)] == 0) continue;
      const Mat3<double> across = cross(i);  // P_i^T = [I; [d_i]x], P_j = [I, -[d_j]x]
      for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k) {
        const Index j = p.column[at(k)];
        if (motion_.moves[at(j)] == 0) continue;
        const Index slot = own != nullptr ? 0 : model_->coarse_pattern.slot(c, h.coarse_of(j));
        if (own != nullptr ? h.fine.aggregate_of[at(j)] != aggregate : !cholesky_.takes(slot)) continue;
        WideBlock6 block;
        const Mat3<double> left = matrix.block(k).template cast<double>(), right = -(left * cross(j));
        block.set_block(0, 0, left);
        block.set_block(0, 3, right);
        block.set_block(3, 0, across * left);
        block.set_block(3, 3, across * right);
        if (own != nullptr)
          *own += block;
        else
          cholesky_.entry(slot) += block;
      }
    }
  }

  /// z = D^-1 r on the aggregate, and the force and torque of r on it; returns r . z.
  [[nodiscard]] double smooth_and_gather(Index aggregate, const PaddedField<Scalar>& r, PaddedField<Scalar>& z) {
    using Q = detail::Vec4<Scalar>;
    // Column c: sum of (offset, 1) r_c. The last row is the force; the torque is the antisymmetric part of the rest.
    std::array<Q, 3> column{Q(Scalar(0)), Q(Scalar(0)), Q(Scalar(0))};
    Q product(Scalar(0));
    for (const Index v : hierarchy().vertices_of(aggregate)) {
      const PaddedVector<Scalar>& rv = r[at(v)];
      const Q smooth = smoother_.apply_to(v, rv);
      z[at(v)].set(smooth);
      product += smooth * rv.vec4();
      const Q offset = motion_.offset[at(v)].vec4();
      COROTET_UNROLL
      for (std::size_t c = 0; c < 3; ++c) column[c] += offset * Q(rv[c]);
    }
    std::array<std::array<Scalar, 4>, 3> m;
    COROTET_UNROLL
    for (std::size_t c = 0; c < 3; ++c) column[c].store(m[c].data());
    std::array<Scalar, 4> sum;
    product.store(sum.data());
    load_[at(aggregate)] = detail::six_vector<Scalar>({m[0][3], m[1][3], m[2][3]},
                                                      {m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]});
    return static_cast<double>(sum[0] + sum[1] + sum[2]);
  }

  /// z += t + w x offset.
  void scatter(Index aggregate, PaddedField<Scalar>& z) const {
    using Q = detail::Vec4<Scalar>;
    const detail::SixVector<Scalar>& m = answer_[at(aggregate)];
    const auto column = [](Scalar x, Scalar y, Scalar zz) {
      const std::array<Scalar, 4> c{x, y, zz, Scalar(0)};
      return Q::load(c.data());
    };
    const Q x = column(0, m[5], -m[4]), y = column(-m[5], 0, m[3]), w = column(m[4], -m[3], 0),
            t = column(m[0], m[1], m[2]);
    for (const Index v : hierarchy().vertices_of(aggregate)) {
      const PaddedVector<Scalar>& d = motion_.offset[at(v)];
      z[at(v)].set(z[at(v)].vec4() + x * Q(d[0]) + y * Q(d[1]) + w * Q(d[2]) + t * Q(d[3]));
    }
  }

  [[nodiscard]] static detail::SixVector<Scalar> world_motion(const detail::RigidFrames<Scalar>& frames,
                                                              Index aggregate, const detail::SixVector<Scalar>& y) {
    return detail::six_vector<Scalar>(frames.translation(aggregate, y), frames.turn(aggregate, y));
  }

  /// The load on an aggregate in its own axes.
  [[nodiscard]] detail::SixVector<Scalar> in_axes_of(Index aggregate) const {
    const detail::SixVector<Scalar>& load = load_[at(aggregate)];
    return motion_.fine.to_own_axes(aggregate, load.template head<3>(), load.template tail<3>());
  }

  /// Aggregates by their own blocks, and the rigid motions of coarse aggregates on top.
  void solve_coarse(ExecutorRef executor) {
    const Hierarchy& h = hierarchy();
    for_ranges(executor, h.coarse_count(), coarse_grain, [&](Index begin, Index end) {
      for (Index c = begin; c < end; ++c) {
        Vec3<Scalar> force = Vec3<Scalar>::Zero(), torque = force;
        for (const Index a : h.fine_of(c)) {
          const Vec3<Scalar> f = load_[at(a)].template head<3>(), t = load_[at(a)].template tail<3>();
          force += f;
          torque += t + motion_.arm[at(a)].cross(f);
          answer_[at(a)] = world_motion(motion_.fine, a, own_inverse_[at(a)] * in_axes_of(a));
        }
        coarse_answer_[at(c)] = motion_.coarse.to_own_axes(c, force, torque);
      }
    });
    cholesky_.solve(coarse_answer_.front().data(), coarse_answer_.front().data());
    for_ranges(executor, h.coarse_count(), coarse_grain, [&](Index begin, Index end) {
      for (Index c = begin; c < end; ++c) {
        const detail::SixVector<Scalar> m = world_motion(motion_.coarse, c, coarse_answer_[at(c)]);
        const Vec3<Scalar> move = m.template head<3>(), turn = m.template tail<3>();
        for (const Index a : h.fine_of(c))
          answer_[at(a)] += detail::six_vector<Scalar>(move + turn.cross(motion_.arm[at(a)]), turn);
      }
    });
  }

  static constexpr Index coarse_grain = 64;  // coarse aggregates a task: some hundred fine ones

  Sizes wanted_;
  detail::Shared<Model> model_;
  detail::AggregateMotion<Scalar> motion_;
  BlockJacobi<Scalar> smoother_;
  BlockCholesky<Scalar, 6> cholesky_;
  detail::Scratch<detail::SixVector<Scalar>> load_, answer_, coarse_answer_;
  detail::Scratch<double> product_;
  detail::Buffer<Block6> own_inverse_;
  RefactorizationPolicy policy_;
};

}  // namespace corotet::inline v0_1
