// Node numbers of files that may leave gaps.
#pragma once

#include <algorithm>
#include <corotet/detail/core/types.hpp>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Maps node tags to 0-based indices in order of their appearance. Tags without gaps, the usual case, need no search.
class NodeTags {
 public:
  void reserve(std::size_t count) { tags_.reserve(count); }
  void add(std::int64_t tag) { tags_.push_back(tag); }

  /// Call once after the last `add`. Returns a tag that was given twice, if there is one.
  std::optional<std::int64_t> finish() {
    consecutive_ = true;
    for (std::size_t i = 1; i < tags_.size() && consecutive_; ++i) consecutive_ = tags_[i] - 1 == tags_[i - 1];
    if (consecutive_) return std::nullopt;
    sorted_.reserve(tags_.size());
    for (std::size_t i = 0; i < tags_.size(); ++i) sorted_.emplace_back(tags_[i], static_cast<Index>(i));
    std::sort(sorted_.begin(), sorted_.end());
    const auto twin = std::adjacent_find(sorted_.begin(), sorted_.end(),
                                         [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twin != sorted_.end()) return twin->first;
    return std::nullopt;
  }

  /// The index of `tag`, or nothing.
  [[nodiscard]] std::optional<Index> find(std::int64_t tag) const {
    if (consecutive_) {
      if (tags_.empty() || tag < tags_.front() || tag > tags_.back()) return std::nullopt;
      return static_cast<Index>(tag - tags_.front());
    }
    const auto place = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair<std::int64_t, Index>{tag, 0});
    if (place == sorted_.end() || place->first != tag) return std::nullopt;
    return place->second;
  }

 private:
  std::vector<std::int64_t> tags_;
  std::vector<std::pair<std::int64_t, Index>> sorted_;
  bool consecutive_ = false;
};

}  // namespace corotet::inline v0_1::detail
