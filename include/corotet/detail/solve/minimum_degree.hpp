// The order in which to eliminate vertices so that a Cholesky factor stays sparse.
#pragma once

#include <algorithm>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Approximate minimum degree (Amestoy, Davis & Duff 1996, "An approximate minimum degree ordering algorithm") on the
/// graph of a pattern: a quotient graph of variables that are left and elements that were eliminated, with aggressive
/// absorption of elements, mass elimination, and variables that are coupled to the same merged into one. (Eigen has the
/// same; its sparse headers alone cost as much compile time as a third of this library. The tests compare the two.)
class MinimumDegree {
 public:
  /// Entry k is the row to eliminate as k-th.
  [[nodiscard]] COROTET_COLD static std::vector<Index> order(const BlockPattern& pattern) {
    MinimumDegree graph(pattern);
    graph.eliminate();
    return std::move(graph.order_);
  }

 private:
  /// A variable, or the element that it becomes when it is eliminated.
  struct Node {
    Index start = 0;     ///< of its entries in `entry_`
    Index elements = 0;  ///< of a variable, how many of its entries are elements: they come first
    Index entries = 0;   ///< of a variable, elements and variables that share none of these with it; of an element, the
                         ///< variables that it couples
    Index weight = 1;    ///< of a variable, how many it stands for: 0 once it is eliminated or merged into another
    Index degree = 0;    ///< of a variable, at most; of an element, the weight of its variables
    Index step = -1;     ///< of a variable, the last in which it was on the boundary; of an element, see `outside`
    Index outside = 0;   ///< of an element, the weight of its variables that are not on the boundary of `step`
    bool absorbed = false;  ///< an element that is part of another
    Index next = none,
          previous = none;  ///< variables of equal degree, in the outer loop; of equal sums in `merge_equals`
  };

  COROTET_COLD explicit MinimumDegree(const BlockPattern& pattern)
      : count_(pattern.rows()),
        node_(at(count_)),
        first_(at(count_) + 1, none),
        bucket_(at(count_), none),
        bucket_step_(at(count_), -1),
        compared_(at(count_), none),
        twin_(at(count_), none),
        last_(at(count_)) {
    order_.reserve(at(count_));
    entry_.resize(3 * pattern.column.size() + at(count_));
    for (Index i = count_ - 1; i >= 0; --i) {
      Node& node = node_[at(i)];
      node.start = end_;
      for (Index k = pattern.row_start[at(i)]; k < pattern.row_start[at(i) + 1]; ++k)
        if (pattern.column[at(k)] != i) entry_[at(end_++)] = pattern.column[at(k)];
      node.entries = end_ - node.start;
      last_[at(i)] = i;
      insert(i, node.entries);
    }
  }

  COROTET_COLD void eliminate() {
    Index least = 0;
    while (size_of(order_) < count_) {
      while (first_[at(least)] == none) ++least;
      const Index pivot = first_[at(least)], step = size_of(order_);
      remove(pivot);
      append(pivot);
      find_boundary(pivot, step);
      Node& element = node_[at(pivot)];
      if (element.degree == count_ - size_of(order_)) {  // all that is left is coupled to all: any order
        for (Index k = 0; k < element.entries; ++k) append(entry_[at(element.start + k)]);
        return;
      }
      count_outside(element, step);
      for (Index k = 0; k < element.entries; ++k) update(entry_[at(element.start + k)], pivot, step);
      merge_equals(element, step);
      Index kept = 0;
      const Index left = count_ - size_of(order_);
      for (Index k = 0; k < element.entries; ++k) {
        const Index i = entry_[at(element.start + k)];
        const Node& variable = node_[at(i)];
        if (variable.weight == 0) continue;
        entry_[at(element.start + kept++)] = i;
        insert(i, (std::min)(variable.degree, left - variable.weight));
        least = (std::min)(least, variable.degree);
      }
      element.entries = kept;
    }
  }

  /// Makes the pivot an element: its entries become the variables that it couples. Elements that it was coupled to are
  /// part of it from now on.
  COROTET_COLD void find_boundary(Index pivot, Index step) {
    Node& element = node_[at(pivot)];
    Index most = element.entries;
    for (Index k = 0; k < element.elements; ++k) most += node_[at(entry_[at(element.start + k)])].entries;
    if (size_of(entry_) - end_ < most) entry_.resize(2 * entry_.size() + at(most));
    const Index begin = end_;
    element.step = step;
    element.degree = 0;
    const auto add = [&](Index first, Index last) {
      for (Index k = first; k < last; ++k) {
        Node& variable = node_[at(entry_[at(k)])];
        if (variable.step == step || variable.weight == 0) continue;
        variable.step = step;
        entry_[at(end_++)] = entry_[at(k)];
        element.degree += variable.weight;
      }
    };
    for (Index k = 0; k < element.elements; ++k) {
      Node& part = node_[at(entry_[at(element.start + k)])];
      add(part.start, part.start + part.entries);
      part.absorbed = true;
    }
    add(element.start + element.elements, element.start + element.entries);
    element.start = begin;
    element.entries = end_ - begin;
    element.elements = 0;
  }

  /// Sets `outside` of the elements that touch the boundary of the new one.
  COROTET_COLD void count_outside(const Node& boundary, Index step) {
    for (Index k = 0; k < boundary.entries; ++k) {
      const Node& variable = node_[at(entry_[at(boundary.start + k)])];
      for (Index m = 0; m < variable.elements; ++m) {
        Node& element = node_[at(entry_[at(variable.start + m)])];
        if (element.absorbed) continue;
        if (element.step != step) {
          element.step = step;
          element.outside = element.degree;
        }
        element.outside -= variable.weight;
      }
    }
  }

  /// A variable on the boundary of the new element, out of the lists of degrees: what it is coupled to otherwise, and
  /// its degree, an upper bound. If that is nothing, the variable is eliminated along.
  COROTET_COLD void update(Index i, Index pivot, Index step) {
    Node& variable = node_[at(i)];
    Node& boundary = node_[at(pivot)];
    remove(i);
    Index sum = 0, end = variable.start;
    for (Index k = 0; k < variable.elements; ++k) {
      const Index e = entry_[at(variable.start + k)];
      Node& element = node_[at(e)];
      if (element.outside == 0) element.absorbed = true;  // which is part of the new one
      if (element.absorbed) continue;
      entry_[at(end++)] = e;
      sum += element.outside;
    }
    const Index elements = end - variable.start;
    for (Index k = variable.elements; k < variable.entries; ++k) {
      const Index j = entry_[at(variable.start + k)];
      const Node& other = node_[at(j)];
      if (other.step == step || other.weight == 0) continue;
      entry_[at(end++)] = j;
      sum += other.weight;
    }
    if (sum == 0) {
      boundary.degree -= variable.weight;
      append(i);
      return;
    }
    // One entry at least was dropped: the pivot, or an element that is part of it. The new element takes the place.
    entry_[at(end)] = entry_[at(variable.start + elements)];
    entry_[at(variable.start + elements)] = entry_[at(variable.start)];
    entry_[at(variable.start)] = pivot;
    variable.elements = elements + 1;
    variable.entries = end + 1 - variable.start;
    const Index others = boundary.degree - variable.weight;
    variable.degree = (std::min)({count_ - size_of(order_) - variable.weight, variable.degree + others, sum + others});
  }

  /// Variables on the boundary that are coupled to the same variables and elements become one, which has the weight of
  /// all: they would be eliminated one after the other. Only those whose entries have the same sum are compared.
  COROTET_COLD void merge_equals(const Node& boundary, Index step) {
    for (Index b = 0; b < boundary.entries; ++b) {
      const Index i = entry_[at(boundary.start + b)];
      Node& variable = node_[at(i)];
      if (variable.weight == 0) continue;
      std::int64_t sum = 0;
      for (Index k = 0; k < variable.entries; ++k) sum += entry_[at(variable.start + k)];
      const auto bucket = static_cast<std::size_t>(sum % count_);
      if (std::exchange(bucket_step_[bucket], step) != step) bucket_[bucket] = none;
      bool marked = false;
      for (Index j = bucket_[bucket]; j != none && variable.weight > 0; j = node_[at(j)].next) {
        const Node& other = node_[at(j)];
        if (other.entries != variable.entries || other.elements != variable.elements) continue;
        if (!std::exchange(marked, true))
          for (Index k = 0; k < variable.entries; ++k) compared_[at(entry_[at(variable.start + k)])] = i;
        Index k = 0;
        while (k < other.entries && compared_[at(entry_[at(other.start + k)])] == i) ++k;
        if (k == other.entries) merge(i, j);
      }
      if (variable.weight > 0) variable.next = std::exchange(bucket_[bucket], i);
    }
  }

  /// i becomes part of j.
  void merge(Index i, Index j) {
    node_[at(j)].degree -= node_[at(i)].weight;  // the degree counts others only
    node_[at(j)].weight += std::exchange(node_[at(i)].weight, 0);
    twin_[at(last_[at(j)])] = i;
    last_[at(j)] = last_[at(i)];
  }

  /// Eliminates a variable and those that were merged into it.
  void append(Index i) {
    node_[at(i)].weight = 0;
    for (; i != none; i = twin_[at(i)]) order_.push_back(i);
  }

  // Variables of equal degree are a list, the last one that came first.
  void insert(Index i, Index degree) {
    Node& node = node_[at(i)];
    node.degree = degree;
    node.previous = none;
    node.next = std::exchange(first_[at(degree)], i);
    if (node.next != none) node_[at(node.next)].previous = i;
  }
  void remove(Index i) {
    const Index before = node_[at(i)].previous, after = node_[at(i)].next;
    if (after != none) node_[at(after)].previous = before;
    (before != none ? node_[at(before)].next : first_[at(node_[at(i)].degree)]) = after;
  }

  static constexpr Index none = -1;

  Index count_, end_ = 0;  // end_: of the entries in use
  Buffer<Node> node_;
  std::vector<Index> entry_;
  std::vector<Index> order_, first_;                    // first_: variable of each degree
  std::vector<Index> bucket_, bucket_step_, compared_;  // see merge_equals
  std::vector<Index> twin_, last_;                      // lists of merged variables
};

}  // namespace corotet::inline v0_1::detail
