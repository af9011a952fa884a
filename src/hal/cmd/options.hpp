// The options that halcmd and halrun share.
#pragma once

#include <memory>
#include <string>

#include "hal/cmd/commander.hpp"
#include "ini/ini_file.hpp"

namespace kerf::hal {

struct HalcmdOptions {
  static constexpr const char* kLetters = "efi:kqQRsvV";
  bool from_file{false};  ///< -f
  std::string ini_path;
  bool keep_going{false};
  bool script{false};
  bool echo{false};
  bool json{false};     ///< --json
  bool release{false};  ///< -R
  Commander::Level level{Commander::Level::errors};
  std::unique_ptr<ini::IniFile> ini;

  /// True when the option is one of these.
  bool take(int letter, const char* argument);
  /// Reads the INI file, if one is named; prints what is wrong with it.
  bool load_ini();
  void apply(Commander& commander) const;
};

}  // namespace kerf::hal
