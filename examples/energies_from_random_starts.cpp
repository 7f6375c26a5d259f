// Do other elastic laws bring a body home from where this library's does not? A block of ten elements is held at one
// end, its other vertices start anywhere in its box, and it moves for 60 s (backward Euler, 1/60 s, no damping but the
// integrator's). Five ways: this library with one solve a step, and by Newton's method with line search and the Hessian
// of each quadrature point projected to semi-definite (Teran et al. 2005)
//   corotated        mu |F - R|^2 + lambda/2 tr(S - I)^2, R from the signed singular values, so that it is defined for
//                    inverted elements (Irving, Teran & Fedkiw 2004);
//   bounded pressure the same with the second term linear from |lambda tr(S - I)| = 0.15 mu on: another material where
//                    volumes change by more than a tenth (Poisson's ratio 0.3);
//   fixed corotated  mu |F - R|^2 + lambda/2 (J - 1)^2 (Stomakhin et al. 2012);
//   neo-Hookean      the stable one: finite and smooth for every F (Smith, de Goes & Kim 2018, eq. 14).
// Prints how many come home, and of the others how many end at rest with and without inverted quadrature points.
//
//   energies_from_random_starts [starts, default 40] [Poisson's ratio, default 0.3] [Tet4 | Tet10, default both]
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/core/eigen.hpp>
#include <corotet/corotet.hpp>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <limits>
#include <random>
#include <string_view>
#include <vector>

using namespace corotet;

namespace {

constexpr double step = 1.0 / 60;  // s
using Mat9 = Eigen::Matrix<double, 9, 9>;
using Vec9 = Eigen::Matrix<double, 9, 1>;

Mat3<double> cofactor(const Mat3<double>& f) {
  Mat3<double> c;
  for (int i = 0; i < 3; ++i) c.set_col(i, f.col((i + 1) % 3).cross(f.col((i + 2) % 3)));
  return c;
}

/// The rotation nearest to F, also where det F < 0.
Mat3<double> nearest_rotation(const Mat3<double>& f) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(as_eigen(f), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

class Law {
 public:
  const char* const name;

  Law(const char* law, double lame_mu, double lame_lambda) : name(law), mu(lame_mu), lambda(lame_lambda) {}
  virtual ~Law() = default;
  Law(const Law&) = delete;
  Law& operator=(const Law&) = delete;

  [[nodiscard]] virtual double energy(const Mat3<double>& f) const = 0;        ///< density, J/m^3
  [[nodiscard]] virtual Mat3<double> stress(const Mat3<double>& f) const = 0;  ///< its derivative by F, Pa

 protected:
  double mu, lambda;  // Pa
};

/// `largest_pressure`: |lambda tr(S - I)| up to which the second term is quadratic, Pa.
class Corotated : public Law {
 public:
  Corotated(double lame_mu, double lame_lambda)
      : Corotated("corotated", lame_mu, lame_lambda, std::numeric_limits<double>::infinity()) {}
  Corotated(const char* law, double lame_mu, double lame_lambda, double largest_pressure)
      : Law(law, lame_mu, lame_lambda), largest_(largest_pressure / std::max(lambda, 1e-9 * mu)) {}
  [[nodiscard]] double energy(const Mat3<double>& f) const override {
    const Mat3<double> r = nearest_rotation(f);
    const double growth = trace(r, f), part = bounded(growth);
    return mu * (f - r).squaredNorm() + lambda * part * (growth - part / 2);
  }
  [[nodiscard]] Mat3<double> stress(const Mat3<double>& f) const override {
    const Mat3<double> r = nearest_rotation(f);
    return 2 * mu * (f - r) + lambda * bounded(trace(r, f)) * r;
  }

 private:
  [[nodiscard]] static double trace(const Mat3<double>& r, const Mat3<double>& f) {
    return (r.transpose() * f).trace() - 3;
  }
  [[nodiscard]] double bounded(double growth) const { return std::clamp(growth, -largest_, largest_); }

  double largest_;  // tr(S - I)
};

class BoundedPressure final : public Corotated {
 public:
  BoundedPressure(double lame_mu, double lame_lambda)
      : Corotated("corotated, bounded pressure", lame_mu, lame_lambda, 0.15 * lame_mu) {}
};

class FixedCorotated final : public Law {
 public:
  FixedCorotated(double lame_mu, double lame_lambda) : Law("fixed corotated", lame_mu, lame_lambda) {}
  [[nodiscard]] double energy(const Mat3<double>& f) const override {
    const double growth = f.determinant() - 1;
    return mu * (f - nearest_rotation(f)).squaredNorm() + lambda / 2 * growth * growth;
  }
  [[nodiscard]] Mat3<double> stress(const Mat3<double>& f) const override {
    return 2 * mu * (f - nearest_rotation(f)) + lambda * (f.determinant() - 1) * cofactor(f);
  }
};

/// With its own mu and lambda, for the same small strains.
class NeoHookean final : public Law {
 public:
  NeoHookean(double lame_mu, double lame_lambda)
      : Law("stable neo-Hookean", 4 * lame_mu / 3, lame_lambda + 5 * lame_mu / 6),
        rest_growth_(1 + 3 * mu / (4 * lambda)) {}
  [[nodiscard]] double energy(const Mat3<double>& f) const override {
    const double square = f.squaredNorm(), growth = f.determinant() - rest_growth_;
    return mu / 2 * (square - 3 - std::log((square + 1) / 4)) + lambda / 2 * growth * growth;
  }
  [[nodiscard]] Mat3<double> stress(const Mat3<double>& f) const override {
    return mu * (1 - 1 / (f.squaredNorm() + 1)) * f + lambda * (f.determinant() - rest_growth_) * cofactor(f);
  }

 private:
  double rest_growth_;  // J where the second term vanishes
};

/// A block with its left end held, and where it starts from.
template <class Element>
struct Problem {
  TetMesh<double, Element> mesh;
  Material material;
  std::vector<bool> held;

  explicit Problem(double poisson)
      : mesh(*TetMesh<double, Element>::create(
            *make_block({.size = {1, 0.5, 0.5}, .cells = {2, 1, 1}, .order = Element::order}))),
        material{.young = 5e5, .poisson = poisson, .density = 1000} {
    for (const Vec3<double>& x : mesh.positions()) held.push_back(x.x() < 1e-9);
  }

  [[nodiscard]] Field<double> start(unsigned seed) const {
    std::mt19937_64 random(seed);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    Field<double> x = mesh.positions();
    for (std::size_t v = 0; v < x.size(); ++v) {
      const Vec3<double> anywhere{unit(), unit() / 2, unit() / 2};  // in this order
      if (!held[v]) x[v] = anywhere;
    }
    return x;
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
  void print(const char* element, const char* law) const {
    std::printf("| %s | %s | %d | %d | %d | %d | %.1f |\n", element, law, home, inverted, upright, moving,
                solves / steps);
    std::fflush(stdout);
  }
};

double rms(const Field<double>& x, const Field<double>& rest) {
  double sum = 0;
  for (std::size_t v = 0; v < x.size(); ++v) sum += (x[v] - rest[v]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(x.size()));
}

double largest_speed(const Field<double>& velocity) {
  double largest = 0;
  for (const Vec3<double>& v : velocity) largest = std::max(largest, v.norm());
  return largest;
}

/// Calls `advance`, which returns its number of linear solves, until no vertex has been faster than 1e-3 m/s for 20
/// steps. False if that does not happen.
template <class Advance>
bool comes_to_rest(int steps, const Field<double>& velocity, Tally& tally, Advance&& advance) {
  int quiet = 0;
  for (int i = 0; i < steps && quiet < 20; ++i) {
    tally.solves += advance();
    ++tally.steps;
    quiet = largest_speed(velocity) < 1e-3 ? quiet + 1 : 0;
  }
  return quiet == 20;
}

/// A quadrature point of an element: dN/dX of its nodes, 1/m, and its volume, m^3.
template <class Element>
struct Point {
  Index element;
  std::array<Vec3<double>, Element::nodes> gradient;
  double volume;
};

/// Backward Euler by Newton's method, dense: for small bodies and any law.
template <class Element>
class NewtonBody {
 public:
  NewtonBody(const Problem<Element>& problem, const Law& law)
      : problem_(problem), law_(law), slot_(problem.held.size(), -1), mass_(problem.held.size(), 0) {
    for (std::size_t v = 0; v < slot_.size(); ++v)
      if (!problem.held[v]) slot_[v] = free_++;
    const auto pattern = BlockPattern::of(problem.mesh.elements(), problem.mesh.vertex_count());
    const Mass<double> mass(problem.mesh, problem.material, MassModel::lumped, pattern);
    for (Index v = 0; v < problem.mesh.vertex_count(); ++v) mass_[at(v)] = mass.row_sum(v);
    for (Index e = 0; e < problem.mesh.element_count(); ++e)
      for (std::size_t q = 0; q < Element::stiffness_points.size(); ++q) {
        const auto& natural = natural_gradients<Element>[q];
        const Mat3<double> to_space =
            jacobian(natural, [&](std::size_t a) { return problem.mesh.node_position(e, a); });
        Point<Element> point{e, {}, Element::stiffness_points[q].weight * to_space.determinant()};
        const Mat3<double> to_natural = to_space.transpose().inverse();
        for (std::size_t a = 0; a < Element::nodes; ++a)
          point.gradient[a] = to_natural * Vec3<double>::load(natural[a].data());
        points_.push_back(point);
      }
  }

  void run(const Field<double>& start, int steps, Tally& tally) {
    x_ = start;
    velocity_.assign(x_.size(), Vec3<double>::Zero());
    const bool rests = comes_to_rest(steps, velocity_, tally, [&] { return advance(); });
    tally.add(rms(x_, problem_.mesh.positions()), rests, is_inverted());
  }

 private:
  [[nodiscard]] Mat3<double> deformation(const Point<Element>& point, const Field<double>& x) const {
    Mat3<double> f = Mat3<double>::Zero();
    for (std::size_t a = 0; a < Element::nodes; ++a)
      f += x[at(problem_.mesh.element(point.element)[a])] * point.gradient[a].transpose();
    return f;
  }

  /// |x - xtilde|^2_M / 2 h^2 + W(x), J.
  [[nodiscard]] double potential(const Field<double>& x, const Field<double>& ahead) const {
    double sum = 0;
    for (std::size_t v = 0; v < x.size(); ++v)
      if (slot_[v] >= 0) sum += mass_[v] / (2 * step * step) * (x[v] - ahead[v]).squaredNorm();
    for (const auto& point : points_) sum += point.volume * law_.energy(deformation(point, x));
    return sum;
  }

  /// dP/dF by central differences, symmetric, its negative eigenvalues set to 0.
  [[nodiscard]] Mat9 hessian(const Mat3<double>& f) const {
    constexpr double delta = 1e-6;
    Mat9 h;
    for (int k = 0; k < 9; ++k) {
      Mat3<double> above = f, below = f;
      above(k) += delta;
      below(k) -= delta;
      const Mat3<double> change = (law_.stress(above) - law_.stress(below)) / (2 * delta);
      h.col(k) = Eigen::Map<const Vec9>(change.data());
    }
    const Eigen::SelfAdjointEigenSolver<Mat9> modes((h + h.transpose()) / 2);
    return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() * modes.eigenvectors().transpose();
  }

  /// One step; returns the number of linear solves.
  int advance() {
    const Field<double> before = x_;
    Field<double> ahead = x_;
    for (std::size_t v = 0; v < x_.size(); ++v) ahead[v] += step * velocity_[v];
    constexpr int most = 20;
    int solves = 0;
    for (bool done = false; !done && solves < most; ++solves) {
      Eigen::VectorXd gradient = Eigen::VectorXd::Zero(3 * free_);
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(3 * free_, 3 * free_);
      for (std::size_t v = 0; v < x_.size(); ++v) {
        if (slot_[v] < 0) continue;
        const double inertia = mass_[v] / (step * step);
        gradient.segment<3>(3 * slot_[v]) += inertia * as_eigen(x_[v] - ahead[v]);
        matrix.diagonal().segment<3>(3 * slot_[v]).array() += inertia;
      }
      for (const auto& point : points_) add(point, gradient, matrix);
      const Eigen::VectorXd change = -matrix.llt().solve(gradient);
      const double slope = gradient.dot(change), at_start = potential(x_, ahead);
      const Field<double> from = x_;
      bool lower = false;
      for (double fraction = 1; !lower && fraction > 1e-4; fraction /= 2) {
        for (std::size_t v = 0; v < x_.size(); ++v)
          if (slot_[v] >= 0) x_[v] = from[v] + Vec3<double>(fraction * change.template segment<3>(3 * slot_[v]));
        lower = potential(x_, ahead) <= at_start + 1e-4 * fraction * slope;
      }
      if (!lower) x_ = from;
      done = !lower || change.cwiseAbs().maxCoeff() < 1e-6 * step;  // 1e-6 m/s
    }
    for (std::size_t v = 0; v < x_.size(); ++v) velocity_[v] = (x_[v] - before[v]) / step;
    return solves;
  }

  void add(const Point<Element>& point, Eigen::VectorXd& gradient, Eigen::MatrixXd& matrix) const {
    const Mat3<double> f = deformation(point, x_), stress = point.volume * law_.stress(f);
    const Mat9 h = point.volume * hessian(f);
    for (std::size_t a = 0; a < Element::nodes; ++a) {
      const int i = slot_[at(problem_.mesh.element(point.element)[a])];
      if (i < 0) continue;
      gradient.segment<3>(3 * i) += as_eigen(stress * point.gradient[a]);
      for (std::size_t b = 0; b < Element::nodes; ++b) {
        const int j = slot_[at(problem_.mesh.element(point.element)[b])];
        if (j < 0) continue;
        for (int k = 0; k < 3; ++k)
          for (int l = 0; l < 3; ++l)
            matrix.block<3, 3>(3 * i, 3 * j) +=
                point.gradient[a][k] * point.gradient[b][l] * h.block<3, 3>(3 * k, 3 * l);
      }
    }
  }

  [[nodiscard]] bool is_inverted() const {
    return std::any_of(points_.begin(), points_.end(),
                       [&](const auto& point) { return deformation(point, x_).determinant() <= 0; });
  }

  const Problem<Element>& problem_;
  const Law& law_;
  int free_ = 0;
  std::vector<int> slot_;  // of a free vertex among the unknowns, -1 of one that is held
  std::vector<double> mass_;
  std::vector<Point<Element>> points_;
  Field<double> x_, velocity_;
};

template <class Element>
void library(const char* element, const Problem<Element>& problem, int starts, int steps) {
  auto body = *SoftBody<double, Element>::create(problem.mesh, problem.material);
  body.pin_where([](const Vec3<double>& x) { return x.x() < 1e-9; });
  ImplicitEuler euler(body);
  Tally tally;
  for (int seed = 1; seed <= starts; ++seed) {
    Field<double> displacement = problem.start(static_cast<unsigned>(seed));
    for (std::size_t v = 0; v < displacement.size(); ++v) displacement[v] -= problem.mesh.positions()[v];
    const Field<double> zero(displacement.size(), Vec3<double>::Zero());
    if (!body.set_displacements(displacement).ok() || !body.set_velocities(zero).ok()) std::abort();  // never
    StepReport report;
    const bool rests = comes_to_rest(steps, body.velocities(), tally, [&] {
      report = euler.step(body, step);
      return report.newton_iterations;
    });
    tally.add(rms(body.displacements(), zero), rests, report.inverted_elements > 0);
  }
  tally.print(element, "this library, one solve");
}

template <class Element>
void all(const char* element, int starts, double poisson) {
  constexpr int steps = 3600;
  const Problem<Element> problem(poisson);
  library(element, problem, starts, steps);
  const auto [lambda, mu] = lame(problem.material);
  const Corotated corotated(mu, lambda);
  const BoundedPressure bounded(mu, lambda);
  const FixedCorotated fixed(mu, lambda);
  const NeoHookean neo_hookean(mu, lambda);
  for (const Law* law : std::initializer_list<const Law*>{&corotated, &bounded, &fixed, &neo_hookean}) {
    NewtonBody<Element> body(problem, *law);
    Tally tally;
    for (int seed = 1; seed <= starts; ++seed) body.run(problem.start(static_cast<unsigned>(seed)), steps, tally);
    tally.print(element, law->name);
  }
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
  std::printf("| element | law | home | stuck, inverted | stuck, not inverted | still moving | solves a step |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- |\n");
  if (element != "Tet10") all<Tet4>("Tet4", starts, poisson);
  if (element != "Tet4") all<Tet10>("Tet10", starts, poisson);
  return 0;
}
