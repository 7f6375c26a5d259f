// The library's small matrices against Eigen's: the same results, the same numbers in memory, and the way to and fro.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/core/types.hpp>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <concepts>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/random.hpp"

namespace corotet {
namespace {

using testing::Random;

template <class S>
class SmallMatrix : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(SmallMatrix, Scalars);

template <class S>
constexpr double epsilon = static_cast<double>(std::numeric_limits<S>::epsilon());

template <class S, int R, int C>
Matrix<S, R, C> random_matrix(Random& random, double size = 1) {
  Matrix<S, R, C> m;
  for (S& x : m) x = static_cast<S>(size * random.normal());
  return m;
}

/// No bit of a number differs, nor the place of one.
template <class S, int R, int C>
bool same(const Matrix<S, R, C>& ours, const Eigen::Matrix<S, R, C>& eigens) {
  for (int r = 0; r < R; ++r)
    for (int c = 0; c < C; ++c)
      if (ours(r, c) != eigens(r, c)) return false;
  return true;
}

/// `scale`: what rounding is relative to.
template <class S, int R, int C>
void expect_near(const Matrix<S, R, C>& ours, const Eigen::Matrix<S, R, C>& eigens, double scale, int roundings = 16) {
  for (int r = 0; r < R; ++r)
    for (int c = 0; c < C; ++c)
      EXPECT_NEAR(ours(r, c), eigens(r, c), roundings * epsilon<S> * scale) << "at " << r << ", " << c;
}

/// A hundred times for the sizes that the library computes with, and others: `body` has parameters <R, C>.
template <class Body>
void for_sizes(Body&& body) {
  body.template operator()<3, 1>();
  body.template operator()<4, 1>();
  body.template operator()<3, 3>();
  body.template operator()<6, 6>();
}

// Memory: arrays of them are arrays of numbers, with every compiler and every flag.
template <class S, int R, int C>
constexpr bool is_plain =
    sizeof(Matrix<S, R, C>) == sizeof(S[R * C]) && alignof(Matrix<S, R, C>) == alignof(S[R * C]) &&
    std::is_trivially_copyable_v<Matrix<S, R, C>> && std::is_standard_layout_v<Matrix<S, R, C>> &&
    std::is_trivially_default_constructible_v<Matrix<S, R, C>>;
static_assert(is_plain<float, 3, 1> && is_plain<float, 4, 1> && is_plain<float, 3, 3> && is_plain<float, 4, 4> &&
              is_plain<float, 6, 6> && is_plain<float, 2, 1> && is_plain<float, 3, 10>);
static_assert(is_plain<double, 3, 1> && is_plain<double, 4, 1> && is_plain<double, 3, 3> && is_plain<double, 4, 4> &&
              is_plain<double, 6, 6> && is_plain<double, 2, 1> && is_plain<double, 3, 10>);

// As the compiler computes.
static_assert(Mat3<double>::Identity().determinant() == 1 && Mat3<float>::Identity().trace() == 3);
static_assert(Vec3<double>::UnitX().cross(Vec3<double>::UnitY()) == Vec3<double>::UnitZ());
static_assert((2.0 * Mat3<double>::Identity()).inverse() == 0.5 * Mat3<double>::Identity());
static_assert(Vec3<double>(1, 2, 3).dot({4, 5, 6}) == 32 && Vec3<double>(1, 2, 3).head<2>().sum() == 3);

// What converts: matrices and expressions of the same size, and no others.
static_assert(std::convertible_to<Vec3<double>, Eigen::Vector3d> && std::convertible_to<Eigen::Vector3d, Vec3<double>>);
static_assert(std::convertible_to<Mat3<float>, Eigen::Matrix3f> && std::convertible_to<Eigen::Matrix3f, Mat3<float>>);
static_assert(std::convertible_to<decltype(Eigen::Vector3d() + Eigen::Vector3d()), Vec3<double>>);
static_assert(!std::convertible_to<Eigen::Vector2d, Vec3<double>> &&
              !std::convertible_to<Vec3<double>, Eigen::Vector4d>);
static_assert(!std::convertible_to<Eigen::RowVector3d, Vec3<double>> &&
              !std::convertible_to<Eigen::VectorXd, Vec3<double>>);
static_assert(!std::convertible_to<Vec3<float>, Vec3<double>> && !std::convertible_to<Vec3<double>, Vec3<float>>);
static_assert(!std::convertible_to<Vec3<float>, Eigen::Vector3d> && !std::convertible_to<double, Vec3<double>>);

TYPED_TEST(SmallMatrix, LiesInMemoryByColumns) {
  using S = TypeParam;
  for_sizes([]<int R, int C>() {
    Random random(1);
    const auto m = random_matrix<S, R, C>(random);
    const Eigen::Matrix<S, R, C> e = m;
    std::array<S, std::size_t{R} * C> ours, eigens;
    std::memcpy(ours.data(), &m, sizeof m);
    for (int c = 0; c < C; ++c)
      for (int r = 0; r < R; ++r) eigens[at(c * R + r)] = e(r, c);
    EXPECT_EQ(ours, eigens);
    EXPECT_EQ((Matrix<S, R, C>::load(ours.data())), m);
    for (int i = 0; i < R * C; ++i) {
      EXPECT_EQ(m[i], ours[at(i)]);
      EXPECT_EQ(m(std::size_t(i)), ours[at(i)]);
      EXPECT_EQ(m.data()[i], ours[at(i)]);
    }
    EXPECT_TRUE(std::equal(m.begin(), m.end(), ours.begin(), ours.end()));
  });
}

TYPED_TEST(SmallMatrix, ConvertsToEigensAndBack) {
  using S = TypeParam;
  for_sizes([]<int R, int C>() {
    using Ours = Matrix<S, R, C>;
    using Eigens = Eigen::Matrix<S, R, C>;
    Random random(2);
    const Ours m = random_matrix<S, R, C>(random), n = random_matrix<S, R, C>(random);
    const Eigens e = m, f = n;
    EXPECT_TRUE(same(m, e));
    const Ours back = e;
    EXPECT_EQ(back, m);
    const auto round_trip = [](const Ours& x) -> Eigens { return x; };
    EXPECT_TRUE(same(m, round_trip(e)));  // to an argument, and from what is returned
    Ours assigned;
    assigned = e;
    EXPECT_EQ(assigned, m);
    Eigens eigens_assigned;
    eigens_assigned = m;
    EXPECT_EQ(eigens_assigned, e);
    // Expressions.
    const Ours sum = e + f, scaled = S(3) * e, product = e.cwiseProduct(f), negative = -e,
               absolute = e.array().abs().matrix();
    EXPECT_EQ(sum, m + n);
    EXPECT_EQ(scaled, S(3) * m);
    EXPECT_EQ(product, m.cwiseProduct(n));
    EXPECT_EQ(negative, -m);
    EXPECT_EQ(absolute, m.cwiseAbs());
    const Matrix<S, C, R> transposed = e.transpose();
    EXPECT_EQ(transposed, m.transpose());
    const Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> large = Eigen::Matrix<S, 20, 20>::Random();
    const Ours block = large.template block<R, C>(4, 5);
    EXPECT_TRUE(same(block, Eigens(large.template block<R, C>(4, 5))));
    const Ours mapped = Eigen::Map<const Eigens>(m.data());
    EXPECT_EQ(mapped, m);
    if constexpr (R > 1 && C > 1) {
      const Eigen::Matrix<S, R, C, Eigen::RowMajor> by_rows = e;
      const Ours from_rows = by_rows;
      EXPECT_EQ(from_rows, m);
      const Eigen::Matrix<S, R, C, Eigen::RowMajor> to_rows = m;
      EXPECT_EQ(to_rows, by_rows);
    }
  });
  // In the middle of an expression.
  const Vec3<S> v(1, 2, 3);
  const Eigen::Matrix<S, 3, 3> twice = 2 * Eigen::Matrix<S, 3, 3>::Identity();
  const Vec3<S> doubled = v + Vec3<S>(twice * as_eigen(v));
  EXPECT_EQ(doubled, (Vec3<S>(3, 6, 9)));
  const Vec3<S> added = v + Eigen::Matrix<S, 3, 1>(1, 1, 1);
  EXPECT_EQ(added, (Vec3<S>(2, 3, 4)));
}

TYPED_TEST(SmallMatrix, IsSeenByEigenWhereItIs) {
  using S = TypeParam;
  Random random(3);
  Mat3<S> m = random_matrix<S, 3, 3>(random);
  const Mat3<S> before = m;
  EXPECT_TRUE(same(before, Eigen::Matrix<S, 3, 3>(as_eigen(before))));
  as_eigen(m).row(1) *= S(2);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(m(r, c), before(r, c) * S(r == 1 ? 2 : 1));
  std::array<S, 20> numbers{};
  const detail::MatrixView<S, 3, 3> view(numbers.data() + 5);
  view = before;
  as_eigen(view)(2, 0) = 7;
  EXPECT_EQ(numbers[7], S(7));
  EXPECT_EQ(numbers[4], 0);
  EXPECT_EQ(numbers[14], 0);
  Field<S> field{{1, 2, 3}, {4, 5, 6}};
  flat(field)[4] = 9;
  EXPECT_EQ(field[1], (Vec3<S>(4, 9, 6)));
  EXPECT_EQ(flat(std::as_const(field)).size(), 6);
  const Field<S> nothing;
  EXPECT_EQ(flat(nothing).size(), 0);
}

TYPED_TEST(SmallMatrix, AddsAndScalesAsEigenDoes) {
  using S = TypeParam;
  for_sizes([]<int R, int C>() {
    using Eigens = Eigen::Matrix<S, R, C>;
    Random random(4);
    for (int trial = 0; trial < 100; ++trial) {
      const auto m = random_matrix<S, R, C>(random), n = random_matrix<S, R, C>(random);
      const Eigens e = m, f = n;
      const auto s = static_cast<S>(random.normal());
      EXPECT_TRUE(same(m + n, Eigens(e + f)));
      EXPECT_TRUE(same(m - n, Eigens(e - f)));
      EXPECT_TRUE(same(-m, Eigens(-e)));
      EXPECT_TRUE(same(s * m, Eigens(s * e)));
      EXPECT_TRUE(same(m * s, Eigens(e * s)));
      expect_near(m / s, Eigens(e / s), double(m.norm()) / std::abs(double(s)), 1);
      auto changed = m;
      Eigens eigens_changed = e;
      changed += n;
      eigens_changed += f;
      EXPECT_TRUE(same(changed, eigens_changed));
      changed -= s * n;
      eigens_changed -= (s * f).eval();
      expect_near(changed, eigens_changed, 1 + double(m.norm() + n.norm()) * (1 + std::abs(double(s))), 1);
      changed = m;
      changed *= s;
      EXPECT_EQ(changed, m * s);
      changed = m;
      changed /= s;
      EXPECT_EQ(changed, m / s);
      EXPECT_TRUE(same(m.cwiseMin(n), Eigens(e.cwiseMin(f))));
      EXPECT_TRUE(same(m.cwiseMax(n), Eigens(e.cwiseMax(f))));
      EXPECT_TRUE(same(m.cwiseMax(s), Eigens(e.cwiseMax(s))));
      EXPECT_TRUE(same(m.cwiseProduct(n), Eigens(e.cwiseProduct(f))));
      EXPECT_TRUE(same(m.cwiseAbs(), Eigens(e.cwiseAbs())));
      EXPECT_TRUE(m == m && !(m == n) && m != n);
    }
  });
}

TYPED_TEST(SmallMatrix, MultipliesAsEigenDoes) {
  using S = TypeParam;
  const auto compare = []<int R, int K, int C>() {
    Random random(5);
    for (int trial = 0; trial < 100; ++trial) {
      const auto m = random_matrix<S, R, K>(random);
      const auto n = random_matrix<S, K, C>(random);
      const Eigen::Matrix<S, R, K> e = m;
      const Eigen::Matrix<S, K, C> f = n;
      expect_near(m * n, Eigen::Matrix<S, R, C>(e * f), double(m.norm() * n.norm()), 4);
    }
  };
  compare.template operator()<3, 3, 3>();
  compare.template operator()<3, 3, 1>();
  compare.template operator()<3, 1, 3>();
  compare.template operator()<6, 6, 6>();
  compare.template operator()<6, 6, 1>();
  compare.template operator()<2, 5, 3>();
  // What is assigned to may be read.
  Random random(6);
  const auto a = random_matrix<S, 3, 3>(random), b = random_matrix<S, 3, 3>(random);
  auto m = a;
  m = b * m;
  EXPECT_EQ(m, b * a);
  m = a;
  m *= m;
  EXPECT_EQ(m, a * a);
  m = a.transpose();
  m = m.transpose();
  EXPECT_EQ(m, a);
}

TYPED_TEST(SmallMatrix, SumsAndComparesAsEigenDoes) {
  using S = TypeParam;
  for_sizes([]<int R, int C>() {
    Random random(7);
    for (int trial = 0; trial < 100; ++trial) {
      const auto m = random_matrix<S, R, C>(random), n = random_matrix<S, R, C>(random);
      const Eigen::Matrix<S, R, C> e = m, f = n;
      const double bound = 4 * R * C * epsilon<S>, size = double(m.norm());
      EXPECT_NEAR(m.sum(), e.sum(), bound * size);
      EXPECT_NEAR(m.dot(n), (e.cwiseProduct(f)).sum(), bound * size * double(n.norm()));
      EXPECT_NEAR(m.squaredNorm(), e.squaredNorm(), bound * size * size);
      EXPECT_NEAR(m.norm(), e.norm(), bound * size);
      EXPECT_NEAR(m.stableNorm(), (Eigen::Map<const Eigen::Matrix<S, R * C, 1>>(m.data()).stableNorm()), bound * size);
      EXPECT_EQ(m.minCoeff(), e.minCoeff());
      EXPECT_EQ(m.maxCoeff(), e.maxCoeff());
      EXPECT_EQ(m[m.index_of_max()], e.maxCoeff());
      expect_near(m.normalized(), Eigen::Matrix<S, R, C>(e.normalized()), 1, 4);
      expect_near(m.stableNormalized(), Eigen::Matrix<S, R, C>(e.stableNormalized()), 1, 4);
      auto changed = m;
      changed.normalize();
      EXPECT_EQ(changed, m.normalized());
      if constexpr (R == C) {
        EXPECT_NEAR(m.trace(), e.trace(), bound * size);
        EXPECT_TRUE(same(m.diagonal(), Eigen::Matrix<S, R, 1>(e.diagonal())));
      }
    }
  });
  EXPECT_EQ((Vec3<S>(1, 5, 5).index_of_max()), 1);  // the first of equals
}

TYPED_TEST(SmallMatrix, HasEigensParts) {
  using S = TypeParam;
  Random random(8);
  const auto m = random_matrix<S, 6, 6>(random);
  const Eigen::Matrix<S, 6, 6> e = m;
  for (int i = 0; i < 6; ++i) {
    EXPECT_TRUE(same(m.col(i), Eigen::Matrix<S, 6, 1>(e.col(i))));
    EXPECT_TRUE(same(m.row(i), Eigen::Matrix<S, 1, 6>(e.row(i))));
  }
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 3; ++c) {
      EXPECT_TRUE(same(m.template block<3, 4>(r, c), Eigen::Matrix<S, 3, 4>(e.template block<3, 4>(r, c))));
      const auto part = random_matrix<S, 3, 4>(random);
      auto changed = m;
      Eigen::Matrix<S, 6, 6> eigens_changed = e;
      changed.set_block(r, c, part);
      eigens_changed.template block<3, 4>(r, c) = as_eigen(part);
      EXPECT_TRUE(same(changed, eigens_changed));
      const auto column = random_matrix<S, 6, 1>(random);
      changed.set_col(r, column);
      eigens_changed.col(r) = as_eigen(column);
      EXPECT_TRUE(same(changed, eigens_changed));
      changed.set_row(c, column.transpose());
      eigens_changed.row(c) = as_eigen(column).transpose();
      EXPECT_TRUE(same(changed, eigens_changed));
    }
  const Matrix<S, 6, 1> v = m.col(2);
  const Eigen::Matrix<S, 6, 1> w = v;
  EXPECT_TRUE(same(v.template head<2>(), Eigen::Matrix<S, 2, 1>(w.template head<2>())));
  EXPECT_TRUE(same(v.template tail<4>(), Eigen::Matrix<S, 4, 1>(w.template tail<4>())));
  const Matrix<S, 4, 1> q(1, 2, 3, 4);
  EXPECT_TRUE(q.x() == 1 && q.y() == 2 && q.z() == 3 && q.w() == 4);
}

TYPED_TEST(SmallMatrix, HasEigensConstants) {
  using S = TypeParam;
  for_sizes([]<int R, int C>() {
    using Ours = Matrix<S, R, C>;
    using Eigens = Eigen::Matrix<S, R, C>;
    EXPECT_TRUE(same(Ours::Zero(), Eigens(Eigens::Zero())));
    EXPECT_TRUE(same(Ours::Ones(), Eigens(Eigens::Ones())));
    EXPECT_TRUE(same(Ours::Constant(S(0.5)), Eigens(Eigens::Constant(S(0.5)))));
    EXPECT_TRUE(same(Ours::Identity(), Eigens(Eigens::Identity())));
    EXPECT_TRUE(Ours::Zero().isZero() && !Ours::Ones().isZero());
    auto m = Ours::Ones();
    m.setZero();
    EXPECT_EQ(m, Ours::Zero());
    EXPECT_EQ(Ours::rows(), R);
    EXPECT_EQ(Ours::cols(), C);
    EXPECT_EQ(Ours::size(), R * C);
  });
  EXPECT_EQ(Vec3<S>::UnitX(), (Vec3<S>(1, 0, 0)));
  EXPECT_EQ(Vec3<S>::UnitY(), (Vec3<S>(0, 1, 0)));
  EXPECT_EQ(Vec3<S>::UnitZ(), (Vec3<S>(0, 0, 1)));
}

TYPED_TEST(SmallMatrix, CrossProductsAndDeterminantsAreEigens) {
  using S = TypeParam;
  Random random(9);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto a = random_matrix<S, 3, 1>(random), b = random_matrix<S, 3, 1>(random);
    const Eigen::Matrix<S, 3, 1> e = a, f = b;
    expect_near(a.cross(b), Eigen::Matrix<S, 3, 1>(e.cross(f)), double(a.norm() * b.norm()), 2);
    const auto m = random_matrix<S, 3, 3>(random, std::pow(10.0, random.uniform(-3, 3)));
    const Eigen::Matrix<S, 3, 3> n = m;
    EXPECT_NEAR(m.determinant(), n.determinant(), 8 * epsilon<S> * std::pow(double(m.norm()), 3));
  }
}

/// Both are off by what the condition makes of rounding; of a rotation, of a matrix that is nearly flat, and scaled.
TYPED_TEST(SmallMatrix, InversesAreEigens) {
  using S = TypeParam;
  Random random(10);
  for (int trial = 0; trial < 1000; ++trial) {
    Mat3<S> m = trial % 3 == 0 ? random.rotation().template cast<S>() : random_matrix<S, 3, 3>(random);
    if (trial % 3 == 1) m.set_col(2, m.col(0) + S(0.01) * m.col(2));
    m *= static_cast<S>(std::pow(10.0, random.uniform(-6, 6)));
    const Mat3<S> inverse = m.inverse();
    const Eigen::Matrix<S, 3, 3> eigens = Eigen::Matrix<S, 3, 3>(m).inverse();
    const double condition = as_eigen(m).template cast<double>().norm() * eigens.template cast<double>().norm();
    expect_near(inverse, eigens, condition * double(inverse.norm()), 8);
    EXPECT_LT((m * inverse - Mat3<S>::Identity()).norm(), 16 * epsilon<S> * condition);
  }
  EXPECT_EQ(Mat3<S>::Identity().inverse(), Mat3<S>::Identity());
}

/// Where squares leave the range of the type.
TYPED_TEST(SmallMatrix, StableNormsOfHugeAndTinyNumbersAreEigens) {
  using S = TypeParam;
  using Limits = std::numeric_limits<S>;
  Random random(11);
  const int most = Limits::max_exponent - 4, least = Limits::min_exponent + Limits::digits;
  for (const int exponent : {most, most - 10, most / 2 + 3, 0, least / 2 - 3, least + 3, least})
    for (int trial = 0; trial < 100; ++trial) {
      Vec3<S> v(static_cast<S>(random.uniform(-1, 1)), static_cast<S>(random.uniform(-1, 1)),
                static_cast<S>(random.uniform(-1, 1)));
      const Vec3<S> direction = v.normalized();
      v *= std::ldexp(S(1), exponent);
      const S expected = Eigen::Matrix<S, 3, 1>(v).stableNorm();
      ASSERT_TRUE(std::isfinite(expected) && expected > 0);
      EXPECT_NEAR(v.stableNorm() / expected, 1, 4 * epsilon<S>) << "times 2^" << exponent;
      EXPECT_LT((v.stableNormalized() - direction).norm(), 8 * epsilon<S>) << "times 2^" << exponent;
    }
  EXPECT_EQ((Vec3<S>(0, Limits::denorm_min(), 0).stableNorm()), Limits::denorm_min());
  EXPECT_EQ((Vec3<S>(0, 0, -Limits::max()).stableNorm()), Limits::max());
  EXPECT_EQ((Vec3<S>(0, 0, Limits::denorm_min()).stableNormalized()), Vec3<S>::UnitZ());
  EXPECT_EQ((Vec3<S>(Limits::max(), 0, 0).stableNormalized()), Vec3<S>::UnitX());
  EXPECT_EQ(Vec3<S>::Zero().stableNorm(), 0);
  for (int i = 0; i < 3; ++i) {
    Vec3<S> v(1, -2, 3);
    v[i] = -Limits::infinity();
    EXPECT_EQ(v.stableNorm(), Limits::infinity());
    EXPECT_FALSE(v.allFinite());
    v[i] = Limits::quiet_NaN();
    EXPECT_TRUE(std::isnan(v.stableNorm()));
    EXPECT_FALSE(v.allFinite());
    v[i] = Limits::max();
    EXPECT_TRUE(v.allFinite());
  }
}

TYPED_TEST(SmallMatrix, ZeroNormalizedStaysZero) {
  using S = TypeParam;
  for_sizes([]<int R, int C>() {
    auto zero = Matrix<S, R, C>::Zero();
    EXPECT_EQ(zero.normalized(), zero);
    EXPECT_EQ(zero.stableNormalized(), zero);
    zero.normalize();
    EXPECT_EQ(zero, (Matrix<S, R, C>::Zero()));
  });
}

TYPED_TEST(SmallMatrix, UnitOrthogonalIsOfLengthOneAndPerpendicular) {
  using S = TypeParam;
  Random random(12);
  const auto expect_perpendicular = [](const Vec3<S>& v) {
    const Vec3<S> p = v.unitOrthogonal();
    EXPECT_NEAR(p.norm(), 1, 4 * epsilon<S>);
    EXPECT_NEAR(p.dot(v) / v.norm(), 0, 4 * epsilon<S>);
  };
  for (int trial = 0; trial < 1000; ++trial)
    expect_perpendicular(random_matrix<S, 3, 1>(random, std::pow(10.0, random.uniform(-6, 6))));
  for (const S x : {S(-1), S(0), S(1), S(1e-6)})
    for (const S y : {S(-1), S(0), S(1), S(1e-6)})
      for (const S z : {S(-1), S(0), S(1), S(1e-6)})
        if (x != 0 || y != 0 || z != 0) expect_perpendicular({x, y, z});
}

TYPED_TEST(SmallMatrix, CastsAsEigenDoes) {
  using S = TypeParam;
  using Other = std::conditional_t<std::same_as<S, float>, double, float>;
  for_sizes([]<int R, int C>() {
    Random random(13);
    const auto m = random_matrix<S, R, C>(random, 1e3);
    EXPECT_TRUE(same(m.template cast<Other>(), Eigen::Matrix<Other, R, C>(as_eigen(m).template cast<Other>())));
    EXPECT_EQ(m.template cast<S>(), m);
    if constexpr (std::same_as<S, float>) {
      EXPECT_EQ(m.template cast<double>().template cast<float>(), m);
    }
  });
}

TYPED_TEST(SmallMatrix, ViewsWriteWhereTheyLook) {
  using S = TypeParam;
  Random random(14);
  std::vector<S> numbers(30, S(-1));
  const detail::MatrixView<S, 3, 3> view(numbers.data() + 6), other(numbers.data() + 18);
  const auto m = random_matrix<S, 3, 3>(random), n = random_matrix<S, 3, 3>(random);
  view = m;
  EXPECT_EQ(view.value(), m);
  EXPECT_EQ(numbers[5], S(-1));
  EXPECT_EQ(numbers[15], S(-1));
  EXPECT_EQ(view.transpose(), m.transpose());
  view += n;
  EXPECT_EQ(view.value(), m + n);
  view -= n;
  EXPECT_EQ(view.value(), m + n - n);
  view(1, 2) = 4;
  EXPECT_EQ(numbers[6 + 7], S(4));
  detail::MatrixView<S, 3, 3> copy(other);
  copy = view;  // the numbers, not where it looks
  EXPECT_EQ(other.value(), view.value());
  const Mat3<S> as_value = view;
  EXPECT_EQ(as_value, view.value());
  view.setZero();
  EXPECT_EQ(view.value(), Mat3<S>::Zero());
  EXPECT_EQ(copy.value(), as_value);
}

}  // namespace
}  // namespace corotet
