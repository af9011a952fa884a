// The programs inivalue and inivar: output, messages, exit codes.
#include "ini/inivalue.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace kerf::ini {
namespace {

using Args = std::vector<std::string>;

/// Runs in a folder of its own that holds c.ini, so that messages show the bare name.
class InivalueRun : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "kerf_inivalue_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    dir_ = name;
    before_ = std::filesystem::current_path();
    std::filesystem::current_path(dir_);
  }
  void TearDown() override {
    std::filesystem::current_path(before_);
    std::filesystem::remove_all(dir_);
  }

  static void write(const std::string& text, const char* name = "c.ini") {
    std::FILE* file = std::fopen(name, "wb");
    ASSERT_NE(file, nullptr);
    std::fputs(text.c_str(), file);
    std::fclose(file);
  }

  /// inivalue ARGS c.ini on the given content.
  static CommandOutput run(const std::string& text, Args args) {
    write(text);
    args.emplace_back("c.ini");
    return run_inivalue(args);
  }

  std::filesystem::path dir_;
  std::filesystem::path before_;
};

void expect(const CommandOutput& got, int code, const std::string& out, const std::string& err) {
  EXPECT_EQ(got.exit_code, code);
  EXPECT_EQ(got.out, out);
  EXPECT_EQ(got.err, err);
}

TEST_F(InivalueRun, PrintsInstances) {
  const std::string text = "[A]\nX=1\nX=2\nX=3\nE=\n";
  expect(run(text, {"-V", "X"}), 0, "1\n", "");
  expect(run(text, {"--var=X", "--sec=A"}), 0, "1\n", "");
  expect(run(text, {"-VX", "-N", "2"}), 0, "2\n", "");
  expect(run(text, {"-V", "X", "-a"}), 0, "1\n2\n3\n", "");
  expect(run(text, {"-V", "X", "-N2", "--all"}), 0, "2\n3\n", "");
  expect(run(text, {"-V", "E"}), 0, "\n", "");
  expect(run(text, {}), 0, "1\n", "");
}

TEST_F(InivalueRun, NotFound) {
  const std::string text = "[A]\nX=1\n";
  expect(run(text, {"-V", "Q", "-S", "A"}), 2, "", "error: Cannot find instance 1 of '[A]Q'\n");
  expect(run(text, {"-V", "Q"}), 2, "", "error: Cannot find instance 1 of '[]Q'\n");
  expect(run(text, {"-V", "x"}), 2, "", "error: Cannot find instance 1 of '[]x'\n");
  expect(run(text, {"-V", "Q", "-q"}), 2, "", "");
  expect(run(text, {"-V", "Q", "-a"}), 0, "", "");
  expect(run(text, {"-V", "X", "-N", "5", "-a"}), 2, "", "error: No instance 5 or more of '[]X'\n");
}

TEST_F(InivalueRun, Lists) {
  const std::string text = "[A]\nX=1\nX=2\n[B]\nY=3\n";
  expect(run(text, {"-e"}), 0, "A\nB\n", "");
  expect(run(text, {"-o"}), 0, "X\nX\nY\n", "");
  expect(run(text, {"-oc", "-S", "B"}), 0, "Y=3\n", "");
  expect(run(text, {"--variables", "--prefix", "--sec", "B"}), 0, "[B]Y\n", "");
  expect(run(text, {"-ocp"}), 0, "[A]X=1\n[A]X=2\n[B]Y=3\n", "");
  expect(run(text, {"-o", "-S", "NOPE"}), 0, "", "");
}

TEST_F(InivalueRun, BadCalls) {
  write("[A]\nX=1\n");
  expect(run_inivalue({}), 1, "", "error: Missing ini-file\n");
  expect(run_inivalue({"-N", "0", "c.ini"}), 1, "",
         "error: Invalid number '0' in --num argument\n");
  expect(run_inivalue({"-y", "z", "c.ini"}), 1, "",
         "error: Invalid type identifier 'z' accepted={i,u,b,s,r}\n");
  expect(run_inivalue({"-m", "1", "-y", "i", "c.ini"}), 1, "",
         "error: Must first specify --type before minimum\n");
  EXPECT_EQ(run_inivalue({"--nope", "c.ini"}).exit_code, 1);
  EXPECT_EQ(run_inivalue({"--var"}).exit_code, 1);
  expect(run_inivalue({"-VX", "nofile.ini"}), 1, "",
         "nofile.ini: error: Cannot open ini-file (errno=2 (No such file or directory))\n");
  EXPECT_EQ(run_inivalue({"--help"}).exit_code, 0);
}

TEST_F(InivalueRun, FileWithAnErrorPrintsNothing) {
  expect(run("[A]\nX=1\nY\n", {"-V", "X"}), 1, "",
         "c.ini:3: error: Invalid tag 'Y'. Expected '=' after tag identifier\n");
}

struct TypeCase {
  const char* value;
  const char* type;
  int code;
  const char* out;
  const char* err{""};
};

TEST_F(InivalueRun, Types) {
  const std::string big = "18446744073709551613\n";
  const TypeCase cases[] = {
      {"12", "i", 0, "12\n"},
      {"-3", "i", 0, "-3\n"},
      {"+4", "i", 0, "4\n"},
      {"-3", "u", 0, big.c_str(),
       "c.ini:2: warning: Unsigned integer conversion detected a leading minus sign (-)\n"},
      {"+4", "u", 0, "4\n"},
      {"12", "r", 0, "1.200000000000000e+01\n"},
      {"0x1F", "i", 0, "31\n"},
      {"0b101", "u", 0, "5\n"},
      {"0o17", "i", 0, "15\n"},
      {"017", "i", 0, "17\n"},
      {"0x1F", "r", 0, "3.100000000000000e+01\n"},
      {"017", "r", 0, "1.700000000000000e+01\n"},
      {"0b101", "r", 0, "0.000000000000000e+00\n",
       "c.ini:2: warning: Trailing character(s) in floating point conversion ([A]X='0b101')\n"},
      {"1.5", "i", 0, "1\n",
       "c.ini:2: warning: Trailing character(s) in signed integer conversion ([A]X='1.5')\n"},
      {"12abc", "u", 0, "12\n",
       "c.ini:2: warning: Trailing character(s) in unsigned integer conversion ([A]X='12abc')\n"},
      {"1e3", "r", 0, "1.000000000000000e+03\n"},
      {"1 2", "i", 0, "1\n"},
      {"1 2", "r", 0, "1.000000000000000e+00\n"},
      {"99999999999999999999", "r", 0, "1.000000000000000e+20\n"},
      {"TRUE", "b", 0, "true\n"},
      {"yes", "b", 0, "true\n"},
      {"On", "b", 0, "true\n"},
      {"1", "b", 0, "true\n"},
      {"fAlse", "b", 0, "false\n"},
      {"No", "b", 0, "false\n"},
      {"0", "b", 0, "false\n"},
      {"12", "b", 3, "", "c.ini:2: error: Invalid boolean value [A]X='12'\n"},
      {"a b", "s", 0, "a b\n"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(std::string(c.type) + " of '" + c.value + "'");
    expect(run(std::string("[A]\nX=") + c.value + "\n", {"-VX", "-y", c.type}), c.code, c.out,
           c.err);
  }
  for (const char* bad : {"", "abc", "nan", "inf", "TRUE"}) {
    for (const char* type : {"i", "u", "r"}) {
      EXPECT_EQ(run(std::string("[A]\nX=") + bad + "\n", {"-VX", "-y", type}).exit_code, 3) << bad;
    }
  }
}

TEST_F(InivalueRun, BooleanForms) {
  expect(run("[A]\nX=yes\n", {"-VX", "-yb", "-b"}), 0, "1\n", "");
  expect(run("[A]\nX=off\n", {"-VX", "-yb", "--boolpy"}), 0, "False\n", "");
}

TEST_F(InivalueRun, Ranges) {
  const std::string text = "[A]\nX=5\n";
  expect(run(text, {"-VX", "-yi", "-m", "1", "-M", "5"}), 0, "5\n", "");
  expect(run(text, {"-VX", "-yi", "-m", "1", "-M", "4"}), 3, "",
         "error: Invalid integer []X='5' or out of range [1,4]\n");
  expect(run(text, {"-VX", "-yu", "-m", "6", "-M", "9"}), 3, "",
         "error: Invalid unsigned []X='5' or out of range [6,9]\n");
  expect(run(text, {"-VX", "-yr", "-m", "6", "-M", "9.5"}), 3, "",
         "error: Invalid real []X='5' or out of range [6,9.5]\n");
  expect(run(text, {"-VX", "-yi", "-m", "9", "-M", "4"}), 3, "",
         "error: Invalid integer range min '9' > max '4'\n");
  expect(run("[A]\nX=abc\n", {"-VX", "-SA", "-yi", "-m1", "-M4"}), 3, "",
         "c.ini:2: error: Invalid signed integer [A]X='abc'\n"
         "error: Invalid integer [A]X='abc' or out of range [1,4]\n");
}

TEST_F(InivalueRun, TildeExpansionOnlyWhenAsked) {
  const char* home = std::getenv("HOME");
  ASSERT_NE(home, nullptr);
  expect(run("[A]\nX=~/a\n", {"-VX"}), 0, "~/a\n", "");
  expect(run("[A]\nX=~/a\n", {"-VX", "-T"}), 0, std::string(home) + "/a\n", "");
  expect(run("[A]\nX=a/~/b\n", {"-VX", "-T"}), 0, "a/~/b\n", "");
}

TEST_F(InivalueRun, Inivar) {
  write("[A]\nX=1\nX=2\n");
  write("[E]\nX=emc\n", "emc.ini");
  expect(run_inivar({"-var", "X", "-sec", "A", "-ini", "c.ini"}), 0, "1\n", "");
  expect(run_inivar({"-var", "X", "-num", "2", "-ini", "c.ini"}), 0, "2\n", "");
  expect(run_inivar({"-var", "X"}), 0, "emc\n", "");
  expect(run_inivar({"-var", "Q", "-sec", "A", "-ini", "c.ini"}), 2, "",
         "error: Cannot find instance 1 of '[A]Q'\n");
  expect(run_inivar({}), 1, "", "inivar: No variable supplied (missing -var)\n");
  expect(run_inivar({"-var", "X", "-sec"}), 1, "", "inivar: Missing argument to -sec\n");
  expect(run_inivar({"-var", "X", "-var", "Y"}), 1, "", "inivar: Duplicate -var option\n");
  expect(run_inivar({"-var", "X", "c.ini"}), 1, "", "inivar: Invalid option 'c.ini'\n");
}

}  // namespace
}  // namespace kerf::ini
