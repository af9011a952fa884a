// TclFiles: Tcl files in a check. They run in a Tcl whose HAL words go to the check, with the INI file's arrays, so that loops and
// conditions go the way they go on the machine. What would reach out of the script does nothing: programs, files that are written,
// waiting, printing.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/cmd/check.hpp"

namespace kerf::hal {

class ScriptCheck::TclFiles {
 public:
  /// All outlive it. `ini` may be null.
  TclFiles(ScriptCheck& check, Session& session, const ini::IniFile* ini);
  ~TclFiles();
  TclFiles(const TclFiles&) = delete;
  TclFiles& operator=(const TclFiles&) = delete;

  void run(const std::string& path, const std::vector<std::string>& arguments);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kerf::hal
