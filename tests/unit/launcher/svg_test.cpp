#include "launcher/svg.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::launcher {
namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

std::vector<PathPiece> part() {
  return {{true, 0, {{0, 0, 0}, {10, 10, 0}}},
          {false, 300, {{10, 10, 0}, {10, 10, -5}}},
          {false, 1200, {{10, 10, -5}, {60, 10, -5}, {60, 40, -5}}}};
}

TEST(Svg, HasThreeViewsALegendAndOneCurveAFeed) {
  const std::string svg = draw_toolpath(part(), {"part.ngc", "a run"});
  EXPECT_EQ(svg.rfind("<svg", 0), 0U);
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
  for (const char* view : {"<g id='top'>", "<g id='front'>", "<g id='isometric'>"})
    EXPECT_EQ(count(svg, view), 1U) << view;
  EXPECT_EQ(count(svg, "F 300 mm/min"), 3U);
  EXPECT_EQ(count(svg, "F 1200 mm/min"), 3U);
  EXPECT_EQ(count(svg, "class='p r'"), 4U);  // three views and the legend
  EXPECT_EQ(count(svg, "X [mm]"), 2U);
  EXPECT_EQ(count(svg, "Z [mm]"), 1U);
  EXPECT_NE(svg.find(">300</text>"), std::string::npos);
}

TEST(Svg, TagsAreBalancedAndTextIsEscaped) {
  const std::string svg = draw_toolpath(part(), {"a<b>&'c'.ngc", "\"quoted\""});
  EXPECT_EQ(svg.find("a<b>"), std::string::npos);
  EXPECT_NE(svg.find("a&lt;b&gt;&amp;&#39;c&#39;.ngc"), std::string::npos);
  for (const char* tag : {"g", "text", "title", "svg", "style"})
    EXPECT_EQ(count(svg, std::string("</") + tag + ">"),
              count(svg, std::string("<") + tag + ">") + count(svg, std::string("<") + tag + " ") -
                  (std::string(tag) == "g" ? 0 : 0))
        << tag;
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(Svg, NothingThatMovedIsAPictureToo) {
  const std::string svg = draw_toolpath({}, {"empty.ngc", ""});
  EXPECT_NE(svg.find("nothing moved"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Svg, OneAxisAloneIsDrawn) {
  const std::string svg = draw_toolpath({{false, 100, {{0, 0, 0}, {0, 0, -10}}}}, {"z.ngc", ""});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_EQ(count(svg, "F 100 mm/min"), 3U);
}

TEST(Svg, ManyFeedsGetAColourBar) {
  std::vector<PathPiece> pieces;
  for (int i = 0; i < 20; ++i)
    pieces.push_back({false, 100.0 + i, {{0, i * 1.0, 0}, {10, i * 1.0, 0}}});
  const std::string svg = draw_toolpath(pieces, {"many.ngc", ""});
  EXPECT_NE(svg.find("linearGradient"), std::string::npos);
}

TEST(Svg, SizeStaysReasonable) {
  PathPiece piece{false, 500, {}};
  for (int i = 0; i < 100'000; ++i)
    piece.points.push_back({50 * std::cos(i * 1e-2), 50 * std::sin(i * 1e-2), -i * 1e-4});
  EXPECT_LT(draw_toolpath({piece}, {"helix.ngc", ""}).size(), 3'000'000U);
}

TEST(Svg, NiceSteps) {
  EXPECT_DOUBLE_EQ(nice_step(100, 10), 10);
  EXPECT_DOUBLE_EQ(nice_step(300, 8), 50);
  EXPECT_DOUBLE_EQ(nice_step(150, 8), 20);
  EXPECT_NEAR(nice_step(0.9, 8), 0.1, 1e-12);
}

TEST(Svg, Colours) {
  EXPECT_EQ(feed_colour(0), "#2646a0");
  EXPECT_EQ(feed_colour(1), "#d63c28");
  EXPECT_EQ(feed_colour(-5), feed_colour(0));
  EXPECT_EQ(feed_colour(7), feed_colour(1));
}

}  // namespace
}  // namespace kerf::launcher
