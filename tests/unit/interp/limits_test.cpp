// Programs of unreasonable size and endless ones: bounded memory, clear errors, one block at a time.
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "interp/core.hpp"
#include "interp/null_canon.hpp"
#include "interp/source.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

/// Steps of a program that must not end by itself; what it ended with, else ok.
Outcome run_steps(Interpreter& interp, int steps) {
  Outcome o = Outcome::ok;
  for (int i = 0; i < steps && o == Outcome::ok; ++i) o = interp.execute_next();
  return o;
}

std::size_t bytes_in_use() { return ::mallinfo2().uordblks; }

TEST(Limits, EndlessProgramsTakeNoMemoryAndStopAtOnce) {
  const char* const programs[] = {
      "o1 while [1]\no1 endwhile\nM2\n",
      "o1 while [1]\n#1=[#1+1]\n#<a>=#1\nG0 X#1\no1 endwhile\nM2\n",
      R"(o1 do
o2 repeat [3]
o2 endrepeat
o3 if [#1 gt 2]
o3 elseif [0]
o3 else
o3 endif
o1 while [1]
M2
)",
      "o<s> sub\n#<x>=#1\no<s> endsub\no1 while [1]\no<s> call [2]\no1 endwhile\nM2\n",
      // Labels that are computed are no new names each time.
      R"(o1 while [1]
o[10 + #1] if [0]
o[10 + #1] endif
#1=[#1+1]
o1 endwhile
M2
)",
  };
  for (const char* const program : programs) {
    Rig rig;
    ASSERT_TRUE(rig.interp.open_text("endless.ngc", program).ok());
    ASSERT_EQ(run_steps(rig.interp, 300000), Outcome::ok) << program << rig.interp.error().text;
    (void)rig.calls();
    const std::size_t before = bytes_in_use();
    ASSERT_EQ(run_steps(rig.interp, 1000), Outcome::ok) << program;
    EXPECT_LT(bytes_in_use(), before + 100000) << program;
    rig.interp.abort();
    EXPECT_EQ(rig.interp.next_line(), 1) << program;
  }
}

TEST(Limits, WithCutterCompensationABoundedNumberOfBlocksWaits) {
  Rig rig;
  ASSERT_TRUE(
      rig.interp
          .open_text("waits.ngc",
                     "G21 G41.1 D2\nG1 X10 F100\nY20\no1 while [1]\nM8\n#1=[#1+1]\no1 endwhile\n")
          .ok());
  ASSERT_EQ(run_steps(rig.interp, 100000), Outcome::error);
  EXPECT_EQ(rig.interp.error().text,
            "10000 blocks wait for the next move in the plane of the cutter compensation");
  (void)rig.calls();
  // Nothing of them runs after the abort.
  rig.interp.abort();
  ASSERT_EQ(rig.interp.execute_mdi("M9"), Outcome::ok);
  EXPECT_EQ(rig.calls().find("FLOOD_ON"), std::string::npos);
}

TEST(Limits, RecursionGoesAsDeepAsTheDialectSays) {
  Dialect deep = linuxcnc_dialect();
  deep.call_levels = 10000;
  Environment world;
  NullCanon canon;
  Core core(world, canon, {}, deep);
  core.init();
  const char* const program =
      "o<down> sub\n#<level>=#1\no1 if [#1 lt %d]\no<down> call [#1+1]\no1 endif\n"
      "o2 if [#<level> ne #1]\n(abort,locals are mixed up)\no2 endif\no<down> endsub\no<down> call "
      "[1]\nM2\n";
  for (const auto& [depth, wanted] :
       {std::pair{10000, Outcome::program_end}, {10001, Outcome::error}}) {
    char text[400];
    std::snprintf(text, sizeof text, program, depth);
    const std::size_t before = bytes_in_use();
    core.open_main("deep.ngc", make_text_source(text));
    Outcome o = Outcome::ok;
    std::size_t deepest = 0;
    for (int i = 0; i < 200000 && o == Outcome::ok; ++i) {
      o = core.execute_next();
      deepest = std::max(deepest, core.flows.frames.size());
    }
    EXPECT_EQ(o, wanted) << core.error.text;
    EXPECT_EQ(deepest, 10001U);  // the main program is one
    EXPECT_LT(bytes_in_use(), before + 20000000);
    EXPECT_EQ(core.error.text, wanted == Outcome::error ? "Too many subroutine levels" : "");
  }
}

TEST(Limits, LinuxCncAllowsTenLevels) {
  Rig rig;
  EXPECT_EQ(rig.run("o<s> sub\no<s> call\no<s> endsub\no<s> call\nM2\n"),
            "error: Too many subroutine levels");
}

class BigFiles : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  void write(const std::string& text, std::ios::openmode mode = {}) const {
    std::ofstream(path_, std::ios::binary | mode) << text;
  }
  std::string path_ = (std::filesystem::temp_directory_path() /
                       ("kerf_limits_" + std::to_string(::getpid()) + ".ngc"))
                          .string();
};

std::string repeated(std::string_view text, std::size_t bytes) {
  std::string all;
  while (all.size() < bytes) all += text;
  return all;
}

TEST_F(BigFiles, ALineOfAMegabyteIsALine) {
  constexpr std::size_t kMegabyte = 1000000;
  Rig rig;
  const std::string comment(kMegabyte, 'x');
  write("G0 X1\n(" + comment + ")\nG0" + std::string(kMegabyte, ' ') + "X2\nG0 X[" +
        repeated("1-1+", kMegabyte) + "3]\nG0 X[" + repeated("#1+", kMegabyte) + "4]\nM2\n");
  ASSERT_TRUE(rig.interp.open(path_).ok());
  EXPECT_EQ(run_steps(rig.interp, 10), Outcome::program_end) << rig.interp.error().text;
  const std::string calls = rig.calls();
  EXPECT_NE(calls.find("COMMENT(\"" + comment + "\")"), std::string::npos);
  for (const char* x : {"1.0000", "2.0000", "3.0000", "4.0000"})
    EXPECT_NE(calls.find("STRAIGHT_TRAVERSE(" + std::string(x)), std::string::npos) << x;
}

TEST_F(BigFiles, WhatALineMayNotHoldIsAClearError) {
  struct Case {
    std::string line;
    const char* error;
  };
  const Case cases[] = {
      {std::string(kLongestLine + 1, ' '), "Command too long"},
      {"(" + std::string(3 * kLongestLine, 'x') + ")", "Command too long"},
      {repeated("#1=1", 1000000), "Too many parameter settings on one line"},
      {repeated("G1", 1000000), "Two g codes used from same modal group"},
      {repeated("X1", 1000000), "Multiple x words on one line"},
      {"#1=" + std::string(1000000, '['), "Expression nested too deeply"},
      {"#1=" + std::string(1000000, '-') + "1", "Expression nested too deeply"},
      {"#1=" + std::string(1000000, '#') + "1", "Expression nested too deeply"},
      {"G0 X" + std::string(1000000, '9'), "bad number format (conversion failed) parsing"},
  };
  for (const Case& c : cases) {
    Rig rig;
    write("G0 X1\n" + c.line + "\nG0 X2\nM2\n");
    ASSERT_TRUE(rig.interp.open(path_).ok());
    ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
    ASSERT_EQ(rig.interp.execute_next(), Outcome::error) << c.error;
    EXPECT_EQ(rig.interp.error().text.substr(0, std::string_view(c.error).size()), c.error);
    EXPECT_EQ(rig.interp.error().line, 2) << c.error;
    (void)rig.calls();
    // The next line is the next one, not the rest of that one.
    ASSERT_EQ(rig.interp.execute_next(), Outcome::ok) << c.error;
    EXPECT_NE(rig.calls().find("STRAIGHT_TRAVERSE(2.0000"), std::string::npos) << c.error;
  }
}

TEST_F(BigFiles, ASearchStopsAfterAPieceOfTheFile) {
  write("o1 if [0]\n" + repeated("G0 X1\n", 600000) + "o1 endif\nM2\n");
  Rig rig;
  ASSERT_TRUE(rig.interp.open(path_).ok());
  int steps = 0;
  while (rig.interp.execute_next() == Outcome::ok) ++steps;
  EXPECT_GT(steps, 50);
  EXPECT_EQ(rig.interp.error().text, "");
  // The same in lines that are long.
  write("o1 if [0]\n" + repeated("(" + std::string(9000, 'x') + ")\n", 1000000) + "o1 endif\nM2\n");
  ASSERT_TRUE(rig.interp.open(path_).ok());
  for (steps = 0; rig.interp.execute_next() == Outcome::ok;) ++steps;
  EXPECT_GT(steps, 10);
}

TEST_F(BigFiles, AFileCutWhileItRunsIsAnError) {
  write(repeated("G0 X1 Y2 Z3\n", 1000000) + "M2\n");
  Rig rig;
  ASSERT_TRUE(rig.interp.open(path_).ok());
  ASSERT_EQ(run_steps(rig.interp, 100), Outcome::ok);
  std::filesystem::resize_file(path_, 5000);
  EXPECT_EQ(run_steps(rig.interp, 20000), Outcome::error);
  EXPECT_EQ(rig.interp.error().text, "The program file was changed while it runs");
}

TEST_F(BigFiles, AFileThatGrowsWhileItRunsIsAnError) {
  write(repeated("G0 X1 Y2 Z3\n", 1000000));
  Rig rig;
  ASSERT_TRUE(rig.interp.open(path_).ok());
  ASSERT_EQ(run_steps(rig.interp, 100), Outcome::ok);
  write("G0 X9\n", std::ios::app);
  EXPECT_EQ(run_steps(rig.interp, 20000), Outcome::error);
  EXPECT_EQ(rig.interp.error().text, "The program file was changed while it runs");
}

TEST_F(BigFiles, ASmallFileRunsAsItWasWhenItWasOpened) {
  write("G0 X1\nG0 X2\nM2\n");
  Rig rig;
  ASSERT_TRUE(rig.interp.open(path_).ok());
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  write("");
  EXPECT_EQ(run_steps(rig.interp, 10), Outcome::program_end);
  EXPECT_NE(rig.calls().find("STRAIGHT_TRAVERSE(2.0000"), std::string::npos);
}

TEST_F(BigFiles, ALoopOverMoreLinesThanAreKeptRunsThemAll) {
  // 40 MB of parsed lines.
  std::string body;
  for (int i = 0; i < 100000; ++i) body += "G0 X" + std::to_string(i) + " Y1 Z2\n";
  write("o1 repeat [2]\n" + body + "o1 endrepeat\nM2\n");
  Environment world;
  NullCanon canon;
  Interpreter interp(world, canon);
  interp.init();
  ASSERT_TRUE(interp.open(path_).ok());
  const std::size_t before = bytes_in_use();
  EXPECT_EQ(run_steps(interp, 1000000), Outcome::program_end) << interp.error().text;
  EXPECT_EQ(canon.moves, 200000U);
  EXPECT_LT(bytes_in_use(), before + 40000000);
}

TEST_F(BigFiles, NamesWithoutEndAreAClearError) {
  for (const auto& [line, error] :
       {std::pair{"#<name%d>=1\n", "Too many named parameters"},
        {"o<label%d> if [1]\no<label%d> endif\n", "Too many O-word labels"},
        {"o%d sub\no%d endsub\n", "Too many subroutines"}}) {
    std::string text;
    for (int i = 0; i < 200000; ++i) {
      char one[100];
      std::snprintf(one, sizeof one, line, i, i);
      text += one;
    }
    write(text);
    text = {};
    Environment world;
    NullCanon canon;
    Interpreter interp(world, canon);
    interp.init();
    const std::size_t before = bytes_in_use();
    ASSERT_TRUE(interp.open(path_).ok());
    EXPECT_EQ(run_steps(interp, 1000000), Outcome::error);
    EXPECT_EQ(interp.error().text, error);
    EXPECT_LT(bytes_in_use(), before + 40000000) << error;
  }
}

TEST_F(BigFiles, ManySubFilesKeepNoDescriptors) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("kerf_subs_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  std::string calls;
  for (int i = 0; i < 1500; ++i) {
    const std::string name = "s" + std::to_string(i);
    std::ofstream(folder / (name + ".ngc"))
        << "o<" << name << "> sub\n#5=" << i << "\no<" << name << "> endsub\n";
    calls += "o<" + name + "> call\n";
  }
  Rig rig;
  rig.world.files.add_directory(folder.string());
  EXPECT_EQ(rig.run(calls + "(debug,#1)\nM2\n").substr(0, 7), "MESSAGE");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace kerf::interp
