#include "hal/cmd/options.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "rtapi/log/log.hpp"

namespace kerf::hal {

bool HalcmdOptions::take(int letter, const char* argument) {
  switch (letter) {
    case 'e': echo = true; return true;
    case 'f': from_file = true; return true;
    case 'i': ini_path = argument; return true;
    case 'k': keep_going = true; return true;
    case 'q': level = Commander::Level::errors; return true;
    case 'Q': level = Commander::Level::silent; return true;
    case 'R': release = true; return true;
    case 's': script = true; return true;
    case 'v': level = Commander::Level::verbose; return true;
    case 'V':
      level = Commander::Level::debug;
      rtapi::set_log_level(rtapi::Level::debug);
      return true;
    default: return false;
  }
}

bool HalcmdOptions::load_ini() {
  if (ini_path.empty()) return true;
  if (::access(ini_path.c_str(), R_OK) != 0) {
    std::fprintf(stderr, "Could not open INI file '%s': %s\n", ini_path.c_str(),
                 std::strerror(errno));
    return false;
  }
  auto loaded = ini::IniFile::load(ini_path);
  for (const auto& d : loaded.diagnostics) std::fprintf(stderr, "%s\n", d.message().c_str());
  if (!loaded.ok) return false;
  ini = std::make_unique<ini::IniFile>(std::move(loaded.file));
  return true;
}

void HalcmdOptions::apply(Commander& commander) const {
  commander.set_level(level);
  commander.set_keep_going(keep_going);
  commander.set_script_mode(script);
  commander.set_echo(echo);
  commander.set_json(json);
  if (ini) commander.set_ini(ini_lookup(*ini));
}

}  // namespace kerf::hal
