// The order in which to eliminate vertices so that a Cholesky factor stays sparse.
#pragma once

#include <algorithm>
#include <corotet/assembly/block_pattern.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/types.hpp>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// Approximate minimum degree (Amestoy, Davis & Duff 1996, "An approximate minimum degree ordering algorithm") on the
/// graph of a pattern: a quotient graph of variables that are left and elements that were eliminated, with aggressive
/// absorption of elements, and variables that are coupled to the same merged into one. (Eigen has the same; its sparse
/// headers alone cost as much compile time as a third of this library. The tests compare the two.)
class MinimumDegree {
 public:
  /// Entry k is the row to eliminate as k-th.
  [[nodiscard]] COROTET_COLD static std::vector<Index> order(const BlockPattern& pattern) {
    MinimumDegree graph(pattern);
    return graph.eliminate();
  }

 private:
  COROTET_COLD explicit MinimumDegree(const BlockPattern& pattern)
      : count_(pattern.rows()),
        neighbours_(at(count_)),
        elements_(at(count_)),
        boundary_(at(count_)),
        absorbed_(at(count_), false),
        outside_(at(count_), 0),
        seen_(at(count_), -1),
        mark_(at(count_), -1),
        size_(at(count_), 0),
        weight_(at(count_), 1),
        twin_(at(count_), none),
        last_(at(count_)),
        bucket_(at(count_), none),
        bucket_step_(at(count_), -1),
        next_in_bucket_(at(count_), none),
        degree_(at(count_), 0),
        first_(at(count_ + 1), none),
        next_(at(count_), none),
        previous_(at(count_), none) {
    std::iota(last_.begin(), last_.end(), 0);
    for (Index i = count_ - 1; i >= 0; --i) {
      for (Index k = pattern.row_start[at(i)]; k < pattern.row_start[at(i) + 1]; ++k)
        if (pattern.column[at(k)] != i) neighbours_[at(i)].push_back(pattern.column[at(k)]);
      insert(i, size_of(neighbours_[at(i)]));
    }
  }

  [[nodiscard]] COROTET_COLD std::vector<Index> eliminate() {
    std::vector<Index> order;
    order.reserve(at(count_));
    Index least = 0;
    while (size_of(order) < count_) {
      while (first_[at(least)] == none) ++least;
      const Index pivot = first_[at(least)], step = size_of(order);
      remove(pivot);
      append(pivot, order);
      find_boundary(pivot, step);
      std::vector<Index>& boundary = boundary_[at(pivot)];
      const Index left = count_ - size_of(order);
      if (size_[at(pivot)] == left) {  // all that is left is coupled to all: any order
        for (const Index i : boundary) append(i, order);
        break;
      }
      count_outside(boundary, step);
      for (const Index i : boundary) update(i, pivot, step, left);
      merge_equals(boundary, step);
      std::erase_if(boundary, [&](Index i) { return weight_[at(i)] == 0; });
      for (const Index i : boundary) {
        insert(i, (std::min)(degree_[at(i)], left - weight_[at(i)]));
        least = (std::min)(least, degree_[at(i)]);
      }
    }
    return order;
  }

  /// The variables that the pivot, an element from now on, couples. Elements that it was coupled to are part of it.
  COROTET_COLD void find_boundary(Index pivot, Index step) {
    std::vector<Index>& boundary = boundary_[at(pivot)];
    mark_[at(pivot)] = step;
    size_[at(pivot)] = 0;
    const auto add = [&](Index j) {
      if (mark_[at(j)] == step || weight_[at(j)] == 0) return;
      mark_[at(j)] = step;
      boundary.push_back(j);
      size_[at(pivot)] += weight_[at(j)];
    };
    for (const Index j : neighbours_[at(pivot)]) add(j);
    for (const Index e : elements_[at(pivot)]) {
      for (const Index j : boundary_[at(e)]) add(j);
      absorb(e);
    }
    std::vector<Index>().swap(neighbours_[at(pivot)]);
    std::vector<Index>().swap(elements_[at(pivot)]);
  }

  /// outside_[e]: how many variables of element e are not on the new boundary, for elements that touch it.
  COROTET_COLD void count_outside(const std::vector<Index>& boundary, Index step) {
    for (const Index i : boundary)
      for (const Index e : elements_[at(i)]) {
        if (absorbed_[at(e)]) continue;
        if (seen_[at(e)] != step) {
          seen_[at(e)] = step;
          outside_[at(e)] = size_[at(e)];
        }
        outside_[at(e)] -= weight_[at(i)];
      }
  }

  /// A variable on the boundary of the new element, out of the lists of degrees: what it is coupled to otherwise, and
  /// its degree, an upper bound.
  COROTET_COLD void update(Index i, Index pivot, Index step, Index left) {
    const Index others = size_[at(pivot)] - weight_[at(i)];
    Index sum = others;
    remove(i);
    std::erase_if(elements_[at(i)], [&](Index e) {
      if (!absorbed_[at(e)] && outside_[at(e)] == 0) absorb(e);
      if (absorbed_[at(e)]) return true;
      sum += outside_[at(e)];
      return false;
    });
    elements_[at(i)].push_back(pivot);
    std::erase_if(neighbours_[at(i)], [&](Index j) {
      if (mark_[at(j)] == step || weight_[at(j)] == 0) return true;
      sum += weight_[at(j)];
      return false;
    });
    degree_[at(i)] = (std::min)({left - weight_[at(i)], degree_[at(i)] + others, sum});
  }

  /// Variables on the boundary that are coupled to the same variables and elements become one, which has the weight of
  /// all: they would be eliminated one after the other. Only those whose neighbours have the same sum are compared.
  COROTET_COLD void merge_equals(const std::vector<Index>& boundary, Index step) {
    for (const Index i : boundary) {
      std::sort(neighbours_[at(i)].begin(), neighbours_[at(i)].end());
      std::sort(elements_[at(i)].begin(), elements_[at(i)].end());
      std::int64_t sum = 0;
      for (const Index j : neighbours_[at(i)]) sum += j;
      for (const Index e : elements_[at(i)]) sum += e;
      const auto bucket = static_cast<std::size_t>(sum % count_);
      if (std::exchange(bucket_step_[bucket], step) != step) bucket_[bucket] = none;
      for (Index j = bucket_[bucket]; j != none; j = next_in_bucket_[at(j)])
        if (elements_[at(i)] == elements_[at(j)] && neighbours_[at(i)] == neighbours_[at(j)]) {
          merge(i, j);
          break;
        }
      if (weight_[at(i)] > 0) next_in_bucket_[at(i)] = std::exchange(bucket_[bucket], i);
    }
  }

  /// i becomes part of j.
  COROTET_COLD void merge(Index i, Index j) {
    degree_[at(j)] -= weight_[at(i)];  // the degree counts others only
    weight_[at(j)] += std::exchange(weight_[at(i)], 0);
    twin_[at(last_[at(j)])] = i;
    last_[at(j)] = last_[at(i)];
    std::vector<Index>().swap(neighbours_[at(i)]);
    std::vector<Index>().swap(elements_[at(i)]);
  }

  /// A variable and those that were merged into it.
  void append(Index i, std::vector<Index>& order) const {
    for (; i != none; i = twin_[at(i)]) order.push_back(i);
  }

  void absorb(Index element) {
    absorbed_[at(element)] = true;
    std::vector<Index>().swap(boundary_[at(element)]);
  }

  // Variables of equal degree are a list, the last one that came first.
  void insert(Index i, Index degree) {
    degree_[at(i)] = degree;
    previous_[at(i)] = none;
    next_[at(i)] = std::exchange(first_[at(degree)], i);
    if (next_[at(i)] != none) previous_[at(next_[at(i)])] = i;
  }
  void remove(Index i) {
    const Index before = previous_[at(i)], after = next_[at(i)];
    if (after != none) previous_[at(after)] = before;
    (before != none ? next_[at(before)] : first_[at(degree_[at(i)])]) = after;
  }

  static constexpr Index none = -1;

  Index count_;
  std::vector<std::vector<Index>> neighbours_;  // of a variable: variables that share no element with it
  std::vector<std::vector<Index>> elements_;    // of a variable
  std::vector<std::vector<Index>> boundary_;    // of an element: its variables
  std::vector<bool> absorbed_;                  // elements that became part of another
  std::vector<Index> outside_, seen_, mark_;
  std::vector<Index> size_;         // of an element: variables on its boundary, merged ones counted
  std::vector<Index> weight_;       // of a variable: how many it stands for, 0 once it is merged into another
  std::vector<Index> twin_, last_;  // lists of merged variables
  std::vector<Index> bucket_, bucket_step_, next_in_bucket_;  // see merge_equals
  std::vector<Index> degree_, first_, next_, previous_;
};

}  // namespace corotet::inline v0_1
