// Where a program would be resumed: the line that the journal tells of, while the machine moves.
#include <gtest/gtest.h>

#include <string>

#include "harness/machine.hpp"
#include "task/api/journal.hpp"

namespace kerf::harness {
namespace {

class JournalLine : public testing::Test {
 protected:
  void SetUp() override {
    MachineOptions options;
    options.replace = {{"CLOCK = real", "CLOCK = real\nJOURNAL = job.journal"}};
    machine_ = Machine::start(options);
    ASSERT_TRUE(machine_->ready()) << machine_->errors();
    ASSERT_TRUE(machine_->power_on_and_home()) << machine_->errors();
  }
  [[nodiscard]] task::JournalRecord record() const {
    const auto record = task::read_journal(machine_->folder() + "/job.journal");
    EXPECT_TRUE(record.ok());
    return record.ok() ? *record : task::JournalRecord{};
  }
  [[nodiscard]] bool x_passes(double x) const {
    return machine_->run_until([&] { return machine_->joint(0) > x; }, 60);
  }
  std::unique_ptr<Machine> machine_;
};

/// Also when nothing of the main program itself has moved the machine yet.
TEST_F(JournalLine, OfASubIsThatOfTheCall) {
  auto& m = *machine_;
  const auto path = m.write_program(
      "o<cut> sub\nG1 X#1 F1200\no<cut> endsub\no<both> sub\no<cut> call [#1 - 10]\no<cut> call "
      "[#1]\no<both> endsub\nF1200\no<cut> call [20]\nG1 Y5\no<both> call [40]\nM2\n");
  const auto id = m.start_program(path);
  ASSERT_TRUE(x_passes(10));
  EXPECT_EQ(record().line, 9);
  EXPECT_EQ(record().source_line, 2);
  for (const double x : {28.0, 38.0}) {
    ASSERT_TRUE(x_passes(x));
    EXPECT_EQ(record().line, 11) << "X" << x;
    EXPECT_EQ(record().source_line, 2) << "X" << x;
  }
  ASSERT_TRUE(m.run_until([&] { return task::is_terminal(m.outcome(id).state); }));
  EXPECT_EQ(record().state, task::RunState::ended);
}

/// Power that goes before the line where a run began in its middle, and goes again on the way to that line, costs no line.
TEST_F(JournalLine, OfARunFromALineIsThatLineFromItsFirstMoment) {
  auto& m = *machine_;
  const auto path = m.write_program("G0 X5\nG1 X10 F1200\nG1 X30\nG1 X40\nM2\n");
  m.start_program(path);
  ASSERT_TRUE(x_passes(20));
  EXPECT_EQ(record().line, 3);
  ASSERT_EQ(m.abort().state, task::CommandState::done);
  ASSERT_TRUE(m.mdi("G53 G0 X200 Y100"));
  const auto id = m.send({"run", "3"});
  while (m.joint(0) > 195) {
    m.cycle();
    ASSERT_EQ(record().line, 3);
  }
  ASSERT_TRUE(m.run_until([&] { return task::is_terminal(m.outcome(id).state); }));
  EXPECT_EQ(m.outcome(id).state, task::CommandState::done) << m.errors();
  EXPECT_EQ(record().state, task::RunState::ended);
}

}  // namespace
}  // namespace kerf::harness
