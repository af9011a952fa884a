// Whole sessions on a whole machine in virtual time: each file of sessions/ is a session and what it answers.
//   # comment
//   > a line, sent; its replies follow. Virtual time runs until the session waits for nothing
//   +> a line, sent without that
//   ~ seconds of virtual time that pass
// @ stands for the folder of the machine. KERF_GOLDEN_UPDATE=1 writes the files anew; look at the difference before you commit it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "clients/common/machine_view.hpp"
#include "clients/rsh/live_machine.hpp"
#include "clients/rsh/session.hpp"
#include "harness/machine.hpp"
#include "task/api/message_reader.hpp"

namespace kerf::rsh::test {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(KERF_SOURCE_DIR) / "tests/clients/rsh/sessions";

/// The machine of the harness as the shell sees one.
class HarnessMachine final : public Machine {
 public:
  explicit HarnessMachine(harness::Machine& machine)
      : machine_(machine), view_(std::move(*clients::MachineView::over(machine.segment()))) {
    auto answers = IniAnswers::load(view_->stat().ini_filename);
    if (answers.ok()) ini_ = std::move(*answers);
    cursor_ = view_->task_shared().messages.newest.observe();
  }
  [[nodiscard]] const clients::Stat& stat() const override { return view_->stat(); }
  void refresh() override { (void)view_->poll(); }
  rtapi::Result<std::uint64_t> send(const std::vector<std::string>& words) override {
    const auto id = machine_.send(words);
    sent_.push_back(id);
    return id;
  }
  [[nodiscard]] std::optional<task::Reply> outcome(std::uint64_t id) override {
    if (std::find(sent_.begin(), sent_.end(), id) == sent_.end()) return std::nullopt;
    return machine_.outcome(id);
  }
  void forget(std::uint64_t id) override { std::erase(sent_, id); }
  [[nodiscard]] std::vector<task::OperatorMessage> new_messages() override {
    return task::read_messages(view_->task_shared().messages, cursor_);
  }
  [[nodiscard]] std::optional<std::string> ini(const std::string& section,
                                               const std::string& key) const override {
    return ini_.value(section, key);
  }
  [[nodiscard]] std::string ini_name() const override { return ini_.name(); }
  [[nodiscard]] std::optional<std::string> find_program(const std::string& name) const override {
    return ini_.find_program(name, {});
  }
  [[nodiscard]] double wall_time_s() const override { return 1e9; }

 private:
  harness::Machine& machine_;
  std::unique_ptr<clients::MachineView> view_;
  IniAnswers ini_;
  std::vector<std::uint64_t> sent_;
  std::uint64_t cursor_{0};
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(kFolder))
    if (entry.path().extension() == ".session") out.push_back(entry.path().stem().string());
  std::sort(out.begin(), out.end());
  return out;
}

class RshTranscript : public testing::TestWithParam<std::string> {};

TEST_P(RshTranscript, IsAsWritten) {
  const auto machine = harness::Machine::start();
  ASSERT_TRUE(machine->ready()) << machine->errors();
  machine->write_program("G21 G90\nG1 X5 F600\nG4 P0.2\nG1 X0\nM2\n", "five.ngc");
  machine->write_program("G0 X1\nM0\nG0 X2\nM2\n", "stop.ngc");
  machine->write_program("G0 X1\nG1 Y\nM2\n", "wrong.ngc");
  HarnessMachine seen(*machine);
  Shell shell;
  Session session(shell, seen, 1);

  const fs::path path = kFolder / (GetParam() + ".session");
  std::ifstream in(path);
  std::string wanted, got;
  const auto collect = [&] {
    got += replaced(replaced(session.take_output(), "\r\n", "\n"), machine->folder(), "@");
  };
  for (std::string line; std::getline(in, line);) {
    wanted += line + "\n";
    const bool quick = line.rfind("+> ", 0) == 0;
    const bool asks = quick || line.rfind("> ", 0) == 0;
    const bool waits = line.rfind("~ ", 0) == 0;
    if (!asks && !waits && line.rfind("#", 0) != 0) continue;
    got += line + "\n";
    if (waits) {
      const auto end = machine->now() + rtapi::seconds(std::atof(line.c_str() + 2));
      while (machine->now() < end) machine->cycle(), session.step(machine->now());
    }
    if (asks)
      session.feed(replaced(line.substr(quick ? 3 : 2), "@", machine->folder()) + "\n",
                   machine->now());
    for (int n = 0; asks && !quick && session.waits() && n < 60000; ++n) {
      machine->cycle();
      session.step(machine->now());
    }
    if (asks) machine->cycle(), session.step(machine->now());
    collect();
  }
  if (std::getenv("KERF_GOLDEN_UPDATE") != nullptr) {
    std::ofstream(path) << got;
    GTEST_SKIP() << "written anew";
  }
  EXPECT_EQ(got, wanted) << path;
}

INSTANTIATE_TEST_SUITE_P(Sessions, RshTranscript, testing::ValuesIn(names()),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace kerf::rsh::test
