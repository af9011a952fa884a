// The rs274 program: options, streams and exit status.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace kerf::interp {
namespace {

class Rs274 : public ::testing::Test {
 protected:
  void SetUp() override {
    dir_ = std::filesystem::temp_directory_path() / ("kerf_rs274_" + std::to_string(::getpid()));
    std::filesystem::create_directories(dir_);
  }
  void TearDown() override { std::filesystem::remove_all(dir_); }
  [[nodiscard]] std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ / name) << text;
    return (dir_ / name).string();
  }
  /// Standard output; standard error goes to err_, the exit status to status_.
  std::string run(const std::string& arguments, const std::string& input = "") {
    const std::string in = file("stdin", input), err = (dir_ / "stderr").string();
    const std::string command =
        std::string(KERF_BUILD_DIR) + "/bin/rs274 " + arguments + " <" + in + " 2>" + err;
    std::FILE* p = ::popen(command.c_str(), "r");
    std::string out;
    char buffer[512];
    while (std::fgets(buffer, sizeof buffer, p) != nullptr) out += buffer;
    const int s = ::pclose(p);
    status_ = WIFEXITED(s) ? WEXITSTATUS(s) : -1;
    std::ostringstream e;
    e << std::ifstream(err).rdbuf();
    err_ = e.str();
    return out;
  }
  std::filesystem::path dir_;
  std::string err_;
  int status_{-1};
};

TEST_F(Rs274, PrintsNumberedCallsWithTheNWord) {
  const std::string out = run("-g " + file("a.ngc", "N10 G0 X1\nM2\n"));
  EXPECT_EQ(status_, 0);
  EXPECT_EQ(err_, "executing\n");
  EXPECT_NE(out.find("    6 N..... ON_RESET()\n    7 N10    STRAIGHT_TRAVERSE(1.0000, 0.0000"),
            std::string::npos);
  EXPECT_NE(
      out.find("   14 N..... PROGRAM_END()\n   15 N..... ON_RESET()\n   16 N..... ON_RESET()\n"),
      std::string::npos)
      << out;
}

TEST_F(Rs274, StopsAtAnErrorOrGoesOn) {
  const std::string path = file("a.ngc", "G0 X1\nG1 X2\nG0 X3\nM2\n");
  std::string out = run("-g " + path);
  EXPECT_EQ(status_, 1);
  EXPECT_EQ(err_, "executing\nCannot do g1 with zero feed rate\nG1 X2\n" + path +
                      ":2: Write F with a feed, here or before\n");
  EXPECT_EQ(out.find("TRAVERSE(3"), std::string::npos);
  out = run("-n 0 -g " + path);
  EXPECT_EQ(status_, 0);
  EXPECT_NE(out.find("TRAVERSE(3"), std::string::npos);
  out = run("-n 1 -g " + path, "G0 X9\nquit\nn\n");
  EXPECT_EQ(status_, 1);
  EXPECT_NE(out.find("TRAVERSE(9"), std::string::npos);
}

TEST_F(Rs274, ToolsParametersBlockDeleteAndOutputFile) {
  const std::string program =
      file("a.ngc", "/G0 X99\nT1 M6 G43\nG28.1\n#31=[#31+1]\nG10 L2 P1 X50.8\nM2\n");
  const std::string tools = file("t.tbl", "T1 P1 Z1 ; inches\n"),
                    var = file("v.var", "31\t4\n5161\t9\n");
  const std::string out_path = (dir_ / "out").string();
  EXPECT_EQ(run("-b -t " + tools + " -v " + var + " -g " + program + " " + out_path), "");
  EXPECT_EQ(status_, 0) << err_;
  std::ostringstream out, saved;
  out << std::ifstream(out_path).rdbuf();
  saved << std::ifstream(var).rdbuf();
  EXPECT_EQ(out.str().find("99.0"), std::string::npos);
  EXPECT_NE(out.str().find("USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 25.4000,"), std::string::npos);
  EXPECT_EQ(saved.str().substr(0, 27), "31\t5.000000\n5161\t0.000000\n5");
  EXPECT_NE(saved.str().find("5221\t2.000000\n"), std::string::npos);
}

TEST_F(Rs274, BadUseIsAnError) {
  (void)run("-x");
  EXPECT_EQ(status_, 1);
  EXPECT_EQ(err_.substr(0, 36), "rs274: invalid option -- 'x'\nUsage: ");
  (void)run("-g /no/such/file.ngc");
  EXPECT_EQ(status_, 1);
  EXPECT_NE(err_.find("Unable to open file </no/such/file.ngc>"), std::string::npos);
  (void)run("-t /no/tools -g x");
  EXPECT_EQ(status_, 1);
}

TEST_F(Rs274, AsksWhatToDoWithoutTheBatchOption) {
  const std::string path = file("a.ngc", "G0 X1\n/G0 X2\nG1 X3\nG0 X4\nM2\n");
  // Block delete on, go on at errors.
  const std::string out = run(path, "4\n5\n3\n1\n1\n");
  EXPECT_EQ(status_, 0);
  EXPECT_NE(err_.find("4 = turn block delete switch ON\n"), std::string::npos);
  EXPECT_NE(err_.find("4 = turn block delete switch OFF\n"), std::string::npos);
  EXPECT_NE(err_.find("3 = mdi on error (do not continue or stop)\nenter choice => "),
            std::string::npos);
  EXPECT_NE(out.find("STRAIGHT_TRAVERSE(1.0000"), std::string::npos);
  EXPECT_EQ(out.find("STRAIGHT_TRAVERSE(2.0000"), std::string::npos);
  EXPECT_NE(out.find("STRAIGHT_TRAVERSE(4.0000"), std::string::npos);

  (void)run(path, "2\nnowhere.var\n");
  EXPECT_EQ(status_, 1);
  EXPECT_NE(err_.find("name of parameter file => Cannot open nowhere.var\n"), std::string::npos);
}

TEST_F(Rs274, PointsAtTheWordToBlame) {
  (void)run("-g " + file("a.ngc", "G0 X1\n\tG0 X2 Q3\nM2\n"));
  EXPECT_EQ(status_, 1);
  EXPECT_NE(err_.find("\n\tG0 X2 Q3\n\t      ^\n"), std::string::npos) << err_;
  EXPECT_NE(err_.find("a.ngc:2:8: "), std::string::npos) << err_;
}

TEST_F(Rs274, MakesAParameterFileThatIsNotThere) {
  const std::string variables = (dir_ / "new.var").string();
  (void)run("-g -v " + variables + " " + file("a.ngc", "G10 L2 P1 X3\nM2\n"));
  EXPECT_EQ(status_, 0) << err_;
  std::ostringstream text;
  text << std::ifstream(variables).rdbuf();
  EXPECT_NE(text.str().find("5221\t0.118110\n"), std::string::npos) << text.str();
}

}  // namespace
}  // namespace kerf::interp
