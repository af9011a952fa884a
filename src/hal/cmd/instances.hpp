// Which functions and pins belong to one instance of a component. HAL's records know components only: the objects that functions
// run on, and the names, tell the rest.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hal/core/view.hpp"

namespace kerf::hal {

/// What one object declared.
struct Instance {
  std::string owner;                   ///< component
  std::vector<std::string> functions;  ///< by name
  /// Thread -> positions of its functions there, from 1, ascending.
  std::map<std::string, std::vector<std::size_t>> runs;
};

/// Instances that have functions.
class Instances {
 public:
  Instances(const std::vector<FunctionInfo>& functions, const std::vector<ThreadInfo>& threads);
  [[nodiscard]] const Instance& at(std::size_t i) const { return all_[i]; }
  [[nodiscard]] std::size_t size() const { return all_.size(); }
  /// The only one of the owner, or the one whose function's name has most words in common with the pin's; nullopt: cannot tell.
  [[nodiscard]] std::optional<std::size_t> of_pin(const ItemInfo& pin) const;
  /// True when, in a thread that runs both, the reading instance is done before the writing one begins: the value that is read is
  /// one cycle old. Which of an instance's functions uses a pin is not known, so anything else counts as in time.
  [[nodiscard]] bool late(const ItemInfo& writer, const ItemInfo& reader) const;

 private:
  std::vector<Instance> all_;
  std::map<std::string, std::vector<std::size_t>> by_owner_;
};

}  // namespace kerf::hal
