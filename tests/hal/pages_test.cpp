// Golden texts: graph/NAME.dot is the picture of graph/NAME.hal, describe/ has pages of components. KERF_GOLDEN_UPDATE=1 writes
// them anew.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "hal/cmd/check.hpp"
#include "hal/cmd/describe.hpp"
#include "hal/cmd/graph.hpp"
#include "hal/golden.hpp"

namespace kerf::hal::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const fs::path kFolder = hal_tests();

std::string graph_of(const std::string& script, const GraphOptions& options = {}) {
  StaticSource modules(static_components());
  ScriptCheck check(modules, nullptr);
  check.run_text(script, "test.hal");
  std::vector<StrangePin> strangers;
  for (const auto& pin : check.trace().unchecked)
    strangers.push_back({pin.name, pin.signal, pin.dir});
  return graph_dot(check.view(), options, strangers);
}

class HalGraph : public testing::TestWithParam<const char*> {};

TEST_P(HalGraph, DrawsWhatIsExpected) {
  const fs::path folder = kFolder / "graph";
  expect_file(folder / (std::string(GetParam()) + ".dot"),
              graph_of(read_file(folder / (std::string(GetParam()) + ".hal"))));
}
INSTANTIATE_TEST_SUITE_P(Scripts, HalGraph, testing::Values("chain", "feedback", "panel"));

constexpr const char* kTwoChains =
    "loadrt not names=a,b,x,y\n"
    "loadrt threads name1=servo\n"
    "addf a servo\naddf b servo\naddf x servo\naddf y servo\n"
    "net ab a.out => b.in\n"
    "net xy x.out => y.in\n"
    "setp a.in TRUE\n";

TEST(HalGraphOptions, PatternsTakeWhatTheyNameAndItsNeighbours) {
  GraphOptions options;
  options.patterns = {"a"};
  const std::string text = graph_of(kTwoChains, options);
  EXPECT_THAT(text, HasSubstr("\"a\":\"a.out\":e -> \"b\":\"b.in\":w"));
  EXPECT_THAT(text, Not(HasSubstr("x.out")));
  options.patterns = {"xy"};
  EXPECT_THAT(graph_of(kTwoChains, options), HasSubstr("\"x\":\"x.out\":e"));
}

TEST(HalGraphOptions, ValuesAndAllPins) {
  GraphOptions options;
  EXPECT_THAT(graph_of(kTwoChains, options), Not(HasSubstr("TRUE")));
  EXPECT_THAT(graph_of(kTwoChains, options), HasSubstr("1 not linked"));
  options.values = options.all_pins = true;
  const std::string text = graph_of(kTwoChains, options);
  EXPECT_THAT(text,
              HasSubstr("port=\"a.in\" align=\"left\">in <font color=\"#777777\">TRUE</font>"));
  EXPECT_THAT(text, HasSubstr("label=\"ab = FALSE\""));
  EXPECT_THAT(text, Not(HasSubstr("not linked")));
}

TEST(HalGraphBoxes, AreInstancesOrNumberedParts) {
  const std::vector<std::string> functions{"left.gate", "siggen.0.update", "motion-controller"};
  EXPECT_EQ(box_of("and2.0.in0", {}), "and2.0");
  EXPECT_EQ(box_of("joint.0.motor-pos-cmd", functions), "joint.0");
  EXPECT_EQ(box_of("left.gate.in", functions), "left.gate");
  EXPECT_EQ(box_of("siggen.0.sine", functions), "siggen.0");
  EXPECT_EQ(box_of("hm2_7i96.0.stepgen.00.position-cmd", {}), "hm2_7i96.0.stepgen.00");
  EXPECT_EQ(box_of("axis.x.jog-enable", {}), "axis");
  EXPECT_EQ(box_of("sampler.0.pin.3", {}), "sampler.0");
}

class HalDescribe : public testing::TestWithParam<const char*> {};

TEST_P(HalDescribe, PagesComeFromTheDeclaration) {
  StaticSource modules(static_components());
  Describer describer(modules);
  const auto declaration = describer.describe(GetParam());
  ASSERT_TRUE(declaration.ok());
  expect_file(kFolder / "describe" / (std::string(GetParam()) + ".txt"),
              man_page(*declaration) + markdown_page(*declaration) + text_page(*declaration) +
                  declaration_json(*declaration));
}
INSTANTIATE_TEST_SUITE_P(Components, HalDescribe, testing::Values("and2", "sampler"));

TEST(HalDescribeAll, EveryComponentDeclaresItselfWithoutHelp) {
  StaticSource modules(static_components());
  Describer describer(modules);
  for (const auto& name : modules.names()) {
    const auto declaration = describer.describe(name);
    ASSERT_TRUE(declaration.ok()) << name;
    EXPECT_EQ(declaration->incomplete, "") << name << ": give kInfo.example";
    EXPECT_NE(declaration->summary, "") << name;
  }
}

TEST(HalDescribeAll, UnknownNameGetsTheNearest) {
  StaticSource modules(static_components());
  Describer describer(modules);
  const auto declaration = describer.describe("adn2");
  ASSERT_FALSE(declaration.ok());
  EXPECT_THAT(declaration.error().message(), HasSubstr("did you mean 'and2'"));
}

TEST(HalDescribeGroups, ItemsThatDifferByANumberAreOneEntry) {
  Declaration d;
  for (int i = 0; i < 12; ++i)
    d.items.push_back({"mux.N.in-" + std::string(i < 10 ? "0" : "") + std::to_string(i), Type::bit,
                       Dir::in, 0, "Input"});
  d.items.push_back({"mux.N.out", Type::bit, Dir::out, 0, "Output"});
  const auto groups = grouped(d, true);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].name, "mux.N.in-MM");
  EXPECT_EQ(groups[0].range, "MM from 00 to 11");
  EXPECT_EQ(groups[1].name, "mux.N.out");
}

}  // namespace
}  // namespace kerf::hal::test
