// The order in which to eliminate vertices so that a Cholesky factor stays sparse.
#pragma once

#include <corotet/core/macros_off.hpp>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <corotet/core/macros_on.hpp>

#include <corotet/assembly/block_pattern.hpp>
#include <corotet/core/types.hpp>
#include <vector>

namespace corotet {

/// Approximate minimum degree (Amestoy, Davis & Duff 1996) on the graph of the vertices, by Eigen: entry k is the
/// vertex to eliminate as k-th.
[[nodiscard]] inline std::vector<Index> fill_reducing_order(const BlockPattern& pattern) {
  using Graph = Eigen::SparseMatrix<char, Eigen::ColMajor, Index>;
  const std::vector<char> ones(pattern.column.size(), 1);
  const Graph graph = Eigen::Map<const Graph>(pattern.rows(), pattern.rows(), pattern.blocks(),
                                              pattern.row_start.data(), pattern.column.data(), ones.data());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> permutation;
  Eigen::AMDOrdering<Index>()(graph, permutation);
  return {permutation.indices().data(), permutation.indices().data() + pattern.rows()};
}

}  // namespace corotet
