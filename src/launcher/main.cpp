// kerf: starts and supervises the machine of an INI file. Also installed as `linuxcnc`.
#include <cstdio>
#include <string_view>
#include <utility>

#include "launcher/console.hpp"
#include "launcher/environment.hpp"
#include "launcher/flight_keeper.hpp"
#include "launcher/options.hpp"
#include "launcher/resume.hpp"
#include "launcher/session.hpp"
#include "rtapi/log/log.hpp"

int main(int argc, char** argv) {
  using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file
  rtapi::set_program_name("kerf");
  if (argc > 1 && (std::string_view(argv[1]) == "record" || std::string_view(argv[1]) == "replay"))
    return launcher::record_command({argv + 1, argv + argc}, launcher::find_installation().bin);
  auto options = launcher::parse_options({argv + 1, argv + argc});
  if (!options.ok()) {
    const launcher::ParseEnd& end = options.error();
    std::fputs(end.text.c_str(), end.exit_code == launcher::kExitOk ? stdout : stderr);
    return end.exit_code;
  }
  launcher::Console console(options->verbose);
  if (options->resume) return launcher::resume(*options, console);
  launcher::Session session(std::move(*options), console);
  return session.run();
}
