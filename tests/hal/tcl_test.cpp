// Each folder of tests/hal/tcl with a test.tcl is a case: halrun runs it (with test.ini, if there is one), and its two outputs and
// its exit status are compared with the file `expected`. KERF_GOLDEN_UPDATE=1 writes it anew; look at the difference before you
// commit it.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "hal/golden.hpp"

namespace kerf::hal::test {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = hal_tests() / "tcl";

/// What depends on the machine: the warning about its kernel, process numbers, and where the tree lies.
std::string normalised(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  for (std::string line; std::getline(in, line);)
    if (line.rfind("rtapi_app: ", 0) != 0) out += line + "\n";
  // "halcmd123   123 ", the command's own component in `show comp`.
  const char* const digits = "0123456789";
  for (auto at = out.find("halcmd"); at != std::string::npos; at = out.find("halcmd", at + 1)) {
    const auto blanks = out.find_first_not_of(digits, at + 6);
    const auto pid = out.find_first_not_of(' ', blanks);
    const auto end = out.find_first_not_of(digits, pid);
    if (end == std::string::npos || out[end] != ' ' || at + 6 == blanks || blanks == pid ||
        pid == end)
      continue;
    out.replace(at, end + 1 - at, "halcmdPID PID ");
  }
  for (const std::string& root : {std::string(KERF_BUILD_DIR), std::string(KERF_SOURCE_DIR)})
    for (auto at = out.find(root); at != std::string::npos; at = out.find(root, at))
      out.replace(at, root.size(), "ROOT");
  return out;
}

class TclCase : public testing::TestWithParam<std::string> {};

TEST_P(TclCase, PrintsWhatIsExpected) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  if (GetParam() == "programs")
    GTEST_SKIP() << "Debian's tclsh cannot load a package that was built for a sanitizer";
#endif
  const fs::path folder = kFolder / GetParam();
  const fs::path scratch =
      fs::temp_directory_path() / ("kerf-tcl-" + std::to_string(::getpid()) + "-" + GetParam());
  fs::create_directories(scratch);
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::setenv("KERF_INSTANCE", ("tcl-" + std::to_string(::getpid())).c_str(), 1);
    ::setenv("SCRATCH", scratch.c_str(), 1);
    ::unsetenv("KERF_RUN_ID");
    const int flags = O_CREAT | O_WRONLY | O_TRUNC;
    ::dup2(::open("/dev/null", O_RDONLY), 0);
    ::dup2(::open((scratch / "out").c_str(), flags, 0600), 1);
    ::dup2(::open((scratch / "err").c_str(), flags, 0600), 2);
    if (::chdir(folder.c_str()) != 0) ::_exit(126);
    const std::string halrun = std::string(KERF_BUILD_DIR) + "/bin/halrun";
    ::alarm(60);  // halrun takes all down at SIGALRM's default end, too
    if (fs::exists(folder / "test.ini"))
      ::execl(halrun.c_str(), "halrun", "-i", "test.ini", "test.tcl", nullptr);
    else
      ::execl(halrun.c_str(), "halrun", "test.tcl", nullptr);
    ::_exit(127);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(pid, &status, 0), pid);
  std::string text = normalised(read_file(scratch / "out"));
  if (const auto errors = normalised(read_file(scratch / "err")); !errors.empty())
    text += "--- stderr\n" + errors;
  text += "--- exit status " +
          std::to_string(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status)) + "\n";
  fs::remove_all(scratch);
  expect_file(folder / "expected", text);
}

INSTANTIATE_TEST_SUITE_P(Tcl, TclCase, testing::ValuesIn(folders_of_cases(kFolder, "test.tcl")),
                         case_name);

}  // namespace
}  // namespace kerf::hal::test
