// Every component of the tree, loaded and unloaded again and again while threads run: HAL's memory, the process's memory and its
// descriptors must not grow. KERF_COUNT=N does N rounds instead of 1000 in this process, and N / 40 with the true rtapi_app.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <sched.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <list>
#include <map>
#include <thread>

#include "hal/client/session.hpp"
#include "hal/core/view.hpp"
#include "hal/loader/host.hpp"
#include "hal/loader/module_source.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::hal::test {
namespace {

using Words = std::vector<std::string>;

/// How a component is loaded: what must be there before it, and its parameters. Those that are not named here need neither.
struct Recipe {
  std::vector<Words> before;
  Words args;
};
const std::map<std::string, Recipe>& recipes() {
  static const std::map<std::string, Recipe> table = {
      {"bldc", {{}, {"cfg=qi6,aH"}}},
      {"carousel", {{}, {"pockets=10,8"}}},
      {"lcd", {{}, {"fmt_strings=Place %4.4f|Second page %d"}}},
      {"message", {{}, {"messages=one,two"}}},
      {"sampler", {{}, {"depth=16", "cfg=ffbs"}}},
      {"streamer", {{}, {"depth=16", "cfg=ffbs"}}},
      {"motmod", {{{"trivkins"}}, {"servo_period_nsec=1000000", "num_joints=3"}}},
      {"joint-logger", {{{"trivkins"}, {"motmod", "servo_period_nsec=1000000"}}, {}}},
      {"threads", {{}, {"name1=more", "period1=2000000"}}},
      {"debounce", {{}, {"cfg=2,1"}}},
      {"demux-generic", {{}, {"config=ff4,bu2"}}},
      {"enum", {{}, {"enums=D;OFF;ON,E;STOP;GO"}}},
      {"freqgen", {{}, {"step_type=0,2,5"}}},
      {"matrix-kb", {{}, {"config=4x4s,4x8"}}},
      {"mux-generic", {{}, {"config=ff4,bu2"}}},
      {"pwmgen", {{}, {"output_type=0,1,2"}}},
      {"stepgen", {{}, {"step_type=0,2,5"}}},
      {"watchdog", {{}, {"num_inputs=2"}}},
      {"weighted-sum", {{}, {"wsum_sizes=4,2"}}},
  };
  return table;
}

std::string with_dashes(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

int rounds() {
  const char* given = std::getenv("KERF_COUNT");
  return given != nullptr ? std::max(40, std::atoi(given)) : 1000;
}

std::size_t resident_kb(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::size_t pages = 0;
  file >> pages >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) / 1024;
}

std::size_t descriptors(pid_t pid) {
  std::size_t n = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator it("/proc/" + std::to_string(pid) + "/fd", error), end;
       !error && it != end; it.increment(error))
    ++n;
  return n;
}

/// One load and unload of a component by whatever way commands are done. Gives the first complaint.
template <class Ask>
std::string cycle_of(const std::string& name, const View& view, bool with_functions, Ask&& ask) {
  const auto recipe = recipes().find(with_dashes(name));
  std::vector<std::string> loaded;
  std::string complaint;
  const auto load = [&](const Words& words) {
    Words command = {"loadrt"};
    command.insert(command.end(), words.begin(), words.end());
    if (complaint.empty()) complaint = ask(command);
    if (complaint.empty()) loaded.push_back(words[0]);
  };
  Words own = {name};
  if (recipe != recipes().end()) {
    for (const auto& before : recipe->second.before) load(before);
    own.insert(own.end(), recipe->second.args.begin(), recipe->second.args.end());
  }
  load(own);
  if (with_functions && complaint.empty()) {
    for (const auto& function : view.functions()) {
      if (complaint.empty()) complaint = ask({"addf", function.name, "t"});
    }
  }
  for (auto it = loaded.rbegin(); it != loaded.rend(); ++it) {
    const std::string unloading = ask({"unloadrt", *it});
    if (complaint.empty()) complaint = unloading;
  }
  // Threads that stand on their own.
  for (const auto& component : view.components()) {
    if (component.name.rfind("__", 0) == 0 && component.name != "__t") {
      const std::string ending = ask({"unloadrt", component.name});
      if (complaint.empty()) complaint = ending;
    }
  }
  return complaint;
}

/// Runs each thread's cycles without pause.
class Spinners final : public HostDriver {
 public:
  ~Spinners() override {
    while (!running_.empty()) thread_removed(*running_.front().runner);
  }
  rtapi::Status thread_added(ThreadRunner& runner) override {
    runner.record().ticking.publish(1);
    auto& spinner = running_.emplace_back();
    spinner.runner = &runner;
    spinner.thread = std::thread([&spinner] {
      rtapi::Nanos t = 0;
      while (!spinner.stop.requested()) {
        spinner.runner->run_cycle(t, t);
        t += spinner.runner->period_ns();
        ::sched_yield();
      }
    });
    return {};
  }
  void thread_removed(ThreadRunner& runner) override {
    for (auto it = running_.begin(); it != running_.end(); ++it) {
      if (it->runner != &runner) continue;
      it->stop.request();
      it->thread.join();
      runner.record().ticking.publish(0);
      running_.erase(it);
      return;
    }
  }
  bool wait_for_threads(int attempt) override {
    ::sched_yield();
    return attempt < 100'000'000;
  }

 private:
  struct Spinner {
    ThreadRunner* runner{nullptr};
    rtapi::StopWord stop;
    std::thread thread;
  };
  std::list<Spinner> running_;
};

/// Resident memory of the other process may grow by so much. A sanitizer keeps what was freed for a while.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr long kSpareKb = 1L << 20;
#else
constexpr long kSpareKb = 512;
#endif
/// What this process holds from the allocator may grow by so much: less than a byte for each component loaded. (How many
/// pages the allocator spreads it over depends on the order in which threads ended, so resident memory says nothing here.)
constexpr std::size_t kSpareHeapKb = 64;

/// Bytes held from the allocator in all its arenas; 0 under a sanitizer, whose allocator does not say.
std::size_t heap_kb() {
  const auto info = ::mallinfo2();
  return (info.uordblks + info.hblkhd) / 1024;
}

struct Figures {
  std::uint64_t arena{0};
  std::size_t memory_kb{0};
  std::size_t descriptors{0};
};

TEST(LoadCycle, NothingGrowsInThisProcess) {
  auto segment = rtapi::Segment::in_memory();
  const auto clock = rtapi::make_real_clock();
  StaticSource modules(static_components());
  Spinners driver;
  auto host = std::move(Host::create(*segment, *clock, modules, &driver)).value();
  const View view(*segment);
  const auto ask = [&](const Words& words) {
    const Reply reply = host->command(words);
    return reply.ok() ? std::string() : words[0] + " " + words[1] + ": " + reply.text;
  };
  const auto figures = [&] {
    return Figures{host->registry().arena_bytes(), heap_kb(), descriptors(::getpid())};
  };
  ASSERT_EQ(ask({"loadrt", "threads", "name1=t", "period1=1000000"}), "");
  ASSERT_EQ(ask({"unloadrt", "threads"}), "");
  ASSERT_TRUE(host->command({"start"}).ok());
  const auto names = modules.names();
  ASSERT_GT(names.size(), 20U);
  // The order of loading differs from round to round, so free memory is cut in many ways before it is measured.
  const int all = rounds();
  const int warm = all / 10;
  Figures before;
  for (int round = 0; round < all; ++round) {
    if (round == warm) before = figures();
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto& name = names[(i * 7 + static_cast<std::size_t>(round)) % names.size()];
      ASSERT_EQ(cycle_of(name, view, (round + static_cast<int>(i)) % 2 == 0, ask), "")
          << name << ", round " << round;
    }
  }
  const Figures after = figures();
  EXPECT_LE(after.arena, before.arena);
  EXPECT_LE(after.memory_kb, before.memory_kb + kSpareHeapKb);
  EXPECT_EQ(after.descriptors, before.descriptors);
  EXPECT_EQ(view.components().size(), 1U);  // __t
  const auto whole = host->registry().check_invariants();
  EXPECT_TRUE(whole.ok()) << whole.error().message();
  std::printf("%d rounds of %zu components: arena %llu bytes, heap %zu -> %zu kB\n", all,
              names.size(), static_cast<unsigned long long>(after.arena), before.memory_kb,
              after.memory_kb);
}

TEST(LoadCycle, NothingGrowsInRtapiApp) {
  const std::string instance = "test-cycles-" + std::to_string(::getpid());
  const std::string bin = std::string(KERF_BUILD_DIR) + "/bin/rtapi_app";
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  const pid_t app = ::fork();
  if (app == 0) {
    ::close(ends[0]);
    ::setenv("KERF_SUPERVISOR_FD", std::to_string(ends[1]).c_str(), 1);
    // One arena: otherwise resident memory depends on which thread of the host ended first.
    ::setenv("MALLOC_ARENA_MAX", "1", 1);
    // Large blocks go back to the system at once; else they stay in the heap after the first of them has.
    ::setenv("MALLOC_MMAP_THRESHOLD_", "131072", 1);
    ::execl(bin.c_str(), bin.c_str(), "--instance", instance.c_str(), nullptr);
    ::_exit(127);
  }
  ::close(ends[1]);
  char byte = 0;
  ASSERT_EQ(::read(ends[0], &byte, 1), 1) << "rtapi_app did not start";
  {
    auto segment = std::move(rtapi::Segment::attach(instance)).value();
    auto session = std::move(SocketSession::connect(*segment)).value();
    const View view(*segment);
    const auto ask = [&](const Words& words) {
      const auto reply = session->request(words);
      if (!reply.ok()) return "rtapi_app: " + reply.error().message();
      return reply->ok() ? std::string() : words[0] + " " + words[1] + ": " + reply->text;
    };
    const auto figures = [&] {
      return Figures{view.counts().bytes_used + view.counts().bytes_free, resident_kb(app),
                     descriptors(app)};
    };
    ASSERT_EQ(ask({"loadrt", "threads", "name1=t", "period1=1000000"}), "");
    ASSERT_EQ(ask({"unloadrt", "threads"}), "");
    ASSERT_TRUE(session->request({"start"})->ok());
    // Those that this build has made; the file name says '-' or '_'.
    const auto names = DlopenSource({std::string(KERF_BUILD_DIR) + "/components"}).names();
    ASSERT_GT(names.size(), 2U);
    const int all = rounds() / 40;
    // Until every component has been everywhere in the arena, pages are new. Then the least of a quarter of the rounds counts: the heap is a megabyte
    // longer in some, when what came last was freed in another order, and short again in the next. What leaks is in all of them.
    const int warm = all / 2, middle = all * 3 / 4;
    Figures before, after;
    for (int round = 0; round < all; ++round) {
      for (const auto& name : names)
        ASSERT_EQ(cycle_of(name, view, round % 2 == 0, ask), "") << name << ", round " << round;
      Figures& now = round < middle ? before : after;
      const std::size_t least = round == warm || round == middle ? SIZE_MAX : now.memory_kb;
      now = figures();
      now.memory_kb = std::min(now.memory_kb, least);
    }
    EXPECT_LE(after.arena, before.arena);
    EXPECT_LE(after.memory_kb, before.memory_kb + kSpareKb);
    EXPECT_EQ(after.descriptors, before.descriptors);
    EXPECT_TRUE(session->request({"check-invariants"})->ok());
    std::printf("%d rounds of %zu components: arena %llu bytes, resident %zu -> %zu kB\n", all,
                names.size(), static_cast<unsigned long long>(after.arena), before.memory_kb,
                after.memory_kb);
  }
  ::close(ends[0]);  // the supervisor is gone
  int status = -1;
  EXPECT_EQ(::waitpid(app, &status, 0), app);
  EXPECT_EQ(status, 0);
  EXPECT_FALSE(rtapi::Segment::attach(instance).ok());
}

}  // namespace
}  // namespace kerf::hal::test
