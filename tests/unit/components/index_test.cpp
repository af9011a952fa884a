// docs/components/index.md lists all components; it is made from their declarations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

constexpr const char* kFolder = KERF_SOURCE_DIR "/docs/components/";
constexpr const char* kPage = KERF_SOURCE_DIR "/docs/components/index.md";

std::string page() {
  struct Entry {
    std::string page, purpose;
  };
  std::map<std::string, Entry> entries;
  for (const hal::Module* m : all_modules()) {
    std::string name(m->info.name);
    std::replace(name.begin(), name.end(), '-', '_');
    // Pages are called as the files that loadrt loads: with `_` nearly all.
    const bool plain = std::filesystem::exists(std::string(kFolder) + name + ".md");
    entries[name] = {(plain ? name : std::string(m->info.name)) + ".md",
                     std::string(m->info.summary)};
  }
  std::ostringstream out;
  out << "# HAL components\n\n"
         "`loadrt NAME` loads one; its page here, which `hal describe NAME` shows too, has its "
         "pins, "
         "parameters, functions and loadrt parameters. In\n"
         "names `-` and `_` are the same to `loadrt`. This page is made from the declarations:\n"
         "`KERF_WRITE_PAGES=1 build/dev/tests/components_test --gtest_filter=ComponentIndex.*` "
         "writes it. Kinematics modules are listed in [kinematics.md](../kinematics.md).\n\n"
         "| component | what it is |\n|---|---|\n";
  for (const auto& [name, entry] : entries)
    out << "| [`" << name << "`](" << entry.page << ") | " << entry.purpose << " |\n";
  return out.str();
}

TEST(ComponentIndex, IsMadeFromTheDeclarations) {
  const std::string expected = page();
  if (std::getenv("KERF_WRITE_PAGES") != nullptr) std::ofstream(kPage) << expected;
  std::ifstream file(kPage);
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), expected) << "docs/components/index.md is stale";
}

}  // namespace
}  // namespace kerf::components
