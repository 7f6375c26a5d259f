// The state of a material at each quadrature point of a body.
#pragma once

#include <concepts>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/material/elastic_model.hpp>
#include <cstddef>

namespace corotet::inline v0_1 {

/// One Model::State for each batch and point; an empty class for a model without state.
template <std::floating_point Scalar, ElasticModel Model>
class PointStates {
 public:
  using State = typename Model::template State<Scalar>;  ///< of a quadrature point of a batch

  PointStates() = default;
  /// Every point at rest.
  PointStates(std::size_t batches, std::size_t points) : points_(points), state_(batches * points) {}

  /// The state of quadrature point `point` of a batch.
  [[nodiscard]] const State& get(std::size_t point, Index batch) const { return state_[at(batch) * points_ + point]; }
  /// Sets the state of quadrature point `point` of a batch.
  void set(std::size_t point, Index batch, const State& state) { state_[at(batch) * points_ + point] = state; }

  /// For snapshots.
  void visit_state(detail::StateArchive& archive) {
    const std::size_t numbers = state_.size() * sizeof(State) / sizeof(Scalar);
    archive.expect(numbers);
    archive.some(reinterpret_cast<Scalar*>(state_.data()), numbers);
  }

  /// Points of all batches.
  [[nodiscard]] std::size_t size() const { return state_.size(); }

 private:
  std::size_t points_ = 0;
  detail::Buffer<State> state_;  // [batch][point]
};

template <std::floating_point Scalar, ElasticModel Model>
  requires(!detail::has_state<Model>)
class PointStates<Scalar, Model> {
 public:
  using State = typename Model::template State<Scalar>;

  PointStates() = default;
  PointStates(std::size_t /*batches*/, std::size_t /*points*/) {}

  [[nodiscard]] State get(std::size_t /*point*/, Index /*batch*/) const { return {}; }
  void set(std::size_t /*point*/, Index /*batch*/, const State& /*state*/) {}
  [[nodiscard]] std::size_t size() const { return 0; }
};

}  // namespace corotet::inline v0_1
