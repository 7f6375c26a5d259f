// Sparse Cholesky factorisation by small blocks: for direct solutions of small bodies, and inside preconditioners.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/shared.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/block_substitution.hpp>
#include <corotet/detail/solve/compensated_column.hpp>
#include <corotet/detail/solve/small_cholesky.hpp>
#include <corotet/detail/solve/symbolic_factor.hpp>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

namespace corotet::inline v0_1 {

/// A = P^T L L^T P with a fill-reducing permutation of the vertices (MinimumDegree). L is made in double and kept in
/// Scalar: the factor of a stiff body needs double, and one that was rounded afterwards is still symmetric and positive
/// definite, with half the memory to read. The numbers of L are the only memory of any size that a copy owns; its
/// pattern is shared. Nothing allocates but `analyze`. Left-looking by columns, after Davis 2006, "Direct Methods for
/// Sparse Linear Systems", section 4.8.
///
/// `begin`, the values of A by `entry`, `factorize`, then any number of `solve`. A compact one, of blocks of 3x3 in
/// float, keeps L in float while it is made, too, and takes A as `factorize(pattern, entry)` asks for it: half the
/// memory for the same factor, in half as much time again (detail::CompensatedColumn).
template <std::floating_point Scalar, int B = 3>
class BlockCholesky {
 public:
  using Block = Matrix<double, B, B>;  ///< of the matrix, in double
  /// Of a segment: B numbers and zeros.
  static constexpr std::size_t width = detail::BlockSubstitution<Scalar, B>::width;

  BlockCholesky() = default;
  /// Copies share the symbolic part.
  BlockCholesky(const BlockCholesky& other)
      : symbolic_(other.symbolic_),
        value_(other.copy_of_values()),
        segment_(other.segment_),
        work_(other.work_),
        has_factor_(other.has_factor_) {}
  BlockCholesky(BlockCholesky&&) noexcept = default;
  /// Copies share the symbolic part.
  BlockCholesky& operator=(const BlockCholesky& other) {
    if (this != &other) *this = BlockCholesky(other);
    return *this;
  }
  BlockCholesky& operator=(BlockCholesky&&) noexcept = default;
  ~BlockCholesky() = default;

  /// Ordering, pattern of L, and memory for L, if it fits.
  COROTET_COLD void analyze(const BlockPattern& pattern) {
    analyze(detail::Shared<detail::SymbolicFactor>::make(pattern));
  }
  /// The same with a symbolic factor that others hold as well. `compact`: only where `can_be_compact`.
  COROTET_COLD void analyze(detail::Shared<detail::SymbolicFactor> symbolic, bool compact = false) {
    *this = {};
    symbolic_ = std::move(symbolic);
    if (!symbolic_->fits()) return;
    value_ = detail::Buffer<double>(compact ? (numbers() * sizeof(Scalar) - 1) / sizeof(double) + 1 : numbers());
    segment_ = detail::Scratch<Scalar>(at(rows()) * width);
    const std::size_t column = compact ? detail::CompensatedColumn<Scalar>::bytes_for(symbolic_->max_column()) : 0;
    work_ = detail::Scratch<std::byte>(index_bytes() + column);
  }

  /// False before `analyze`, and for a factor that cannot be indexed: then nothing below may be called.
  [[nodiscard]] bool is_ready() const { return !value_.empty(); }

  /// Rows of blocks of the matrix.
  [[nodiscard]] Index rows() const { return symbolic_->rows(); }
  /// Pattern and order of the factor.
  [[nodiscard]] const detail::SymbolicFactor& symbolic() const { return *symbolic_; }

  /// Multiplications and additions of one factorisation: c^2/2 block products of 2 B^3 operations a column of c.
  [[nodiscard]] double factor_flops() const { return 1.0 * B * B * B * symbolic_->squares; }

  /// Sets A to zero, and forgets the factor.
  void begin() {
    COROTET_ASSERT(value_.size() == numbers(),
                   "a compact factor takes its matrix block by block: factorize(pattern, entry)");
    has_factor_ = false;
    std::memset(value_.data(), 0, value_.size() * sizeof(double));
  }

  /// Whether A takes the block in this slot of its pattern: the others follow by symmetry.
  [[nodiscard]] bool takes(Index slot) const { return symbolic_->position[at(slot)] >= 0; }

  /// That block. Between `begin` and `factorize`; different slots by different threads at the same time, if need be.
  [[nodiscard]] detail::MatrixView<double, B, B> entry(Index slot) { return block(symbolic_->position[at(slot)]); }

  /// False if a pivot is not positive definite to rounding: then there is no factor.
  bool factorize() {
    const Index n = rows();
    Index *const first = static_cast<Index*>(static_cast<void*>(work_.data())), *const next = first + n,
                 *const done = next + n, *const place = done + n;
    for (Index k = 0; k < n; ++k) first[k] = -1;
    for (Index k = 0; k < n; ++k) {
      const Index begin = start(k), end = start(k + 1);
      for (Index p = begin; p < end; ++p) place[symbolic_->row[at(p)]] = p;
      // Columns whose next block is in row k: they have done their part in all columns before.
      for (Index j = first[k]; j >= 0;) {
        const Index from = done[j], left = start(j + 1) - from, other = next[j];
        Index following = other, other_from = -1;
        if (B == 3 && other >= 0 && are_alike(j, other, left, start(other + 1) - done[other])) {
          other_from = done[other];
          following = next[other];
          wait(other, other_from + 1, first, next, done);
        }
        subtract_columns(from, other_from, left, place);
        wait(j, from + 1, first, next, done);
        j = following;
      }
      Block inverse;
      if (!detail::inverse_cholesky(block(begin).value(), inverse)) return false;
      block(begin) = inverse;
      for (Index p = begin + 1; p < end; ++p) block(p) = block(p).value() * inverse.transpose();
      wait(k, begin + 1, first, next, done);
    }
    round_in_place();
    has_factor_ = true;
    return true;
  }

  /// The factor of a matrix on the pattern that was analysed.
  template <std::floating_point Other>
  bool factorize(const BlockMatrix<Other, B>& matrix) {
    begin();
    for (Index k = 0; k < matrix.pattern().blocks(); ++k)
      if (takes(k)) entry(k) = matrix.block(k).template cast<double>();
    return factorize();
  }

  /// Whether there is a compact factor of this kind.
  static constexpr bool can_be_compact = B == 3 && std::same_as<Scalar, float>;

  /// The compact factor of a symmetric matrix on the pattern that was analysed; `entry(i, slot)` returns its block in
  /// slot `slot` of row i, in double. False if a pivot is not positive definite to rounding.
  template <std::invocable<Index, Index> Entry>
    requires can_be_compact
  bool factorize(const BlockPattern& pattern, const Entry& entry) {
    COROTET_ASSERT(value_.size() < numbers(), "analyze this factor as a compact one");
    has_factor_ = false;
    std::memset(value_.data(), 0, value_.size() * sizeof(double));
    Scalar* const all = reinterpret_cast<Scalar*>(value_.data());
    const Index n = rows();
    const Index* const row = symbolic_->row.data();
    Index *const first = static_cast<Index*>(static_cast<void*>(work_.data())), *const next = first + n,
                 *const done = next + n, *const place = done + n;
    detail::CompensatedColumn<Scalar> made(work_.data() + index_bytes(), symbolic_->max_column());
    for (Index k = 0; k < n; ++k) first[k] = -1;
    for (Index k = 0; k < n; ++k) {
      const Index begin = start(k), count = start(k + 1) - begin, i = symbolic_->order[at(k)];
      Scalar* const own = all + block_size * at(begin);
      for (Index p = 0; p < count; ++p) place[row[begin + p]] = p;
      made.begin(own, at(count));
      for (Index slot = pattern.row_start[at(i)]; slot < pattern.row_start[at(i) + 1]; ++slot)
        if (const Index j = symbolic_->place[at(pattern.column[at(slot)])]; j >= k)
          made.add(place[j], entry(i, slot).transpose());
      for (Index j = first[k]; j >= 0;) {
        const Index from = done[j], following = next[j];
        made.subtract(values(from), row + from, start(j + 1) - from, place);
        wait(j, from + 1, first, next, done);
        j = following;
      }
      if (!made.finish(at(count), own)) return false;
      made.compensate(own, row + begin, at(count), *symbolic_, all);
      wait(k, begin + 1, first, next, done);
    }
    has_factor_ = true;
    return true;
  }

  /// Whether the last factorisation succeeded.
  [[nodiscard]] bool has_factor() const { return has_factor_; }

  /// x = A^-1 b; both are rows() times B numbers, and may be the same. There must be a factor, here and below.
  void solve(const Scalar* b, Scalar* x) {
    const Index n = rows();
    for (Index k = 0; k < n; ++k)
      for (std::size_t c = 0; c < width; ++c)
        segment(k)[c] = c < std::size_t{B} ? b[at(symbolic_->order[at(k)]) * B + c] : Scalar(0);
    solve_segments();
    for (Index k = 0; k < n; ++k)
      for (std::size_t c = 0; c < std::size_t{B}; ++c) x[at(symbolic_->order[at(k)]) * B + c] = segment(k)[c];
  }
  /// Solves A x = b with the factor; b and x may be the same.
  void solve(const Field<Scalar>& b, Field<Scalar>& x)
    requires(B == 3)
  {
    solve(b.front().data(), x.front().data());
  }

  /// The B numbers of row symbolic().order[k] with zeros behind them: the right side before `solve_segments`. After it
  /// the solution, with any numbers behind it.
  [[nodiscard]] Scalar* segment(Index k) { return segment_.data() + at(k) * width; }
  /// Solves with the right side that the segments hold, which then hold the solution.
  void solve_segments() { Substitution{*symbolic_, values(0), segment_.data()}.solve(); }

  /// The factor, if there is one.
  COROTET_COLD void visit_state(detail::StateArchive& archive) {
    const std::size_t count = archive.some(reinterpret_cast<Scalar*>(value_.data()), has_factor_ ? numbers() : 0);
    if (archive.reads()) has_factor_ = count > 0;
  }

  /// Bytes of its own, and those that copies share.
  [[nodiscard]] MemoryUse memory() const {
    return {detail::bytes_of(value_) + detail::bytes_of(segment_) + detail::bytes_of(work_),
            symbolic_ ? symbolic_->bytes() : 0};
  }

 private:
  static constexpr std::size_t block_size = std::size_t{B} * B;
  static constexpr std::size_t padding = width;  // numbers that are read behind the last block
  using Substitution = detail::BlockSubstitution<Scalar, B>;

  [[nodiscard]] detail::Buffer<double> copy_of_values() const {
    detail::Buffer<double> copy = value_.without_values();
    if (has_factor_) std::memcpy(copy.data(), value_.data(), numbers() * sizeof(Scalar));
    return copy;
  }

  /// In Scalar, with those that are read behind the last block.
  [[nodiscard]] std::size_t index_bytes() const { return std::size_t{4} * sizeof(Index) * at(rows()); }
  [[nodiscard]] std::size_t numbers() const { return block_size * symbolic_->blocks + padding; }

  [[nodiscard]] Index start(Index column) const { return symbolic_->column_start[at(column)]; }

  // Of L, while it is made, and of A before. On the diagonal: at the end, the inverse of L_jj.
  [[nodiscard]] detail::MatrixView<double, B, B> block(Index p) {
    return detail::MatrixView<double, B, B>(value_.data() + block_size * at(p));
  }

  /// Column j waits for the column in whose row its block p is.
  void wait(Index j, Index p, Index* first, Index* next, Index* done) const {
    if (p == start(j + 1)) return;
    const Index row = symbolic_->row[at(p)];
    done[j] = p;
    next[j] = first[row];
    first[row] = j;
  }

  /// Whether two columns of which so many blocks are left have them in the same rows: one is the parent of the other,
  /// whose rows it has all.
  [[nodiscard]] bool are_alike(Index i, Index j, Index left_of_i, Index left_of_j) const {
    if (left_of_i != left_of_j || (i - j != 1 && j - i != 1)) return false;
    const Index child = i < j ? i : j;
    return symbolic_->row[at(start(child)) + 1] == child + 1;
  }

  /// L_ik -= L_ij L_kj^T for the `count` blocks of a column j from `from` on, the first of which is L_kj; and the same
  /// for a second column with blocks in the same rows, from `second` on if that is not -1, for B = 3. `place`: of row i
  /// in column k.
  void subtract_columns(Index from, Index second, Index count, const Index* place) {
    const Index* const row = symbolic_->row.data() + from;
    const Block factor = block(from).transpose();
    if constexpr (B == 3) {
      const bool two = second >= 0;
      const Block second_factor = two ? block(second).transpose() : Block::Zero();
      for (Index p = 0; p < count; ++p) {
        double* const target = value_.data() + block_size * at(place[row[p]]);
        std::array<Column, 3> sum{Column::load(target), Column::load(target + 3), Column::load(target + 6)};
        subtract_product(from + p, factor, sum);
        if (two) subtract_product(second + p, second_factor, sum);
        sum[0].store(target);  // and one number more, which the next store corrects
        sum[1].store(target + 3);
        sum[2].template store_part<3>(target + 6);
      }
    } else {
      for (Index p = 0; p < count; ++p) block(place[row[p]]) -= block(from + p).value() * factor;
    }
  }

  using Column = detail::SimdVec<double, 4>;  // of a 3x3 block, and one number more
  COROTET_ALWAYS_INLINE void subtract_product(Index p, const Block& factor, std::array<Column, 3>& sum) const {
    const double* const source = value_.data() + block_size * at(p);
    COROTET_UNROLL
    for (int r = 0; r < 3; ++r) {
      const Column column = Column::load(source + 3 * r);
      COROTET_UNROLL
      for (int c = 0; c < 3; ++c) sum[at(c)] -= column * Column(factor(r, c));
    }
  }

  /// The numbers of L in Scalar, in the memory that they have in double.
  void round_in_place() {
    if constexpr (!std::is_same_v<Scalar, double>) {
      auto* const bytes = reinterpret_cast<unsigned char*>(value_.data());
      for (std::size_t i = 0; i < value_.size(); ++i) {
        const auto rounded = static_cast<Scalar>(value_[i]);
        std::memcpy(bytes + i * sizeof(Scalar), &rounded, sizeof(Scalar));  // before the doubles that are still there
      }
    }
  }
  [[nodiscard]] const Scalar* values(Index p) const {
    return reinterpret_cast<const Scalar*>(value_.data()) + block_size * at(p);
  }

  detail::Shared<detail::SymbolicFactor> symbolic_;
  detail::Buffer<double> value_;
  detail::Scratch<Scalar> segment_;
  detail::Scratch<std::byte> work_;  // of factorize: four Index a row, and of a compact factor a column
  bool has_factor_ = false;
};

}  // namespace corotet::inline v0_1
