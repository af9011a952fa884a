// What the parts of the library share: the lock, errors as errno with their line on stderr, checks of arguments.
#pragma once

#include <hal.h>

#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "hal/capi/backend.hpp"
#include "hal/core/view.hpp"

namespace kerf::hal::capi {

/// One call at a time. A callback of a query may call again.
std::recursive_mutex& library_mutex();

/// errno for a failure of HAL; what a call answers differently it decides itself.
int errno_of(rtapi::Errc code) noexcept;
/// Prints "HAL: ERROR: text" and gives -error.
int refuse(int error, const std::string& text);
int refuse(const rtapi::Error& error);

/// A call of the library: its lock, and the backend. `error` is what to return when there is no backend.
class Call {
 public:
  Call();
  /// 0, or why nothing can be done.
  [[nodiscard]] int error() const noexcept { return error_; }
  Backend& operator*() const noexcept { return *backend_; }
  Backend* operator->() const noexcept { return backend_; }
  /// True and a message when HAL is locked against it.
  [[nodiscard]] bool locked(unsigned bits, const char* what,
                            const char* how = "while HAL locked") const;
  /// A component of ours that still takes pins; null after a message.
  Component* open_component(int id, const char* what) const;
  /// A command of Host. 0 or -errno; a refusal is printed with `text` in place of Host's own when it is not empty.
  int command(std::initializer_list<std::string> argv, const std::string& text = {}) const;

 private:
  std::unique_lock<std::recursive_mutex> lock_;
  Backend* backend_{nullptr};
  int error_{0};
};

/// Empty, or why the text is no name: "pin name 'x' is too long".
std::string bad_name(const char* what, const char* name);
inline std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }
/// The formatted name, or one that is too long.
std::string format_name(const char* fmt, std::va_list args);
Type type_of(int type) noexcept;
/// A millisecond, or until a signal. In programs.
void wait_a_little();

}  // namespace kerf::hal::capi
