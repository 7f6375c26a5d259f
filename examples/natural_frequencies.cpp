// How good is a mass matrix? The first bending frequencies of a cantilever, for both elements and both mass models,
// against Timoshenko's beam. Uses the library's parts without time steps: stiffness, mass, sparse Cholesky.
//
//   natural_frequencies
#include <Eigen/Eigenvalues>
#include <cmath>
#include <corotet/eigen.hpp>
#include <corotet/matrices.hpp>
#include <corotet/solvers.hpp>
#include <cstdio>

#include "self_weight_beam.hpp"

using namespace corotet;

namespace {

/// The `count` lowest eigenvalues of K x = w^2 M x with the clamped vertices fixed, by subspace iteration (Bathe &
/// Wilson 1972). rad^2/s^2, ascending; empty if K cannot be factored.
template <class Body>
Eigen::VectorXd lowest_eigenvalues(const Body& body, int count) {
  SerialExecutor serial;
  const auto n = Eigen::Index{3} * body.vertex_count();
  typename Body::Law::Evaluation state(body.law());
  body.law().evaluate(body.displacements(), state, serial);
  BlockMatrix<double> stiffness(body.pattern());
  assemble(body.law(), state, body.mass(), 0.0, 1.0, stiffness, serial);
  for (const Index v : body.pins().vertices()) stiffness.isolate(v);
  BlockCholesky<double> factor;
  factor.analyze(*body.pattern());
  if (!factor.factorize(stiffness)) return {};

  const auto times_mass = [&](const Field<double>& x) {
    Field<double> y(x.size());
    for (Index i = 0; i < body.vertex_count(); ++i) y[at(i)] = body.mass().row_product(*body.pattern(), i, x);
    for (const Index v : body.pins().vertices()) y[at(v)].setZero();
    return y;
  };
  const int vectors = count + 8;
  Eigen::MatrixXd basis = Eigen::MatrixXd::NullaryExpr(n, vectors, [](auto i, auto j) {
    return std::sin(1.0 + 12.9898 * double(i) + 78.233 * double(j));  // any start that is not special
  });
  Eigen::VectorXd eigenvalues = Eigen::VectorXd::Zero(vectors);
  for (int iteration = 0; iteration < 60; ++iteration) {
    Eigen::MatrixXd next(n, vectors), k_next(n, vectors), m_next(n, vectors);
    for (int j = 0; j < vectors; ++j) {
      Field<double> x(at(body.vertex_count())), solution(x.size());
      flat(x) = basis.col(j);
      const Field<double> right_side = times_mass(x);
      factor.solve(right_side, solution);
      next.col(j) = flat(solution);
      k_next.col(j) = flat(right_side);  // K times the solution
      m_next.col(j) = flat(times_mass(solution));
    }
    const Eigen::MatrixXd k_small = next.transpose() * k_next, m_small = next.transpose() * m_next;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> small(k_small, m_small);
    basis = next * small.eigenvectors();
    const double change = (small.eigenvalues() - eigenvalues).head(count).cwiseAbs().maxCoeff();
    eigenvalues = small.eigenvalues();
    if (change < 1e-9 * eigenvalues[count - 1]) break;
  }
  return eigenvalues.head(count);
}

template <class Element>
bool row(const char* name, std::array<Index, 3> cells, BlockSplit split, MassModel model) {
  const Material material = beam::material(1, 0);
  const auto mesh = beam::mesh<double, Element>(cells, split);
  if (!mesh) return false;
  auto body = SoftBody<double, Element>::create(*mesh, material, {.mass = model, .damping = {}});
  if (!body) return false;
  beam::hang(*body);
  const Eigen::VectorXd squared = lowest_eigenvalues(*body, 4);
  if (squared.size() != 4) return false;

  // Euler and Bernoulli, times Timoshenko's correction at length = 10 thicknesses and poisson = 0.
  const double unit =
      std::sqrt(material.young * beam::inertia / (beam::density * beam::area)) / (beam::length * beam::length);
  const double first = std::pow(1.8751040687, 2) * 0.99349 * unit, second = std::pow(4.6940911330, 2) * 0.95721 * unit;
  // A square section bends in two planes at the same frequency: the pairs come one after the other.
  const double w1 = std::sqrt((squared[0] + squared[1]) / 2), w2 = std::sqrt((squared[2] + squared[3]) / 2);
  std::printf("| %-28s | %8d | %-10s | %+7.2f %% | %+7.2f %% |\n", name, mesh->vertex_count(),
              model == MassModel::lumped ? "lumped" : "consistent", 100 * (w1 / first - 1), 100 * (w2 / second - 1));
  return true;
}

}  // namespace

int main() {
  std::printf("Error of the first two bending frequencies, cantilever with length = 10 thicknesses, poisson = 0\n\n");
  std::printf("| mesh | vertices | mass | first | second |\n| --- | --- | --- | --- | --- |\n");
  bool ok = true;
  for (const MassModel model : {MassModel::lumped, MassModel::consistent}) {
    ok = ok && row<Tet4>("Tet4 20x2x2, alternating", {20, 2, 2}, BlockSplit::alternating5, model) &&
         row<Tet4>("Tet4 40x4x4, alternating", {40, 4, 4}, BlockSplit::alternating5, model) &&
         row<Tet4>("Tet4 40x4x4, Kuhn", {40, 4, 4}, BlockSplit::kuhn6, model) &&
         row<Tet10>("Tet10 5x1x1, alternating", {5, 1, 1}, BlockSplit::alternating5, model) &&
         row<Tet10>("Tet10 10x1x1, alternating", {10, 1, 1}, BlockSplit::alternating5, model) &&
         row<Tet10>("Tet10 20x2x2, alternating", {20, 2, 2}, BlockSplit::alternating5, model);
  }
  return ok ? 0 : 1;
}
