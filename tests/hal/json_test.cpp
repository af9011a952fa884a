// What halcmd --json prints, and that docs/hal-json.md tells of each key.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "hal/cmd/check.hpp"
#include "hal/cmd/commander.hpp"
#include "hal/script_machine.hpp"

namespace kerf::hal::test {
namespace {

using nlohmann::json;
using Keys = std::set<std::string>;

/// Keys of the table under "# NAME" or "## NAME" ... of docs/hal-json.md.
Keys documented(const std::string& name) {
  std::ifstream in(std::string(KERF_SOURCE_DIR) + "/docs/hal-json.md");
  Keys out;
  bool here = false;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind('#', 0) == 0) here = line.substr(line.find_first_not_of('#') + 1) == name;
    if (here && line.rfind("| `", 0) == 0) out.insert(line.substr(3, line.find('`', 3) - 3));
  }
  return out;
}

Keys keys(const json& object) {
  Keys out;
  for (const auto& [key, value] : object.items()) out.insert(key);
  return out;
}

struct JsonMachine : ScriptMachine {
  class Both final : public CommandSink {
   public:
    void out(std::string_view t) override { stdout_text += t; }
    void err(std::string_view t) override { stderr_text += t; }
    std::string stdout_text, stderr_text;
  };
  Both sink;
  Commander commander{session, {}, &sink};

  JsonMachine() {
    commander.set_clock(&clock);
    commander.set_json(true);
  }
  void script(const std::string& text) {
    ASSERT_TRUE(commander.run_text(text, "test.hal")) << sink.stderr_text;
  }
  json print(const std::string& line) {
    sink.stdout_text.clear();
    EXPECT_TRUE(commander.run_line(line, "test.hal", 1)) << sink.stderr_text;
    return json::parse(sink.stdout_text);
  }
  /// A pin with a value, whatever its type.
  json value_of(const std::string& type, const std::string& text) {
    const std::string name = "c" + std::to_string(count_++);
    for (const auto& words : {std::vector<std::string>{"comp-new", name},
                              {"pin-new", name, name + ".p", type, "IN"},
                              {"comp-ready", name},
                              {"setp", name + ".p", text}}) {
      const auto reply = session.request(words);
      EXPECT_TRUE(reply.ok() && reply->ok()) << words[0] << ": " << reply->text;
    }
    return print("getp " + name + ".p").at("value");
  }

 private:
  int count_{0};
};

constexpr const char* kScript =
    "loadrt and2 count=2\n"
    "loadrt threads name1=servo\n"
    "addf and2.1 servo\n"
    "addf and2.0 servo\n"
    "net a and2.0.out => and2.1.in0 and2.1.in1\n"
    "alias pin and2.0.in0 start-button\n"
    "start\n"
    "sleep 0.01\n";

TEST(HalJson, ShowsEachKindWithTheKeysOfItsDocument) {
  JsonMachine machine;
  machine.script(kScript);
  const json all = machine.print("show all");
  EXPECT_EQ(keys(all), documented("show"));
  EXPECT_EQ(keys(all["components"][0]), documented("component"));
  EXPECT_EQ(keys(all["aliases"][0]), documented("alias"));
  EXPECT_EQ(keys(all["pins"][0]), documented("pin"));
  EXPECT_EQ(keys(all["parameters"][0]), documented("parameter"));
  EXPECT_EQ(keys(all["signals"][0]), documented("signal"));
  EXPECT_EQ(keys(all["functions"][0]), documented("function"));
  EXPECT_EQ(keys(all["threads"][0]), documented("thread"));
  EXPECT_EQ(keys(all["threads"][0]["timing"]), documented("statistics"));
  EXPECT_EQ(keys(all["threads"][0]["wake_up"]), documented("statistics"));
  EXPECT_EQ(keys(all["threads"][0]["functions"][0]),
            (Keys{"name", "position", "time_ns", "tmax_ns", "timing"}));
  const json status = machine.print("status");
  EXPECT_EQ(keys(status), documented("status"));
  EXPECT_EQ(keys(status["lock"]), documented("lock"));
  EXPECT_EQ(keys(status["memory"]), documented("memory"));
  EXPECT_EQ(keys(status["memory"]["pins"]), documented("count"));
}

TEST(HalJson, ShowsHowThingsHangTogether) {
  JsonMachine machine;
  machine.script(kScript);
  const json signal = machine.print("show sig a")["signals"][0];
  EXPECT_EQ(signal["writers"], json({"and2.0.out"}));
  EXPECT_EQ(signal["readers"], json({"and2.1.in0", "and2.1.in1"}));
  EXPECT_EQ(signal["bidirs"], json::array());
  const json thread = machine.print("show thread")["threads"][0];
  EXPECT_EQ(thread["period_ns"], 1'000'000);
  EXPECT_EQ(thread["functions"][0]["name"], "and2.1");
  EXPECT_EQ(thread["functions"][1]["position"], 2);
  const json function = machine.print("show funct and2.0")["functions"][0];
  EXPECT_EQ(function["thread"], "servo");
  EXPECT_EQ(function["position"], 2);
  const json pins = machine.print("show pin and2.1.in0 start");
  EXPECT_EQ(keys(pins), Keys{"pins"});
  ASSERT_EQ(pins["pins"].size(), 2U);
  EXPECT_EQ(pins["pins"][0]["signal"], "a");
  EXPECT_EQ(pins["pins"][0]["original_name"], nullptr);
  EXPECT_EQ(pins["pins"][1]["original_name"], "and2.0.in0");
  EXPECT_EQ(pins["pins"][1]["signal"], nullptr);
  EXPECT_EQ(machine.print("show alias")["aliases"][0]["alias"], "start-button");
  EXPECT_EQ(machine.print("show pinexact and2.1.in")["pins"].size(), 0U);
  EXPECT_EQ(machine.print("list sig"), json({"a"}));
  EXPECT_EQ(machine.print("list comp and2"), json({"and2"}));
}

TEST(HalJson, NumbersAreExact) {
  JsonMachine machine;
  EXPECT_EQ(machine.value_of("bit", "1"), true);
  EXPECT_EQ(machine.value_of("s64", "-9223372036854775808"), INT64_MIN);
  EXPECT_EQ(machine.value_of("u64", "18446744073709551615"), UINT64_MAX);
  EXPECT_EQ(machine.value_of("s32", "-2147483648"), INT32_MIN);
  EXPECT_EQ(machine.value_of("u32", "4294967295"), UINT32_MAX);
  EXPECT_EQ(machine.value_of("float", "0.1"), 0.1);
  EXPECT_TRUE(machine.value_of("float", "3").is_number_float());
  EXPECT_EQ(machine.value_of("float", "nan"), "nan");
  EXPECT_EQ(machine.value_of("float", "inf"), "inf");
  EXPECT_EQ(machine.value_of("float", "-inf"), "-inf");
}

TEST(HalJson, ValuesAndTypesOfOneItem) {
  JsonMachine machine;
  machine.script(kScript);
  EXPECT_EQ(machine.print("getp and2.0.out"),
            json({{"name", "and2.0.out"}, {"type", "bit"}, {"value", false}}));
  EXPECT_EQ(machine.print("gets a"), json({{"name", "a"}, {"type", "bit"}, {"value", false}}));
  EXPECT_EQ(machine.print("ptype and2.0.out"), json({{"name", "and2.0.out"}, {"type", "bit"}}));
  EXPECT_EQ(machine.print("stype a"), json({{"name", "a"}, {"type", "bit"}}));
}

TEST(HalJson, ErrorsAreJsonToo) {
  JsonMachine machine;
  EXPECT_FALSE(machine.commander.run_line("getp nothing", "test.hal", 7));
  const json error = json::parse(machine.sink.stderr_text);
  EXPECT_EQ(keys(error), Keys{"error"});
  EXPECT_EQ(keys(error["error"]), documented("error"));
  EXPECT_EQ(error["error"]["file"], "test.hal");
  EXPECT_EQ(error["error"]["line"], 7);
  EXPECT_THAT(error["error"]["message"].get<std::string>(), testing::HasSubstr("'nothing'"));
}

TEST(HalJson, FindingsOfACheck) {
  StaticSource modules(static_components());
  ScriptCheck check(modules, nullptr);
  check.run_text("loadrt and2\nnet a and2.0.no\nloadusr sh\nnet b panel.x\n", "test.hal");
  const auto findings = check.finish();
  const json out = json::parse(check_json(check, findings));
  EXPECT_EQ(keys(out), documented("check"));
  EXPECT_EQ(keys(out["findings"][0]), documented("finding"));
  EXPECT_EQ(out["errors"], 1);
  EXPECT_EQ(out["unchecked"], json({"panel.x"}));
}

}  // namespace
}  // namespace kerf::hal::test
