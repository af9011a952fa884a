#include "hal/loader/batch.hpp"

#include "hal/client/request_all.hpp"
#include "unit/hal/fixture.hpp"

namespace kerf::hal::test {
namespace {

std::span<const std::string> behind_name(const std::vector<std::string>& words) {
  return std::span<const std::string>(words).subspan(1);
}

TEST(Batch, CommandsComeBackAsTheyWere) {
  const std::vector<Command> commands{
      {"net", "a", "b c"}, {}, {""}, {"setp", std::string("\0x", 2), "\xff"}};
  for (const bool keep_going : {false, true}) {
    const auto words = encode_batch(commands, keep_going);
    EXPECT_EQ(words[0], "batch");
    const auto batch = decode_batch(behind_name(words));
    ASSERT_TRUE(batch.has_value());
    EXPECT_EQ(batch->keep_going, keep_going);
    EXPECT_EQ(batch->commands, commands);
  }
}

TEST(Batch, WordsThatAreNoneAreRefused) {
  using Words = std::vector<std::string>;
  for (const Words& words :
       {Words{}, Words{"some"}, Words{"all", "x"}, Words{"all", "-1", "a"}, Words{"stop", "2", "a"},
        Words{"stop", "1"}, Words{"all", "1x", "a"}, Words{"all", "99999999999999999999", "a"}})
    EXPECT_FALSE(decode_batch(words).has_value()) << testing::PrintToString(words);
  EXPECT_TRUE(decode_batch(Words{"all"})->commands.empty());
}

TEST(Batch, FailuresComeBackAndHalfOnesAreRefused) {
  const std::vector<ReplyPacket> failures{{0, 5, "first"}, {77, 1, ""}, {78, 2, "x\ny"}};
  const std::string text = encode_failures(failures);
  const auto back = decode_failures(text);
  ASSERT_TRUE(back.has_value());
  ASSERT_EQ(back->size(), 3U);
  EXPECT_EQ((*back)[1].id, 77U);
  EXPECT_EQ((*back)[2].text, "x\ny");
  for (std::size_t n = 1; n < text.size(); ++n) {
    const auto half = decode_failures(std::string_view(text).substr(0, n));
    EXPECT_TRUE(!half.has_value() || half->size() < 3U) << n;
  }
}

using BatchTest = HostTest;

TEST_F(BatchTest, StopsAtTheFirstFailureOrGoesOn) {
  LocalSession session(*host_);
  ok({"loadrt", "adder", "names=a"});
  const std::vector<Command> commands{
      {"newsig", "s", "bit"}, {"nonsense"}, {"newsig", "t", "bit"}, {"batch", "all"}};
  auto refused = request_all(session, commands, false);
  ASSERT_TRUE(refused.ok());
  ASSERT_EQ(refused->size(), 1U);
  EXPECT_EQ((*refused)[0].index, 1U);
  EXPECT_TRUE(view_->find_signal("s").has_value());
  EXPECT_FALSE(view_->find_signal("t").has_value());
  const auto first_three = std::span<const Command>(commands).first(3);
  refused = request_all(session, first_three, true);
  ASSERT_EQ(refused->size(), 2U);
  EXPECT_EQ((*refused)[0].reply.text, "duplicate signal 's'");
  EXPECT_TRUE(view_->find_signal("t").has_value());
  // No batch within a batch.
  EXPECT_FALSE(request_all(session, commands, true).ok());
}

/// More than one packet holds: the places of the failures are still those of the commands.
TEST_F(BatchTest, LongListsAreSplit) {
  LocalSession session(*host_);
  std::vector<Command> commands;
  for (int i = 0; i < 5000; ++i)
    commands.push_back({"newsig", "signal" + std::to_string(i), "bit"});
  commands[4321] = {"delsig", "no-such-signal-at-all"};
  auto refused = request_all(session, commands, true);
  ASSERT_TRUE(refused.ok());
  ASSERT_EQ(refused->size(), 1U);
  EXPECT_EQ((*refused)[0].index, 4321U);
  EXPECT_EQ(view_->names(Kind::signal).size(), 4999U);
}

}  // namespace
}  // namespace kerf::hal::test
