// Result<T, E>: what functions return outside the realtime loop (std::expected is C++23).
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <variant>

#include "rtapi/base/fixed_string.hpp"

namespace kerf::rtapi {

/// What kind of failure; the text says the rest. Stable numbers: they cross process borders.
enum class Errc : std::int32_t {
  ok = 0,
  bad_argument = 1,   ///< the caller's value is wrong (unknown option, number out of range)
  not_found = 2,      ///< no such file, name, pin, component
  exists = 3,         ///< the name is taken
  type_mismatch = 4,  ///< types or directions do not fit
  busy = 5,           ///< in use, locked, or not now
  no_memory = 6,      ///< an arena or table is full; the text names the INI key
  permission = 7,     ///< a right is missing; the text names which
  system = 8,         ///< a system call failed; the text has errno's meaning
  protocol = 9,       ///< the other side sent something that cannot be
  syntax = 10,        ///< text that does not parse
  cancelled = 11,     ///< stopped on request
  dead = 12,          ///< the process on the other side is gone
  internal = 13,      ///< a fault of ours
};

/// Where in a user's file. `file` empty: no place known. Lines and columns count from 1; 0: unknown.
struct SourcePos {
  FixedString<160> file;
  std::int32_t line{0};
  std::int32_t column{0};
};

/// One failure: what happened, where, and what to do about it, in one message for a person.
struct Error {
  Errc code{Errc::internal};
  FixedString<480> what;
  SourcePos at{};

  /// "FILE:LINE: text" when the place is known, else the text.
  [[nodiscard]] std::string message() const {
    std::string out;
    if (!at.file.empty()) {
      out = std::string(at.file.view());
      if (at.line > 0) out += ':' + std::to_string(at.line);
      if (at.column > 0) out += ':' + std::to_string(at.column);
      out += ": ";
    }
    out += what.view();
    return out;
  }
};

/// Wraps an error so that it converts to any Result.
template <class E>
struct Failure {
  E error;
};
template <class E>
Failure(E) -> Failure<E>;

[[nodiscard]] inline Failure<Error> fail(Errc code, std::string_view what, SourcePos at = {}) {
  return {Error{code, FixedString<480>(what), at}};
}

/// Either a value or an error. Reading the wrong one is a programming fault and aborts.
template <class T, class E = Error>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  template <class F>
  Result(Failure<F> failure) : state_(std::in_place_index<1>, std::move(failure.error)) {}

  [[nodiscard]] bool ok() const noexcept { return state_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }
  T& value() & { return *checked(std::get_if<0>(&state_)); }
  const T& value() const& { return *checked(std::get_if<0>(&state_)); }
  T&& value() && { return std::move(*checked(std::get_if<0>(&state_))); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  [[nodiscard]] const E& error() const { return *checked(std::get_if<1>(&state_)); }
  [[nodiscard]] T value_or(T other) const { return ok() ? value() : std::move(other); }

 private:
  template <class P>
  static P* checked(P* p) {
    if (p == nullptr) {
      std::fputs("kerf: internal fault: Result read on the wrong side\n", stderr);
      std::abort();
    }
    return p;
  }
  std::variant<T, E> state_;
};

/// Nothing or an error.
template <class E>
class [[nodiscard]] Result<void, E> {
 public:
  Result() = default;
  template <class F>
  Result(Failure<F> failure) : error_(std::move(failure.error)), failed_(true) {}
  [[nodiscard]] bool ok() const noexcept { return !failed_; }
  explicit operator bool() const noexcept { return ok(); }
  [[nodiscard]] const E& error() const { return error_; }

 private:
  E error_{};
  bool failed_{false};
};

using Status = Result<void, Error>;

}  // namespace kerf::rtapi

/// Returns the error of `expr` from the enclosing function.
#define KERF_CHECK(expr)                                   \
  do {                                                     \
    if (auto kerf_status_ = (expr); !kerf_status_.ok())    \
      return ::kerf::rtapi::Failure{kerf_status_.error()}; \
  } while (false)

#define KERF_CONCAT_OF(a, b) a##b
#define KERF_CONCAT(a, b) KERF_CONCAT_OF(a, b)
/// `KERF_TRY(auto x, f());` declares x from the value of f(), or returns f()'s error.
#define KERF_TRY(declaration, expr)                                             \
  auto KERF_CONCAT(kerf_result_, __LINE__) = (expr);                            \
  if (!KERF_CONCAT(kerf_result_, __LINE__).ok())                                \
    return ::kerf::rtapi::Failure{KERF_CONCAT(kerf_result_, __LINE__).error()}; \
  declaration = std::move(KERF_CONCAT(kerf_result_, __LINE__)).value()
