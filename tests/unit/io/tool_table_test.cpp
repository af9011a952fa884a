// Tool table files. Manual: "Tool Table Format".
#include "io/tool_table.hpp"

#include <gmock/gmock.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace kerf::io {
namespace {

using ::testing::HasSubstr;

ToolTable parse(const std::string& text, double unit = 1.0) {
  auto table = ToolTable::parse(text, "tool.tbl", unit);
  EXPECT_TRUE(table.ok()) << (table.ok() ? "" : table.error().message());
  return table.ok() ? *table : ToolTable();
}

std::string complaint(const std::string& text, bool random = false) {
  const auto table = ToolTable::parse(text, "tool.tbl", 1.0, random);
  EXPECT_FALSE(table.ok()) << text;
  return table.ok() ? "" : table.error().message();
}

TEST(ToolTable, reads_every_word_in_any_case_and_order) {
  const auto table =
      parse("t7 p3 x+1 Y-2 z.5 a10 b20 c30 u4 v5 w6 d6.35 i11 j12 q3 ;  6 mm; carbide\r\n");
  ASSERT_EQ(table.tools().size(), 1u);
  const ToolEntry& t = *table.find(7);
  EXPECT_EQ(t.pocket, 3);
  EXPECT_EQ(t.offset, (rtapi::Pose{1, -2, .5, 10, 20, 30, 4, 5, 6}));
  EXPECT_EQ(t.diameter_mm, 6.35);
  EXPECT_EQ(t.front_angle_deg, 11);
  EXPECT_EQ(t.back_angle_deg, 12);
  EXPECT_EQ(t.orientation, 3);
  EXPECT_EQ(t.remark, "  6 mm; carbide");
}

TEST(ToolTable, inches_are_converted_rotary_offsets_are_not) {
  const auto table = parse("T1 P1 Z1 A90 D0.5\n", 25.4);
  EXPECT_DOUBLE_EQ(table.find(1)->offset.z, 25.4);
  EXPECT_DOUBLE_EQ(table.find(1)->offset.a, 90);
  EXPECT_DOUBLE_EQ(table.find(1)->diameter_mm, 12.7);
}

TEST(ToolTable, comments_and_their_places_are_kept) {
  const std::string text = "; my tools\n\nT2 P2 Z20 D3 ;drill\n;T9 P9 old one\nT1 P1 D6\n";
  EXPECT_EQ(parse(text).text(1.0), text);
}

TEST(ToolTable, errors_name_file_line_and_what_was_expected_all_at_once) {
  const std::string all =
      complaint("T1 P1\nT2\nP3\nT4 P4 Zx\nT5 P5 K3\nT6 P2000\nT7 P7 Q10\nT8 P8 Z1 Z2\nT-1 P1\n");
  EXPECT_THAT(all, HasSubstr("tool.tbl:2: no pocket number"));
  EXPECT_THAT(all, HasSubstr("tool.tbl:3: no tool number"));
  EXPECT_THAT(all, HasSubstr("tool.tbl:4: Zx: expected a number"));
  EXPECT_THAT(all, HasSubstr("tool.tbl:5: 'K3'"));
  EXPECT_THAT(complaint("T6 P2000\n", true), HasSubstr("0 to 1000"));
  EXPECT_EQ(parse("T99999 P99999\n").tools()[0].pocket, 99999) << "P is the user's own here";
  EXPECT_THAT(complaint("T7 P7 Q10\n"), HasSubstr("0 to 9"));
  EXPECT_THAT(complaint("T8 P8 Z1 Z2\n"), HasSubstr("two Z"));
  EXPECT_THAT(complaint("T1 P\n"), HasSubstr("expected a whole number"));
}

TEST(ToolTable, of_two_lines_for_a_tool_the_first_counts_and_the_other_is_kept) {
  const std::string text = "T1 P1 Z1 D6\nT1 P9 Z2\n";
  const auto table = parse(text);
  ASSERT_EQ(table.tools().size(), 1U);
  EXPECT_DOUBLE_EQ(table.find(1)->offset.z, 1);
  ASSERT_EQ(table.warnings().size(), 1U);
  EXPECT_THAT(table.warnings()[0], HasSubstr("tool.tbl:2: tool T1 is defined twice"));
  EXPECT_EQ(table.text(1.0), text);
}

TEST(ToolTable, headings_and_old_formats_are_skipped_and_kept) {
  const std::string text = "TOOLNO POCKET LENGTH\n1 1 0.5 0.25\nT3 P3 D6\n";
  const auto table = parse(text);
  ASSERT_EQ(table.tools().size(), 1U);
  ASSERT_EQ(table.warnings().size(), 2U);
  EXPECT_THAT(table.warnings()[1], HasSubstr("tool.tbl:2: not a line of a tool"));
  EXPECT_EQ(table.text(1.0), text);
}

TEST(ToolTable, two_tools_in_one_pocket_are_wrong_on_random_changers_only) {
  const std::string text = "T1 P5\nT2 P5\n";
  EXPECT_TRUE(ToolTable::parse(text, "tool.tbl", 1.0, false).ok());
  const auto random = ToolTable::parse(text, "tool.tbl", 1.0, true);
  ASSERT_FALSE(random.ok());
  EXPECT_THAT(random.error().message(),
              HasSubstr("tool.tbl:2: tool T2 is in pocket P5, where T1 is already"));
}

TEST(ToolTable, put_replaces_and_adds_and_keeps_remarks) {
  auto table = parse("T1 P1 Z1 ;keep me\n");
  ToolEntry entry = *table.find(1);
  entry.offset.z = 2;
  entry.remark.clear();
  table.put(entry);
  entry.number = 5;
  table.put(entry);
  EXPECT_EQ(table.text(1.0), "T1 P1 Z2 D0 ;keep me\nT5 P1 Z2 D0\n");
}

TEST(ToolTable, what_is_written_reads_back_the_same) {
  std::mt19937 random(42);
  std::uniform_real_distribution<double> number(-1000, 1000);
  for (const double unit : {1.0, 25.4}) {
    ToolTable table;
    for (int n = 1; n <= 1500; ++n) {
      ToolEntry t;
      t.number = n;
      t.pocket = n % 1001;
      for (std::size_t a = 0; a < rtapi::kAxes; ++a)
        t.offset[a] = random() % 3 == 0 ? number(random) : 0;
      t.diameter_mm = number(random);
      t.orientation = static_cast<int>(random() % 10);
      if (random() % 2 == 0) t.remark = "tool " + std::to_string(n);
      table.put(t);
    }
    const auto again = parse(table.text(unit), unit);
    ASSERT_EQ(again.tools().size(), 1500u);
    EXPECT_EQ(again.text(unit), table.text(unit));
    for (const auto& t : table.tools())
      for (std::size_t a = 0; a < rtapi::kAxes; ++a)
        EXPECT_NEAR(again.find(t.number)->offset[a], t.offset[a], 1e-12);
  }
}

/// No number of tools is too many, pockets are what the user calls them, and a new length touches its own line only.
TEST(ToolTable, ten_thousand_tools_in_any_pocket) {
  constexpr int kTools = 10000;
  std::vector<std::string> lines;
  for (int n = 0; n < kTools; ++n) {
    const int number = 1 + (n * 7919) % kTools;  // in no order
    lines.push_back("T" + std::to_string(number) + " P" + std::to_string(number + 3) + " Z" +
                    std::to_string(1 + number % 97) + " D" + std::to_string(1 + number % 20) +
                    " ;tool; " + std::to_string(n));
  }
  const auto text_of = [&lines] {
    std::string text;
    for (const std::string& line : lines) text.append(line).append("\n");
    return text;
  };
  auto table = parse(text_of());
  ASSERT_EQ(table.tools().size(), static_cast<std::size_t>(kTools));
  for (int number = 1; number <= kTools; ++number) {
    const ToolEntry* tool = table.find(number);
    ASSERT_NE(tool, nullptr) << number;
    EXPECT_EQ(tool->pocket, number + 3);
    EXPECT_EQ(tool->offset.z, 1 + number % 97);
  }
  EXPECT_EQ(table.text(1.0), text_of());
  ToolEntry changed = *table.find(1);
  changed.offset.z = 12.5;
  table.put(changed);
  lines[0] = "T1 P4 Z12.5 D2 ;tool; 0";
  EXPECT_EQ(table.text(1.0), text_of());
}

class OnDisk : public ::testing::Test {
 protected:
  OnDisk() {
    std::string name = std::filesystem::temp_directory_path().string() + "/kerf-io-XXXXXX";
    folder_ = ::mkdtemp(name.data());
  }
  ~OnDisk() override { std::filesystem::remove_all(folder_); }
  std::string folder_;
};

TEST_F(OnDisk, save_is_whole_keeps_mode_and_follows_links) {
  const std::string file = folder_ + "/tool.tbl", link = folder_ + "/link.tbl";
  std::ofstream(file) << "T1 P1 Z1\n";
  ::chmod(file.c_str(), 0640);
  ASSERT_EQ(::symlink(file.c_str(), link.c_str()), 0);
  auto table = ToolTable::load(link, 1.0);
  ASSERT_TRUE(table.ok());
  table->put({2, 2, {}, 3, 0, 0, 0, ""});
  ASSERT_TRUE(table->save(link, 1.0).ok());
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(ToolTable::load(file, 1.0)->tools().size(), 2u);
  struct stat s {};
  ::stat(file.c_str(), &s);
  EXPECT_EQ(s.st_mode & 0777U, 0640U);
  int files = 0;
  for ([[maybe_unused]] const auto& e : std::filesystem::directory_iterator(folder_)) ++files;
  EXPECT_EQ(files, 2) << "nothing temporary is left";
}

TEST_F(OnDisk, missing_file_and_folder_are_errors_with_their_names) {
  const auto missing = ToolTable::load(folder_ + "/none.tbl", 1.0);
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, rtapi::Errc::not_found);
  EXPECT_THAT(missing.error().message(), HasSubstr("none.tbl"));
  EXPECT_FALSE(ToolTable().save(folder_ + "/no/such/tool.tbl", 1.0).ok());
}

}  // namespace
}  // namespace kerf::io
