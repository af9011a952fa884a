// Four clients at one idle machine, each as if it were alone: two that type lines, one that jogs, and a panel with buttons of halui
// for lines and jogs. Nobody meets an error about modes, nobody's line is lost or runs twice, and no jog moves beside a line.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "harness/halui.hpp"
#include "harness/machine.hpp"
#include "task/api/client.hpp"

namespace kerf::harness {
namespace {

using task::CommandState;

constexpr double kMachineSeconds = 600;
constexpr int kFewest = 50;
/// The line that the panel's button stands for; its analog output tells that it ran.
constexpr const char* kPanelIni =
    "\n[HALUI]\nMDI_COMMAND = G21 G90 G53 G0 Z-12 M68 E3 Q[#<_presses> + 1] #<_presses> = "
    "[#<_presses> + 1]\n";

/// Somebody who sends lines, one at a time. Its n-th line that ran puts n on its analog output.
class Typist {
 public:
  Typist(Machine& m, int output, std::uint32_t seed)
      : m_(m), output_(output), dice_(seed), client_(m.connect()) {}

  void look() {
    ASSERT_TRUE(client_->poll().ok());
    (void)client_->new_messages();
    if (open_ != 0) {
      const auto reply = client_->outcome(open_);
      if (!reply || !task::is_terminal(reply->state)) return;
      take(*reply);
      if (next_ != rtapi::kForever)
        next_ = m_.now() + rtapi::seconds(0.05 + 0.1 * static_cast<double>(dice_() % 12));
    }
    if (m_.now() < next_) return;
    const double x = 20 + static_cast<double>(dice_() % 2000) / 10;
    const auto id =
        client_->send({"mdi", "G21 G90 G53 G1 F6000 X" + std::to_string(x) + " M68 E" +
                                  std::to_string(output_) + " Q" + std::to_string(done + 1)});
    ASSERT_TRUE(id.ok()) << id.error().message();
    open_ = *id;
  }
  [[nodiscard]] bool waits() const { return open_ != 0; }
  void rests() { next_ = rtapi::kForever; }

  int done{0};
  std::map<std::string, int> refused;

 private:
  void take(const task::Reply& reply) {
    client_->forget(open_);
    open_ = 0;
    const auto out = m_.motion().analog_out[static_cast<std::size_t>(output_)];
    if (reply.state == CommandState::done) {
      ++done;
      EXPECT_EQ(out, done) << "it is done, and has run";
    } else {
      EXPECT_EQ(out, done) << "it is refused, and has not run: " << reply.text;
      ++refused[reply.text];
    }
  }

  Machine& m_;
  int output_;
  std::mt19937 dice_;
  std::unique_ptr<task::Client> client_;
  std::uint64_t open_{0};
  rtapi::Nanos next_{0};
};

/// Somebody who jogs: by turns a distance, and on until he lets go.
class Jogger {
 public:
  explicit Jogger(Machine& m) : m_(m), dice_(5), client_(m.connect()) {}

  void look() {
    ASSERT_TRUE(client_->poll().ok());
    (void)client_->new_messages();
    std::erase_if(open_, [this](std::uint64_t id) {
      const auto reply = client_->outcome(id);
      if (!reply || !task::is_terminal(reply->state)) return false;
      if (reply->state == CommandState::done)
        ++done;
      else
        ++refused[reply->text];
      client_->forget(id);
      return true;
    });
    if (m_.now() < next_) return;
    next_ = m_.now() + rtapi::seconds(0.2 + 0.1 * static_cast<double>(dice_() % 10));
    if (held_)
      send({"jog-stop"});
    else if (dice_() % 2 == 0)
      send({"jog", "y", to_the_middle() ? "20" : "-20", "3"});
    else
      send({"jog", "y", to_the_middle() ? "15" : "-15"}), held_ = true;
    if (held_ && dice_() % 2 == 0) held_ = false;
  }
  void let_go() {
    send({"jog-stop"});
    next_ = rtapi::kForever;
  }
  [[nodiscard]] std::size_t waits() const { return open_.size(); }

  int done{0};
  std::map<std::string, int> refused;

 private:
  bool to_the_middle() const { return m_.joint(1) < 100; }
  void send(const std::vector<std::string>& words) {
    const auto id = client_->send(words);
    ASSERT_TRUE(id.ok()) << id.error().message();
    open_.push_back(*id);
    if (words[0] == "jog-stop") held_ = false;
  }

  Machine& m_;
  std::mt19937 dice_;
  std::unique_ptr<task::Client> client_;
  std::vector<std::uint64_t> open_;
  rtapi::Nanos next_{0};
  bool held_{false};
};

/// Somebody at a panel: a button for a line, and two that jog Z.
class Presser {
 public:
  explicit Presser(Machine& m) : m_(m), dice_(11), halui_(add_halui(m)) {
    EXPECT_TRUE(m.hal("setp halui.axis.jog-speed 120"));
  }
  ~Presser() {
    if (halui_ != nullptr) m_.remove(*halui_);
  }
  Presser(const Presser&) = delete;
  Presser& operator=(const Presser&) = delete;

  void look() {
    if (m_.now() < next_) return;
    constexpr const char* kButtons[]{"mdi-command-00", "axis.z.plus", "axis.z.minus"};
    if (held_ == nullptr) {
      held_ = kButtons[dice_() % 3];
      presses += held_ == kButtons[0] ? 1 : 0;
    }
    down_ = !down_;
    EXPECT_TRUE(m_.hal(std::string("setp halui.") + held_ + (down_ ? " 1" : " 0")));
    if (!down_) held_ = nullptr;
    next_ = m_.now() + rtapi::seconds(0.05 + 0.1 * static_cast<double>(dice_() % 10));
  }
  void let_go() {
    next_ = 0;
    if (down_) look();
    next_ = rtapi::kForever;
  }

  int presses{0};  ///< of the line's button

 private:
  Machine& m_;
  std::mt19937 dice_;
  std::unique_ptr<clients::halui::HaluiParticipant> halui_;
  const char* held_{nullptr};
  bool down_{false};
  rtapi::Nanos next_{0};
};

/// What the operator was told.
class Listener {
 public:
  explicit Listener(Machine& m) : client_(m.connect()) {}
  void look() {
    ASSERT_TRUE(client_->poll().ok());
    std::uint64_t lost = 0;
    for (const auto& message : client_->new_messages(&lost))
      ++told[std::string(message.text.view())];
    EXPECT_EQ(lost, 0U);
  }
  std::map<std::string, int> told;

 private:
  std::unique_ptr<task::Client> client_;
};

int sum(const std::map<std::string, int>& refused) {
  int n = 0;
  for (const auto& [text, count] : refused) n += count;
  return n;
}

TEST(FourClients, MeetNoErrorAboutModesAndLoseNoLine) {
  MachineOptions options;
  options.clients = true;
  options.append = kPanelIni;
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("#<_presses> = 0 G53 G0 X100 Y100 Z-20")) << m->errors();
  Typist first(*m, 1, 21), second(*m, 2, 22);
  Jogger jogger(*m);
  Presser presser(*m);
  Listener listener(*m);
  int beside = 0, jog_cycles = 0, line_cycles = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    const bool line = !s.path_empty;
    beside += s.jogging && (line || s.mode == motion::MotionMode::coordinated) ? 1 : 0;
    jog_cycles += s.jogging ? 1 : 0;
    line_cycles += line ? 1 : 0;
  });
  const auto end = m->now() + rtapi::seconds(kMachineSeconds);
  while (m->now() < end && !HasFailure()) {
    first.look();
    second.look();
    jogger.look();
    presser.look();
    listener.look();
    m->cycle();
  }
  presser.let_go();
  jogger.let_go();
  first.rests();
  second.rests();
  m->run_for(10);
  first.look();
  second.look();
  jogger.look();
  EXPECT_EQ(jogger.waits(), 0U) << "each jog has an outcome";
  EXPECT_FALSE(first.waits() || second.waits()) << "each line has an outcome";
  EXPECT_EQ(beside, 0) << "cycles with a jog beside a line";
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  // One only ever hears of what moves just now.
  constexpr const char* kLineBesideJog = "can't issue MDI command while the machine homes or jogs";
  constexpr const char* kJogBesideLine = "can't jog while something runs; abort or wait";
  for (const auto& [text, n] : first.refused) EXPECT_EQ(text, kLineBesideJog) << n;
  for (const auto& [text, n] : second.refused) EXPECT_EQ(text, kLineBesideJog) << n;
  for (const auto& [text, n] : jogger.refused) EXPECT_EQ(text, kJogBesideLine) << n;
  listener.look();
  for (const auto& [text, n] : listener.told)
    EXPECT_TRUE(text == kLineBesideJog || text == kJogBesideLine) << text;
  EXPECT_EQ(listener.told[kJogBesideLine], sum(jogger.refused)) << "each is told once";
  const int panel_refused =
      listener.told[kLineBesideJog] - sum(first.refused) - sum(second.refused);
  EXPECT_EQ(m->motion().analog_out[3], presser.presses - panel_refused)
      << "each press ran once, or was refused";
  // It was no quiet time.
  for (const int n : {first.done, second.done, jogger.done, presser.presses - panel_refused,
                      jog_cycles / 100, line_cycles / 100, sum(first.refused), sum(jogger.refused)})
    EXPECT_GT(n, kFewest);
}

}  // namespace
}  // namespace kerf::harness
