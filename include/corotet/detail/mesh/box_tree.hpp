// A tree of axis-aligned boxes over elements or triangles: what contains a point, what is nearest to it.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/box.hpp>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// What `BoxTree::nearest` found.
struct NearestPrimitive {
  static constexpr Index none = -1;
  Index primitive = none;
  double squared_distance = std::numeric_limits<double>::infinity();  ///< m^2
  std::int64_t visited = 0;                                           ///< boxes looked at: the cost of the query
};

/// Primitives 0 ... n-1, known by their boxes. Median splits make the depth log2(n) at most, so that queries need a
/// small fixed stack; construction is O(n log n). The tree depends on the boxes alone, not on the standard library.
class BoxTree {
 public:
  BoxTree() = default;

  /// `boxes[i]` bounds primitive i and must be finite and not empty.
  explicit BoxTree(const std::vector<Box>& boxes) {
    if (boxes.empty()) return;
    order_.resize(boxes.size());
    std::iota(order_.begin(), order_.end(), 0);
    nodes_.reserve(boxes.size());
    build(boxes);
    leaf_boxes_.reserve(boxes.size());
    for (const Index primitive : order_) leaf_boxes_.push_back(boxes[at(primitive)]);
  }

  /// Other boxes for the same primitives, as many as before: the tree keeps its shape. O(n), allocates nothing. Queries
  /// stay right, and cost more the farther primitives have moved apart.
  void refit(std::span<const Box> boxes) {
    COROTET_ASSERT(boxes.size() == order_.size(), "refitting needs one box for each primitive of the tree");
    for (std::size_t i = 0; i < order_.size(); ++i) leaf_boxes_[i] = boxes[at(order_[i])];
    for (Index n = size_of(nodes_) - 1; n >= 0; --n) {  // children come after their parent
      Node& node = nodes_[at(n)];
      node.box = Box{};
      if (node.right == leaf) {
        for (Index i = node.begin; i < node.end; ++i) node.box.add(leaf_boxes_[at(i)]);
      } else {
        node.box.add(nodes_[at(n + 1)].box);
        node.box.add(nodes_[at(node.right)].box);
      }
    }
  }

  [[nodiscard]] bool empty() const { return nodes_.empty(); }

  /// Bounds everything; empty for an empty tree.
  [[nodiscard]] Box bounds() const { return empty() ? Box{} : nodes_.front().box; }

  /// Calls `visit(primitive)` for every primitive whose box contains `p`; returns how many boxes were looked at.
  template <class Visit>
  std::int64_t for_each_containing(const Vec3<double>& p, Visit&& visit) const {
    std::int64_t visited = 0;
    if (empty()) return visited;
    std::array<Index, stack_size> stack;
    Index top = 0;
    stack[at(top++)] = 0;
    while (top > 0) {
      const Index n = stack[at(--top)];
      const Node& node = nodes_[at(n)];
      ++visited;
      if (!node.box.contains(p)) continue;
      if (node.right == leaf) {
        for (Index i = node.begin; i < node.end; ++i, ++visited)
          if (leaf_boxes_[at(i)].contains(p)) visit(order_[at(i)]);
      } else {
        stack[at(top++)] = node.right;
        stack[at(top++)] = n + 1;
      }
    }
    return visited;
  }

  /// The primitive nearest to `p`, by branch and bound: `squared_distance(primitive)` (m^2) is asked only where the box
  /// is nearer than the best so far, and must be no less than the distance of the box. Of several at the same distance
  /// the first one met is kept, always the same one for the same tree and point. Only what is nearer than sqrt(`most`)
  /// is found.
  template <class SquaredDistance>
  [[nodiscard]] NearestPrimitive nearest(const Vec3<double>& p, SquaredDistance&& squared_distance,
                                         double most = std::numeric_limits<double>::infinity()) const {
    NearestPrimitive best;
    best.squared_distance = most;
    if (empty()) return best;
    struct Entry {
      Index node;
      double squared_distance;
    };
    std::array<Entry, stack_size> stack;
    Index top = 0;
    stack[at(top++)] = {0, nodes_.front().box.squared_distance(p)};
    ++best.visited;
    while (top > 0) {
      const Entry entry = stack[at(--top)];
      if (entry.squared_distance >= best.squared_distance) continue;
      const Node& node = nodes_[at(entry.node)];
      if (node.right == leaf) {
        for (Index i = node.begin; i < node.end; ++i) {
          ++best.visited;
          if (leaf_boxes_[at(i)].squared_distance(p) >= best.squared_distance) continue;
          const double d2 = squared_distance(order_[at(i)]);
          if (d2 < best.squared_distance) {
            best.primitive = order_[at(i)];
            best.squared_distance = d2;
          }
        }
        continue;
      }
      Entry nearer{entry.node + 1, nodes_[at(entry.node + 1)].box.squared_distance(p)};
      Entry farther{node.right, nodes_[at(node.right)].box.squared_distance(p)};
      best.visited += 2;
      if (farther.squared_distance < nearer.squared_distance) std::swap(nearer, farther);
      stack[at(top++)] = farther;
      stack[at(top++)] = nearer;
    }
    return best;
  }

 private:
  static constexpr Index leaf = 0;               // the root is nobody's right child
  static constexpr Index leaf_size = 4;          // primitives
  static constexpr std::size_t stack_size = 64;  // one entry a level and one more; 2^31 primitives make 31 levels

  /// The left child is the next node; the right child is `right`, or `leaf`.
  struct Node {
    Box box;
    Index begin, end, right;
  };

  void build(const std::vector<Box>& boxes) {
    constexpr Index nobody = -1;
    struct Range {
      Index begin, end, parent;  // the parent whose right child this is
    };
    std::array<Range, stack_size> stack;
    Index top = 0;
    stack[at(top++)] = {0, size_of(order_), nobody};
    while (top > 0) {
      const Range range = stack[at(--top)];
      const Index n = size_of(nodes_);
      if (range.parent != nobody) nodes_[at(range.parent)].right = n;
      Node node{{}, range.begin, range.end, leaf};
      Box centres;
      for (Index i = range.begin; i < range.end; ++i) {
        const Box& box = boxes[at(order_[at(i)])];
        COROTET_ASSERT(box.low.allFinite() && box.high.allFinite(), "check positions before building a BoxTree");
        node.box.add(box);
        centres.add(box.low + box.high);
      }
      nodes_.push_back(node);
      const auto first = order_.begin() + range.begin, last = order_.begin() + range.end;
      if (range.end - range.begin <= leaf_size) {
        std::sort(first, last);
        continue;
      }
      const int axis = (centres.high - centres.low).index_of_max();
      const Index middle = range.begin + (range.end - range.begin) / 2;
      // Ties are broken by number, so that both halves are well defined.
      std::nth_element(first, order_.begin() + middle, last, [&](Index a, Index b) {
        const double ca = boxes[at(a)].low[axis] + boxes[at(a)].high[axis];
        const double cb = boxes[at(b)].low[axis] + boxes[at(b)].high[axis];
        return exactly_equal(ca, cb) ? a < b : ca < cb;
      });
      stack[at(top++)] = {middle, range.end, n};
      stack[at(top++)] = {range.begin, middle, nobody};
    }
  }

  std::vector<Node> nodes_;
  std::vector<Index> order_;     // primitives, leaf after leaf
  std::vector<Box> leaf_boxes_;  // their boxes in that order
};

}  // namespace corotet::inline v0_1::detail
