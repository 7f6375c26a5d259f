// A value, or the reason why there is none. Takes the place of exceptions, which the library never uses.
#pragma once

#include <corotet/core/assert.hpp>
#include <optional>
#include <string>
#include <utility>

namespace corotet::inline v0_1 {

/// What kind of thing went wrong; the texts of Error say exactly what, where and why.
enum class ErrorCode {
  file_not_found,       ///< the file cannot be opened
  file_unreadable,      ///< the file was opened, but reading or writing failed
  unknown_format,       ///< no reader recognises the content
  malformed_file,       ///< the content breaks its own format: truncated, out of range, not a number, ...
  unsupported,          ///< valid, but not something that corotet handles
  empty_mesh,           ///< no vertices or no elements
  index_out_of_range,   ///< an element names a vertex that does not exist
  duplicate_node,       ///< an element names the same vertex twice
  unreferenced_vertex,  ///< a vertex belongs to no element, so it would have no mass
  degenerate_element,   ///< zero, negative or non-finite volume
  non_finite_value,     ///< NaN or infinity
  invalid_argument      ///< a parameter outside its stated range
};

/// What happened, where, and why.
struct Error {
  ErrorCode code = ErrorCode::invalid_argument;
  std::string where;   ///< file with line or byte offset, element, vertex, or parameter: "beam.msh:12", "element 7"
  std::string reason;  ///< what was found there and what was expected

  [[nodiscard]] std::string message() const { return where.empty() ? reason : where + ": " + reason; }
};

/// Holds a `T`, or the `Error` that prevented it. Test it before use; reading the wrong side is an assertion.
template <class T>
class [[nodiscard]] Result {
 public:
  // Implicit on purpose: `return value;` and `return Error{...};` are the two ways to end a function.
  Result(T value) : value_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return value_.has_value(); }
  explicit operator bool() const { return ok(); }

  [[nodiscard]] T& value() & {
    COROTET_ASSERT(ok(), "test a Result before taking its value");
    return *value_;
  }
  [[nodiscard]] const T& value() const& {
    COROTET_ASSERT(ok(), "test a Result before taking its value");
    return *value_;
  }
  [[nodiscard]] T&& value() && {
    COROTET_ASSERT(ok(), "test a Result before taking its value");
    return std::move(*value_);
  }

  [[nodiscard]] T& operator*() & { return value(); }
  [[nodiscard]] const T& operator*() const& { return value(); }
  [[nodiscard]] T&& operator*() && { return std::move(*this).value(); }
  [[nodiscard]] T* operator->() { return &value(); }
  [[nodiscard]] const T* operator->() const { return &value(); }

  [[nodiscard]] const Error& error() const {
    COROTET_ASSERT(!ok(), "this Result holds a value, not an error");
    return error_;
  }

 private:
  std::optional<T> value_;
  Error error_;
};

/// The outcome of something that returns nothing: success, or an `Error`.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor): as above

  [[nodiscard]] bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }

  [[nodiscard]] const Error& error() const {
    COROTET_ASSERT(!ok(), "this Result is a success, it has no error");
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace corotet::inline v0_1
