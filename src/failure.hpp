// How a command ends when it cannot do what was asked.
#pragma once

#include <corotet/detail/core/result.hpp>
#include <stdexcept>
#include <utility>

namespace corotet::program {

/// Carries what went wrong up to `main`, which prints it and returns 1.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The value of a library call, or its error as a Failure.
template <class T>
[[nodiscard]] T require(Result<T> result) {
  if (!result) throw Failure(result.error().message());
  return std::move(result).value();
}

inline void require(const Result<void>& status) {
  if (!status) throw Failure(status.error().message());
}

}  // namespace corotet::program
