// LoadrtMerge: the loadrt lines of all HAL files of a machine, put together to one a module ([HAL]TWOPASS).
//
//   LoadrtMerge merge(lists_of);                // what modules declare; see hal/client/list_parameters.hpp
//   merge.add({"and2", "names=a"}, {"core.hal", 3});
//   merge.add({"and2", "names=b,c"}, {"panel.tcl", 7});
//   merge.modules()[0].words()                  // and2 names=a,b,c
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rtapi/base/result.hpp"

namespace kerf::hal::tcl {

/// Where a command stands in a user's file.
struct Place {
  std::string file;
  int line{0};
  /// FILE:LINE
  [[nodiscard]] std::string text() const { return file + ":" + std::to_string(line); }
};

class LoadrtMerge {
 public:
  struct Parameter {
    std::string key;  ///< "" for a word without '='
    std::string value;
    Place at;  ///< where it stood first
  };
  struct Module {
    std::string name;
    std::vector<Parameter> parameters;
    std::vector<Place> places;  ///< of all its loadrt lines, in order
    /// loadrt's words after "loadrt".
    [[nodiscard]] std::vector<std::string> words() const;
    /// Places of all lines, separated by ", ".
    [[nodiscard]] std::string places_text() const;

    std::size_t instances{0};  ///< counted by names= or count=
    bool has_personality{false};
    /// Of its parameters those that take a list; asked for at the first that is repeated.
    std::optional<std::vector<std::string>> lists;
  };
  /// The parameters of a module that take a list, as it declares them; nothing when there is no such module.
  using ListsOf = std::function<std::optional<std::vector<std::string>>(const std::string& module)>;
  explicit LoadrtMerge(ListsOf lists_of) : lists_of_(std::move(lists_of)) {}

  /// `words`: module and parameters, without "loadrt". count= and num_chan= are summed; names=, personality= and other lists are
  /// joined by commas; anything else may be repeated with the same value only.
  rtapi::Status add(std::span<const std::string> words, const Place& at);

  /// In the order of their first lines.
  [[nodiscard]] const std::vector<Module>& modules() const { return modules_; }

 private:
  rtapi::Status merge_other(Module& module, const Parameter& given);
  [[nodiscard]] bool takes_list(Module& module, const std::string& key) const;

  ListsOf lists_of_;
  std::vector<Module> modules_;
};

/// True when a line of the .hal file's text begins with #NOTWOPASS, whatever its case and blanks.
bool is_excluded(std::string_view text);

}  // namespace kerf::hal::tcl
