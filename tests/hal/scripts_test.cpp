// Each folder beside this file with a test.hal is a case: its commands run with "keep going", and what halcmd prints is compared
// with the file `expected`.
#include <gtest/gtest.h>

#include <filesystem>

#include "hal/cmd/commander.hpp"
#include "hal/golden.hpp"
#include "hal/script_machine.hpp"
#include "ini/ini_file.hpp"

namespace kerf::hal::test {
namespace {

namespace fs = std::filesystem;

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

class HalScript : public testing::TestWithParam<std::string> {};

TEST_P(HalScript, PrintsWhatIsExpected) {
  const InFolder folder(hal_tests() / GetParam());
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
  expect_file("expected", without_addresses(sink.text));
}

INSTANTIATE_TEST_SUITE_P(Folders, HalScript,
                         testing::ValuesIn(folders_of_cases(hal_tests(), "test.hal")), case_name);

}  // namespace
}  // namespace kerf::hal::test
