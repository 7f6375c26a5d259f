// Do other elastic laws return a body to rest from where this library's does not? A block of ten elements is held at
// one end, its other vertices start anywhere in its box, and it moves for 60 s (backward Euler, 1/60 s, no damping but
// the integrator's). Five ways: the default, corotated with one solve a step, and by Newton's method with line search
// and the exact tangent
//   corotated        mu |F - R|^2 + lambda/2 tr(S - I)^2, the library's;
//   bounded pressure the same with the second term linear from |lambda tr(S - I)| = 0.15 mu on: another material where
//                    volumes change by more than a tenth (Poisson's ratio 0.3);
//   fixed corotated  mu |F - R|^2 + lambda/2 (J - 1)^2 (Stomakhin et al. 2012);
//   neo-Hookean      the stable one, the library's (Smith, de Goes & Kim 2018, eq. 14).
// The second and the third are written here, as any ElasticModel is: by the energy's derivatives in the stretches.
// Prints how many return to rest, and of the others how many end at rest with and without inverted quadrature points.
//
//   energies_from_random_starts [starts, default 40] [Poisson's ratio, default 0.3] [Tet4 | Tet10, default both]
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <corotet/corotet.hpp>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string_view>
#include <vector>

using namespace corotet;

namespace {

constexpr double step = 1.0 / 60;  // s

/// An isotropic law by its density psi(s), a function of the signed stretches. `Density::of(constants, s)` returns psi,
/// its derivatives, and for the tangent the eigenvalues that add_principal_tangent wants.
template <class Density>
struct IsotropicModel {
  static constexpr std::string_view name = Density::name;
  static constexpr bool is_conservative = true;
  using Rotation = Polar;
  template <std::floating_point Scalar>
  using State = NoState;
  template <std::floating_point Scalar>
  using Constants = Corotated<Polar>::Constants<Scalar>;  // Lame's parameters

  template <std::floating_point Scalar>
  static Lanes<Scalar> energy(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                              const NoState& /*committed*/) {
    return Density::of(constants, PrincipalFrame<Scalar>(deformation).stretch).psi;
  }

  /// P = U diag(dpsi/ds) V^T.
  template <std::floating_point Scalar>
  static void stress(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                     const NoState& /*committed*/, NoState& /*trial*/, Mat3Lanes<Scalar>& p) {
    const PrincipalFrame<Scalar> frame(deformation);
    const auto density = Density::of(constants, frame.stretch);
    Mat3Lanes<Scalar> scaled;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) scaled(i, j) = frame.u(i, j) * density.slope[at(j)];
    product_with_transpose(scaled, frame.v, p);
  }

  template <std::floating_point Scalar>
  static void tangent(const Constants<Scalar>& constants, const DeformationLanes<Scalar>& deformation,
                      const NoState& /*committed*/, bool semi_definite, TangentLanes<Scalar>& c) {
    const PrincipalFrame<Scalar> frame(deformation);
    auto density = Density::of(constants, frame.stretch);
    add_principal_tangent(frame, density.twist, density.flip, density.scaling, semi_definite, c);
  }
};

template <std::floating_point Scalar>
struct PrincipalDensity {
  Lanes<Scalar> psi;        ///< J/m^3
  Vec3Lanes<Scalar> slope;  ///< dpsi/ds, Pa
  Vec3Lanes<Scalar> twist, flip;
  Mat3Lanes<Scalar> scaling;

  /// Of mu sum (s - 1)^2, to which a law adds what resists a change of volume.
  template <class Constants>
  PrincipalDensity(const Constants& constants, const Vec3Lanes<Scalar>& s) : psi(0) {
    const Lanes<Scalar> two_mu = constants.mu + constants.mu;
    for (int k = 0; k < 3; ++k) {
      const Lanes<Scalar> e = s[at(k)] - Lanes<Scalar>(1), sum = s[at((k + 1) % 3)] + s[at((k + 2) % 3)];
      psi += constants.mu * e * e;
      slope[at(k)] = two_mu * e;
      twist[at(k)] = two_mu - (two_mu + two_mu) / lane_max(sum, min_sum());
      flip[at(k)] = two_mu;
      for (int j = 0; j < 3; ++j) scaling(k, j) = j == k ? two_mu : Lanes<Scalar>(0);
    }
  }

  /// Of two stretches: an inverted element may have any.
  static Lanes<Scalar> min_sum() { return Lanes<Scalar>(Scalar(1e-3)); }
};

struct BoundedPressure {
  static constexpr std::string_view name = "corotated, bounded pressure";

  template <class Constants, std::floating_point Scalar>
  static PrincipalDensity<Scalar> of(const Constants& constants, const Vec3Lanes<Scalar>& s) {
    using L = Lanes<Scalar>;
    PrincipalDensity<Scalar> density(constants, s);
    const L sum = s[0] + s[1] + s[2], growth = sum - L(3), bound = L(Scalar(0.15)) * constants.mu;
    const L pressure = lane_max(lane_min(constants.lambda * growth, bound), -bound);
    const L slope = select(lane_abs(constants.lambda * growth) < bound, constants.lambda, L(0));
    // lambda growth^2 / 2 within the bound, linear beyond.
    density.psi += pressure * (growth - L(Scalar(0.5)) * pressure / lane_max(constants.lambda, L(Scalar(1e-9))));
    for (int i = 0; i < 3; ++i) {
      density.slope[at(i)] += pressure;
      density.twist[at(i)] += (pressure + pressure) / lane_max(sum - s[at(i)], density.min_sum());
      for (int j = 0; j < 3; ++j) density.scaling(i, j) += slope;
    }
    return density;
  }
};

struct FixedCorotated {
  static constexpr std::string_view name = "fixed corotated";

  template <class Constants, std::floating_point Scalar>
  static PrincipalDensity<Scalar> of(const Constants& constants, const Vec3Lanes<Scalar>& s) {
    using L = Lanes<Scalar>;
    PrincipalDensity<Scalar> density(constants, s);
    const L growth = s[0] * s[1] * s[2] - L(1), pressure = constants.lambda * growth;
    density.psi += L(Scalar(0.5)) * pressure * growth;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const L area = s[at(i)] * s[at(j)];
      density.slope[at(k)] += pressure * area;
      density.twist[at(k)] += pressure * s[at(k)];
      density.flip[at(k)] += -pressure * s[at(k)];
      density.scaling(k, k) += constants.lambda * area * area;
      const L mixed = constants.lambda * area * s[at(k)] * s[at(k)] + pressure * s[at(k)];
      density.scaling(i, j) += mixed;
      density.scaling(j, i) += mixed;
    }
    return density;
  }
};

/// A block with its left end held, and where it starts from.
template <class Element>
struct Problem {
  TetMesh<double, Element> mesh;
  Material material;

  explicit Problem(double poisson)
      : mesh(*TetMesh<double, Element>::create(
            *make_block({.size = {1, 0.5, 0.5}, .cells = {2, 1, 1}, .order = Element::order}))),
        material{.young = 5e5, .poisson = poisson, .density = 1000} {}

  [[nodiscard]] static bool is_held(const Vec3<double>& x) { return x.x() < 1e-9; }

  /// As displacement from rest.
  [[nodiscard]] Field<double> start(unsigned seed) const {
    std::mt19937_64 random(seed);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    Field<double> u;
    for (const Vec3<double>& x : mesh.positions()) {
      const Vec3<double> anywhere{unit(), unit() / 2, unit() / 2};  // in this order
      u.push_back(is_held(x) ? Vec3<double>::Zero() : Vec3<double>(anywhere - x));
    }
    return u;
  }
};

struct Tally {
  int home = 0, inverted = 0, upright = 0, moving = 0;
  double solves = 0, steps = 0;

  void add(double rms, bool rests, bool is_inverted) {
    if (rms < 1e-3 && !is_inverted)
      ++home;
    else if (!rests)
      ++moving;
    else
      ++(is_inverted ? inverted : upright);
  }
  void print(const char* element, std::string_view law) const {
    std::printf("| %s | %.*s | %d | %d | %d | %d | %.1f |\n", element, static_cast<int>(law.size()), law.data(), home,
                inverted, upright, moving, solves / steps);
    std::fflush(stdout);
  }
};

double rms(const Field<double>& displacement) {
  double sum = 0;
  for (const Vec3<double>& u : displacement) sum += u.squaredNorm();
  return std::sqrt(sum / static_cast<double>(displacement.size()));
}

double max_speed(const Field<double>& velocity) {
  double largest = 0;
  for (const Vec3<double>& v : velocity) largest = std::max(largest, v.norm());
  return largest;
}

/// All starts with one law: steps until no vertex has been faster than 1e-3 m/s for 20 steps, or for 60 s.
template <class Law, class Element>
void run(const char* element, std::string_view name, const Problem<Element>& problem, int starts,
         const StepOptions& newton) {
  auto body = *SoftBody<double, Element, Law>::create(problem.mesh, problem.material);
  body.pin_where(&Problem<Element>::is_held);
  ImplicitEuler euler(body, SolverOptions{}, newton);
  Tally tally;
  for (int seed = 1; seed <= starts; ++seed) {
    const Field<double> start = problem.start(static_cast<unsigned>(seed));
    const Field<double> zero(start.size(), Vec3<double>::Zero());
    if (!body.set_displacements(start).ok() || !body.set_velocities(zero).ok()) std::abort();  // never
    StepReport report;
    int quiet = 0;
    for (int i = 0; i < 3600 && quiet < 20; ++i) {
      report = euler.step(body, step);
      if (!report.accepted()) break;
      tally.solves += report.newton_iterations;
      ++tally.steps;
      quiet = max_speed(body.velocities()) < 1e-3 ? quiet + 1 : 0;
    }
    tally.add(rms(body.displacements()), quiet == 20, report.inverted_elements > 0);
  }
  tally.print(element, name);
}

template <class Element>
void all(const char* element, int starts, double poisson) {
  const Problem<Element> problem(poisson);
  const StepOptions newton{.iterations = 20, .tolerance = 1e-6, .tangent = Tangent::consistent};
  run<Polar>(element, "this library, one solve", problem, starts, {});
  run<Polar>(element, "corotated", problem, starts, newton);
  run<IsotropicModel<BoundedPressure>>(element, BoundedPressure::name, problem, starts, newton);
  run<IsotropicModel<FixedCorotated>>(element, FixedCorotated::name, problem, starts, newton);
  run<StableNeoHookean>(element, "stable neo-Hookean", problem, starts, newton);
}

}  // namespace

int main(int argc, char** argv) {
  const int starts = argc > 1 ? std::atoi(argv[1]) : 40;
  const double poisson = argc > 2 ? std::atof(argv[2]) : 0.3;
  const std::string_view element = argc > 3 ? argv[3] : "";
  const bool known = element.empty() || element == "Tet4" || element == "Tet10";
  if (!(starts > 0 && poisson > -1 && poisson < 0.5 && known))
    return std::fprintf(stderr, "starts > 0, -1 < Poisson's ratio < 0.5 and Tet4 or Tet10 are needed\n"), 2;
  std::printf("%d random starts, Poisson's ratio %g\n\n", starts, poisson);
  std::printf("| element | law | at rest | stuck, inverted | stuck, not inverted | still moving | solves a step |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- |\n");
  if (element != "Tet10") all<Tet4>("Tet4", starts, poisson);
  if (element != "Tet4") all<Tet10>("Tet10", starts, poisson);
  return 0;
}
