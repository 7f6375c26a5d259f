// All that is wrong with an input, so that it can be said at once.
#pragma once

#include <corotet/detail/core/result.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "failure.hpp"

namespace corotet::program {

class Problems {
 public:
  /// `source`: the file that they are about; `prefix`: what stands before all keys, such as "bodies[1].".
  explicit Problems(std::string source, std::string prefix = "")
      : source_(std::move(source)), prefix_(std::move(prefix)) {}

  void add(const std::string& key, const std::string& reason) {
    list_.push_back(key.empty() ? reason : prefix_ + key + ": " + reason);
  }

  /// The value of a library call, or nothing, after noting its error under `key`.
  template <class T>
  std::optional<T> take(const std::string& key, Result<T> result) {
    if (result) return std::move(result).value();
    add(key, result.error().message());
    return std::nullopt;
  }

  /// Notes the error of a library call under `key`, if there is one.
  void check(const std::string& key, const Result<void>& status) {
    if (!status) add(key, status.error().message());
  }

  /// Throws a Failure that lists the problems, if there are any.
  void stop_if_any() const {
    if (list_.empty()) return;
    if (list_.size() == 1) throw Failure(source_ + ": " + list_.front());
    std::string text = source_ + ": " + std::to_string(list_.size()) + " problems";
    for (const std::string& problem : list_) text += "\n  " + problem;
    throw Failure(text);
  }

 private:
  std::string source_, prefix_;
  std::vector<std::string> list_;
};

}  // namespace corotet::program
