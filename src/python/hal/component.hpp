// Components of this process, their pins and parameters.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "hal/component.hpp"
#include "hal/core/port.hpp"
#include "python/hal/link.hpp"

namespace kerf::python {

namespace py = pybind11;

/// What a component shares with its items, which may outlive it.
struct ComponentState {
  std::shared_ptr<Link> link;
  std::string name;
  bool open{false};
  /// Raises when the component has exited, HAL has ended or this is a forked child.
  void check() const;
};

/// hal.item: a pin or a parameter.
class Item {
 public:
  Item(std::shared_ptr<const ComponentState> owner, std::string name, hal::Type type, hal::Dir dir,
       bool is_pin, hal::SlotRef slot)
      : owner_(std::move(owner)),
        name_(std::move(name)),
        type_(type),
        dir_(dir),
        is_pin_(is_pin),
        value_(slot) {}
  [[nodiscard]] py::object get() const;
  void set(py::handle value);
  /// The queue of a port; raises TypeError for another type.
  [[nodiscard]] hal::Port port() const;
  /// Within its component, without the prefix.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] int type() const noexcept { return static_cast<int>(type_); }
  [[nodiscard]] int dir() const noexcept { return static_cast<int>(dir_); }
  [[nodiscard]] bool is_pin() const noexcept { return is_pin_; }
  [[nodiscard]] std::string repr() const;

 private:
  std::shared_ptr<const ComponentState> owner_;
  std::string name_;
  hal::Type type_;
  hal::Dir dir_;
  bool is_pin_;
  hal::LinkIo<std::uint64_t> value_;  ///< the slot as it is, any type
};

/// hal.component, without attribute access, which hal/__init__.py adds.
class Component {
 public:
  Component(const std::string& name, const py::object& prefix);
  ~Component();
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;

  std::shared_ptr<Item> new_item(const std::string& name, int type, int dir, bool is_pin);
  /// Raises AttributeError for an unknown one.
  [[nodiscard]] std::shared_ptr<Item> item(const std::string& name) const;
  [[nodiscard]] std::shared_ptr<Item> item_of(const std::string& name, bool is_pin) const;
  [[nodiscard]] py::dict values() const;
  [[nodiscard]] std::size_t size() const;
  void ready();
  void unready();
  void exit();
  [[nodiscard]] const std::string& prefix() const;
  void set_prefix(const std::string& prefix);
  [[nodiscard]] std::string repr() const;

  [[nodiscard]] const std::shared_ptr<ComponentState>& state() const noexcept { return state_; }
  [[nodiscard]] Link& link() const noexcept { return *state_->link; }

 private:
  void ask_for(const char* command);
  std::shared_ptr<ComponentState> state_;
  std::string prefix_;
  std::string id_;
  std::map<std::string, std::shared_ptr<Item>, std::less<>> items_;
};

void add_component(py::module_& m);

}  // namespace kerf::python
