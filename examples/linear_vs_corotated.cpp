// One beam, three rotation models. Linear elasticity (R = identity) blows the beam up as it turns; a rotation for each
// quadrature point keeps its volume. Prints a table; writes each static shape as DIR/<model>.vtu.
//
//   linear_vs_corotated [DIR] [cells along the beam, default 20]
#include <corotet/mesh/io/write_vtu.hpp>
#include <corotet/rotation/gram_schmidt.hpp>
#include <corotet/rotation/identity.hpp>
#include <corotet/rotation/polar.hpp>
#include <cstdio>
#include <cstdlib>
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
        for (int i = 0; i < 3; ++i) jacobian.col(i) += body.position(nodes[a]) * gradient[a][at(i)];
      sum += point.weight * jacobian.determinant();
    }
  return sum;
}

template <RotationExtractor Rotation>
bool run(const TetMesh<double, Tet10>& mesh, const std::string& folder) {
  auto body = SoftBody<double, Tet10, Rotation>::create(mesh, beam::material(8, 0.3));
  if (!body) return std::fprintf(stderr, "%s\n", body.error().message().c_str()), false;
  const Index tip = beam::hang(*body);
  const double rest_volume = volume(*body);
  const bool settled = beam::settle(*body);
  const Vec3<double> u = body->displacements()[at(tip)];
  std::printf("| %-12s | %6.3f | %9.3f | %8.3f | %6.2f |%s\n", Rotation::name.data(), volume(*body) / rest_volume,
              -u.x(), -u.z(), body->law().energy(body->displacements()), settled ? "" : " (not at rest)");
  if (folder.empty()) return settled;

  Field<double> position;
  for (Index v = 0; v < mesh.vertex_count(); ++v) position.push_back(body->position(v));
  const Status written = write_vtu(
      folder + "/" + std::string(Rotation::name) + ".vtu",
      {.points = position, .cells = vtu_cells(mesh), .point_data = {{"displacement", body->displacements()}}});
  if (!written) std::fprintf(stderr, "%s\n", written.error().message().c_str());
  return settled && written;
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
  return ok ? 0 : 1;
}
