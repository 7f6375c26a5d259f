// What the warped stiffness leaves out of the exact tangent: the stress turns with the element.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/eigen_lanes.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace corotet::inline v0_1 {

/// The matrix in which a step's elastic force is linearised. All three give the same motion once Newton's iteration has
/// converged; with one solve a step they differ.
enum class Tangent : std::uint8_t {
  /// The warped stiffness R K_e R^T (Müller & Gross 2004): semi-definite, keeps the spin of a free body. One solve a
  /// step keeps vibrating in a body that is held stretched to about three times its length.
  warped,
  /// Adds to each twist mode what its stiffness exceeds mu/2 by, or less in steps that are longer than sound takes
  /// through the body's thickness: nothing in ordinary scenes, and rest for a body that is held stretched or hangs.
  stabilized,
  /// Adds all of each twist mode: the Hessian of the energy, with which Newton's iteration converges quadratically.
  /// Where that makes a step's matrix indefinite, the step goes on with the modes' positive parts alone, each point's
  /// part of the Hessian projected to semi-definite (Teran et al. 2005; on demand: Longva et al. 2023, "Pitfalls of
  /// projection"). One solve a step of it damps spin.
  consistent
};

/// As in a scene file.
[[nodiscard]] constexpr std::string_view name_of(Tangent tangent) {
  return tangent == Tangent::warped ? "plain" : tangent == Tangent::consistent ? "exact" : "stretch_stable";
}

namespace detail {

/// The twist modes of one state of a body, as the tangent wants them: docs/theory.md, equations 7 and 8. They are what
/// the Hessian of the energy has besides the warped stiffness (Smith, de Goes & Kim 2019, "Analytic eigensystems for
/// isotropic distortion energies", section 5, for energies in the invariants of S).
///
/// The class keeps the symmetric matrix H = sum kappa_k (R n_k)(R n_k)^T / 2 mu of each quadrature point. Block (a, b)
/// of an element is mu V [g_a]x H [g_b]x^T with g = R grad N.
template <std::floating_point Scalar>
class TwistModes {
 public:
  using SymmetricLanes = std::array<Lanes<Scalar>, 6>;  ///< xx yy zz yz zx xy

  TwistModes() = default;

  /// Memory for a body. Plain: none.
  TwistModes(Tangent tangent, std::size_t batches, std::size_t points)
      : tangent_(tangent),
        projects_(tangent == Tangent::stabilized),
        batches_(tangent == Tangent::warped ? 0 : batches),
        active_(batches_ * points, 0),
        value_(batches_ * points * at(lane_count<Scalar>)) {}

  [[nodiscard]] Tangent tangent() const { return tangent_; }
  /// Whether modes of negative stiffness are left out. Exact: as set here, from the next evaluation on.
  [[nodiscard]] bool projects() const { return projects_; }
  void project(bool on) { projects_ = on || tangent_ == Tangent::stabilized; }

  /// The stiffness that `stabilized` leaves out of each mode at most, over mu, 0 ... 1 (1/2): from the next evaluation
  /// on.
  void set_cap(double cap) { cap_ = static_cast<Scalar>(cap); }
  [[nodiscard]] Scalar cap() const { return cap_; }

  [[nodiscard]] COROTET_ALWAYS_INLINE bool wanted() const { return tangent_ != Tangent::warped; }

  /// Sets the modes of a batch at quadrature point q, from the strain sym(R^T F) - I, the pressure over mu, and R.
  COROTET_ALWAYS_INLINE void set(std::size_t q, Index batch, const SymmetricLanes& strain,
                                 const Lanes<Scalar>& pressure, const Mat3Lanes<Scalar>& r) {
    const std::size_t place = q * batches_ + at(batch);
    active_[place] = tangent_ == Tangent::consistent || !all_below_cap(strain, pressure) ? 1 : 0;
    if (active_[place] != 0) compute(place, strain, pressure, r);
  }

  /// Of the batches at all points, how many have anything to add: 0 ... 1.
  [[nodiscard]] double active_share() const {
    const auto active = std::count(active_.begin(), active_.end(), std::uint8_t{1});
    return active == 0 ? 0 : static_cast<double>(active) / static_cast<double>(active_.size());
  }
  [[nodiscard]] COROTET_ALWAYS_INLINE bool any(std::size_t q, std::size_t element) const {
    return active_[q * batches_ + element / at(lane_count<Scalar>)] != 0;
  }

  /// H of an element at point q, if any(q, element).
  [[nodiscard]] Mat3<Scalar> matrix(std::size_t q, std::size_t element) const {
    const std::array<Scalar, 8>& h = value_[q * batches_ * at(lane_count<Scalar>) + element];
    Mat3<Scalar> m;
    m.set_col(0, {h[0], h[5], h[4]});
    m.set_col(1, {h[5], h[1], h[3]});
    m.set_col(2, {h[4], h[3], h[2]});
    return m;
  }

  [[nodiscard]] std::size_t bytes() const { return bytes_of(active_) + bytes_of(value_); }

 private:
  using L = Lanes<Scalar>;

  /// True if no twist mode of the batch exceeds what is left of it: where s_i + s_j <= (4 - 2 p) / (2 - cap), so where
  /// the strain, shifted, has no negative eigenvalue, so where none of its three invariants is negative.
  [[nodiscard]] COROTET_ALWAYS_INLINE bool all_below_cap(const SymmetricLanes& e, const L& pressure) const {
    const L shift = L(2 / (2 - cap_)) * (L(2) - pressure) - L(2) - (e[0] + e[1] + e[2]);
    const L x = e[0] + shift, y = e[1] + shift, z = e[2] + shift;
    const L minor_x = y * z - e[3] * e[3], minor_y = z * x - e[4] * e[4], minor_z = x * y - e[5] * e[5];
    const L determinant = x * minor_x - e[5] * (e[5] * z - e[3] * e[4]) + e[4] * (e[5] * e[3] - y * e[4]);
    const L least = lane_min(x + y + z, lane_min(minor_x + minor_y + minor_z, determinant));
    return !(least < L(0)).any();
  }

#if defined(__GNUC__)
  __attribute__((noinline))
#endif
  void
  compute(std::size_t place, const SymmetricLanes& strain, const L& pressure, const Mat3Lanes<Scalar>& r) {
    Mat3Lanes<Scalar> e, n;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      e(i, i) = strain[at(i)];
      e(j, k) = e(k, j) = strain[at(3 + i)];
    }
    diagonalise_lanes(e, n);
    const L trace = strain[0] + strain[1] + strain[2];
    const L least =
        L(Scalar(1e-3)) * (L(1) + lane_abs(trace + L(3)));  // of s_i + s_j, which an inversion may make zero
    // Exact: all of each mode, or what is positive of it; else what exceeds the threshold.
    const L threshold = L(tangent_ == Tangent::consistent ? Scalar(0) : cap_);
    const L lowest = L(projects_ ? Scalar(0) : std::numeric_limits<Scalar>::lowest());
    SymmetricLanes h;
    h.fill(L(0));
    for (int k = 0; k < 3; ++k) {
      const L sum = lane_max(L(2) + trace - e(k, k), least);
      const L stiffness = L(2) + (L(2) * pressure - L(4)) / sum;  // over mu
      const L half = L(Scalar(0.5)) * lane_max(stiffness - threshold, lowest);
      Vec3Lanes<Scalar> axis;
      for (int i = 0; i < 3; ++i) axis[at(i)] = r(i, 0) * n(0, k) + r(i, 1) * n(1, k) + r(i, 2) * n(2, k);
      for (std::size_t i = 0; i < 3; ++i) {
        h[i] += half * axis[i] * axis[i];
        h[3 + i] += half * axis[(i + 1) % 3] * axis[(i + 2) % 3];
      }
    }
    std::array<Scalar, 8>* const out = value_.data() + place * at(lane_count<Scalar>);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto lanes = h[i].values();
      for (std::size_t l = 0; l < lanes.size(); ++l) out[l][i] = lanes[l];
    }
  }

  Tangent tangent_ = Tangent::warped;
  Scalar cap_ = Scalar(0.5);
  bool projects_ = false;
  std::size_t batches_ = 0;
  Buffer<std::uint8_t> active_;          // [point][batch]
  Buffer<std::array<Scalar, 8>> value_;  // [point][element], two of eight unused
};

}  // namespace detail

}  // namespace corotet::inline v0_1
