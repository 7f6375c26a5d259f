// How a body is divided into aggregates of vertices, and those into coarse aggregates.
#pragma once

#include <algorithm>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/index_list.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/aggregates.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <span>
#include <vector>

namespace corotet::inline v0_1::detail {

/// The part of RigidAggregates that follows from the pattern and the rest configuration alone; copies share one.
/// Without a coarse level each aggregate is a coarse aggregate of its own.
template <std::floating_point Scalar>
struct AggregateHierarchy {
  Field<Scalar> rest;           ///< m
  Aggregates fine, coarse;      ///< of vertices; of fine aggregates
  bool two_levels = true;       ///< there is no coarse level: fine aggregates are coupled directly
  Field<Scalar> fine_center;    ///< mean rest position of the vertices, m
  Field<Scalar> coarse_center;  ///< mean of the fine centres, m; empty without a coarse level

  COROTET_COLD AggregateHierarchy(const Field<Scalar>& rest_positions, Index fine_count, Index coarse_count)
      : rest(rest_positions),
        fine(Aggregates::of_positions(rest, std::clamp<Index>(fine_count, 1, size_of(rest)))),
        two_levels(coarse_count == 0),
        fine_center(at(fine.count()), Vec3<Scalar>::Zero()) {
    for (Index a = 0; a < fine.count(); ++a) {
      Vec3<double> sum = Vec3<double>::Zero();
      for (const Index v : vertices_of(a)) sum += rest[at(v)].template cast<double>();
      fine_center[at(a)] = (sum / double(vertices_of(a).size())).template cast<Scalar>();
    }
    if (two_levels) {
      set_single_aggregates();
      return;
    }
    coarse = Aggregates::of_positions(fine_center, std::clamp<Index>(coarse_count, 1, fine.count()));
    coarse_center = Field<Scalar>(at(coarse.count()), Vec3<Scalar>::Zero());
    for (Index c = 0; c < coarse.count(); ++c) coarse_center[at(c)] = mean_of_fine(c, fine_center);
  }

  [[nodiscard]] std::span<const Index> vertices_of(Index aggregate) const { return fine.members(aggregate); }
  [[nodiscard]] std::span<const Index> fine_of(Index coarse_aggregate) const {
    return coarse.members(coarse_aggregate);
  }
  [[nodiscard]] Index coarse_of(Index vertex) const { return coarse.aggregate_of[at(fine.aggregate_of[at(vertex)])]; }
  /// 0 without a coarse level.
  [[nodiscard]] Index coarse_count() const { return size_of(coarse_center); }

  /// Of a value of the fine aggregates, in a coarse one.
  template <class Values>
  [[nodiscard]] Vec3<Scalar> mean_of_fine(Index coarse_aggregate, const Values& value) const {
    Vec3<Scalar> sum = Vec3<Scalar>::Zero();
    for (const Index a : fine_of(coarse_aggregate)) sum += value[at(a)];
    return sum / static_cast<Scalar>(fine_of(coarse_aggregate).size());
  }

  /// Calls `body(aggregate)` for each fine aggregate, some of them a task.
  template <class Body>
  void for_fine(ExecutorRef executor, Body&& body) const {
    const Index vertices_each = std::max<Index>(1, size_of(rest) / fine.count());
    for_ranges(executor, fine.count(), std::max<Index>(1, DeterministicSum::grain / vertices_each),
               [&](Index begin, Index end) {
                 for (Index a = begin; a < end; ++a) body(a);
               });
  }

  /// Which coarse aggregates the matrix of the body couples.
  [[nodiscard]] COROTET_COLD BlockPattern coarse_pattern(const BlockPattern& pattern) const {
    BlockPattern p;
    p.row_start.assign(1, 0);
    std::vector<Index> row;
    for (Index c = 0; c < coarse.count(); ++c) {
      row.clear();
      for (const Index a : fine_of(c))
        for (const Index v : vertices_of(a))
          for (Index k = pattern.row_start[at(v)]; k < pattern.row_start[at(v) + 1]; ++k)
            if (const Index other = coarse_of(pattern.column[at(k)]); row.empty() || row.back() != other)
              row.push_back(other);
      sort_and_unite(row);
      p.diagonal.push_back(size_of(p.column) +
                           static_cast<Index>(std::lower_bound(row.begin(), row.end(), c) - row.begin()));
      append(p.column, row);
      p.row_start.push_back(size_of(p.column));
    }
    return p;
  }

  [[nodiscard]] std::size_t bytes() const {
    return bytes_of(rest) + fine.bytes() + coarse.bytes() + bytes_of(fine_center) + bytes_of(coarse_center);
  }

 private:
  COROTET_COLD void set_single_aggregates() {
    for (Index a = 0; a <= fine.count(); ++a) coarse.start.push_back(a);
    for (Index a = 0; a < fine.count(); ++a) coarse.member.push_back(a);
    coarse.aggregate_of = coarse.member;
  }
};

}  // namespace corotet::inline v0_1::detail
