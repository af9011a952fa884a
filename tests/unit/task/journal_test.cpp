// The journal's file: whole records only, the newest of them, never longer.
#include "task/api/journal.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "task/journal_writer.hpp"

namespace kerf::task {
namespace {

namespace fs = std::filesystem;

JournalRecord sample(int line) {
  JournalRecord r;
  r.ini_file = "/machines/mill.ini";
  r.program = "/parts/plate.ngc";
  r.line = line;
  r.position.x = line + 0.1;
  r.tool = 3;
  r.tool_offset.z = -41.25;
  r.joints = {1, 2, 3.0000000000000004};
  r.spindle_rpm = {-1200};
  r.g_codes.fill(-1);
  r.m_codes.fill(-1);
  r.digital_out = ~std::uint64_t{0};
  return r;
}

class JournalFile : public testing::Test {
 protected:
  void SetUp() override {
    folder = testing::TempDir() + "kerf_journal_" + std::to_string(getpid());
    fs::remove_all(folder);
    path = folder + "/deep/job.journal";
    program = folder + "/p.ngc";
    fs::create_directories(folder);
    std::ofstream(program) << "G0 X1\nM2\n";
  }
  void TearDown() override { fs::remove_all(folder); }
  [[nodiscard]] std::string bytes() const {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  void put(const std::string& text) const { std::ofstream(path, std::ios::binary) << text; }
  void write_lines(int from, int to, bool thread = false) const {
    JournalWriter writer(path, {thread, false});
    ASSERT_TRUE(writer.open().ok());
    writer.begin_program();
    for (int line = from; line <= to; ++line) {
      JournalRecord r = sample(line);
      r.program = program;
      while (!writer.post(r)) {
      }
      writer.flush();
    }
  }
  std::string folder, path, program;
};

TEST(JournalRecord, ComesBackAsItWasPut) {
  JournalRecord record = sample(1184);
  record.state = RunState::paused;
  record.why = "a \"quoted\" text\nof two lines \xff";
  record.source = "/subs/cut.ngc";
  record.source_line = 7;
  record.marked = true;
  record.mark = {12, ~std::uint64_t{0}};
  const std::string slot = format_slot(record);
  ASSERT_EQ(slot.size(), kJournalSlotBytes);
  const auto back = parse_slot(slot);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->line, 1184);
  EXPECT_EQ(back->state, RunState::paused);
  EXPECT_EQ(back->position.x, record.position.x);
  EXPECT_EQ(back->joints, record.joints);
  EXPECT_EQ(back->mark, record.mark);
  EXPECT_EQ(back->digital_out, record.digital_out);
  EXPECT_EQ(format_slot(*back).size(), kJournalSlotBytes);
  const std::string told = describe(*back);
  for (const char* part :
       {"plate.ngc", "paused", "1184", "cut.ngc line 7", "X1184.1", "Z-41.25", "reverse 1200 rpm"})
    EXPECT_NE(told.find(part), std::string::npos) << told;
}

TEST(JournalRecord, ATornOneIsRecognisedWhereverItWasTorn) {
  const std::string old = format_slot(sample(1)), fresh = format_slot(sample(22222));
  int whole = 0;
  for (std::size_t at = 0; at <= fresh.size(); ++at) {
    // The end of the power left the first bytes of the new record before the rest of the old one.
    const auto back = parse_slot(fresh.substr(0, at) + old.substr(at));
    if (!back.ok()) continue;
    ++whole;
    EXPECT_TRUE(back->line == 1 || back->line == 22222) << at;
  }
  EXPECT_LT(whole, 4000);
  EXPECT_GT(whole, 0);
  EXPECT_FALSE(parse_slot("").ok());
  EXPECT_FALSE(parse_slot(std::string(kJournalSlotBytes, '\0')).ok());
}

TEST(JournalRecord, TextsWithoutEndDoNotCostTheNumbers) {
  JournalRecord record = sample(5);
  record.why = std::string(10000, 'x');
  const auto back = parse_slot(format_slot(record));
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->line, 5);
}

TEST_F(JournalFile, KeepsTheNewestAndIsBounded) {
  write_lines(1, 30);
  EXPECT_LE(bytes().size(), kJournalSlots * kJournalSlotBytes);
  EXPECT_EQ(read_journal(path)->line, 30);
  EXPECT_EQ(read_journal(path)->mark, *mark_file(program));
  // A new task goes on behind it.
  write_lines(31, 33, true);
  EXPECT_EQ(read_journal(path)->line, 33);
  EXPECT_EQ(read_journal(path)->number, 33U);
  // The newest is torn: the one before it counts.
  std::string text = bytes();
  text[33 % kJournalSlots * kJournalSlotBytes + 100] ^= 1;
  put(text);
  EXPECT_EQ(read_journal(path)->line, 32);
}

TEST_F(JournalFile, SaysWhatItIsNot) {
  EXPECT_EQ(read_journal(path).error().code, rtapi::Errc::not_found);
  fs::create_directories(folder + "/deep");
  put("");
  EXPECT_EQ(read_journal(path).error().code, rtapi::Errc::not_found);
  const std::string other(kJournalSlots * kJournalSlotBytes + 1, 'x');
  put(other);
  JournalWriter writer(path, {false, false});
  const auto opened = writer.open();
  ASSERT_FALSE(opened.ok());
  EXPECT_NE(opened.error().message().find("[KERF]JOURNAL"), std::string::npos);
  EXPECT_EQ(bytes(), other) << "untouched";
}

TEST(JournalPath, IsBesideTheIniFileOrInTheFolderForState) {
  EXPECT_EQ(journal_path("/m/mill.ini", "job.journal"), "/m/job.journal");
  EXPECT_EQ(journal_path("/m/mill.ini", "/var/job.journal"), "/var/job.journal");
  EXPECT_EQ(journal_path("/m/mill.ini", "off"), "");
  EXPECT_NE(journal_path("/m/mill.ini", ""), journal_path("/n/mill.ini", ""));
}

}  // namespace
}  // namespace kerf::task
