// What mass-spring systems lack: a beam of springs along the edges of tetrahedra, beside finite elements on the same
// meshes. Linear statics, small deflections: what differs is the model alone. Springs are calibrated on one mesh, to
// the deflection of the real beam; other meshes of the same beam then show what that is worth.
//
//   spring_beam [quick]
#include <array>
#include <corotet/matrices.hpp>
#include <corotet/solvers.hpp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "self_weight_beam.hpp"

using namespace corotet;

namespace {

/// A mesh of the beam, and what both models need of it.
template <class Element>
struct Model {
  TetMesh<double, Element> mesh;
  std::shared_ptr<const BlockPattern> pattern;

  explicit Model(TetMesh<double, Element> of)
      : mesh(std::move(of)),
        pattern(std::make_shared<const BlockPattern>(BlockPattern::of(mesh.elements(), mesh.vertex_count()))) {}

  /// Displacements with the end at x = 0 held, m; nothing if the matrix is singular.
  [[nodiscard]] std::optional<Field<double>> solve(BlockMatrix<double> stiffness, Field<double> force) const {
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.position(v).x() < 1e-6) {
        stiffness.isolate(v);
        force[at(v)].setZero();
      }
    BlockCholesky<double> cholesky;
    cholesky.analyze(*pattern);
    if (!cholesky.factorize(stiffness)) return {};
    Field<double> displacement(force.size());
    cholesky.solve(force, displacement);
    return displacement;
  }

  /// The beam's weight, N, spread over the vertices.
  [[nodiscard]] Field<double> weight() const {
    const Mass<double> mass(mesh, beam::material(1, 0), MassModel::consistent, *pattern);
    Field<double> force;
    for (Index v = 0; v < mesh.vertex_count(); ++v) force.emplace_back(0, 0, -beam::gravity * mass.row_sum(v));
    return force;
  }

  /// A pull of 1 N along x, the same on each vertex of the free end.
  [[nodiscard]] Field<double> pull() const {
    Field<double> force(at(mesh.vertex_count()), Vec3<double>::Zero());
    double pulled = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.position(v).x() > beam::length - 1e-6) {
        force[at(v)].x() = 1;
        ++pulled;
      }
    for (Vec3<double>& f : force) f /= pulled;
    return force;
  }
};

using Linear = Model<Tet4>;

template <class Element>
BlockMatrix<double> elastic_stiffness(const Model<Element>& model, const Material& material) {
  SerialExecutor serial;
  const Elasticity<double, Element> law(model.mesh, material);
  typename Elasticity<double, Element>::Evaluation state(law);
  law.evaluate(Field<double>(at(model.mesh.vertex_count()), Vec3<double>::Zero()), state, serial);
  BlockMatrix<double> stiffness(model.pattern);
  const Mass<double> mass(model.mesh, material, MassModel::lumped, *model.pattern);
  assemble(law, state, mass, 0.0, 1.0, stiffness, serial);
  return stiffness;
}

/// How stiff the spring along an edge is.
enum class SpringLaw {
  same,   ///< one k, N/m, for all springs: what most programs do
  gelder  ///< k = c V / l^2, V the volume of the tetrahedra around the edge (Van Gelder 1998, extended to 3D)
};

/// Springs along the edges of the tetrahedra. On one tetrahedron they are the linear element of a material whose
/// elasticity is C = sum over the edges of (k l^2 / V) n n n n: it depends on the element's shape, and C_xxyy = C_xyxy
/// leaves an isotropic one no Poisson's ratio but 1/4 (Cauchy's relations). `strength` is k (N/m) or c (Pa).
BlockMatrix<double> spring_stiffness(const Linear& model, SpringLaw law, double strength) {
  BlockMatrix<double> stiffness(model.pattern);
  const BlockPattern& pattern = *model.pattern;
  const auto add = [&](Index a, Index b, const Mat3<double>& k) {
    stiffness.block(pattern.slot(a, a)) += k;
    stiffness.block(pattern.slot(b, b)) += k;
    stiffness.block(pattern.slot(a, b)) -= k;
    stiffness.block(pattern.slot(b, a)) -= k;
  };
  const auto direction_product = [&](Index a, Index b) -> Mat3<double> {
    const Vec3<double> n = (model.mesh.position(b) - model.mesh.position(a)).normalized();
    return n * n.transpose();
  };
  if (law == SpringLaw::same) {
    for (Index a = 0; a < pattern.rows(); ++a)
      for (Index s = pattern.diagonal[at(a)] + 1; s < pattern.row_start[at(a) + 1]; ++s)
        add(a, pattern.column[at(s)], strength * direction_product(a, pattern.column[at(s)]));
    return stiffness;
  }
  for (const auto& nodes : model.mesh.elements()) {
    const auto x = [&](std::size_t i) { return model.mesh.position(nodes[i]); };
    const double volume = (x(1) - x(0)).cross(x(2) - x(0)).dot(x(3) - x(0)) / 6;
    for (const auto& [a, b] : tet_edges) {
      const Index i = nodes[a], j = nodes[b];
      add(i, j, strength * volume / (x(a) - x(b)).squaredNorm() * direction_product(i, j));
    }
  }
  return stiffness;
}

/// How far the middle of the free end drops, m; -1 if the matrix is singular.
template <class Element>
double drop(const Model<Element>& model, const BlockMatrix<double>& stiffness) {
  const auto u = model.solve(stiffness, model.weight());
  if (!u) return -1;
  return -(*u)[at(model.mesh.nearest_vertex({beam::length, 0, 0}))].z();
}

/// What a pull says of a beam as a material: measured in its middle, four thicknesses from where it is held and pulled.
struct Measured {
  double young = 0;                     ///< Pa
  double poisson_y = 0, poisson_z = 0;  ///< lateral contraction along each axis
  double shear = 0;                     ///< shear strain per stretch: 0 for an isotropic material
};

template <class Element>
std::optional<Measured> pull_test(const Model<Element>& model, const BlockMatrix<double>& stiffness) {
  const auto u = model.solve(stiffness, model.pull());
  if (!u) return {};
  // Least squares: the best uniform displacement gradient of the middle.
  Mat3<double> moment = Mat3<double>::Zero(), product = Mat3<double>::Zero();
  Vec3<double> mean_x = Vec3<double>::Zero(), mean_u = Vec3<double>::Zero();
  std::vector<Index> middle;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    if (std::abs(model.mesh.position(v).x() - beam::length / 2) < 0.1 + 1e-6) middle.push_back(v);
  for (const Index v : middle) {
    mean_x += model.mesh.position(v) / double(middle.size());
    mean_u += (*u)[at(v)] / double(middle.size());
  }
  for (const Index v : middle) {
    const Vec3<double> x = model.mesh.position(v) - mean_x;
    moment += x * x.transpose();
    product += ((*u)[at(v)] - mean_u) * x.transpose();
  }
  const Mat3<double> gradient = product * moment.inverse();
  const double stretch = gradient(0, 0);
  return Measured{1 / beam::area / stretch, -gradient(1, 1) / stretch, -gradient(2, 2) / stretch,
                  std::hypot(gradient(1, 0) + gradient(0, 1), gradient(2, 0) + gradient(0, 2)) / stretch};
}

/// The beam with `n` cells through its thickness; `jitter`: interior vertices moved at random, in cells.
template <class Element>
std::optional<Model<Element>> cut(Index n, BlockSplit split, double jitter) {
  auto block = make_block({.corner = {0, -beam::thickness / 2, -beam::thickness / 2},
                           .size = {beam::length, beam::thickness, beam::thickness},
                           .cells = {10 * n, n, n},
                           .split = split,
                           .order = Element::order});
  if (!block) return {};
  std::mt19937 engine(1);
  const double cell = beam::thickness / n, half = beam::thickness / 2 - 1e-6;
  for (Vec3<double>& x : block->positions) {
    Vec3<double> move;
    for (int i = 0; i < 3; ++i) move[i] = jitter * cell * (2 * double(engine()) / double(std::mt19937::max()) - 1);
    // On the surface, only along it; the two ends stay.
    if (x.x() < 1e-6 || x.x() > beam::length - 1e-6) continue;
    for (int i = 1; i < 3; ++i)
      if (std::abs(x[i]) > half) move[i] = 0;
    x += move;
  }
  auto mesh = TetMesh<double, Element>::create(std::move(*block));
  if (!mesh) return std::fprintf(stderr, "%s\n", mesh.error().message().c_str()), std::nullopt;
  return Model<Element>(std::move(*mesh));
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::strcmp(argv[1], "quick") == 0;  // leaves out the finest meshes
  const Material material = beam::material(0.1, 0.3);
  const double exact = beam::timoshenko_tip(material);
  const auto reference = cut<Tet4>(2, BlockSplit::alternating5, 0);
  if (!reference) return 1;

  // Springs know no E: their strength is chosen so that one mesh bends as the beam does.
  std::array<double, 2> strength{};
  for (const SpringLaw law : {SpringLaw::same, SpringLaw::gelder})
    strength[std::size_t(law)] = drop(*reference, spring_stiffness(*reference, law, 1)) / exact;

  std::printf("Beam 1 x 0.1 x 0.1 m under its own weight, poisson 0.3: tip drop / Timoshenko's, %.5f m.\n", exact);
  std::printf("Springs calibrated on 20x2x2, alternating: k = %.4g N/m, c = %.3f E\n\n", strength[0],
              strength[1] / material.young);
  std::printf("| mesh | springs, one k | springs, k = c V/l^2 | Tet4 | Tet10 |\n| --- | --- | --- | --- | --- |\n");
  struct Row {
    const char* name;
    Index n;
    BlockSplit split;
    double jitter;
    bool quadratic;
  };
  const std::vector<Row> rows{{"10x1x1, alternating", 1, BlockSplit::alternating5, 0, true},
                              {"20x2x2, alternating", 2, BlockSplit::alternating5, 0, true},
                              {"40x4x4, alternating", 4, BlockSplit::alternating5, 0, !quick},
                              {"80x8x8, alternating", 8, BlockSplit::alternating5, 0, false},
                              {"40x4x4, Kuhn", 4, BlockSplit::kuhn6, 0, false},
                              {"40x4x4, irregular", 4, BlockSplit::alternating5, 0.2, false}};
  for (const Row& row : rows) {
    if (quick && row.n == 8) continue;
    const auto model = cut<Tet4>(row.n, row.split, row.jitter);
    if (!model) return 1;
    std::printf("| %-20s | %.3f | %.3f | %.3f |", row.name,
                drop(*model, spring_stiffness(*model, SpringLaw::same, strength[0])) / exact,
                drop(*model, spring_stiffness(*model, SpringLaw::gelder, strength[1])) / exact,
                drop(*model, elastic_stiffness(*model, material)) / exact);
    if (row.quadratic) {
      const auto quadratic = cut<Tet10>(row.n, row.split, row.jitter);
      if (!quadratic) return 1;
      std::printf(" %.3f |\n", drop(*quadratic, elastic_stiffness(*quadratic, material)) / exact);
    } else {
      std::printf(" |\n");
    }
  }

  std::printf(
      "\nThe same beams pulled: the material that is measured in their middle, E in units of what was asked.\n\n");
  std::printf("| model and mesh | asked: poisson | E | poisson y | poisson z | shear / stretch |\n");
  std::printf("| --- | --- | --- | --- | --- | --- |\n");
  const auto print = [&](const char* what, const char* name, const char* asked, const std::optional<Measured>& m) {
    const auto tidy = [](double x) { return std::abs(x) < 5e-5 ? 0 : x; };  // no "-0.0000"
    if (m)
      std::printf("| %s, %s | %s | %.4f | %.4f | %.4f | %.4f |\n", what, name, asked, m->young / material.young,
                  tidy(m->poisson_y), tidy(m->poisson_z), m->shear);
  };
  for (const Row& row : rows) {
    if (row.n == 8 || row.n == 1) continue;
    const auto model = cut<Tet4>(row.n, row.split, row.jitter);
    if (!model) return 1;
    print("one k", row.name, "no input", pull_test(*model, spring_stiffness(*model, SpringLaw::same, strength[0])));
    print("k = c V/l^2", row.name, "no input",
          pull_test(*model, spring_stiffness(*model, SpringLaw::gelder, strength[1])));
    for (const double poisson : {0.0, 0.3, 0.45}) {
      if (poisson != 0.3 && row.jitter == 0) continue;
      Material asked = material;
      asked.poisson = poisson;
      std::array<char, 16> text{};
      std::snprintf(text.data(), text.size(), "%.2f", poisson);
      print("Tet4", row.name, text.data(), pull_test(*model, elastic_stiffness(*model, asked)));
    }
  }
  return 0;
}
