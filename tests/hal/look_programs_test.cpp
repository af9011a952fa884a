// halcmd check, halcmd graph and hal describe as programs: exit statuses, files and what needs graphviz.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kerf::hal::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kBin = std::string(KERF_BUILD_DIR) + "/bin/";

struct Outcome {
  int status;
  std::string text;  ///< of stdout and stderr
};

class LookPrograms : public testing::Test {
 protected:
  LookPrograms() {
    const std::string name = "test-look-" + std::to_string(::getpid());
    ::setenv("KERF_INSTANCE", name.c_str(), 1);
    folder_ = fs::temp_directory_path() / name;
    fs::create_directories(folder_);
    old_ = fs::current_path();
    fs::current_path(folder_);
  }
  ~LookPrograms() override {
    fs::current_path(old_);
    fs::remove_all(folder_);
  }
  static void write(const std::string& name, const std::string& text) {
    std::ofstream(name) << text;
  }
  static std::string read(const std::string& name) {
    std::ifstream in(name);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
  static Outcome run(const std::string& command) {
    const bool piped = command.rfind("cat ", 0) == 0;
    std::FILE* pipe = ::popen((command + " 2>&1" + (piped ? "" : " </dev/null")).c_str(), "r");
    Outcome out{-1, {}};
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe))
      out.text.append(buffer, n);
    const int status = ::pclose(pipe);
    out.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return out;
  }

 private:
  fs::path folder_, old_;
};

constexpr const char* kGood =
    "loadrt and2\nloadrt threads name1=servo\naddf and2.0 servo\n"
    "setp and2.0.in0 1\nnet a and2.0.out => and2.0.in1\n";

TEST_F(LookPrograms, CheckTellsByItsExitStatus) {
  write("good.hal", kGood);
  write("bad.hal", "loadrt adn2\n");
  write("machine.ini", "[HAL]\nHALFILE = good.hal\n");
  fs::create_directory("elsewhere");
  auto good = run(kBin + "halcmd check good.hal");
  EXPECT_EQ(good.status, 0) << good.text;
  EXPECT_THAT(good.text, HasSubstr("0 errors, 0 warnings, 1 note\n"));
  auto bad = run(kBin + "halcmd check good.hal bad.hal");
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.text, HasSubstr("bad.hal:1: error: no component 'adn2'; did you mean 'and2'?\n"));
  EXPECT_EQ(run(kBin + "halcmd check").status, 2);
  EXPECT_EQ(run(kBin + "halcmd check --no-such-option good.hal").status, 2);
  EXPECT_EQ(run(kBin + "halcmd check absent.hal").status, 1);
  // The INI's files are meant from its folder.
  EXPECT_EQ(run("cd elsewhere; " + kBin + "hal check -i ../machine.ini").status, 0);
  EXPECT_EQ(run(kBin + "halcmd -i machine.ini check").status, 0);
  EXPECT_EQ(run(kBin + "halcmd check machine.ini").text,
            run(kBin + "halcmd check -i machine.ini").text);
  const auto json = nlohmann::json::parse(run(kBin + "halcmd check --json bad.hal").text);
  EXPECT_EQ(json["errors"], 1);
}

TEST_F(LookPrograms, GraphMakesPicturesOrSaysWhatIsMissing) {
  write("good.hal", kGood);
  const auto text = run(kBin + "halcmd graph --from good.hal");
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.text, StartsWith("digraph hal {"));
  EXPECT_EQ(run(kBin + "halcmd graph --from good.hal -o x.dot").status, 0);
  EXPECT_EQ(read("x.dot"), text.text);
  EXPECT_EQ(run(kBin + "halcmd graph --from good.hal -o x.bmp").status, 2);
  const auto missing = run("PATH=/nowhere " + kBin + "halcmd graph --from good.hal -o y.svg");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.text, HasSubstr("package graphviz"));
  EXPECT_EQ(read("y.dot"), text.text);
  if (run("dot -V").status != 0) GTEST_SKIP() << "graphviz is not installed";
  EXPECT_EQ(run(kBin + "halcmd graph --from good.hal -o x.svg").status, 0);
  EXPECT_THAT(read("x.svg"), HasSubstr("<svg"));
  EXPECT_THAT(read("x.svg"), HasSubstr("and2.0"));
}

TEST_F(LookPrograms, TheyAreCommandsOfAnInteractiveHalcmdToo) {
  write("bad.hal", "loadrt adn2\n");
  write("lines", std::string(kGood) + "graph\ncheck bad.hal\ngetp and2.0.in0\n");
  const auto said = run("cat lines | " + kBin + "halrun -k -I");
  EXPECT_THAT(said.text, HasSubstr("\"and2.0\":\"and2.0.out\":e"));
  EXPECT_THAT(said.text, HasSubstr("bad.hal:1: error: no component 'adn2'"));
  EXPECT_THAT(said.text, HasSubstr("\nTRUE\n"));
}

TEST_F(LookPrograms, GraphOfTheRunningHal) {
  EXPECT_EQ(run(kBin + "halcmd graph").status, 1);
  write("good.hal",
        std::string(kGood) + "loadusr -w " + kBin + "halcmd graph --values -o live.dot\n");
  const auto ran = run(kBin + "halrun good.hal");
  EXPECT_EQ(ran.status, 0) << ran.text;
  EXPECT_THAT(read("live.dot"), HasSubstr("\"and2.0\":\"and2.0.out\":e"));
  EXPECT_THAT(read("live.dot"), HasSubstr("FALSE"));
}

TEST_F(LookPrograms, DescribeWritesPages) {
  const auto page = run(kBin + "hal describe and2");
  EXPECT_EQ(page.status, 0);
  EXPECT_THAT(page.text, StartsWith("and2 - "));
  EXPECT_EQ(run(kBin + "hal describe --man -o pages and2 threads").status, 0);
  EXPECT_THAT(read("pages/and2.9"), HasSubstr(".TH AND2 9"));
  EXPECT_THAT(read("pages/threads.9"), HasSubstr(".SH THREADS"));
  const auto unknown = run(kBin + "hal describe adn2");
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.text, HasSubstr("did you mean 'and2'"));
  EXPECT_EQ(run(kBin + "hal describe").status, 2);
  EXPECT_EQ(run(kBin + "hal descrive and2").status, 2);
  EXPECT_EQ(run(kBin + "hal --help").status, 0);
}

}  // namespace
}  // namespace kerf::hal::test
