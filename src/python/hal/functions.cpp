#include "python/hal/functions.hpp"

#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "hal/core/value_text.hpp"
#include "hal/core/view.hpp"
#include "python/hal/errors.hpp"
#include "python/hal/link.hpp"
#include "python/hal/values.hpp"
#include "rtapi/clock/join_clock.hpp"

namespace kerf::python {

using rtapi::Errc;

namespace {

/// RuntimeError, not hal.error: these are no calls of a component.
std::shared_ptr<Link> link() {
  auto made = Link::get();
  if (!made.ok()) raise(PyExc_RuntimeError, made.error().message());
  return *made;
}

/// True when it failed, which is how scripts know these calls.
bool failed(const std::vector<std::string>& argv) {
  const auto done = link()->ask(argv);
  if (!done.ok()) say_error(done.error().message());
  return !done.ok();
}

bool new_signal(const std::string& name, int type_number) {
  const hal::Type type = type_from_number(type_number);
  if (type == hal::Type::unspecified) raise(PyExc_RuntimeError, "not a valid HAL signal type");
  return failed({"newsig", name, std::string(hal::type_name(type))});
}

/// True, or raises with the command, the name and why.
bool set(const char* call, const char* command, const std::string& name, const py::object& value) {
  const auto done = link()->ask({command, name, value_words(value)});
  if (done.ok()) return true;
  const char* why = "not writable";
  switch (done.error().code) {
    case Errc::not_found: why = "not found"; break;
    case Errc::bad_argument: why = "invalid argument"; break;
    case Errc::busy: why = errno_of(done.error()) == EPERM ? "HAL is locked" : why; break;
    case Errc::no_memory: why = "no memory"; break;
    case Errc::dead: raise(PyExc_RuntimeError, done.error().message());
    default: break;
  }
  raise(PyExc_RuntimeError, std::string(call) + ": " + name + ": " + why);
}

py::object item_value(Link& at, const std::string& name) {
  const auto item = at.view().find_item(name);
  if (!item) return py::none();
  return to_python(item->type, item->raw, at.segment());
}

/// The value as the slot has it; nothing when only setp's reader of texts can tell.
std::optional<std::uint64_t> plain_raw(hal::Type type, py::handle value) {
  if (type == hal::Type::floating && PyFloat_CheckExact(value.ptr()) != 0)
    return hal::to_raw(PyFloat_AS_DOUBLE(value.ptr()));
  if (PyLong_Check(value.ptr()) == 0) return std::nullopt;
  int overflow = 0;
  const std::int64_t n = PyLong_AsLongLongAndOverflow(value.ptr(), &overflow);
  if (overflow != 0) return std::nullopt;
  const auto within = [n](std::int64_t least, std::int64_t most) {
    return n >= least && n <= most;
  };
  switch (type) {
    case hal::Type::bit: return within(0, 1) ? std::optional(hal::to_raw(n != 0)) : std::nullopt;
    case hal::Type::s32:
      return within(INT32_MIN, INT32_MAX) ? std::optional(hal::to_raw(n)) : std::nullopt;
    case hal::Type::u32:
      return within(0, UINT32_MAX) ? std::optional(hal::to_raw(n)) : std::nullopt;
    case hal::Type::s64: return hal::to_raw(n);
    case hal::Type::u64: return within(0, INT64_MAX) ? std::optional(hal::to_raw(n)) : std::nullopt;
    default: return std::nullopt;
  }
}

/// From now on the slots whose place this process knows are not used for anything else while it lives.
std::weak_ptr<Link>& holding_values() {
  static std::weak_ptr<Link> held;  // under the GIL
  return held;
}

/// An unlinked pin whose value is a number is written where it stands, without asking the realtime host. False: ask it, also for what is
/// wrong with the call.
bool set_pin_directly(const std::shared_ptr<Link>& at, const std::string& name, py::handle value) {
  const hal::View view = at->view();
  if ((view.lock_bits() & hal::lock_params) != 0) return false;
  for (auto& held = holding_values();;) {
    const auto pin = view.find_pin(name);
    if (!pin || pin->dir == hal::Dir::out || !pin->signal.empty() || pin->place == 0 ||
        view.find_param(name))
      return false;
    const auto raw = plain_raw(pin->type, value);
    if (!raw) return false;
    if (held.lock() == at) {
      // The pin's own slot, whatever it is linked to by now: a signal gets no value that was meant for a pin without one.
      using Slot = std::remove_pointer_t<decltype(hal::FixedSlot::value)>;
      hal::Param<std::uint64_t> own;
      own.place() = {at->segment().at<Slot>(pin->place)};
      own.set(*raw);
      return true;
    }
    if (!at->ask({"hold-values"}).ok()) return false;
    held = at;  // and look again: the place may have been given away before it was held
  }
}

py::object signal_value(Link& at, const std::string& name) {
  const auto signal = at.view().find_signal(name);
  if (!signal) return py::none();
  return to_python(signal->type, signal->raw, at.segment());
}

py::object any_value(const std::string& name) {
  const auto at = link();
  py::object value = item_value(*at, name);
  if (value.is_none()) value = signal_value(*at, name);
  if (value.is_none()) raise(PyExc_RuntimeError, "get_value: " + name + ": not found");
  return value;
}

bool pin_has_writer(const std::string& name) {
  const auto at = link();
  const auto pin = at->view().find_pin(name);
  if (!pin) raise(PyExc_NameError, "Pin `" + name + "' does not exist");
  if (pin->signal.empty()) return false;
  const auto signal = at->view().find_signal(pin->signal);
  return signal && signal->writers > 0;
}

/// Name of the output pin that drives a signal, or None.
py::object driver(const hal::SignalInfo& signal) {
  for (const auto& pin : signal.pins) {
    if (pin.dir == hal::Dir::out) return py::str(pin.name);
  }
  return py::none();
}

py::list info_items(bool pins) {
  const auto at = link();
  py::list out;
  for (const auto& item : pins ? at->view().pins() : at->view().params()) {
    py::dict d;
    d["NAME"] = item.name;
    d["VALUE"] = to_python(item.type, item.raw, at->segment());
    d["DIRECTION"] = static_cast<int>(item.dir);
    d["TYPE"] = static_cast<int>(item.type);
    out.append(d);
  }
  return out;
}

py::list info_signals() {
  const auto at = link();
  py::list out;
  for (const auto& signal : at->view().signals()) {
    py::dict d;
    d["NAME"] = signal.name;
    d["VALUE"] = to_python(signal.type, signal.raw, at->segment());
    d["DRIVER"] = driver(signal);
    d["TYPE"] = static_cast<int>(signal.type);
    out.append(d);
  }
  return out;
}

}  // namespace

void add_functions(py::module_& m) {
  m.def(
      "component_exists",
      [](const std::string& name) { return link()->view().find_component(name).has_value(); },
      py::arg("name"), "True when a component has the name.");
  m.def(
      "component_is_ready",
      [](const std::string& name) {
        const auto found = link()->view().find_component(name);
        return found && found->ready;
      },
      py::arg("name"), "True when the component is there and ready.");
  m.def("new_sig", new_signal, py::arg("name"), py::arg("type"),
        "Makes a signal. True when it failed.");
  m.def(
      "connect",
      [](const std::string& pin, const std::string& signal) {
        return failed({"linkps", pin, signal});
      },
      py::arg("pin"), py::arg("signal"), "Links a pin to a signal. True when it failed.");
  m.def(
      "disconnect",
      [](const std::string& pin) {
        return failed({"unlinkp", pin});
      },
      py::arg("pin"), "Unlinks a pin. True when it failed.");
  m.def(
      "set_p",
      [](const std::string& n, const py::object& v) {
        return set_pin_directly(link(), n, v) || set("set_p", "setp", n, v);
      },
      py::arg("name"), py::arg("value"), "Sets a parameter or an unlinked pin.");
  m.def(
      "set_s", [](const std::string& n, const py::object& v) { return set("set_s", "sets", n, v); },
      py::arg("name"), py::arg("value"),
      "Sets a signal that has no writer; of a port the size of its queue.");
  m.def(
      "get_p", [](const std::string& name) { return item_value(*link(), name); }, py::arg("name"),
      "Value of a pin or parameter, or None.");
  m.def(
      "get_s", [](const std::string& name) { return signal_value(*link(), name); }, py::arg("name"),
      "Value of a signal, or None.");
  m.def("get_value", any_value, py::arg("name"), "Value of a pin, parameter or signal.");
  m.def("pin_has_writer", pin_has_writer, py::arg("name"),
        "True when the pin's signal has a writer.");
  m.def("get_info_pins", [] { return info_items(true); });
  m.def("get_info_params", [] { return info_items(false); });
  m.def("get_info_signals", info_signals);
  m.def("get_msg_level", message_level);
  m.def("set_msg_level", set_message_level, py::arg("level"));
  m.def(
      "is_initialized",
      [] {
        const auto present = Link::present();
        return present && present->usable() && present->components > 0;
      },
      "True while this process has a component.");
  m.def(
      "_clock_is_virtual",
      []() -> std::optional<bool> {
        const auto at = Link::get();
        if (!at.ok()) return std::nullopt;
        return rtapi::clock_mode((*at)->segment()) == rtapi::ClockMode::virtual_time;
      },
      "None without a running HAL.");
}

// ---- queries ------------------------------------------------------------------------------------

namespace {

py::dict about_item(Link& at, const hal::ItemInfo& item, bool pin) {
  py::dict d;
  const bool aliased = !item.original_name.empty();
  d["haltype"] = pin ? "pin" : "parameter";
  d["name"] = aliased ? item.original_name : item.name;
  d["type"] = static_cast<int>(item.type);
  d["dir"] = static_cast<int>(item.dir);
  d["value"] = to_python(item.type, item.raw, at.segment());
  d["alias"] = aliased ? py::object(py::str(item.name)) : py::none();
  if (pin) d["signal"] = item.signal.empty() ? py::none() : py::object(py::str(item.signal));
  d["comp"] = item.owner;
  d["comp_id"] = item.owner_id;
  return d;
}

py::dict about_signal(Link& at, const hal::SignalInfo& signal) {
  py::dict d;
  d["haltype"] = "signal";
  d["name"] = signal.name;
  d["type"] = static_cast<int>(signal.type);
  d["value"] = to_python(signal.type, signal.raw, at.segment());
  d["writers"] = signal.writers;
  d["readers"] = signal.readers;
  d["bidirs"] = signal.bidirs;
  d["driver"] = driver(signal);
  return d;
}

py::dict about_component(const hal::ComponentInfo& component) {
  const bool realtime = component.type == hal::ComponentKind::realtime;
  py::dict d;
  d["haltype"] = "component";
  d["name"] = component.name;
  d["type"] = static_cast<int>(component.type);
  d["id"] = component.id;
  d["pid"] = component.pid;
  d["ready"] = component.ready;
  d["insmod"] = realtime ? py::object(py::str(component.args)) : py::none();
  return d;
}

py::dict about_function(const hal::FunctionInfo& function) {
  py::dict d;
  d["haltype"] = "function";
  d["name"] = function.name;
  d["comp"] = function.owner;
  d["comp_id"] = function.owner_id;
  d["users"] = function.users;
  d["reentrant"] = false;
  return d;
}

py::dict about_thread(const hal::ThreadInfo& thread, std::size_t priority) {
  py::dict d;
  d["haltype"] = "thread";
  d["name"] = thread.name;
  d["comp"] = thread.owner;
  d["comp_id"] = thread.owner_id;
  d["priority"] = priority;
  d["period"] = thread.period_ns;
  py::list functions;
  for (std::size_t i = 0; i < thread.functions.size(); ++i) {
    py::dict f;
    f["haltype"] = "threadfunction";
    f["name"] = thread.functions[i];
    f["index"] = i;
    f["is_init"] = false;
    functions.append(f);
  }
  d["functions"] = functions;
  return d;
}

py::list all_items(bool pins) {
  const auto at = link();
  py::list out;
  for (const auto& item : pins ? at->view().pins() : at->view().params())
    out.append(about_item(*at, item, pins));
  return out;
}

py::object one_item(const std::string& name, bool pin) {
  const auto at = link();
  const auto item = pin ? at->view().find_pin(name) : at->view().find_param(name);
  if (!item) return py::none();
  return about_item(*at, *item, pin);
}

std::optional<py::list> pins_of_signal(const std::string& name) {
  const auto at = link();
  const auto signal = at->view().find_signal(name);
  if (!signal) return std::nullopt;
  py::list out;
  for (const auto& pin : signal->pins) {
    const auto item = at->view().find_pin(pin.name);
    if (item) out.append(about_item(*at, *item, true));
  }
  return out;
}

/// The fastest thread has priority 0.
py::list all_threads() {
  const auto threads = link()->view().threads();
  py::list out;
  for (const auto& thread : threads) {
    std::size_t faster = 0;
    for (const auto& other : threads) faster += other.period_ns < thread.period_ns ? 1 : 0;
    out.append(about_thread(thread, faster));
  }
  return out;
}

}  // namespace

void add_queries(py::module_& m) {
  m.def("query_pins", [] { return all_items(true); });
  m.def("query_params", [] { return all_items(false); });
  m.def("query_pin", [](const std::string& name) { return one_item(name, true); });
  m.def("query_param", [](const std::string& name) { return one_item(name, false); });
  m.def("query_signal", [](const std::string& name) -> py::object {
    const auto at = link();
    const auto signal = at->view().find_signal(name);
    if (!signal) return py::none();
    return about_signal(*at, *signal);
  });
  m.def("query_signals", [] {
    const auto at = link();
    py::list out;
    for (const auto& signal : at->view().signals()) out.append(about_signal(*at, signal));
    return out;
  });
  m.def("query_signal_pins", pins_of_signal);
  m.def("query_comps", [] {
    py::list out;
    for (const auto& component : link()->view().components())
      out.append(about_component(component));
    return out;
  });
  m.def("query_functs", [] {
    py::list out;
    for (const auto& function : link()->view().functions()) out.append(about_function(function));
    return out;
  });
  m.def("query_threads", all_threads);
}

}  // namespace kerf::python
