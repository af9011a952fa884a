// UserComponent: pins of an ordinary process.
//
//   hal::UserComponent comp(session, "iocontrol.0");
//   auto change = comp.pin<hal::LinkOut<bool>>("tool-change");
//   auto changed = comp.pin<hal::LinkIn<bool>>("tool-changed");
//   if (auto status = comp.ready(); !status.ok()) ...           // the first error of all that was asked
//   change = true;
#pragma once

#include <string>
#include <string_view>

#include "hal/client/session.hpp"
#include "hal/component.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// A parameter that users set and the component reads; the component may write it too.
template <class T>
using LinkParam = detail::Sharing<T, Dir::rw, SlotRef>;

/// Errors latch: after the first, pins are harmless handles of this object's own memory, and ready() gives the error.
class UserComponent {
 public:
  /// `session` must outlive the component.
  UserComponent(Session& session, std::string_view name);
  /// Removes the component and its pins.
  ~UserComponent();
  UserComponent(const UserComponent&) = delete;
  UserComponent& operator=(const UserComponent&) = delete;

  /// "NAME.suffix"; with `whole` true the suffix is the whole name.
  template <class Pin>
  Pin pin(std::string_view suffix, typename Pin::Item initial = {}, bool whole = false) {
    using T = typename Pin::Item;
    return Pin(add("pin-new", suffix, TypeOf<T>::kType, Pin::kDir, to_raw<T>(initial), whole));
  }
  template <class P>
  P param(std::string_view suffix, typename P::Item initial = {}, bool whole = false) {
    using T = typename P::Item;
    return P(add("param-new", suffix, TypeOf<T>::kType, P::kDir, to_raw<T>(initial), whole));
  }
  /// No more pins after this; scripts that wait for the component go on.
  rtapi::Status ready();
  /// As the destructor, at once.
  void leave();

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool failed() const { return !status_.ok(); }
  [[nodiscard]] const rtapi::Status& status() const { return status_; }

 private:
  SlotRef add(const char* command, std::string_view suffix, Type type, Dir dir, std::uint64_t raw,
              bool whole);
  Session& session_;
  std::string name_;
  rtapi::Status status_;
  bool present_{false};
  std::uint64_t dummy_[2]{};
};

}  // namespace kerf::hal
