// A value, or the reason why there is none. Takes the place of exceptions, which the library never uses.
#pragma once

#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <memory>
#include <new>
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
  ErrorCode code = ErrorCode::invalid_argument;  ///< what kind of mistake
  std::string where;   ///< file with line or byte offset, element, vertex, or parameter: "beam.msh:12", "element 7"
  std::string reason;  ///< what was found there and what was expected

  /// One line for a user: `where: reason`.
  [[nodiscard]] COROTET_COLD std::string message() const {
    std::string all = where;
    if (!where.empty()) all.append(": ", 2);
    return all.append(reason.data(), reason.size());
  }
};

namespace detail {

/// An error that lies elsewhere, or none: results of calls that went well are tested and passed on for next to nothing.
class OptionalError {
 public:
  OptionalError() = default;
  explicit OptionalError(const Error& error) : error_(copy(error)) {}
  explicit OptionalError(Error&& error) : error_(move(std::move(error))) {}
  OptionalError(const OptionalError& other) : error_(other.error_ == nullptr ? nullptr : copy(*other.error_)) {}
  OptionalError(OptionalError&& other) noexcept : error_(std::exchange(other.error_, nullptr)) {}
  OptionalError& operator=(OptionalError other) noexcept {
    std::swap(error_, other.error_);
    return *this;
  }
  ~OptionalError() {
    if (error_ != nullptr) destroy(error_);
  }

  [[nodiscard]] const Error* get() const { return error_; }

 private:
  COROTET_COLD static Error* copy(const Error& error) { return new Error(error); }
  COROTET_COLD static Error* move(Error&& error) { return new Error(std::move(error)); }
  COROTET_COLD static void destroy(Error* error) { delete error; }

  Error* error_ = nullptr;
};

}  // namespace detail

/// A `T`, or the `Error` that prevented it. Test it before use; reading the wrong side is an assertion.
///
/// All functions that depend on data (a file, a mesh, a material) return one; nothing throws. Mistakes of the calling
/// program are assertions instead: see COROTET_ASSERT.
/// @snippet files.cpp result
template <class T>
class [[nodiscard]] Result {
 public:
  // Implicit on purpose: `return value;` and `return Error{...};` are the two ways to end a function.
  /// A success.
  Result(T value) : value_(std::move(value)), ok_(true) {}  // NOLINT(google-explicit-constructor)
  /// A failure.
  Result(const Error& error) : error_(error) {}  // NOLINT(google-explicit-constructor)
  /// The same.
  Result(Error&& error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  /// For the library: of an error that there is.
  Result(detail::OptionalError error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  /// Copies the value or the error.
  Result(const Result& other) : error_(other.error_) {
    if (other.ok_) hold(other.value_);
  }
  /// Moves the value or the error.
  Result(Result&& other) noexcept : error_(std::move(other.error_)) {
    if (other.ok_) hold(std::move(other.value_));
  }
  /// Takes over the value or the error.
  Result& operator=(Result other) noexcept {
    drop();
    if (other.ok_) hold(std::move(other.value_));
    error_ = std::move(other.error_);
    return *this;
  }
  ~Result() { drop(); }

  /// Whether there is a value.
  [[nodiscard]] bool ok() const { return ok_; }
  /// The same as ok().
  explicit operator bool() const { return ok_; }

  /// The value. A failed result has none: asking for it is a mistake of the program (COROTET_ASSERT).
  [[nodiscard]] T& value() & {
    COROTET_ASSERT(ok_, "test a Result before taking its value");
    return value_;
  }
  /// The same, read-only.
  [[nodiscard]] const T& value() const& {
    COROTET_ASSERT(ok_, "test a Result before taking its value");
    return value_;
  }
  /// The same, to be moved from.
  [[nodiscard]] T&& value() && {
    COROTET_ASSERT(ok_, "test a Result before taking its value");
    return std::move(value_);
  }

  /// The same as value().
  [[nodiscard]] T& operator*() & { return value(); }
  /// The same as value().
  [[nodiscard]] const T& operator*() const& { return value(); }
  /// The same as value().
  [[nodiscard]] T&& operator*() && { return std::move(*this).value(); }
  /// A member of value().
  [[nodiscard]] T* operator->() { return &value(); }
  /// A member of value().
  [[nodiscard]] const T* operator->() const { return &value(); }

  /// The error. A success has none: asking for it is a mistake of the program.
  [[nodiscard]] const Error& error() const {
    COROTET_ASSERT(!ok_, "this Result holds a value, not an error");
    return *error_.get();
  }

 private:
  template <class U>
  void hold(U&& value) {
    ::new (static_cast<void*>(std::addressof(value_))) T(std::forward<U>(value));
    ok_ = true;
  }
  void drop() {
    if (ok_) value_.~T();
    ok_ = false;
  }

  detail::OptionalError error_;
  union {      // by hand: std::optional of each T that is a result costs sixty functions to compile
    T value_;  // NOLINT(readability-identifier-naming): private
  };
  bool ok_ = false;
};

/// The outcome of something that returns nothing: success, or an `Error`.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  /// A failure.
  Result(const Error& error) : error_(error) {}  // NOLINT(google-explicit-constructor): as above
  /// The same.
  Result(Error&& error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  /// Of an error, or of none.
  Result(detail::OptionalError error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  /// Whether it succeeded.
  [[nodiscard]] bool ok() const { return error_.get() == nullptr; }
  /// The same as ok().
  explicit operator bool() const { return ok(); }

  /// The error. A success has none: asking for it is a mistake of the program.
  [[nodiscard]] const Error& error() const {
    COROTET_ASSERT(!ok(), "this Result is a success, it has no error");
    return *error_.get();
  }

 private:
  detail::OptionalError error_;
};

}  // namespace corotet::inline v0_1
