// Three ways to take the rotation out of a deformation, and the laws of mechanics: none at all (linear elasticity),
// Gram-Schmidt, and the polar decomposition. A force that has an energy which no rotation changes does no work over a
// closed loop, exerts no torque on the body it belongs to, and keeps energy and angular momentum. Prints how far each
// is from that. A cube of 1 m, lambda = mu = 1 Pa unless another unit is said; no solver, no damping.
//
//   rotation_laws [seconds that the free cubes ring, default 200] [time step, default 0.005 s]
#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/matrices.hpp>
#include <corotet/mesh.hpp>
#include <corotet/models.hpp>
#include <corotet/types.hpp>
#include <cstdio>
#include <cstdlib>

using namespace corotet;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr Material material{.young = 2.5, .poisson = 0.25, .density = 1};  // lambda = mu = 1 Pa

template <RotationExtractor Rotation>
class Cube {
 public:
  Field<double> displacement, velocity;

  explicit Cube(Index cells)
      : mesh_(*TetMesh<double>::create(
            *make_block({.corner = Vec3<double>::Constant(-0.5), .cells = {cells, cells, cells}}))),
        pattern_(BlockPattern::of(mesh_.elements(), mesh_.vertex_count())),
        law_(mesh_, material),
        state_(law_),
        mass_(mesh_, material, MassModel::lumped, pattern_) {
    displacement.assign(at(mesh_.vertex_count()), Vec3<double>::Zero());
    velocity = displacement;
  }

  [[nodiscard]] Index vertices() const { return mesh_.vertex_count(); }
  [[nodiscard]] const Vec3<double>& rest(Index v) const { return mesh_.position(v); }
  [[nodiscard]] Vec3<double> position(Index v) const { return rest(v) + displacement[at(v)]; }
  [[nodiscard]] double mass(Index v) const { return mass_.row_sum(v); }
  [[nodiscard]] Vec3<double> force(Index v) const { return state_.vertex_force(pattern_, v); }

  /// x = F X at each vertex.
  void deform(const Mat3<double>& f) {
    for (Index v = 0; v < vertices(); ++v) displacement[at(v)] = f * rest(v) - rest(v);
    evaluate();
  }
  void evaluate() {
    SerialExecutor serial;
    law_.evaluate(displacement, state_, serial);
  }

  [[nodiscard]] double elastic_energy() const { return law_.energy(displacement); }
  [[nodiscard]] double max_force() const {
    double largest = 0;
    for (Index v = 0; v < vertices(); ++v) largest = std::max(largest, force(v).norm());
    return largest;
  }
  [[nodiscard]] Vec3<double> torque() const {
    Vec3<double> sum = Vec3<double>::Zero();
    for (Index v = 0; v < vertices(); ++v) sum += position(v).cross(force(v));
    return sum;
  }
  [[nodiscard]] double kinetic_energy() const {
    double sum = 0;
    for (Index v = 0; v < vertices(); ++v) sum += 0.5 * mass(v) * velocity[at(v)].squaredNorm();
    return sum;
  }
  [[nodiscard]] Vec3<double> angular_momentum() const {
    Vec3<double> sum = Vec3<double>::Zero();
    for (Index v = 0; v < vertices(); ++v) sum += mass(v) * position(v).cross(velocity[at(v)]);
    return sum;
  }

  /// Symplectic Euler: keeps the angular momentum exactly and the energy on average, if the force does.
  void step(double h) {
    evaluate();
    for (Index v = 0; v < vertices(); ++v) {
      velocity[at(v)] += h / mass(v) * force(v);
      displacement[at(v)] += h * velocity[at(v)];
    }
  }

 private:
  TetMesh<double> mesh_;
  BlockPattern pattern_;
  Elasticity<double, Tet4, Rotation> law_;
  typename Elasticity<double, Tet4, Rotation>::Evaluation state_;
  Mass<double> mass_;
};

/// Energy and largest force of a cube that is only turned, by `degrees` about an axis that is not special.
template <RotationExtractor Rotation>
void turned(double degrees) {
  Cube<Rotation> cube(1);
  cube.deform(rotation_by(degrees * pi / 180 * Vec3<double>(1, 2, 3).normalized()));
  std::printf(" %.2e | %.2e |", cube.elastic_energy(), cube.max_force());
}

/// A strain of about `size`, with no axis of symmetry.
Mat3<double> strained(double size) {
  Mat3<double> gradient;
  gradient.set_row(0, {0.5, 1, 0});
  gradient.set_row(1, {0, -0.5, 0.3});
  gradient.set_row(2, {0.2, 0, 0.1});
  return Mat3<double>::Identity() + size * gradient;
}

/// The torque that the own forces of a strained, free cube exert on it.
template <RotationExtractor Rotation>
void ghost_torque(double size) {
  Cube<Rotation> cube(1);
  cube.deform(strained(size));
  std::printf(" %.2e |", cube.torque().norm());
}

/// Work of the elastic force while the cube is sheared and stretched in a circle of strain `a`, back to where it began.
/// The trapezoidal rule converges exponentially for a smooth loop.
template <RotationExtractor Rotation>
void loop_work(double a, int points = 256) {
  Cube<Rotation> cube(1);
  double work = 0;
  for (int k = 0; k < points; ++k) {
    const double t = 2 * pi * k / points, dt = 2 * pi / points;
    Mat3<double> f = Mat3<double>::Identity(), df = Mat3<double>::Zero();
    f(0, 1) = a * std::cos(t);
    df(0, 1) = -a * std::sin(t);
    f(1, 0) = a * std::sin(t);
    df(1, 0) = a * std::cos(t);
    f(1, 1) += a * std::cos(t);
    df(1, 1) = -a * std::sin(t);
    cube.deform(f);
    for (Index v = 0; v < cube.vertices(); ++v) work += cube.force(v).dot(df * cube.rest(v)) * dt;
  }
  std::printf(" %.2e |", std::abs(work));
}

/// A free cube that is let go out of a strain: no force from outside, so it may not begin to spin, nor gain energy.
template <RotationExtractor Rotation>
void let_go(double seconds, double h) {
  constexpr double inertia = 1.0 / 6;  // kg m^2, of the cube at rest; it rings with periods of about 2 s
  Cube<Rotation> cube(2);
  cube.deform(strained(0.2));
  const double before = cube.elastic_energy();
  const auto energy = [&] { return (cube.elastic_energy() + cube.kinetic_energy()) / before; };
  double doubled = -1, max_change = 0, spin_at_10 = 0, spin = 0;
  for (int k = 1; k * h <= seconds && doubled < 0; ++k) {
    cube.step(h);
    spin = std::max(spin, cube.angular_momentum().norm() / inertia * 180 / pi);
    if (k * h <= 10) spin_at_10 = spin;
    max_change = std::max(max_change, std::abs(energy() - 1));
    if (energy() > 2) doubled = k * h;
  }
  std::printf("| %-12s | %.1e | %.1e | %.1f %% |", Rotation::name.data(), spin_at_10, spin, 100 * max_change);
  if (doubled < 0)
    std::printf(" never |\n");
  else
    std::printf(" after %.0f s |\n", doubled);
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 200, h = argc > 2 ? std::atof(argv[2]) : 0.005;
  if (!(seconds >= 0 && h > 0)) return std::fprintf(stderr, "seconds >= 0 and a time step > 0 are needed\n"), 2;

  std::printf("Turned rigidly: elastic energy (J) and largest force on a vertex (N), both 0 for a solid\n\n");
  std::printf(
      "| angle, degrees | identity | | gram_schmidt | | polar | |\n| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const double degrees : {1.0, 10.0, 30.0, 90.0, 180.0}) {
    std::printf("| %.0f |", degrees);
    turned<Identity>(degrees);
    turned<GramSchmidt>(degrees);
    turned<Polar>(degrees);
    std::printf("\n");
  }

  std::printf("\nStrained: torque of the body's own forces on it (N m), 0 for a solid\n\n");
  std::printf("| strain | identity | gram_schmidt | polar |\n| --- | --- | --- | --- |\n");
  for (const double size : {0.05, 0.1, 0.2, 0.4}) {
    std::printf("| %.2f |", size);
    ghost_torque<Identity>(size);
    ghost_torque<GramSchmidt>(size);
    ghost_torque<Polar>(size);
    std::printf("\n");
  }

  std::printf("\nStrained in a closed loop: work done by the elastic force (J), 0 for a solid\n\n");
  std::printf("| size of the loop | identity | gram_schmidt | polar |\n| --- | --- | --- | --- |\n");
  for (const double size : {0.05, 0.1, 0.2, 0.4}) {
    std::printf("| %.2f |", size);
    loop_work<Identity>(size);
    loop_work<GramSchmidt>(size);
    loop_work<Polar>(size);
    std::printf("\n");
  }

  std::printf("\nStrained by 0.2 and let go, free, undamped, for %.0f s: the spin that it gives itself, its energy\n\n",
              seconds);
  std::printf(
      "| rotation | spin within 10 s, degrees/s | to the end | largest change of the energy | energy doubled |\n");
  std::printf("| --- | --- | --- | --- | --- |\n");
  let_go<Identity>(seconds, h);
  let_go<GramSchmidt>(seconds, h);
  let_go<Polar>(seconds, h);
  return 0;
}
