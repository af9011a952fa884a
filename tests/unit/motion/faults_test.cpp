#include "motion/api/faults.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

namespace kerf::motion {
namespace {

TEST(Faults, EachHasANameATextAndAPage) {
  std::set<std::string> names;
  MachineConfig config;
  for (const Fault f : kFaults) {
    const std::string name = fault_name(f);
    EXPECT_NE(name, "unknown") << static_cast<int>(f);
    EXPECT_TRUE(names.insert(name).second) << name;
    FaultRecord r;
    r.fault = f;
    r.index = 1;
    EXPECT_GT(fault_text(r, config).size(), 20U) << name;
    const std::filesystem::path page =
        std::filesystem::path(KERF_SOURCE_DIR) / "docs/troubleshooting" / (name + ".md");
    ASSERT_TRUE(std::filesystem::exists(page)) << page;
    std::ifstream in(page);
    std::string text((std::istreambuf_iterator<char>(in)), {});
    EXPECT_NE(text.find("## What to do"), std::string::npos) << page;
  }
}

TEST(Faults, PagesWithoutAFaultDoNotExist) {
  std::set<std::string> names;
  for (const Fault f : kFaults) names.insert(fault_name(f));
  for (const auto& e : std::filesystem::directory_iterator(std::filesystem::path(KERF_SOURCE_DIR) /
                                                           "docs/troubleshooting"))
    EXPECT_TRUE(e.path().stem() == "README" || names.contains(e.path().stem())) << e.path();
}

TEST(Faults, TextsNameAxisValueAndLimitInMachineUnits) {
  MachineConfig config;
  config.linear_units_per_mm = 1 / 25.4;
  FaultRecord r;
  r.fault = Fault::axis_soft_limit_max;
  r.index = 2;
  r.value = 254;
  r.limit = 127;
  r.tag.line = 42;
  const std::string text = fault_text(r, config);
  for (const char* part : {"axis Z", "10.0000", "5.0000", "line 42", "MAX_LIMIT"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  r.index = 4;
  EXPECT_NE(fault_text(r, config).find("254.0000"), std::string::npos) << "degrees stay degrees";
}

}  // namespace
}  // namespace kerf::motion
