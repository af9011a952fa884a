// Each folder in check/ is a case of `halcmd check`: its test.hal, or the files that its file `files` names, or else those of its
// test.ini. What is found is compared with the file `expected`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "hal/cmd/check.hpp"
#include "hal/golden.hpp"
#include "harness/module_of.hpp"
#include "ini/ini_file.hpp"

namespace kerf::hal::test {
namespace {

namespace fs = std::filesystem;

const fs::path check_folder = hal_tests() / "check";

std::string found_in_present_folder() {
  ini::LoadResult ini;
  if (fs::exists("test.ini")) {
    ini = ini::IniFile::load("test.ini");
    EXPECT_TRUE(ini.ok);
  }
  StaticSource modules(static_components());
  ScriptCheck check(modules, fs::exists("test.ini") ? &ini.file : nullptr);
  if (fs::exists("test.hal")) {
    check.run_file("test.hal");
  } else if (fs::exists("files")) {
    std::istringstream names(read_file("files"));
    for (std::string name; std::getline(names, name);) check.run_file(name);
  } else {
    check.run_ini_files();
  }
  std::string out;
  for (const auto& finding : check.finish()) out += finding.text_line() + "\n";
  return out;
}

class HalCheck : public testing::TestWithParam<std::string> {};

TEST_P(HalCheck, FindsWhatIsExpected) {
  const InFolder folder(check_folder / GetParam());
  expect_file("expected", found_in_present_folder());
}

INSTANTIATE_TEST_SUITE_P(Folders, HalCheck, testing::ValuesIn(folders_of_cases(check_folder)),
                         case_name);

/// A driver that would open its device in any circumstances.
class Careless final : public Component<Careless> {
 public:
  static constexpr Info kInfo{.name = "careless", .summary = "Opens a file", .singleton = true};
  explicit Careless(Builder& b) noexcept : Component(b) {
    declared_only = b.declares_only();
    std::ifstream device("/dev/null");
    opened = device.is_open();
  }
  static inline bool opened{false};
  static inline bool declared_only{false};
};
constexpr Module kCareless = test::module_of<Careless>();

TEST(HalCheckOfDrivers, TouchesNoDevice) {
  const StaticModule table[] = {{"careless", &kCareless}};
  StaticSource modules(table);
  ScriptCheck check(modules, nullptr);
  check.run_text("loadrt careless\n", "drivers.hal");
  EXPECT_THAT(check.finish(), testing::IsEmpty());
  EXPECT_TRUE(Careless::declared_only);
#if !defined(__SANITIZE_ADDRESS__)  // see ScriptCheck::NoDevices
  EXPECT_FALSE(Careless::opened);
#endif
  EXPECT_TRUE(std::ifstream("/dev/null").is_open()) << "files may be opened again";
}

}  // namespace
}  // namespace kerf::hal::test
