#include "test_body.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <utility>

#include "../failure.hpp"
#include "../momenta.hpp"

namespace corotet::program::stress {

TestBody::TestBody(const Scene& scene, MeshData mesh)
    : scene_(scene), mesh_(std::move(mesh)), simulation_(make_simulation(scene_, mesh_)) {}

void TestBody::place(const std::function<Vec3<double>(Index)>& position) {
  Field<double> positions;
  for (Index v = 0; v < vertices(); ++v) positions.push_back(position(v));
  require(simulation_->set_positions(positions));
}

void TestBody::push(const std::function<Vec3<double>(Index)>& velocity) {
  Field<double> velocities;
  for (Index v = 0; v < vertices(); ++v) velocities.push_back(velocity(v));
  require(simulation_->set_velocities(velocities));
}

std::vector<Index> TestBody::pin(const std::function<bool(const Vec3<double>&)>& where) {
  std::vector<Index> pinned;
  for (Index v = 0; v < vertices(); ++v) {
    if (!where(rest(v))) continue;
    simulation_->pin(v);
    pinned.push_back(v);
  }
  return pinned;
}

void TestBody::touch(const ContactOptions& options) {
  ContactScene contact;
  contact.options = options;
  require(simulation_->touch(obstacles, contact));
}

bool TestBody::step() {
  if (!error_.empty()) return false;
  clock_.start();
  last_ = simulation_->step(scene_.dt, pool_, clock_);
  counts_.add(last_);
  if (!last_.accepted()) error_ = fmt::format("step {} was refused: {}", counts_.accepted + 1, last_.advice());
  obstacles.advance(scene_.dt);
  return error_.empty();
}

bool TestBody::run(int steps, const std::function<bool()>& stop) {
  for (int i = 0; i < steps; ++i) {
    if (!step()) return false;
    if (stop && stop()) break;
  }
  return error_.empty();
}

bool TestBody::finite() const {
  for (Index v = 0; v < vertices(); ++v)
    if (!simulation_->displacement(v).allFinite() || !simulation_->velocity(v).allFinite()) return false;
  return true;
}

double TestBody::max_speed() const {
  double largest = 0;
  for (Index v = 0; v < vertices(); ++v) largest = std::max(largest, simulation_->velocity(v).norm());
  return largest;
}

double TestBody::rms_to_rest() const {
  double sum = 0;
  for (Index v = 0; v < vertices(); ++v) sum += simulation_->displacement(v).squaredNorm();
  return std::sqrt(sum / vertices());
}

double TestBody::kinetic_energy() const {
  double sum = 0;
  for (Index v = 0; v < vertices(); ++v) sum += simulation_->vertex_mass(v) * simulation_->velocity(v).squaredNorm();
  return sum / 2;
}

double TestBody::energy() const {
  double lift = 0;
  for (Index v = 0; v < vertices(); ++v)
    lift -= simulation_->vertex_mass(v) * simulation_->displacement(v).dot(scene_.gravity);
  return kinetic_energy() + simulation_->elastic_energy() + lift;
}

Vec3<double> TestBody::centre() const { return centre_of_mass(*simulation_, vertices()); }
Vec3<double> TestBody::momentum() const { return linear_momentum(*simulation_, vertices()); }
Vec3<double> TestBody::angular_momentum() const {
  return program::angular_momentum(*simulation_, vertices(), centre());
}

double TestBody::inertia_radius() const {
  const Vec3<double> c = centre();
  double sum = 0, mass = 0;
  for (Index v = 0; v < vertices(); ++v) {
    sum += simulation_->vertex_mass(v) * (simulation_->position(v) - c).squaredNorm();
    mass += simulation_->vertex_mass(v);
  }
  return std::sqrt(sum / mass);
}

double TestBody::volume() const {
  double sum = 0;
  const auto nodes = at(mesh_.nodes_per_element);
  for (std::size_t first = 0; first < mesh_.connectivity.size(); first += nodes) {
    const auto x = [&](std::size_t k) { return simulation_->position(mesh_.connectivity[first + k]); };
    sum += (x(1) - x(0)).cross(x(2) - x(0)).dot(x(3) - x(0)) / 6;
  }
  return sum;
}

Index TestBody::folded_elements() const {
  Index folded = 0;
  const auto nodes = at(mesh_.nodes_per_element);
  for (std::size_t first = 0; first < mesh_.connectivity.size(); first += nodes) {
    const auto x = [&](std::size_t k) { return simulation_->position(mesh_.connectivity[first + k]); };
    const auto middle = [&](std::size_t a, std::size_t b) -> Vec3<double> {
      for (std::size_t e = 0; nodes == 10 && e < tet_edges.size(); ++e)
        if (std::minmax({a, b}) == std::minmax({tet_edges[e].a, tet_edges[e].b})) return x(4 + e);
      return (x(a) + x(b)) / 2;
    };
    bool inside_out = false;
    for (std::size_t a = 0; a < 4; ++a) {
      Mat3<double> edges;  // derivatives along the edges from corner a, which are a left hand's for odd a
      int column = 0;
      for (std::size_t b = 0; b < 4; ++b)
        if (b != a) edges.set_col(column++, 4 * middle(a, b) - 3 * x(a) - x(b));
      inside_out = inside_out || (a % 2 == 0 ? 1 : -1) * edges.determinant() <= 0;
    }
    if (inside_out) ++folded;
  }
  return folded;
}

void TestBody::report_to(CaseResult& verdict) const {
  verdict.steps.add(counts_);
  verdict.expect(error_.empty(), error_);
  verdict.expect(finite(), "a position or velocity is not finite");
}

MeshData block(int order) {
  return require(make_block(
      {.size = {1, 0.5, 0.5}, .cells = order == 1 ? std::array{4, 2, 2} : std::array{2, 1, 1}, .order = order}));
}

MeshData fine_block(int order) {
  return require(make_block({.size = {1, 0.5, 0.5}, .cells = {4, 2, 2}, .order = order}));
}

MeshData coarse_block(int order) {
  return require(make_block({.size = {1, 0.5, 0.5}, .cells = {2, 1, 1}, .order = order}));
}

namespace {

MeshData bar_of(const std::array<Index, 3>& cells, int order) {
  return require(make_block({.corner = {0, -0.1, -0.1}, .size = {1, 0.2, 0.2}, .cells = cells, .order = order}));
}

}  // namespace

MeshData bar(int order) { return order == 1 ? bar_of({10, 2, 2}, 1) : bar_of({5, 1, 1}, 2); }
MeshData coarse_bar(int order) { return bar_of({5, 1, 1}, order); }
MeshData twisted_bar(int order) { return bar_of({order == 1 ? 5 : 10, 1, 1}, order); }

}  // namespace corotet::program::stress
