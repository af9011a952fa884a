// Sixteen processes make, link, unlink and delete a thousand objects each on one true rtapi_app whose threads run, and some of
// them are killed anywhere. Whatever happens: those that live get done, HAL stays whole, what belonged to the dead is gone, and
// the realtime threads have never waited for anybody.
//
// KERF_COUNT=N does N rounds, KERF_SEED=N begins with that seed. A failing seed is printed.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include "hal/client/session.hpp"
#include "hal/core/view.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::hal::test {
namespace {

using Words = std::vector<std::string>;
using Random = std::mt19937_64;

constexpr int kWorkers = 16;
constexpr int kObjects = 1000;  ///< of each worker: pins, parameters and signals
constexpr int kPinsEach = 30;   ///< of one component
constexpr int kParamsEach = 5;
constexpr int kSignalsEach = 15;
constexpr int kSharedSignals = 12;   ///< for which all workers fight
constexpr std::size_t kWindow = 24;  ///< requests under way, so that many die unanswered

/// In memory that all processes share: objects that the worker in this place has made.
struct Progress {
  rtapi::Word<std::uint32_t> made[kWorkers];
};

// ---- a worker -----------------------------------------------------------------------------------

/// Ends the process when something is not as it must be.
class Worker {
 public:
  Worker(const std::string& instance, int place, std::uint64_t seed, Progress& progress)
      : name_("w" + std::to_string(place) + "-" + std::to_string(::getpid())),
        random_(seed),
        made_(progress.made[place]) {
    auto segment = rtapi::Segment::attach(instance);
    if (!segment.ok()) die(segment.error().message());
    segment_ = std::move(*segment);
    auto session = SocketSession::connect(*segment_);
    if (!session.ok()) die(session.error().message());
    session_ = std::move(*session);
  }

  void run() {
    made_.set(0);
    for (int n = 0; made_.get() < kObjects; ++n) one_component(name_ + "-" + std::to_string(n));
    collect(0);
  }

 private:
  [[noreturn]] void die(const std::string& why) {
    std::fprintf(stderr, "%s: %s\n", name_.c_str(), why.c_str());
    ::_exit(3);
  }
  std::uint64_t any(std::uint64_t n) { return random_() % n; }

  /// `must`: nobody else can make it fail.
  void ask(const Words& words, bool must) {
    if (auto posted = session_->post(words); !posted.ok()) die(posted.error().message());
    under_way_.push_back({words, must});
    collect(kWindow);
  }
  void collect(std::size_t leave) {
    for (; under_way_.size() > leave; under_way_.pop_front()) {
      auto reply = session_->collect();
      if (!reply.ok()) die(reply.error().message());
      if (!reply->ok() && under_way_.front().must)
        die(under_way_.front().words[0] + " " + under_way_.front().words[1] + ": " + reply->text);
    }
  }
  /// Asks and waits for the answer.
  std::string answer(const Words& words) {
    collect(0);
    auto reply = session_->request(words);
    if (!reply.ok()) die(reply.error().message());
    if (!reply->ok()) die(words[0] + ": " + reply->text);
    return reply->text;
  }

  void one_component(const std::string& component) {
    const auto base = reinterpret_cast<std::uintptr_t>(segment_->base());
    const std::uint64_t cells = std::stoull(answer({"mem-new", std::to_string(kPinsEach * 8)}));
    ask({"comp-new", component, std::to_string(base)}, true);
    std::vector<std::string> pins;
    std::vector<std::string> outs;
    std::vector<std::string> signals;
    for (int i = 0; i < kPinsEach; ++i) {
      static constexpr const char* kDirs[] = {"IN", "OUT", "I/O"};
      const std::string name = component + ".p" + std::to_string(i);
      Words words = {"pin-new", component, name, i % 4 == 0 ? "float" : "s32", kDirs[any(3)]};
      if (any(2) == 0) {
        words.insert(words.end(), {"0", std::to_string(cells + static_cast<unsigned>(i) * 8)});
      }
      if (i % 10 == 0) {
        // As a component would: it writes to its pin all the time, wherever that is linked.
        slots_.push_back(slot_at(*segment_, std::stoull(answer(words))));
      } else {
        ask(words, true);
      }
      pins.push_back(name);
      count();
    }
    for (int i = 0; i < kParamsEach; ++i) {
      ask({"param-new", component, component + ".q" + std::to_string(i), "u32", "RW", "7"}, true);
      count();
    }
    ask({"comp-ready", component}, true);
    for (int i = 0; i < kSignalsEach; ++i) {
      signals.push_back(component + "-s" + std::to_string(i));
      ask({"newsig", signals.back(), i % 4 == 0 ? "float" : "s32"}, true);
      count();
    }
    for (int i = 0; i < 3 * kPinsEach; ++i) {
      const std::string& pin = pins[any(pins.size())];
      const std::string signal = any(4) == 0 ? "shared-" + std::to_string(any(kSharedSignals))
                                             : signals[any(signals.size())];
      switch (any(8)) {
        case 0:
        case 1:
        case 2: ask({"net", signal, pin, pins[any(pins.size())]}, false); break;
        case 3: ask({"linkps", pin, signal}, false); break;
        case 4:
        case 5: ask({"unlinkp", pin}, true); break;
        case 6: ask({"sets", signal, std::to_string(any(100))}, false); break;
        default: ask({"delsig", "shared-" + std::to_string(any(kSharedSignals))}, false); break;
      }
      for (const auto& slot : slots_) slot.slot().store(any(1000), std::memory_order_relaxed);
    }
    for (const auto& signal : signals) ask({"delsig", signal}, true);
    slots_.clear();
    ask({"comp-exit", component}, true);
  }
  void count() { made_.add(1); }

  struct Asked {
    Words words;
    bool must;
  };
  std::string name_;
  Random random_;
  rtapi::Word<std::uint32_t>& made_;
  std::unique_ptr<rtapi::Segment> segment_;
  std::unique_ptr<SocketSession> session_;
  std::deque<Asked> under_way_;
  std::vector<SlotRef> slots_;
};

// ---- the test -----------------------------------------------------------------------------------

/// What the kernel says of a thread: how often it has given up the processor by itself.
std::uint64_t voluntary_switches(pid_t process, const std::string& thread) {
  for (const auto& entry :
       std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task")) {
    std::ifstream comm(entry.path() / "comm");
    std::string name;
    if (!std::getline(comm, name) || name != thread) continue;
    std::ifstream status(entry.path() / "status");
    std::string word;
    while (status >> word) {
      std::uint64_t n = 0;
      if (word == "voluntary_ctxt_switches:" && status >> n) return n;
    }
  }
  return 0;
}

/// Looks at HAL from outside, as any program can: gives the first contradiction.
std::string contradiction(const View& view) {
  std::map<std::string, const SignalInfo*> by_name;
  const auto signals = view.signals();
  for (const auto& signal : signals) {
    by_name[signal.name] = &signal;
    std::uint32_t in = 0;
    std::uint32_t out = 0;
    std::uint32_t io = 0;
    for (const auto& pin : signal.pins) {
      in += pin.dir == Dir::in ? 1U : 0U;
      out += pin.dir == Dir::out ? 1U : 0U;
      io += pin.dir == Dir::io ? 1U : 0U;
    }
    if (out > 1) return "signal " + signal.name + " has two writers";
    if (out > 0 && io > 0) return "signal " + signal.name + " has a writer and an I/O pin";
    if (in != signal.readers || out != signal.writers || io != signal.bidirs)
      return "signal " + signal.name + " counts its pins wrongly";
  }
  return {};
}

class KillProperty : public testing::Test {
 protected:
  void SetUp() override {
    instance_ = "test-kill-" + std::to_string(::getpid());
    void* shared = ::mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE,
                          MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(shared, MAP_FAILED);
    progress_ = new (shared) Progress();
    int ends[2];
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
    const std::string bin = std::string(KERF_BUILD_DIR) + "/bin/rtapi_app";
    app_ = ::fork();
    if (app_ == 0) {
      const int kept = ::dup(ends[1]);
      ::setenv("KERF_SUPERVISOR_FD", std::to_string(kept).c_str(), 1);
      ::execl(bin.c_str(), bin.c_str(), "--instance", instance_.c_str(), nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    supervisor_ = ends[0];
    char byte = 0;
    ASSERT_EQ(::read(supervisor_, &byte, 1), 1) << "rtapi_app did not start";
    segment_ = std::move(rtapi::Segment::attach(instance_)).value();
    session_ = std::move(SocketSession::connect(*segment_)).value();
    for (const Words& words :
         std::vector<Words>{{"loadrt", "threads", "name1=fast", "period1=1000000", "name2=slow",
                             "period2=10000000"},
                            {"loadrt", "and2", "count=20"},
                            {"start"}})
      must(words);
    for (int i = 0; i < 20; ++i)
      must({"addf", "and2." + std::to_string(i), i % 2 == 0 ? "fast" : "slow"});
  }
  void TearDown() override {
    for (const auto& [pid, place] : workers_) {
      ::kill(pid, SIGKILL);
      ::waitpid(pid, nullptr, 0);
    }
    session_.reset();
    segment_.reset();
    ::close(supervisor_);
    int status = -1;
    EXPECT_EQ(::waitpid(app_, &status, 0), app_);
    EXPECT_EQ(status, 0);
    EXPECT_FALSE(rtapi::Segment::attach(instance_).ok());
    ::munmap(progress_, sizeof(Progress));
  }
  void must(const Words& words) {
    const auto reply = session_->request(words);
    ASSERT_TRUE(reply.ok()) << reply.error().message();
    ASSERT_TRUE(reply->ok()) << words[0] << ": " << reply->text;
  }
  void start_worker(int place, Random& random) {
    const std::uint64_t seed = random();
    const pid_t pid = ::fork();
    if (pid == 0) {
      ::close(supervisor_);
      ::close(session_->fd());
      Worker(instance_, place, seed, *progress_).run();
      ::_exit(0);
    }
    workers_[pid] = place;
  }
  static void pause_us(std::int64_t us) {
    const auto clock = rtapi::make_real_clock();
    rtapi::WaitSpec spec;
    spec.wake_at(clock->now() + us * 1000);
    clock->wait(spec);
  }

  /// One life of all workers. `kills`: how many are ended before their time, and replaced.
  void round(std::uint64_t seed, int kills) {
    Random random(seed);
    for (int place = 0; place < kWorkers; ++place) start_worker(place, random);
    struct Doom {
      int place;
      std::uint32_t after;
    };
    std::vector<Doom> dooms;
    for (int i = 0; i < kills; ++i) {
      dooms.push_back(
          {static_cast<int>(random() % kWorkers), static_cast<std::uint32_t>(random() % kObjects)});
    }
    const View view(*segment_);
    while (!workers_.empty()) {
      for (auto doom = dooms.begin(); doom != dooms.end();) {
        const auto victim = std::find_if(workers_.begin(), workers_.end(),
                                         [&](const auto& w) { return w.second == doom->place; });
        if (victim == workers_.end()) {
          doom = dooms.erase(doom);  // it was faster
          continue;
        }
        if (progress_->made[doom->place].get() < doom->after) {
          ++doom;
          continue;
        }
        ::kill(victim->first, SIGKILL);
        int status = 0;
        ::waitpid(victim->first, &status, 0);
        killed_ += WIFSIGNALED(status) ? 1 : 0;
        workers_.erase(victim);
        progress_->made[doom->place].set(0);
        start_worker(doom->place, random);
        doom = dooms.erase(doom);
      }
      for (auto it = workers_.begin(); it != workers_.end();) {
        int status = 0;
        if (::waitpid(it->first, &status, WNOHANG) != it->first) {
          ++it;
          continue;
        }
        EXPECT_EQ(status, 0) << "worker in place " << it->second;
        it = workers_.erase(it);
      }
      ASSERT_EQ(contradiction(view), "");
      ASSERT_EQ(::waitpid(app_, nullptr, WNOHANG), 0) << "rtapi_app has died";
      pause_us(300);
    }
    // The host reads the ends of connections in its own time, but before what is asked after them.
    must({"check-invariants"});
    for (int i = 0; i < 1000 && view.components().size() > components_; ++i) pause_us(1000);
    EXPECT_EQ(view.components().size(), components_);
    for (const auto& pin : view.pins()) EXPECT_NE(pin.name[0], 'w') << pin.name;
    for (const auto& param : view.params()) EXPECT_NE(param.name[0], 'w') << param.name;
    must({"check-invariants"});
    ASSERT_EQ(contradiction(view), "");
    // Signals belong to nobody: those of the dead stay, without pins of theirs.
    for (const auto& signal : view.signals()) {
      EXPECT_TRUE(signal.pins.empty()) << signal.name;
      must({"delsig", signal.name});
    }
  }

  std::string instance_;
  Progress* progress_{nullptr};
  pid_t app_{-1};
  int supervisor_{-1};
  std::unique_ptr<rtapi::Segment> segment_;
  std::unique_ptr<SocketSession> session_;
  std::map<pid_t, int> workers_;
  std::size_t components_{0};
  int killed_{0};
};

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

TEST_F(KillProperty, ProcessesThatDieAnywhereHurtNobody) {
  const View view(*segment_);
  components_ = view.components().size();
  const auto cycles = [&] { return view.find_thread("fast")->cycles; };
  const std::uint64_t first_seed = from_environment("KERF_SEED", 1);
  const std::uint64_t rounds = from_environment("KERF_COUNT", 2);
  std::uint64_t memory = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + rounds; ++seed) {
    SCOPED_TRACE("KERF_SEED=" + std::to_string(seed));
    // The cycles from before the first to after the last look at the switches: no fewer than the switches that are seen.
    const std::uint64_t cycles_before = cycles();
    const std::uint64_t switches_before = voluntary_switches(app_, "fast");
    round(seed, 12);
    if (HasFatalFailure()) return;
    const std::uint64_t switches = voluntary_switches(app_, "fast") - switches_before;
    const std::uint64_t run = cycles() - cycles_before;
    // A cycle ends with one sleep. Had the thread waited for a lock, for memory or for anything else that others have, the kernel
    // would have counted a switch more. (Cycles that the busy computer lost have neither.)
    EXPECT_GT(run, 0U);
    EXPECT_LE(switches, run + 2);
    const auto counts = view.counts();
    if (seed == first_seed) memory = counts.bytes_used;
    EXPECT_LE(counts.bytes_used, memory + (1U << 20U));  // a round makes twelve times as much
    std::printf("seed %llu: %d killed, %llu cycles, %llu waits of the thread, %llu bytes used\n",
                static_cast<unsigned long long>(seed), killed_,
                static_cast<unsigned long long>(run), static_cast<unsigned long long>(switches),
                static_cast<unsigned long long>(counts.bytes_used));
  }
  EXPECT_GT(killed_, 0);
}

}  // namespace
}  // namespace kerf::hal::test
