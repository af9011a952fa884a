// Each folder beside this file with a test.hal is a case: its commands run with "keep going", and what halcmd prints is compared
// with the file `expected`. KERF_GOLDEN_UPDATE=1 writes it anew; look at the difference before you commit it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "hal/cmd/commander.hpp"
#include "hal/script_machine.hpp"
#include "ini/ini_file.hpp"

namespace kerf::hal::test {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(KERF_SOURCE_DIR) / "tests/hal";

class Both final : public CommandSink {
 public:
  void out(std::string_view t) override { text += t; }
  void err(std::string_view t) override { text += t; }
  std::string text;
};

/// Addresses differ from run to run: twelve hexadecimal digits become "ADDRESS".
std::string without_addresses(const std::string& text) {
  std::string out;
  std::string run;
  const auto flush = [&] {
    out += run.size() == 12 && run.find_first_of("abcdef0123456789") == 0 ? "ADDRESS" : run;
    run.clear();
  };
  for (const char c : text) {
    if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'f')) {
      run += c;
    } else {
      flush();
      out += c;
    }
  }
  flush();
  return out;
}

std::string read_file(const fs::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::string> cases() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    if (fs::exists(entry.path() / "test.hal")) out.push_back(entry.path().filename().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

class HalScript : public testing::TestWithParam<std::string> {};

TEST_P(HalScript, PrintsWhatIsExpected) {
  const fs::path folder = kFolder / GetParam();
  const fs::path old = fs::current_path();
  fs::current_path(folder);  // scripts name their files relative to themselves
  Both sink;
  {
    ScriptMachine machine;
    IniLookup lookup;
    ini::LoadResult ini;
    if (fs::exists("test.ini")) {
      ini = ini::IniFile::load("test.ini");
      ASSERT_TRUE(ini.ok);
      lookup = ini_lookup(ini.file);
    }
    Commander commander(machine.session, lookup, &sink);
    commander.set_clock(&machine.clock);
    commander.set_keep_going(true);
    (void)commander.run_file("test.hal");
  }
  fs::current_path(old);
  const std::string got = without_addresses(sink.text);
  if (std::getenv("KERF_GOLDEN_UPDATE") != nullptr) {
    std::ofstream(folder / "expected") << got;
    GTEST_SKIP() << "written anew";
  }
  EXPECT_EQ(got, read_file(folder / "expected"));
}

INSTANTIATE_TEST_SUITE_P(Folders, HalScript, testing::ValuesIn(cases()), [](const auto& tested) {
  std::string name = tested.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace kerf::hal::test
