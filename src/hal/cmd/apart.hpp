// Work with the code of components in a process of its own: what was written by others may crash or never return.
//
//   const auto done = hal::do_apart([&](const hal::Tell& tell) {
//     tell("and2");                       // what is dealt with from here on
//     return page_of("and2");
//   });
//   if (!done.text) std::puts((done.at + ": " + done.why).c_str());
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "hal/loader/module_source.hpp"

namespace kerf::hal {

struct Apart {
  std::optional<std::string> text;  ///< what the work gave; nothing when it did not come to its end
  std::string at;                   ///< the component that it dealt with then
  std::string why;                  ///< "its code crashed while the component was made: ..."
};
/// Says with which component's code the work deals now.
using Tell = std::function<void(std::string_view component)>;

/// The work's stdout and stderr are this process's own. After 20 s without a word from it, it is ended.
Apart do_apart(const std::function<std::string(const Tell&)>& work);

/// Modules of another source, but for those that are known not to come through being made; each is told before it is opened.
class ToldModules final : public ModuleSource {
 public:
  using Refused = std::map<std::string, std::string, std::less<>>;  ///< and why
  /// All must outlive it.
  ToldModules(ModuleSource& modules, const Tell& tell, const Refused& refused)
      : modules_(modules), tell_(tell), refused_(refused) {}
  rtapi::Result<const Module*> open(std::string_view name) override;
  void close(const Module* module) override { modules_.close(module); }
  [[nodiscard]] std::vector<std::string> names() const override { return modules_.names(); }

 private:
  ModuleSource& modules_;
  const Tell& tell_;
  const Refused& refused_;
};

/// do_apart(), and again without each component whose code did not come to its end: then the work meets an error at its place.
std::string do_apart_without_broken(const std::function<std::string(ModuleSource& modules)>& work);

}  // namespace kerf::hal
