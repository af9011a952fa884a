// Hours of machine time: random programs, overrides, holds, aborts, estops, mode changes, jogs and MDI from several clients, a panel of
// halui's, wheels and switches, on a mill without jerk limits, on one with them, and on mills whose kinematics, units, periods and limits
// are random.
//
// scripts/soak --hours N --seed S --mills N, or KERF_SOAK_HOURS=N KERF_SOAK_SEED=S KERF_SOAK_MILLS=N soak_test. The same seed is the same
// run. KERF_SOAK_VERBOSE=1 tells of every command.
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <sstream>

#include "hal/core/view.hpp"
#include "harness/machine.hpp"
#include "rtapi/shm/segment.hpp"
#include "soak/mills.hpp"
#include "soak/panel.hpp"
#include "soak/programs.hpp"
#include "soak/watch.hpp"
#include "task/api/client.hpp"

namespace kerf::soak {
namespace {

constexpr double kDefaultHours = 1;
/// Time laws cost more of the computer's time than the rest of the machine.
constexpr double kShareWithJerk = 0.25;
constexpr double kMaxJerk = 20'000;  ///< mm/s3
constexpr double kDefaultMills = 6;
constexpr int kRoundsOfAMill = 12;
constexpr int kWarmUpRounds = 40;
/// What allocators and logs that have not filled up yet may add after the warm-up.
constexpr double kHeapAllowance = 512.0 * 1024;

double from_environment(const char* name, double fallback) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtod(text, nullptr) : fallback;
}

std::size_t open_files() {
  std::size_t n = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd"))
    ++n;
  return n;
}

std::string numbered(const std::string& program) {
  std::string out;
  std::istringstream in(program);
  int number = 0;
  for (std::string line; std::getline(in, line);)
    out.append("    ").append(std::to_string(++number)).append(": ").append(line).append("\n");
  return out;
}

/// What must not grow.
struct Sizes {
  double heap{0};
  std::size_t files{0}, folder{0};
  std::uint64_t segment{0};
};

/// A client's seat, by turns another connection.
class Operator {
 public:
  Operator(harness::Machine& m, int number, bool verbose)
      : m_(m), number_(number), verbose_(verbose) {
    sit();
  }
  /// Dies in the middle of whatever it does and comes back as somebody else.
  void die() {
    tell("dies");
    client_.reset();
    sent_.clear();
    watched_ = 0;
    m_.run_for(0.002);
    sit();
  }
  std::uint64_t send(const std::vector<std::string>& words) {
    if (verbose_) {
      std::string text;
      for (const auto& w : words) text += " " + w;
      tell(text.c_str());
    }
    const auto id = client_->send(words);
    EXPECT_TRUE(id.ok()) << id.error().message();
    if (!id.ok()) return 0;
    sent_.push_back(*id);
    return *id;
  }
  /// Takes replies in; gives how many commands have no outcome yet.
  std::size_t poll() {
    EXPECT_TRUE(client_->poll().ok());
    std::erase_if(sent_, [this](std::uint64_t id) {
      const auto reply = client_->outcome(id);
      if (!reply || !task::is_terminal(reply->state)) return false;
      last_ = *reply;
      if (id == watched_) watched_ends_(*reply);
      if (verbose_ && !reply->text.empty()) tell(reply->text.c_str());
      client_->forget(id);
      return true;
    });
    (void)client_->new_messages();
    return sent_.size();
  }
  [[nodiscard]] const task::Reply& last() const { return last_; }
  /// As send(); `ends` takes the outcome, unless he dies before.
  void send(const std::vector<std::string>& words, std::function<void(const task::Reply&)> ends) {
    watched_ = send(words);
    watched_ends_ = std::move(ends);
  }

 private:
  void sit() { client_ = m_.connect(); }
  void tell(const char* what) const {
    if (verbose_)
      std::fprintf(stderr, "  %.3f client %d: %s\n", static_cast<double>(m_.now()) * 1e-9, number_,
                   what);
  }
  harness::Machine& m_;
  int number_;
  bool verbose_;
  std::unique_ptr<task::Client> client_;
  std::vector<std::uint64_t> sent_;
  task::Reply last_;
  std::uint64_t watched_{0};
  std::function<void(const task::Reply&)> watched_ends_;
};

class Soak {
 public:
  /// `m` is made of `mill`.
  Soak(harness::Machine& m, const Mill& mill, std::uint64_t seed)
      : m_(m),
        mill_(mill),
        dice_(seed),
        verbose_(std::getenv("KERF_SOAK_VERBOSE") != nullptr),
        watch_(mill),
        panel_(m) {
    for (int i = 0; i < 3; ++i) operators_.push_back(std::make_unique<Operator>(m, i, verbose_));
    m_.on_cycle([this](const motion::MotionStatus& s) { watch_.look(s); });
  }

  void run(double hours) {
    fill_logs();
    const auto end = m_.now() + rtapi::seconds(hours * 3600);
    Sizes warm;
    for (round_ = 0; m_.now() < end && !testing::Test::HasFailure(); ++round_) {
      one_round();
      if (round_ == kWarmUpRounds) warm = sizes();
      if (round_ > kWarmUpRounds && round_ % 20 == 0) check_growth(warm);
    }
    tell_what_was_done();
  }
  void run_rounds(int rounds) {
    for (round_ = 0; round_ < rounds && !testing::Test::HasFailure(); ++round_) one_round();
    tell_what_was_done();
  }

 private:
  void tell_what_was_done() const {
    std::printf("soak: %.2f h of machine time in %d rounds, %.1f m of travel;",
                watch_.seconds / 3600, round_, watch_.travelled_mm / 1000);
    for (const auto& [name, n] : counts_) std::printf(" %s %d", name.c_str(), n);
    std::printf("\n");
  }
  /// Task keeps the last 10000 outcomes of this process's own commands: they are full before anything is measured.
  void fill_logs() {
    for (int i = 0; i < 10100; ++i) {
      (void)m_.send({"debug", "0"});
      if (i % 100 == 0) m_.cycle();
    }
    m_.run_for(0.1);
    // The parameter file is there from the first end of a program on.
    EXPECT_EQ(m_.run_text("M2\n").state, task::CommandState::done) << m_.errors();
  }
  Operator& anyone() {
    return *operators_[static_cast<std::size_t>(dice_.below(static_cast<int>(operators_.size())))];
  }
  void count(const char* what) { ++counts_[what]; }
  void poll_all() {
    for (auto& o : operators_) (void)o->poll();
  }
  /// All commands have had their outcome.
  bool all_answered() {
    std::size_t open = 0;
    for (auto& o : operators_) open += o->poll();
    return open == 0;
  }

  void one_round() {
    const int kind = dice_.below(10);
    const std::string name = "round " + std::to_string(round_) + " (" +
                             (kind < 6   ? "program"
                              : kind < 8 ? "jogs"
                                         : "mdi") +
                             "): ";
    if (verbose_) std::fprintf(stderr, "%s\n", name.c_str());
    if (kind < 6)
      program(name);
    else if (kind < 8)
      jogs();
    else
      mdi_lines();
    settle(name);
    for (const auto& text : watch_.take_complaints()) ADD_FAILURE() << name << text;
  }

  void program(const std::string& name) {
    count("programs");
    const Program p = random_program(dice_);
    const std::string path = m_.write_program(p.text, "soak.ngc");
    if (verbose_) std::fprintf(stderr, "%s", numbered(p.text).c_str());
    Operator& runner = anyone();
    runner.send({"open", path});
    runner.send({"run"});
    const bool quiet = p.is_sound && !p.asks && dice_.one_in(3);
    if (quiet) {
      count("undisturbed");
      EXPECT_TRUE(m_.run_until([&] { return runner.poll() == 0; }, 900))
          << name << m_.task().waiting_for.object.c_str();
      EXPECT_EQ(runner.last().state, task::CommandState::done) << name << runner.last().text << "\n"
                                                               << p.text;
      return;
    }
    for (int i = 3 + dice_.below(30); i > 0 && runner.poll() > 0; --i) {
      m_.run_for(dice_.one_in(3) ? dice_.between(0.001, 0.05) : dice_.between(0.05, 2));
      poll_all();
      disturb();
    }
  }

  /// What somebody does while something runs.
  void disturb() {
    Operator& who = anyone();
    const std::string scale = std::to_string(dice_.between(0, 1.5));
    switch (dice_.below(mill_.has_free_pins ? 33 : 30)) {
      case 30:
      case 31:
      case 32: return touch_a_pin();
      case 0:
      case 1:
      case 2: count("overrides"); return (void)who.send({"feed-override", scale});
      case 3: count("overrides"); return (void)who.send({"rapid-override", scale});
      case 4:
        count("overrides");
        return (void)who.send({"spindle-override", std::to_string(dice_.between(0.5, 1.5))});
      case 5:
        count("overrides");
        return (void)who.send({"max-velocity", std::to_string(dice_.between(1, 200))});
      case 6:
      case 7:
      case 8: count("holds"); return (void)who.send({"pause"});
      case 9:
      case 10:
      case 11:
      case 12: return (void)who.send({"resume"});
      case 13: count("steps"); return (void)who.send({"step"});
      case 14: count("aborts"); return (void)who.send({"abort"});
      case 15:
        if (!dice_.one_in(3)) return;
        count("estops");
        return (void)who.send({"state", "estop"});
      case 16:
        if (!dice_.one_in(3)) return;
        count("offs");
        return (void)who.send({"state", "off"});
      case 17: count("modes"); return (void)who.send({"mode", dice_.one_in(2) ? "manual" : "mdi"});
      case 18: return (void)who.send({"jog", "x", "20"});
      case 19: return (void)who.send({"mdi", random_mdi(dice_)});
      case 20: return (void)who.send({"optional-stop", dice_.one_in(2) ? "on" : "off"});
      case 21: return (void)who.send({"block-delete", dice_.one_in(2) ? "on" : "off"});
      case 22: count("deaths"); return who.die();
      case 23: return (void)who.send({"spindle", "off"});
      case 24: count("away"); return away(who);
      case 25:
      case 26: count("panel"); return tell(panel_.press_mdi(dice_));
      case 27: count("panel"); return tell(panel_.press_other(dice_));
      case 28: count("reversals"); return turn_round(who);
      default: return (void)who.send({"feed-override", "1"});
    }
  }

  void tell(const std::string& what) const {
    if (verbose_)
      std::fprintf(stderr, "  %.3f panel: %s\n", static_cast<double>(m_.now()) * 1e-9,
                   what.c_str());
  }

  void set_pin(const std::string& pin, double value) {
    char line[120];
    std::snprintf(line, sizeof line, "%s %.6g", pin.c_str(), value);
    tell(line);
    EXPECT_TRUE(m_.hal(std::string("setp ") + line)) << line;
  }

  /// What switches, amplifiers and other controls do; let_go_of_pins() puts it back.
  void touch_a_pin() {
    count("pins");
    const std::string joint =
        "joint." + std::to_string(dice_.below(static_cast<int>(mill_.joints.size()))) + ".";
    switch (dice_.below(12)) {
      case 0: return touch(joint + "neg-lim-sw-in", 1);
      case 1: return touch(joint + "pos-lim-sw-in", 1);
      case 2: return touch(joint + "amp-fault-in", 1);
      case 3:
      case 4: return touch("motion.feed-hold", 1);
      case 5: return touch("motion.feed-inhibit", 1);
      case 6: return touch("motion.enable", 0);
      case 7:
      case 8: return touch("motion.adaptive-feed", dice_.between(-0.5, 1));
      default: return let_go_of_pins();
    }
  }
  void touch(const std::string& pin, double value) {
    touched_[pin] = pin == "motion.enable" || pin == "motion.adaptive-feed" ? 1 : 0;
    set_pin(pin, value);
  }
  void let_go_of_pins() {
    for (const auto& [pin, value] : touched_) set_pin(pin, value);
    touched_.clear();
  }

  /// A wheel at an axis or a joint.
  void turn_a_wheel() {
    if (!mill_.has_free_pins) return;
    count("wheels");
    const bool axis = dice_.one_in(2);
    const auto number = static_cast<std::size_t>(
        dice_.below(static_cast<int>(axis ? mill_.letters.size() : mill_.joints.size())));
    const std::string name =
        axis ? std::string("axis.") + mill_.letters[number] : "joint." + std::to_string(number);
    set_pin(name + ".jog-scale", dice_.one_in(3) ? dice_.between(-1, 1) : 0.01);
    touch(name + ".jog-vel-mode", dice_.one_in(2) ? 1 : 0);
    touch(name + ".jog-enable", 1);
    m_.run_for(dice_.between(0.001, 0.02));
    double& counts = wheel_[name];
    for (int i = dice_.below(30); i > 0; --i) {
      counts += dice_.below(9) - 4 + (dice_.one_in(10) ? dice_.below(400) - 200 : 0);
      set_pin(name + ".jog-counts", counts);
      m_.run_for(dice_.between(0.001, 0.05));
    }
    if (dice_.one_in(2)) touch(name + ".jog-enable", 0);
  }

  /// Back along the path for a while, and by turns on forwards again.
  void turn_round(Operator& who) {
    who.send({"pause"});
    m_.run_for(dice_.between(0.001, 0.4));
    who.send({"direction", "reverse"});
    who.send({"resume"});
    m_.run_for(dice_.one_in(3) ? dice_.between(0.001, 0.05) : dice_.between(0.05, 2));
    if (dice_.one_in(3)) return;
    who.send({"pause"});
    m_.run_for(dice_.between(0.001, 0.4));
    who.send({"direction", "forward"});
    who.send({"resume"});
  }

  void away(Operator& who) {
    who.send({"away"});
    m_.run_for(dice_.between(0.2, 1));
    who.send({"jog", dice_.one_in(2) ? "x" : "y", dice_.one_in(2) ? "15" : "-15"});
    m_.run_for(dice_.between(0.1, 1));
    if (dice_.one_in(3))
      who.die();
    else
      who.send({"jog-stop"});
    m_.run_for(0.3);
    if (dice_.one_in(2)) {
      who.send({"exchange-tool", std::to_string(1 + dice_.below(3))}, [this](const task::Reply& r) {
        count(r.state == task::CommandState::done ? "tools exchanged" : "refused");
      });
      if (!dice_.one_in(4)) m_.run_for(dice_.between(0, 0.2));
    }
    who.send({"return"});
    m_.run_for(dice_.between(0.1, 3));
    who.send({"resume"});
  }

  void jogs() {
    count("jogs");
    Operator& who = anyone();
    who.send({"mode", "manual"});
    m_.run_for(0.1);
    const bool teleop = !dice_.one_in(3);
    who.send({"teleop", teleop ? "on" : "off"});
    m_.run_for(0.1);
    const int ways = static_cast<int>(teleop ? mill_.letters.size() : mill_.joints.size());
    for (int i = 2 + dice_.below(12); i > 0; --i) {
      Operator& jogger = anyone();
      const int which = dice_.below(ways);
      std::vector<std::string> words{
          "jog",
          teleop ? std::string(1, mill_.letters[static_cast<std::size_t>(which)])
                 : std::to_string(which),
          std::to_string(dice_.between(-120, 120))};
      if (dice_.one_in(2)) words.push_back(std::to_string(dice_.between(0.01, 30)));
      const bool lives = words.size() == 3;
      jogger.send(words);
      m_.run_for(dice_.between(0.005, 1.5));
      poll_all();
      switch (dice_.below(8)) {
        case 0:
          count("deaths");
          jogger.die();
          // Its lease ends with it: from full speed to rest within v/a, and nothing starts it again.
          if (lives) {
            m_.run_for(std::max(0.3, 0.1 + mill_.stop_s()));
            expect_no_jog(words[1]);
          }
          break;
        case 1: anyone().send({"jog-stop"}); break;
        case 2:
          count("aborts");
          anyone().send({"abort"});
          break;
        case 3: anyone().send({"mdi", random_mdi(dice_)}); break;
        case 4:
          if (dice_.one_in(4)) anyone().send({"state", dice_.one_in(2) ? "off" : "estop"});
          break;
        case 5: anyone().send({"teleop", dice_.one_in(2) ? "on" : "off"}); break;
        case 6: turn_a_wheel(); break;
        default:
          if (mill_.has_free_pins && dice_.one_in(3)) touch_a_pin();
          break;
      }
    }
    anyone().send({"jog-stop"});
    if (dice_.one_in(4)) {
      count("homings");
      m_.run_for(0.3);
      who.send({"teleop", "off"});
      m_.run_for(0.1);
      who.send(
          {"home", std::to_string(dice_.below(static_cast<int>(mill_.joints.size()) + 1) - 1)});
      m_.run_for(dice_.between(0.1, 5));
      if (dice_.one_in(2)) anyone().send({"abort"});
    }
  }

  void expect_no_jog(const std::string& what) {
    const auto a = m_.motion();
    m_.run_for(0.02);
    const auto b = m_.motion();
    if (!a.path_empty || a.mode == motion::MotionMode::coordinated)
      return;                       // an MDI line ran, and there was no jog
    if (!touched_.empty()) return;  // a wheel may turn
    for (std::size_t j = 0; j < mill_.joint_letters.size(); ++j) {
      if (what == std::to_string(j) || what[0] == mill_.joint_letters[j]) {
        EXPECT_EQ(a.joint[j].pos_cmd, b.joint[j].pos_cmd)
            << "round " << round_ << ": the jog of a client that died goes on, joint " << j;
      }
    }
  }

  void mdi_lines() {
    count("mdi");
    for (int i = 1 + dice_.below(8); i > 0; --i) {
      if (dice_.one_in(4)) {
        count("panel");
        tell(panel_.press_mdi(dice_));
      } else {
        anyone().send({"mdi", random_mdi(dice_)});
      }
      if (dice_.one_in(2)) m_.run_for(dice_.between(0.001, 3));
      poll_all();
      if (dice_.one_in(3)) disturb();
    }
    m_.run_for(dice_.between(0, 2));
  }

  bool on_and_homed() {
    if (m_.task().task_state == task::TaskState::estop && !m_.does({"state", "estop-reset"}))
      return false;
    if (m_.task().task_state != task::TaskState::on && !m_.does({"state", "on"})) return false;
    const auto s = m_.motion();
    return (s.all_homed && !is_racked(s)) || m_.does({"home", "-1"});
  }
  /// Jogs in joint mode have moved the legs of a gantry apart.
  [[nodiscard]] bool is_racked(const motion::MotionStatus& s) const {
    return mill_.joint_letters == "xyyz" && s.joint[1].pos_cmd != s.joint[2].pos_cmd;
  }

  /// Stops what runs, looks whether it stands, and puts the machine into order for the next round.
  void settle(const std::string& name) {
    // By another way than theirs: what clients have sent is taken first, or it would rightly run behind the abort.
    panel_.let_go();
    let_go_of_pins();
    m_.run_for(0.002);
    ASSERT_TRUE(m_.does({"abort"}, 5)) << name;
    EXPECT_TRUE(m_.run_until([&] { return m_.task().idle && m_.motion().path_empty; },
                             0.2 + mill_.stop_s()))
        << name << "not idle after its abort; it waits for "
        << m_.task().waiting_for.object.c_str();
    EXPECT_TRUE(m_.run_until([&] { return all_answered(); }, 2))
        << name << "a command has no outcome";
    m_.run_for(0.005);
    watch_.expect_rest(true);
    m_.run_for(0.5);
    watch_.expect_rest(false);
    const auto s = m_.motion();
    for (std::size_t j = 0; j < mill_.joints.size(); ++j)
      EXPECT_NEAR(s.joint[j].pos_cmd, s.joint[j].pos_fb, 1e-9) << name << "joint " << j;
    EXPECT_FALSE(s.held) << name;
    EXPECT_FALSE(m_.task().paused) << name;
    ASSERT_TRUE(on_and_homed()) << name << m_.errors();
    for (const char* word : {"feed-override", "rapid-override", "spindle-override"})
      EXPECT_TRUE(m_.does({word, "1"}));
    EXPECT_TRUE(m_.does({"max-velocity", std::to_string(mill_.max_vel)}));
    check_place(name);
    check_faults(name);
  }

  /// What is shown is what is applied, and a place that is asked for is the place that is reached.
  void check_place(const std::string& name) {
    const auto before = m_.motion();
    const std::string shown = m_.line_to_shown_place();
    EXPECT_TRUE(m_.mdi(shown)) << name << m_.errors();
    for (std::size_t j = 0; j < mill_.joints.size(); ++j)
      EXPECT_NEAR(m_.joint(j), before.joint[j].pos_cmd, 1e-9) << name << shown;
    const double x = dice_.between(10, 290), y = dice_.between(10, 190),
                 z = dice_.between(-60, -10);
    char line[120];
    std::snprintf(line, sizeof line, "G21 G90 G40 G53 G0 X%.6f Y%.6f Z%.6f", x, y, z);
    EXPECT_TRUE(m_.mdi(line)) << name << m_.errors();
    double to[2]{};
    std::sscanf(line, "G21 G90 G40 G53 G0 X%lf Y%lf", &to[0], &to[1]);
    const motion::Pose at = m_.motion().pos_cmd;
    EXPECT_NEAR(at.x, to[0], 1e-9) << name << line;
    EXPECT_NEAR(at.y, to[1], 1e-9) << name << line;
  }

  void check_faults(const std::string& name) {
    const auto shared = hal::View(m_.segment())
                            .block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
    ASSERT_TRUE(shared.ok());
    const std::uint64_t newest = (*shared)->faults.newest.observe();
    for (; faults_seen_ < newest; ++faults_seen_) {
      motion::FaultRecord r;
      if (!(*shared)->faults.slot[(faults_seen_ + 1) % motion::FaultLog::kSlots].read(r)) continue;
      const int n = static_cast<int>(r.fault);
      const bool ours = n == 1 || n == 16 || n == 19 || n == 27 || (n >= 30 && n <= 33) || n >= 60;
      EXPECT_FALSE(ours) << name << "fault " << n << " of joint " << r.index << ": " << r.value
                         << " of " << r.limit << " line " << r.tag.line;
    }
  }

  Sizes sizes() {
    Sizes s;
    const struct mallinfo2 heap = mallinfo2();
    s.heap = static_cast<double>(heap.uordblks) + static_cast<double>(heap.hblkhd);
    s.files = open_files();
    for ([[maybe_unused]] const auto& entry :
         std::filesystem::recursive_directory_iterator(m_.folder()))
      ++s.folder;
    for (const auto& region : m_.segment().header().regions) s.segment += region.used.get();
    return s;
  }
  void check_growth(const Sizes& warm) {
    const Sizes now = sizes();
    EXPECT_LE(now.heap, warm.heap + kHeapAllowance) << "round " << round_ << ": the heap grows";
    EXPECT_LE(now.files, warm.files) << "round " << round_ << ": files stay open";
    EXPECT_LE(now.folder, warm.folder) << "round " << round_ << ": files stay behind";
    EXPECT_EQ(now.segment, warm.segment) << "round " << round_ << ": the segment grows";
    if (verbose_)
      std::fprintf(stderr, "heap %+.0f kB since the warm-up\n", (now.heap - warm.heap) / 1024);
  }

  harness::Machine& m_;
  const Mill& mill_;
  Dice dice_;
  bool verbose_;
  Watch watch_;
  Panel panel_;
  std::vector<std::unique_ptr<Operator>> operators_;
  std::map<std::string, int> counts_;
  std::uint64_t faults_seen_{0};
  int round_{0};
  std::map<std::string, double> touched_;  ///< pins and what they are to be again
  std::map<std::string, double> wheel_;    ///< counts
};

std::uint64_t first_seed() {
  return static_cast<std::uint64_t>(from_environment("KERF_SOAK_SEED", 1));
}

void soak(Mill mill, std::uint64_t seed, double hours, int rounds) {
  mill.options.clients = true;
  mill.options.append = Panel::ini_text();
  auto m = harness::Machine::start(mill.options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  std::printf("soak: seed %llu, %s\n", static_cast<unsigned long long>(seed), mill.name.c_str());
  Soak soak(*m, mill, seed);
  if (rounds > 0)
    soak.run_rounds(rounds);
  else
    soak.run(hours);
}

TEST(Soak, MachineTime) {
  soak(sample_mill(0), first_seed(), from_environment("KERF_SOAK_HOURS", kDefaultHours), 0);
}

TEST(Soak, MachineTimeWithJerkLimits) {
  soak(sample_mill(kMaxJerk), first_seed(),
       kShareWithJerk * from_environment("KERF_SOAK_HOURS", kDefaultHours), 0);
}

TEST(Soak, RandomMills) {
  const auto mills = static_cast<std::uint64_t>(from_environment("KERF_SOAK_MILLS", kDefaultMills));
  for (std::uint64_t n = 0; n < mills && !testing::Test::HasFailure(); ++n) {
    const std::uint64_t seed = first_seed() + n;
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() /
        ("kerf-soak-" + std::to_string(getpid()) + "-" + std::to_string(n));
    std::filesystem::create_directories(folder);
    soak(random_mill(seed, folder), seed, 0, kRoundsOfAMill);
    std::filesystem::remove_all(folder);
  }
}

}  // namespace
}  // namespace kerf::soak
