// halui: an operator's panel of HAL pins.
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "clients/halui/layout.hpp"
#include "clients/halui/participant.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/stop_signals.hpp"
#include "rtapi/log/log.hpp"

namespace {

using namespace kerf;

constexpr const char* kUsage =
    "usage: halui [-ini FILE] [--instance NAME]\n"
    "\n"
    "Makes the pins halui.*, through which buttons, knobs and lamps operate a running machine.\n"
    "Started by [HAL]HALUI = halui, or in a HAL file: loadusr -W halui -ini FILE.\n"
    "\n"
    "  -ini FILE         machine file (--ini too); default: INI_FILE_NAME of the environment\n"
    "  --instance NAME   instance; default: KERF_INSTANCE, else by user id\n"
    "  -h, --help        this text\n";

struct Options {
  std::string ini;
  std::string instance{rtapi::default_instance()};
};

int usage_error(const std::string& what) {
  std::fprintf(stderr, "halui: %s\n%s", what.c_str(), kUsage);
  return 2;
}

/// 0: go on; else the exit status is the value minus one.
int read_options(int argc, char** argv, Options& options) {
  if (const char* ini = std::getenv("INI_FILE_NAME"); ini != nullptr) options.ini = ini;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") {
      std::fputs(kUsage, stdout);
      return 1;
    }
    if (word != "--ini" && word != "-ini" && word != "--instance")
      return 1 + usage_error("unknown option '" + word + "': expected -ini or --instance");
    if (++i == argc) return 1 + usage_error(word + " needs a value");
    (word == "--instance" ? options.instance : options.ini) = argv[i];
  }
  if (options.ini.empty())
    return 1 + usage_error("no machine file: expected -ini FILE, or INI_FILE_NAME set");
  return 0;
}

int fail_with(const rtapi::Error& error) {
  std::fprintf(stderr, "halui: %s\n", error.message().c_str());
  return 1;
}

int run(const Options& options) {
  rtapi::catch_stop_signals({SIGINT, SIGTERM, SIGHUP});
  const auto loaded = ini::IniFile::load(options.ini);
  for (const auto& d : loaded.diagnostics)
    if (d.is_error) std::fprintf(stderr, "halui: %s\n", d.message().c_str());
  if (!loaded.ok) return 1;
  auto layout = clients::halui::read_layout(loaded.file);
  if (!layout.ok()) return fail_with(layout.error());
  auto segment = rtapi::Segment::attach(options.instance);
  if (!segment.ok()) return fail_with(segment.error());
  auto session = hal::SocketSession::connect(**segment);
  if (!session.ok()) return fail_with(session.error());
  clients::halui::HaluiParticipant halui(**segment, **session, *layout);
  if (!halui.status().ok()) return fail_with(halui.status().error());
  auto clock = rtapi::join_clock(**segment, rtapi::Role::user_component, "halui");
  if (!clock.ok()) return fail_with(clock.error());
  const rtapi::StopOnSignal stop(**clock);
  int status = 0;
  halui.on_end([&](const rtapi::Error& why) {
    // Task ends before the others when the machine is taken down; then a signal is on its way.
    if (why.code != rtapi::Errc::dead) status = fail_with(why);
    (*clock)->stop();
  });
  rtapi::run_participant(**clock, halui);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::set_program_name("halui");
  Options options;
  if (const int end = read_options(argc, argv, options); end != 0) return end - 1;
  return run(options);
}
