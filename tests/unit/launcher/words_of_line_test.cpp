#include <gtest/gtest.h>

#include "launcher/prompt.hpp"

namespace kerf::launcher {
namespace {

using Words = std::vector<std::string>;

TEST(WordsOfLine, CommandsAndGcode) {
  EXPECT_EQ(words_of_line("  G0 X1  "), (Words{"mdi", "G0 X1"}));
  EXPECT_EQ(words_of_line("home"), (Words{"home"}));
  EXPECT_EQ(words_of_line("state on"), (Words{"state", "on"}));
  EXPECT_EQ(words_of_line("open 'my part.ngc'"), (Words{"open", "my part.ngc"}));
  EXPECT_EQ(words_of_line("o<pocket> call [1]"), (Words{"mdi", "o<pocket> call [1]"}));
  EXPECT_TRUE(words_of_line(" \t").empty());
}

}  // namespace
}  // namespace kerf::launcher
