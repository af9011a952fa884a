// motion-logger: in place of motmod, writes down what task tells motion.
#include <signal.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include "clients/motion_logger/stand_in.hpp"
#include "hal/client/session.hpp"
#include "hal/core/view.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/stop_signals.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/segment.hpp"

namespace {

using namespace kerf;

constexpr const char* kName = "motion-logger";
constexpr const char* kUsage =
    "usage: motion-logger [--instance NAME] [FILE]\n"
    "\n"
    "Stands in for the motion controller: a HAL file loads it instead of motmod, with\n"
    "'loadusr -W motion-logger FILE'. It takes all that task tells motion, says yes at once and\n"
    "writes each command as one line of text to FILE, or to standard output.\n"
    "\n"
    "  --instance NAME   instance; default: KERF_INSTANCE, else by user id\n"
    "  --man             print the list of lines as it stands in the manual page\n";

struct Options {
  std::string instance{rtapi::default_instance()};
  std::string file;
};

/// 0: go on; else the exit status is the value minus one.
int read_options(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") {
      std::fputs(kUsage, stdout);
      return 1;
    }
    if (word == "--man") {
      std::fputs(motion_logger::manual_list().c_str(), stdout);
      return 1;
    }
    if (word == "--instance" && i + 1 < argc) {
      options.instance = argv[++i];
    } else if ((word.size() > 1 && word[0] == '-') || !options.file.empty()) {
      std::fprintf(stderr, "motion-logger: unexpected '%s'\n%s", word.c_str(), kUsage);
      return 3;
    } else {
      options.file = word;
    }
  }
  return 0;
}

int fail_with(const std::string& text) {
  std::fprintf(stderr, "motion-logger: %s\n", text.c_str());
  return 1;
}

/// The block of motion, where task and clients look for it.
rtapi::Result<motion::MotionShared*> make_block(hal::Session& session) {
  const hal::View view(session.segment());
  if (view.block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi).ok())
    return rtapi::fail(
        rtapi::Errc::exists,
        "there is a motion controller already: load motmod or motion-logger, not both");
  auto made = hal::ask(
      session, {"shm-new", motion::kMotionBlock, std::to_string(sizeof(motion::MotionShared)),
                std::to_string(motion::kMotionAbi)});
  if (!made.ok()) return rtapi::Failure{made.error()};
  auto block = view.block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  if (!block.ok()) return block;
  return new (*block) motion::MotionShared();
}

int run(const Options& options) {
  rtapi::catch_stop_signals({SIGINT, SIGTERM, SIGHUP});
  std::FILE* out = stdout;
  if (!options.file.empty() && options.file != "-") {
    out = std::fopen(options.file.c_str(), "we");
    if (out == nullptr)
      return fail_with("cannot write '" + options.file + "': " + std::strerror(errno));
  }
  auto segment = rtapi::Segment::attach(options.instance);
  if (!segment.ok()) return fail_with(segment.error().message());
  auto session = hal::SocketSession::connect(**segment);
  if (!session.ok()) return fail_with(session.error().message());
  if (auto made = hal::ask(**session, {"comp-new", kName}); !made.ok())
    return fail_with(made.error().message());
  auto block = make_block(**session);
  if (!block.ok()) return fail_with(block.error().message());

  motion_logger::StandIn stand_in(**block, [out](const std::string& line) {
    // A whole line at a time, for those who read along.
    std::fprintf(out, "%s\n", line.c_str());
    std::fflush(out);
  });
  {
    // Whoever waits for the component finds a motion that answers.
    rtapi::WaitSpec first;
    stand_in.step(0, first);
  }
  if (auto ready = hal::ask(**session, {"comp-ready", kName}); !ready.ok())
    return fail_with(ready.error().message());
  auto clock = rtapi::join_clock(**segment, stand_in.role(), stand_in.name());
  if (!clock.ok()) return fail_with(clock.error().message());
  const rtapi::StopOnSignal stop(**clock);
  while (!(*clock)->stopped() && (*session)->alive()) {
    rtapi::WaitSpec next;
    (*session)->watch(next);
    stand_in.step((*clock)->now(), next);
    (*clock)->wait(next);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::set_program_name(kName);
  Options options;
  if (const int end = read_options(argc, argv, options); end != 0) return end - 1;
  return run(options);
}
