#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "interp/source.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

class Files : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = (std::filesystem::temp_directory_path() /
             ("kerf_src_" + std::to_string(::getpid()) + ".ngc"))
                .string();
  }
  void TearDown() override { std::filesystem::remove(path_); }
  void write(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }
  std::string path_;
};

TEST_F(Files, LinesAcrossChunksAreWhole) {
  std::string text;
  std::vector<std::string> lines;
  for (int i = 0; i < 60000; ++i) {
    lines.push_back("G1 X" + std::to_string(i) +
                    std::string(static_cast<std::size_t>(i % 37), ' ') + "Y1");
    text += lines.back() + (i % 3 == 0 ? "\r\n" : "\n");
  }
  text.pop_back();
  write(text);
  auto source = open_file_source(path_);
  ASSERT_TRUE(source.ok());
  std::uint64_t at = 0;
  std::string_view line;
  for (const std::string& expected : lines) {
    ASSERT_EQ((*source)->read(at, line, at), LineRead::line);
    ASSERT_EQ(line, expected);
  }
  EXPECT_EQ((*source)->read(at, line, at), LineRead::end);
  // Going back, as a loop does.
  std::uint64_t next = 0;
  ASSERT_EQ((*source)->read(0, line, next), LineRead::line);
  EXPECT_EQ(line, lines[0]);
}

TEST_F(Files, AnEditedFileIsNoticed) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "G1 X1 F1\n";
  write(text);
  Rig rig;
  ASSERT_TRUE(rig.interp.open(path_).ok());
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  write("M2\n");
  Outcome o = Outcome::ok;
  while (o == Outcome::ok) o = rig.interp.execute_next();
  EXPECT_EQ(o, Outcome::error);
  EXPECT_EQ(rig.interp.error().text, "The program file was changed while it runs");
}

TEST_F(Files, MissingOnesAreRefused) {
  Rig rig;
  const auto s = rig.interp.open("/no/such/file.ngc");
  ASSERT_FALSE(s.ok());
  EXPECT_EQ(s.error().what.view().substr(0, 41), "Unable to open file </no/such/file.ngc>\nN");
  EXPECT_FALSE(rig.interp.open("/tmp").ok());
  EXPECT_FALSE(rig.interp.is_open());
}

TEST_F(Files, CallsSayWhereTheyComeFrom) {
  write("N10 G0 X1\n\nG0 X2\nM2\n");
  Rig rig;
  ASSERT_TRUE(rig.interp.open(path_).ok());
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_EQ(rig.interp.modal().line, 1);
  EXPECT_EQ(rig.interp.file_name(rig.interp.current_file()), path_);
  EXPECT_EQ(rig.interp.next_line(), 2);
}

}  // namespace
}  // namespace kerf::interp
