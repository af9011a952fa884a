// motion-replay: what `kerf replay` and `kerf record show` run.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "hal/loader/host.hpp"
#include "motion/replay/replay.hpp"
#include "rtapi/clock/local_scheduler.hpp"
#include "rtapi/shm/segment.hpp"

namespace {

using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file

constexpr int kExitOther = 1, kExitUsage = 2;

constexpr const char* kUsage =
    "usage: motion-replay FILE                    runs a flight record again\n"
    "       motion-replay --show FILE [SECONDS]   prints it, the last SECONDS of it (default 60)\n"
    "       motion-replay -h | --help\n";

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (end > at) out.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

int complain(const std::string& what) {
  std::fprintf(stderr, "kerf: %s\n", what.c_str());
  return kExitOther;
}

/// The machine's kinematics in a HAL of its own.
int run(const std::string& name, const motion::FlightFile& file) {
  const std::vector<std::string> module = words_of(file.text("kinematics"));
  if (module.empty())
    return complain(name + ": it does not say which kinematics the machine has ([KINS]KINEMATICS)");
  const auto segment = rtapi::Segment::in_memory();
  rtapi::LocalScheduler clock;
  hal::DlopenSource modules;
  auto host = hal::Host::create(*segment, clock, modules);
  if (!host.ok()) return complain(host.error().message());
  std::vector<std::string> load{"loadrt"};
  load.insert(load.end(), module.begin(), module.end());
  if (const auto reply = (*host)->command(load); !reply.ok())
    return complain(name + ": " + reply.text);
  const auto [begin, end] = file.head.equal_range("setp");
  for (auto at = begin; at != end; ++at) {
    std::vector<std::string> words = words_of(at->second);
    words.insert(words.begin(), "setp");
    (void)(*host)->command(words);
  }
  auto* kinematics = static_cast<motion::Kinematics*>((*host)->service(motion::kKinematicsService));
  if (kinematics == nullptr)
    return complain(name + ": " + module.front() +
                    " is a module in C; its kinematics run only in a machine");
  const motion::ReplayResult result = motion::replay(file, *kinematics);
  std::fputs(motion::report(result).c_str(), result.error.empty() ? stdout : stderr);
  return result.same() ? 0 : kExitOther;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 1 && (words[0] == "-h" || words[0] == "--help")) {
    std::fputs(kUsage, stdout);
    return 0;
  }
  const bool shows = words.size() >= 2 && words[0] == "--show";
  if (words.empty() || words.size() > 3 || (!shows && words.size() != 1)) {
    std::fputs(kUsage, stderr);
    return kExitUsage;
  }
  const std::string& name = shows ? words[1] : words[0];
  std::FILE* in = std::fopen(name.c_str(), "re");
  if (in == nullptr) return complain(name + ": " + std::strerror(errno));
  motion::FlightFile file;
  const std::string wrong = file.read(in);
  (void)std::fclose(in);
  if (!wrong.empty()) return complain(name + ": " + wrong);
  if (!shows) return run(name, file);
  const double seconds = words.size() == 3 ? std::strtod(words[2].c_str(), nullptr) : 60;
  std::fputs(motion::show(file, seconds).c_str(), stdout);
  return 0;
}
