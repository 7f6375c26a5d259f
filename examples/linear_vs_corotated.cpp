// One beam, three rotation models. Linear elasticity (R = identity) blows the beam up as it turns; a rotation for each
// quadrature point keeps its volume. Prints a table, and a second one of how far a beam may bend before that shows;
// writes each static shape of the first as DIR/<model>.vtu.
//
//   linear_vs_corotated [DIR] [cells along the beam, default 20]
#include <corotet/io.hpp>
#include <corotet/models.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "self_weight_beam.hpp"

using namespace corotet;

namespace {

/// Volume of the deformed body, m^3. The Jacobian of a Tet10 is cubic, which the rule for the mass integrates exactly.
template <class Body>
double volume(const Body& body) {
  using Element = typename Body::element_type;
  double sum = 0;
  for (const auto& nodes : body.mesh().elements())
    for (const QuadraturePoint& point : Element::mass_points) {
      const auto gradient = Element::gradient(point.xi);
      Mat3<double> jacobian = Mat3<double>::Zero();
      for (std::size_t a = 0; a < nodes.size(); ++a)
        jacobian += body.position(nodes[a]) * Vec3<double>::load(gradient[a].data()).transpose();
      sum += point.weight * jacobian.determinant();
    }
  return sum;
}

/// What a beam comes to under its own weight.
struct Shape {
  bool settled = false;
  double volume = 0;                              ///< in units of that before
  Vec3<double> tip_moved = Vec3<double>::Zero();  ///< m
};

/// Lets the beam hang; calls `then(body)` in the end, if it got that far.
template <RotationExtractor Rotation, class Then>
Shape hang(const TetMesh<double, Tet10>& mesh, double q, Then&& then) {
  auto body = SoftBody<double, Tet10, Rotation>::create(mesh, beam::material(q, 0.3));
  if (!body) return std::fprintf(stderr, "%s\n", body.error().message().c_str()), Shape{};
  const Index tip = beam::hang(*body);
  const double rest_volume = volume(*body);
  Shape shape;
  shape.settled = solve_static(*body).converged;
  shape.volume = volume(*body) / rest_volume;
  shape.tip_moved = body->displacements()[at(tip)];
  then(*body);
  return shape;
}

template <RotationExtractor Rotation>
bool run(const TetMesh<double, Tet10>& mesh, const std::string& folder) {
  bool written = true;
  double energy = 0;
  const Shape shape = hang<Rotation>(mesh, 8, [&](const auto& body) {
    energy = body.law().energy(body.displacements());
    if (folder.empty()) return;
    Field<double> position;
    for (Index v = 0; v < mesh.vertex_count(); ++v) position.push_back(body.position(v));
    const Result<void> status = write_vtu(
        folder + "/" + std::string(Rotation::name) + ".vtu",
        {.points = position, .cells = vtu_cells(mesh), .point_data = {{"displacement", body.displacements()}}});
    if (!status) std::fprintf(stderr, "%s\n", status.error().message().c_str());
    written = bool(status);
  });
  std::printf("| %-12s | %6.3f | %9.3f | %8.3f | %6.2f |%s\n", Rotation::name.data(), shape.volume,
              -shape.tip_moved.x(), -shape.tip_moved.z(), energy, shape.settled ? "" : " (not at rest)");
  return shape.settled && written;
}

/// Converged drops of the 3D beam (as beam::reference_drop), from stiff to soft.
bool loads(const TetMesh<double, Tet10>& mesh) {
  std::printf("\n| q | drop m | linear: error | volume | corotational: error | volume |\n");
  std::printf("| --- | --- | --- | --- | --- | --- |\n");
  bool ok = true;
  for (const auto& [q, drop] : {std::pair{1.0, 0.12356}, {4.0, 0.42709}, {8.0, beam::reference_drop}}) {
    const auto ignore = [](const auto&) {};
    const Shape linear = hang<Identity>(mesh, q, ignore), polar = hang<Polar>(mesh, q, ignore);
    std::printf("| %.0f | %.3f | %+.1f %% | %.3f | %+.1f %% | %.3f |\n", q, drop,
                100 * (-linear.tip_moved.z() / drop - 1), linear.volume, 100 * (-polar.tip_moved.z() / drop - 1),
                polar.volume);
    ok = ok && linear.settled && polar.settled;
  }
  return ok;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : "";
  const int cells = argc > 2 ? std::atoi(argv[2]) : 20;
  const auto mesh = beam::mesh<double, Tet10>({cells, std::max(1, cells / 10), std::max(1, cells / 10)});
  if (!mesh) return std::fprintf(stderr, "%s\n", mesh.error().message().c_str()), 1;
  std::error_code ignored;  // an unusable folder shows when a file is written
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);

  std::printf("Beam 1 x 0.1 x 0.1 m, E = %.4g Pa, poisson 0.3, %d Tet10, at rest under its own weight (q = 8)\n\n",
              beam::material(8, 0.3).young, mesh->element_count());
  std::printf("| rotation     | volume | shorter m |   drop m | energy J |\n| --- | --- | --- | --- | --- |\n");
  const bool ok = run<Identity>(*mesh, folder) && run<GramSchmidt>(*mesh, folder) && run<Polar>(*mesh, folder);
  std::printf("| reference    |        | %9.3f | %8.3f |        |\n", beam::reference_shortening, beam::reference_drop);
  return ok && loads(*mesh) ? 0 : 1;
}
