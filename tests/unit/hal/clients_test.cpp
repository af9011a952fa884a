// What other processes may ask of the host, and what happens when they ask for nonsense.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>

#include "unit/hal/fixture.hpp"

namespace kerf::hal::test {
namespace {

using testing::HasSubstr;

class ClientsTest : public HostTest {
 protected:
  static constexpr std::uint64_t kBase = 0x7f0000000000;
  const Caller a{.client = 1, .pid = 101, .process = 11};
  const Caller a2{.client = 2, .pid = 101, .process = 11};  // the same process, another connection
  const Caller b{.client = 3, .pid = 102, .process = 12};

  Reply ask(const Caller& who, const std::vector<std::string>& argv) {
    return host_->command(argv, who);
  }
  std::string answer(const Caller& who, const std::vector<std::string>& argv) {
    const Reply reply = ask(who, argv);
    EXPECT_TRUE(reply.ok()) << argv[0] << ": " << reply.text;
    return reply.text;
  }
  std::string refusal(const Caller& who, const std::vector<std::string>& argv) {
    const Reply reply = ask(who, argv);
    EXPECT_FALSE(reply.ok()) << argv[0];
    return reply.text;
  }
  std::uint64_t offset(const std::string& text) { return std::stoull(text); }
  template <class T>
  T& at(std::uint64_t place) {
    return *segment_->at<T>(place);
  }
  void expect_whole() {
    const auto checked = host_->registry().check_invariants();
    EXPECT_TRUE(checked.ok()) << checked.error().message();
  }
};

TEST_F(ClientsTest, CellsFollowTheLinkOfTheirPin) {
  const auto memory = offset(answer(a, {"mem-new", "64"}));
  ASSERT_TRUE(ask(a, {"comp-new", "u", std::to_string(kBase)}).ok());
  answer(a2, {"mem-new", "8"});  // of no importance, and of the same process
  answer(a, {"pin-new", "u", "u.in", "s32", "IN", "5", std::to_string(memory + 8)});
  const auto pointed = [&]() -> std::int32_t& {
    return at<std::int32_t>(at<std::uint64_t>(memory + 8) - kBase);
  };
  EXPECT_EQ(pointed(), 5);
  ok({"newsig", "s", "s32"});
  ok({"sets", "s", "7"});
  ok({"loadrt", "adder"});
  ok({"net", "s", "adder.0.out", "u.in"});
  ok({"unlinkp", "adder.0.out"});
  ok({"sets", "s", "9"});
  EXPECT_EQ(pointed(), 9);
  ok({"delsig", "s"});
  pointed() = 11;
  EXPECT_EQ(value("u.in"), "11");
  expect_whole();
}

TEST_F(ClientsTest, NativeParametersLiveInTheProgramsMemory) {
  const auto memory = offset(answer(a, {"mem-new", "64"}));
  answer(a, {"comp-new", "u", std::to_string(kBase)});
  at<double>(memory + 16) = 2.5;
  at<std::uint8_t>(memory + 3) = 1;
  answer(a, {"param-new", "u", "u.gain", "float", "RW", "0", std::to_string(memory + 16)});
  answer(a, {"param-new", "u", "u.on", "bit", "RO", "", std::to_string(memory + 3)});
  EXPECT_EQ(value("u.gain"), "2.5");
  EXPECT_EQ(value("u.on"), "TRUE");
  ok({"setp", "u.gain", "4"});
  EXPECT_EQ(at<double>(memory + 16), 4);
  expect_whole();
}

TEST_F(ClientsTest, PlacesAreTakenFromTheProgramsOwnMemoryOnly) {
  const auto memory = offset(answer(a, {"mem-new", "64"}));
  const auto foreign = offset(answer(b, {"mem-new", "64"}));
  answer(a, {"comp-new", "u", std::to_string(kBase)});
  const auto pin = [&](std::uint64_t place) {
    return refusal(a, {"pin-new", "u", "u.in", "float", "IN", "0", std::to_string(place)});
  };
  for (const std::uint64_t place :
       {std::uint64_t{0}, std::uint64_t{8}, memory - 8, memory + 64, memory + 1'000'000, foreign,
        std::uint64_t{1} << 40U, UINT64_MAX, UINT64_MAX - 7}) {
    EXPECT_THAT(pin(place), HasSubstr("not in memory that this program has")) << place;
  }
  EXPECT_THAT(pin(memory + 4), HasSubstr("not aligned"));
  EXPECT_THAT(pin(memory + 60), HasSubstr("not in memory"));
  EXPECT_THAT(refusal(a, {"param-new", "u", "u.p", "u32", "RW", "0", std::to_string(memory + 2)}),
              HasSubstr("not aligned"));
  for (const char* text : {"", "-8", "0x100", "8 ", "99999999999999999999999", "eight"}) {
    EXPECT_THAT(refusal(a, {"pin-new", "u", "u.in", "float", "IN", "0", text}),
                HasSubstr("not a decimal number"));
  }
  answer(a, {"comp-new", "w"});
  EXPECT_THAT(refusal(a, {"pin-new", "w", "w.in", "bit", "IN", "0", std::to_string(memory)}),
              HasSubstr("comp-new NAME BASE"));
  for (const char* base : {"0", "4097", "-4096", "18446744073709547520", "x"})
    refusal(a, {"comp-new", "v", base});
  EXPECT_TRUE(view_->pins().empty());
  EXPECT_TRUE(view_->params().empty());
  expect_whole();
}

TEST_F(ClientsTest, SizesThatCannotBeAreRefused) {
  for (const char* size :
       {"0", "-1", "18446744073709551615", "18446744073709551552", "1e6", "", "68719476736"}) {
    refusal(a, {"mem-new", size});
    refusal(a, {"shm-new", "m", size, "1"});
  }
  EXPECT_THAT(refusal(a, {"mem-new", std::to_string(segment_->header().size)}),
              HasSubstr("[KERF]SEGMENT_MB"));
  answer(a, {"mem-new", "1"});
  expect_whole();
}

TEST_F(ClientsTest, MemoryOutlivesTheConnectionAndGoesWithTheProcess) {
  const auto first = offset(answer(a, {"mem-new", "4096"}));
  at<std::uint64_t>(first) = 77;
  answer(a, {"comp-new", "u", std::to_string(kBase)});
  answer(a, {"pin-new", "u", "u.in", "bit", "IN", "0", std::to_string(first + 8)});
  host_->client_gone(a.client);
  EXPECT_FALSE(view_->find_component("u").has_value());
  EXPECT_TRUE(host_->holds(a.process));
  EXPECT_NE(offset(answer(b, {"mem-new", "4096"})), first);
  EXPECT_EQ(at<std::uint64_t>(first), 77U);
  host_->process_gone(a.process);
  EXPECT_FALSE(host_->holds(a.process));
  host_->process_gone(b.process);
  const auto bytes = host_->registry().arena_bytes();
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Caller c{.client = 100 + i, .pid = 1, .process = 100 + i};
    answer(c, {"mem-new", "100000"});
    answer(c, {"comp-new", "u"});
    answer(c, {"pin-new", "u", "u.in", "bit", "IN"});
    host_->client_gone(c.client);
    host_->process_gone(c.process);
  }
  EXPECT_LE(host_->registry().arena_bytes(), bytes + 200'000);
  expect_whole();
}

TEST_F(ClientsTest, NamedMemoryIsThereUntilItsLastUserLeaves) {
  const auto place = answer(a, {"shm-new", "stream-00000001", "1000", "7"});
  EXPECT_EQ(answer(b, {"shm-new", "stream-00000001", "1000", "7"}), place);
  EXPECT_EQ(view_->find_memory("stream-00000001")->bytes, 1000U);
  EXPECT_THAT(refusal(b, {"shm-new", "stream-00000001", "1000", "8"}), HasSubstr("abi 7"));
  EXPECT_THAT(refusal(b, {"shm-new", "stream-00000001", "1001", "7"}), HasSubstr("1000 bytes"));
  host_->client_gone(a.client);
  host_->process_gone(a.process);
  EXPECT_TRUE(view_->find_memory("stream-00000001").has_value());
  answer(b, {"shm-drop", "stream-00000001"});
  EXPECT_FALSE(view_->find_memory("stream-00000001").has_value());
  EXPECT_THAT(refusal(b, {"shm-drop", "stream-00000001"}), HasSubstr("no memory"));
  // A component's block is found, and stays the component's.
  ok({"loadrt", "faulty", "count=1"});
  answer(b, {"shm-new", "faulty", "64", "1"});
  refusal(b, {"shm-drop", "faulty"});
  ok({"unloadrt", "faulty"});
  EXPECT_FALSE(view_->find_memory("faulty").has_value());
  expect_whole();
}

TEST_F(ClientsTest, OnlyItsOwnClientChangesAComponent) {
  answer(a, {"comp-new", "u"});
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"pin-new", "u", "u.x", "bit", "IN"},
                                             {"comp-ready", "u"},
                                             {"comp-unready", "u"},
                                             {"comp-exit", "u"}}) {
    EXPECT_THAT(refusal(b, words), HasSubstr("belongs to another client"));
    EXPECT_THAT(refusal(a2, words), HasSubstr("belongs to another client"));
  }
  answer(a, {"comp-ready", "u"});
  refusal(a, {"pin-new", "u", "u.x", "bit", "IN"});
  answer(a, {"comp-unready", "u"});
  EXPECT_FALSE(view_->find_component("u")->ready);
  answer(a, {"pin-new", "u", "u.x", "bit", "IN"});
  answer(a, {"comp-ready", "u"});
}

TEST_F(ClientsTest, AliasesAreSecondNames) {
  ok({"loadrt", "adder"});
  ok({"alias", "pin", "adder.0.out", "sum"});
  EXPECT_EQ(value("sum"), "0");
  ok({"net", "s", "sum"});
  EXPECT_EQ(refused({"alias", "pins", "adder.0.in", "i"}),
            "alias: 'pins' is neither pin nor param");
  ok({"unalias", "pin", "sum"});
  EXPECT_FALSE(view_->find_pin("sum").has_value());
  expect_whole();
}

/// Three programs that send anything: true commands with words of others, numbers from the edges, offsets of each other's memory.
/// Nothing but errors may come of it.
TEST_F(ClientsTest, ProgramsThatSendAnythingHurtNobody) {
  ok({"loadrt", "test-threads", "name1=t", "period1=1000000"});
  ok({"start"});
  const std::vector<std::string> commands = {
      "loadrt",    "unloadrt",    "net",          "newsig",    "delsig",   "linkps",
      "linksp",    "linkpp",      "unlinkp",      "setp",      "sets",     "addf",
      "delf",      "start",       "alias",        "unalias",   "comp-new", "pin-new",
      "param-new", "comp-ready",  "comp-unready", "comp-exit", "mem-new",  "shm-new",
      "shm-drop",  "hold-values", "batch",        "timing",    "nonsense"};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    std::mt19937_64 random(seed);
    const auto any = [&](std::uint64_t n) { return random() % n; };
    std::vector<std::string> words = {"adder",
                                      "adder.0",
                                      "adder.0.in",
                                      "adder.0.out",
                                      "t",
                                      "u",
                                      "v",
                                      "u.a",
                                      "u.b",
                                      "v.a",
                                      "s",
                                      "r",
                                      "bit",
                                      "s32",
                                      "u32",
                                      "s64",
                                      "u64",
                                      "float",
                                      "port",
                                      "IN",
                                      "OUT",
                                      "IO",
                                      "RW",
                                      "RO",
                                      "pin",
                                      "param",
                                      "0",
                                      "1",
                                      "-1",
                                      "8",
                                      "64",
                                      "4096",
                                      "TRUE",
                                      "3.5",
                                      "count=2",
                                      "names=u,v",
                                      "18446744073709551615",
                                      "9223372036854775807",
                                      std::to_string(kBase),
                                      "",
                                      "=>",
                                      "all"};
    const std::size_t fixed = words.size();
    const std::array<Caller, 3> callers = {a, b, Caller{.client = 9, .pid = 1, .process = 13}};
    for (int i = 0; i < 20'000; ++i) {
      std::vector<std::string> argv = {commands[any(commands.size())]};
      for (std::uint64_t n = any(8); n > 0; --n) argv.push_back(words[any(words.size())]);
      const Caller& who = callers[any(callers.size())];
      const Reply reply = host_->command(argv, who);
      if (reply.ok() && argv[0] == "mem-new") {
        for (const int more : {0, 8, 56, 61}) {
          words.push_back(std::to_string(std::stoull(reply.text) + static_cast<unsigned>(more)));
        }
        if (words.size() > fixed + 40) words.erase(words.begin() + static_cast<long>(fixed));
      }
      if (any(50) == 0 && !host_->threads().empty()) cycle();
      if (any(500) == 0) host_->client_gone(who.client);
      if (any(1000) == 0) {
        host_->client_gone(who.client);
        host_->process_gone(who.process);
      }
    }
    const auto checked = host_->registry().check_invariants();
    ASSERT_TRUE(checked.ok()) << "seed " << seed << ": " << checked.error().message();
    for (const Caller& who : callers) {
      host_->client_gone(who.client);
      host_->process_gone(who.process);
    }
    ok({"unloadrt", "all"});
    for (const auto& signal : view_->signals()) ok({"delsig", signal.name});
    EXPECT_TRUE(view_->components().empty());
    EXPECT_TRUE(view_->pins().empty());
    ok({"loadrt", "test-threads", "name1=t", "period1=1000000"});
    expect_whole();
  }
}

}  // namespace
}  // namespace kerf::hal::test
