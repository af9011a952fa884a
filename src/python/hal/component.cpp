#include "python/hal/component.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "hal/core/value_text.hpp"
#include "python/hal/errors.hpp"
#include "python/hal/values.hpp"

namespace kerf::python {

using hal::Dir;
using hal::Type;
using rtapi::Errc;

void ComponentState::check() const {
  if (open && link->usable()) return;
  if (link->is_parents()) {
    raise(hal_error, "component '" + name +
                         "' belongs to the process that this one was forked from: make "
                         "components after the fork");
  }
  raise(PyExc_RuntimeError, "Invalid operation on closed HAL component");
}

py::object Item::get() const {
  owner_->check();
  return to_python(type_, value_.get(), owner_->link->segment());
}

void Item::set(py::handle value) {
  owner_->check();
  value_.set(from_python(type_, value));
}

hal::Port Item::port() const {
  owner_->check();
  if (type_ != Type::port) raise(PyExc_TypeError, "'" + name_ + "' is no port");
  return port_at(value_.get(), owner_->link->segment());
}

std::string Item::repr() const {
  return std::string(is_pin_ ? "<hal pin \"" : "<hal param \"") + name_ + "\" " +
         type_label(type_) + "-" + dir_label(dir_) + ">";
}

Component::Component(const std::string& name, const py::object& prefix)
    : state_(std::make_shared<ComponentState>()),
      prefix_(prefix.is_none() ? name : py::cast<std::string>(prefix)) {
  auto link = Link::get();
  if (!link.ok()) raise_hal_error(link.error());
  state_->link = *link;
  state_->name = name;
  auto made = state_->link->ask({"comp-new", name});
  if (!made.ok()) {
    if (made.error().code != Errc::exists) raise_hal_error(made.error());
    say_error(made.error().message());
    raise(hal_error, std::strerror(EEXIST));
  }
  id_ = *made;
  state_->open = true;
  ++state_->link->components;
}

Component::~Component() {
  if (!state_->open) return;
  state_->open = false;
  --state_->link->components;
  if (state_->link->usable()) (void)state_->link->ask({"comp-exit", state_->name});
}

std::shared_ptr<Item> Component::new_item(const std::string& name, int type_number, int dir_number,
                                          bool is_pin) {
  state_->check();
  const char* what = is_pin ? "pin" : "param";
  const Type type = type_from_number(type_number);
  if (type == Type::unspecified || (type == Type::port && !is_pin)) {
    raise(hal_error, std::string("Invalid ") + what + " type " + std::to_string(type_number));
  }
  if (items_.contains(name)) {
    raise(PyExc_ValueError,
          std::string("Duplicate ") + (is_pin ? "pin" : "parameter") + " name '" + name + "'");
  }
  const std::string whole = prefix_ + "." + name;
  if (whole.size() > hal::kNameLength) {
    raise(hal_error, std::string("Invalid ") + what + " name length \"" + whole +
                         "\": max = " + std::to_string(hal::kNameLength) + " characters");
  }
  const Dir dir = static_cast<Dir>(dir_number);
  const bool pin_dir = dir == Dir::in || dir == Dir::out || dir == Dir::io;
  const bool param_dir = dir == Dir::ro || dir == Dir::rw;
  if (is_pin ? !pin_dir : !param_dir) {
    raise_hal_error({Errc::bad_argument, is_pin
                                             ? "pin direction not one of HAL_IN, HAL_OUT, or HAL_IO"
                                             : "param direction not one of HAL_RO, or HAL_RW"});
  }
  auto made = link().ask({is_pin ? "pin-new" : "param-new", state_->name, whole,
                          std::string(hal::type_name(type)), std::string(hal::dir_name(dir))});
  if (!made.ok()) raise_hal_error(made.error());
  const hal::SlotRef slot =
      hal::slot_at(link().segment(), std::strtoull(made->c_str(), nullptr, 10));
  return items_.emplace(name, std::make_shared<Item>(state_, name, type, dir, is_pin, slot))
      .first->second;
}

std::shared_ptr<Item> Component::item(const std::string& name) const {
  state_->check();
  const auto it = items_.find(name);
  if (it == items_.end()) {
    raise(PyExc_AttributeError, "Pin or param '" + name + "' does not exist");
  }
  return it->second;
}

std::shared_ptr<Item> Component::item_of(const std::string& name, bool is_pin) const {
  state_->check();
  const auto it = items_.find(name);
  if (it == items_.end() || it->second->is_pin() != is_pin) {
    raise(PyExc_AttributeError,
          std::string(is_pin ? "Pin '" : "Param '") + name + "' does not exist");
  }
  return it->second;
}

py::dict Component::values() const {
  state_->check();
  py::dict out;
  for (const auto& [name, item] : items_) out[py::str(name)] = item->get();
  return out;
}

std::size_t Component::size() const {
  state_->check();
  return items_.size();
}

void Component::ask_for(const char* command) {
  state_->check();
  auto done = link().ask({command, state_->name});
  if (!done.ok()) raise_hal_error(done.error());
}

void Component::ready() { ask_for("comp-ready"); }
void Component::unready() { ask_for("comp-unready"); }

void Component::exit() {
  ask_for("comp-exit");
  state_->open = false;
  --state_->link->components;
}

const std::string& Component::prefix() const {
  state_->check();
  return prefix_;
}

void Component::set_prefix(const std::string& prefix) {
  state_->check();
  prefix_ = prefix;
}

std::string Component::repr() const {
  return "<hal component " + state_->name + "(" + (state_->open ? id_ : "closed") + ") with " +
         std::to_string(items_.size()) + " pins and params>";
}

namespace {

/// The next bytes of a port, or None when there are not so many.
py::object port_bytes(const Item& item, std::uint32_t count, bool take) {
  hal::Port port = item.port();
  if (count > port.readable()) return py::none();
  std::string bytes(count, '\0');
  if (!(take ? port.read(bytes.data(), count) : port.peek(bytes.data(), count))) return py::none();
  return py::bytes(bytes);
}

bool port_write(const Item& item, const py::buffer& data) {
  const py::buffer_info info = data.request();
  const auto bytes = static_cast<std::uint64_t>(info.size * info.itemsize);
  hal::Port port = item.port();
  return bytes <= port.writable() &&
         port.write(static_cast<const char*>(info.ptr), static_cast<std::uint32_t>(bytes));
}

void add_port_calls(py::class_<Item, std::shared_ptr<Item>>& item) {
  item.def(
          "read", [](const Item& i, std::uint32_t count) { return port_bytes(i, count, true); },
          py::arg("count"), "Takes the next bytes of the port; None when there are not so many.")
      .def(
          "peek", [](const Item& i, std::uint32_t count) { return port_bytes(i, count, false); },
          py::arg("count"), "The same without taking them.")
      .def(
          "peek_commit",
          [](const Item& i, std::uint32_t count) { return i.port().peek_commit(count); },
          py::arg("count"), "Drops the next bytes; False when there are not so many.")
      .def("write", port_write, py::arg("data"), "Appends bytes; False when they do not fit.")
      .def(
          "clear", [](const Item& i) { i.port().clear(); }, "Drops all bytes.")
      .def(
          "size", [](const Item& i) { return i.port().size(); }, "Bytes that the queue holds.")
      .def(
          "readable", [](const Item& i) { return i.port().readable(); }, "Bytes that wait.")
      .def(
          "writable", [](const Item& i) { return i.port().writable(); }, "Bytes that fit.");
}

}  // namespace

void add_component(py::module_& m) {
  py::class_<Item, std::shared_ptr<Item>> item(
      m, "item", "A pin or parameter of a component of this process.");
  item.attr("__module__") = "hal";
  item.def("get", &Item::get, "The value.")
      .def("set", &Item::set, py::arg("value"), "Sets the value.")
      .def("get_name", &Item::name, "Name without the component's prefix.")
      .def("get_type", &Item::type, "A number of hal.HAL_BIT and its like.")
      .def("get_dir", &Item::dir, "A number of hal.HAL_IN and its like.")
      .def("is_pin", &Item::is_pin, "False for a parameter.")
      .def("__repr__", &Item::repr);
  add_port_calls(item);

  py::class_<Component, std::shared_ptr<Component>> component(m, "component");
  component.attr("__module__") = "hal";
  component
      .def(py::init<const std::string&, const py::object&>(), py::arg("name"),
           py::arg("prefix") = py::none())
      .def(
          "newpin",
          [](Component& c, const std::string& name, int type, int dir) {
            return c.new_item(name, type, dir, true);
          },
          py::arg("name"), py::arg("type"), py::arg("dir"))
      .def(
          "newparam",
          [](Component& c, const std::string& name, int type, int dir) {
            return c.new_item(name, type, dir, false);
          },
          py::arg("name"), py::arg("type"), py::arg("dir"))
      .def("getitem", &Component::item, "The pin or parameter of this name.")
      .def("getpin", [](const Component& c, const std::string& n) { return c.item_of(n, true); })
      .def("getparam", [](const Component& c, const std::string& n) { return c.item_of(n, false); })
      .def("getpins", &Component::values, "All pins and parameters with their values.")
      .def("getitems", &Component::values, "All pins and parameters with their values.")
      .def("__getitem__", [](const Component& c, const std::string& n) { return c.item(n)->get(); })
      .def("__setitem__", [](const Component& c, const std::string& n,
                             const py::object& value) { c.item(n)->set(value); })
      .def("__len__", &Component::size)
      .def("__repr__", &Component::repr)
      .def("ready", &Component::ready, "No more pins after this; scripts that wait go on.")
      .def("unready", &Component::unready, "Allows pins again; call ready() when done.")
      .def("exit", &Component::exit, "Removes the component with its pins from HAL.")
      .def("getprefix", &Component::prefix, "What names of new pins begin with.")
      .def("setprefix", &Component::set_prefix, py::arg("prefix"));
}

}  // namespace kerf::python
