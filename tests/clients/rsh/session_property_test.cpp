// Whatever bytes come, in whatever pieces: a session answers in whole lines, keeps within its bounds, and commands nothing that was
// not asked for by a good line of an enabled connection.
//   session_property_test --count=N --seed=S
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <string>

#include "clients/rsh/fake_machine.hpp"
#include "clients/rsh/text.hpp"

namespace kerf::rsh::test {
namespace {

long count = 2000;
unsigned seed = 1;

using Random = std::mt19937_64;

std::size_t below(Random& r, std::size_t n) { return static_cast<std::size_t>(r() % n); }

std::string word(Random& r) {
  static const char* const kWords[]{"get",  "set", "hello", "EMC",   "EMCTOO", "help", "on",
                                    "off",  "-1",  "0",     "x",     "1e3",    "done", "received",
                                    "\xff", "%s",  "nan",   "1e999", "",       "q",    "quit"};
  const auto rows = subcommands();
  switch (below(r, 4)) {
    case 0: return rows[below(r, rows.size())].name;
    case 1: {
      std::string bytes(below(r, 12), ' ');
      for (char& c : bytes) c = static_cast<char>(below(r, 256));
      return bytes;
    }
    default: return kWords[below(r, std::size(kWords))];
  }
}

std::string random_line(Random& r) {
  std::string out;
  if (below(r, 3) == 0) out = below(r, 2) == 0 ? "get " : "set ";
  for (std::size_t n = below(r, 5); n > 0; --n) out += word(r) + " ";
  if (below(r, 200) == 0) out += std::string(below(r, 10000), 'a');
  static const char* const kEnds[]{"\r\n", "\n", "\r", "\n\r"};
  return out + kEnds[below(r, 4)];
}

void expect_whole_lines(const std::string& output) {
  if (output.empty()) return;
  ASSERT_GE(output.size(), 2U);
  EXPECT_EQ(output.substr(output.size() - 2), "\r\n");
}

TEST(RshSessionProperty, SurvivesAnyBytesAndMovesNothingUnasked) {
  for (long n = 0; n < count; ++n) {
    SCOPED_TRACE("--seed=" + std::to_string(seed + static_cast<unsigned>(n)) + " --count=1");
    Random r(seed + static_cast<unsigned>(n));
    Shell shell;
    shell.enable_password = "cannot be typed";
    FakeMachine machine;
    Session session(shell, machine, 1);
    std::string bytes = below(r, 2) == 0 ? "hello EMC c 1.1\r\n" : "";
    for (std::size_t lines = below(r, 40); lines > 0; --lines) bytes += random_line(r);
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t piece = 1 + below(r, 64);
      session.feed(std::string_view(bytes).substr(at, piece), 0);
      session.step(0);
      expect_whole_lines(session.take_output());
      at += piece;
    }
    EXPECT_TRUE(machine.sent.empty()) << machine.sent[0];
    EXPECT_FALSE(shell.shutdown);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(RshSessionProperty, PiecesDoNotMatter) {
  for (long n = 0; n < count; ++n) {
    SCOPED_TRACE("--seed=" + std::to_string(seed + static_cast<unsigned>(n)) + " --count=1");
    Random r(seed + static_cast<unsigned>(n));
    std::string bytes = "hello EMC c 1.1\nset enable EMCTOO\nset verbose on\n";
    for (std::size_t lines = below(r, 20); lines > 0; --lines) bytes += random_line(r);
    std::string whole, parts;
    std::vector<std::string> sent_whole;
    {
      Shell shell;
      FakeMachine machine;
      machine.now.homed.fill(1);
      Session session(shell, machine, 1);
      session.feed(bytes, 0);
      session.step(0);
      whole = session.take_output();
      sent_whole = machine.sent;
    }
    Shell shell;
    FakeMachine machine;
    machine.now.homed.fill(1);
    Session session(shell, machine, 1);
    for (const char c : bytes) {
      session.feed(std::string_view(&c, 1), 0);
      parts += session.take_output();
    }
    session.step(0);
    parts += session.take_output();
    // Waiting for a heartbeat that never comes: what comes later in pieces may be urgent.
    if (session.waits()) continue;
    EXPECT_EQ(whole, parts);
    EXPECT_EQ(sent_whole, machine.sent);
    if (testing::Test::HasFailure()) return;
  }
}

/// An enabled session whose machine answers late, wrongly, or never.
TEST(RshSessionProperty, LateOutcomesNeverStallOrOverflowIt) {
  for (long n = 0; n < count; ++n) {
    SCOPED_TRACE("--seed=" + std::to_string(seed + static_cast<unsigned>(n)) + " --count=1");
    Random r(seed + static_cast<unsigned>(n));
    Shell shell;
    FakeMachine machine;
    machine.answer = nullptr;
    machine.now.homed.fill(1);
    Session session(shell, machine, 1);
    rtapi::Nanos now = 0;
    session.feed("hello EMC c 1.1\nset enable EMCTOO\nset timeout 1\n", now);
    for (int step = 0; step < 60 && !session.ended(); ++step) {
      if (session.takes_input()) session.feed(random_line(r), now);
      for (std::size_t k = below(r, 3); k > 0 && machine.last_id > 0; --k)
        machine.reply(1 + below(r, machine.last_id), static_cast<task::CommandState>(below(r, 5)),
                      "why");
      if (below(r, 4) == 0) now += rtapi::kSecond;
      machine.now.heartbeat += below(r, 2);
      session.step(now);
      expect_whole_lines(session.take_output());
    }
    // With time and an answering machine it always comes to its end.
    machine.answer = &FakeMachine::done;
    for (int step = 0; step < 4000 && !session.idle(); ++step) {
      now += 2 * rtapi::kSecond;
      ++machine.now.heartbeat;
      session.step(now);
    }
    EXPECT_TRUE(session.idle() || session.ended());
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace kerf::rsh::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  for (int i = 1; i < argc; ++i) {
    const std::string text = argv[i];
    if (text.rfind("--count=", 0) == 0)
      kerf::rsh::test::count = std::strtol(argv[i] + 8, nullptr, 10);
    if (text.rfind("--seed=", 0) == 0)
      kerf::rsh::test::seed = static_cast<unsigned>(std::strtoul(argv[i] + 7, nullptr, 10));
  }
  return RUN_ALL_TESTS();
}
