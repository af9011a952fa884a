// What a component declares, and its manual page made from that: the declaration is the only source of both.
//
//   hal::Describer describer(modules);
//   const auto and2 = describer.describe("and2");
//   if (and2.ok()) std::fputs(hal::man_page(*and2).c_str(), stdout);
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "hal/component.hpp"
#include "hal/loader/module_source.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// A component as one instance of it declares itself. Names of an instance hold "N" where its number will stand.
struct Declaration {
  struct Argument {
    std::string name, default_text, doc;
  };
  struct Item {
    std::string name;
    Type type;
    Dir dir;
    std::uint64_t initial;
    std::string doc;
    [[nodiscard]] bool is_pin() const {
      return dir == Dir::in || dir == Dir::out || dir == Dir::io;
    }
  };
  struct Function {
    std::string name, doc;
  };
  struct Thread {
    std::string name;
    std::int64_t period_ns;
  };
  std::string name;  ///< as loadrt takes it
  std::string summary, notes, license, example;
  bool singleton{false};
  std::vector<Argument> arguments;
  std::vector<Item> items;
  std::vector<Function> functions;
  std::vector<Thread> threads;
  std::string incomplete;  ///< why not all could be declared; empty: it is whole
};

class Describer {
 public:
  /// The source must outlive the describer.
  explicit Describer(ModuleSource& modules);
  ~Describer();
  Describer(const Describer&) = delete;
  Describer& operator=(const Describer&) = delete;

  /// Nothing runs and no device is touched (Builder::declares_only). Components that this one needs are made too. One written in C
  /// cannot declare itself: it is loaded into a HAL of its own, with the words of `loadrt` that are given, and what it made is told.
  rtapi::Result<Declaration> describe(const std::string& name,
                                      const std::vector<std::string>& loadrt_words = {});

 private:
  class Recorder;
  rtapi::Result<std::unique_ptr<Recorder>> declare(const std::string& name);
  void find_provider(const std::string& service);
  rtapi::Result<Declaration> describe_c(const std::string& name,
                                        const std::vector<std::string>& loadrt_words);

  ModuleSource& modules_;
  std::map<std::string, void*, std::less<>> services_;
  std::vector<std::unique_ptr<Recorder>>
      recorders_;  ///< providers; a later one may use what an earlier one provides
  std::set<std::string> searching_;  ///< services
};

/// Items alike but for a number, such as "sampler.0.pin.0" to "sampler.0.pin.3".
struct ItemGroup {
  std::string name;   ///< the varying number is "M"
  std::string range;  ///< "M from 0 to 3"; empty: one item
  const Declaration::Item* item;
};
std::vector<ItemGroup> grouped(const Declaration& declaration, bool pins);

std::string man_page(const Declaration& declaration);
std::string markdown_page(const Declaration& declaration);
std::string text_page(const Declaration& declaration);
std::string declaration_json(const Declaration& declaration);

}  // namespace kerf::hal
