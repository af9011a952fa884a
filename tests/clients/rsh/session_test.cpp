// The remote shell's session, line by line, without a machine. Replies marked (captured) are those of LinuxCNC 2.10.
#include "clients/rsh/session.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>

#include "clients/rsh/fake_machine.hpp"

namespace kerf::rsh::test {
namespace {

using task::CommandState;
using task::MessageKind;

class RshSession : public testing::Test {
 protected:
  /// The replies to one line, as lines with '|' between them.
  std::string ask(const std::string& line, rtapi::Nanos now = 0) {
    session.feed(line + "\r\n", now);
    session.step(now);
    return output();
  }
  std::string output() {
    std::string text = session.take_output(), out;
    for (std::size_t at = 0; at < text.size();) {
      const auto end = text.find("\r\n", at);
      EXPECT_NE(end, std::string::npos) << text;
      if (end == std::string::npos) break;
      out += (out.empty() ? "" : "|") + text.substr(at, end - at);
      at = end + 2;
    }
    return out;
  }
  void enable() {
    ask("hello EMC c 1.1");
    ask("set echo off");
    EXPECT_EQ(ask("set enable EMCTOO"), "");
  }

  Shell shell;
  FakeMachine machine;
  Session session{shell, machine, 4};
};

TEST_F(RshSession, SaysHelloToWhoKnowsThePassword) {
  EXPECT_EQ(ask("hello BAD c 1.1"), "HELLO NAK");  // (captured)
  EXPECT_EQ(ask("hello emc c 1.1"), "HELLO NAK");  // passwords have their case
  EXPECT_EQ(ask("hello EMC c"), "HELLO NAK");
  EXPECT_EQ(ask("hello EMC a client 1.1"), "HELLO NAK");
  EXPECT_EQ(ask("HeLLo EMC c 1.1"), "HELLO ACK EMCNETSVR 1.1");  // (captured)
  EXPECT_EQ(ask("get echo"), "get echo|ECHO ON");
  EXPECT_EQ(ask("SET ECHO OFF"), "SET ECHO OFF");
  EXPECT_EQ(ask("get echo"), "ECHO OFF");
}

TEST_F(RshSession, AnswersGetBeforeHelloAndSetOnlyWhenEnabled) {
  EXPECT_EQ(ask("get estop"), "ESTOP ON");  // (captured)
  EXPECT_EQ(ask("set estop off"),
            "error: Connection must be linked by HELLO for SET ESTOP|SET ESTOP NAK");
  ask("hello EMC c 1.1");
  ask("set echo off");
  EXPECT_EQ(ask("set estop off"),
            "error: Connection must be enabled for SET ESTOP|SET ESTOP NAK");  // (captured)
  EXPECT_EQ(ask("set enable BAD"), "SET ENABLE NAK");                          // (captured)
  EXPECT_EQ(ask("set enable EMCTOO"), "");                                     // (captured)
  EXPECT_EQ(ask("get enable"), "ENABLE ON");
  EXPECT_TRUE(machine.sent.empty());
  EXPECT_EQ(ask("set estop off"), "");
  EXPECT_EQ(ask("set verbose on"), "SET VERBOSE ACK");
  EXPECT_EQ(ask("set machine on"), "SET MACHINE ACK");
  EXPECT_EQ(machine.sent, (std::vector<std::string>{"state estop-reset", "state on"}));
  EXPECT_EQ(ask("set disable"), "SET DISABLE ACK");
  EXPECT_EQ(ask("get enable"), "ENABLE OFF");
  ask("set enable EMCTOO");
  EXPECT_EQ(ask("set enable off"), "SET ENABLE ACK");
  EXPECT_EQ(ask("set mode mdi"), "error: Connection must be enabled for SET MODE|SET MODE NAK");
}

TEST_F(RshSession, NamesWhatIsWrong) {  // all captured, but the last four
  enable();
  EXPECT_EQ(ask("get bogus"), "error: Subcommand not found: GET bogus|GET NAK");
  EXPECT_EQ(ask("set bogus"), "error: Subcommand not found: SET bogus|SET NAK");
  EXPECT_EQ(ask("bogus"), "error: Command 'bogus' not found");
  EXPECT_EQ(ask("set mode bogus"),
            "error: Invalid argument 'bogus', must be {manual,auto,mdi}|SET MODE NAK");
  EXPECT_EQ(ask("set feed_override"),
            "error: Too few arguments to SET FEED_OVERRIDE, have 0, need 1 or more"
            "|SET FEED_OVERRIDE NAK");
  EXPECT_EQ(ask("set feed_override x"),
            "error: Invalid argument 'x', must be floating point|SET FEED_OVERRIDE NAK");
  EXPECT_EQ(ask("set spindle_override 80"),
            "error: Too few arguments to SET SPINDLE_OVERRIDE, have 1, need 2 or more"
            "|SET SPINDLE_OVERRIDE NAK");
  EXPECT_EQ(ask("get joint_pos 9"),
            "error: Invalid joint '9', valid range [-1,2]|GET JOINT_POS NAK");
  EXPECT_EQ(ask("get abs_cmd_pos q"),
            "error: Invalid axis 'q', must be one of XYZABCUVW|GET ABS_CMD_POS NAK");
  EXPECT_EQ(ask("set open nofile.ngc"), "error: File 'nofile.ngc' not found|SET OPEN NAK");
  EXPECT_EQ(ask("get ini NOPE EMC"), "error: INI file entry '[EMC]NOPE' not found|GET INI NAK");
  EXPECT_EQ(ask("get comm_prot"),
            "warning: GET COMM_PROT has been deprecated. It has no function.|COMM_PROT 1.1");
  EXPECT_EQ(ask("set debug 1.5"), "error: Invalid argument '1.5', must be integer|SET DEBUG NAK");
  EXPECT_EQ(ask("set jog 0 10 5"),
            "error: Too many arguments to SET JOG, have 3, need at most 2|SET JOG NAK");
  EXPECT_EQ(ask("set jog 7 10"), "error: Invalid joint '7', valid range [0,2]|SET JOG NAK");
  EXPECT_EQ(ask("get"), "error: Too few arguments to GET, have 0, need 1 or more|GET NAK");
  for (const char* bad : {"nan", "inf", "1e999", "0x10", "1,5", "--1", ""})
    EXPECT_NE(ask(std::string("set feed_override ") + bad).find("NAK"), std::string::npos) << bad;
  EXPECT_TRUE(machine.sent.empty());
}

TEST_F(RshSession, AnswersInTheDocumentedForms) {  // captured forms
  enable();
  machine.now.position.x = 1;
  machine.now.actual_position = {1, 2, 0};
  machine.now.g5x_offset.y = -0.5;
  machine.now.tool_offset.z = 3;
  machine.now.joint_actual_position = {1, 2, 0};
  machine.now.homed = {1, 1, 0};
  machine.now.feedrate = 0.5;
  machine.now.spindle[0].override_ = 0.7;
  machine.now.spindle[0].direction = 1;
  machine.now.spindle[0].brake = 0;
  EXPECT_EQ(ask("get abs_cmd_pos"),
            "ABS_CMD_POS 1.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 "
            "0.000000");
  EXPECT_EQ(ask("get abs_act_pos x"), "ABS_ACT_POS X 1.000000");
  EXPECT_EQ(ask("get abs_act_pos -1"),
            "ABS_ACT_POS 1.000000 2.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 "
            "0.000000");
  EXPECT_EQ(ask("get rel_act_pos 1"), "REL_ACT_POS Y 2.500000");
  EXPECT_EQ(ask("get rel_act_pos z"), "REL_ACT_POS Z -3.000000");
  EXPECT_EQ(ask("get joint_pos"), "JOINT_POS 1.000000 2.000000 0.000000");
  EXPECT_EQ(ask("get joint_homed"), "JOINT_HOMED YES YES NO");
  EXPECT_EQ(ask("get joint_homed 0"), "JOINT_HOMED 0 YES");
  EXPECT_EQ(ask("get feed_override"), "FEED_OVERRIDE 50.000000");
  EXPECT_EQ(ask("get spindle_override"), "SPINDLE_OVERRIDE 0 70");
  EXPECT_EQ(ask("get spindle"), "SPINDLE 0 FORWARD");
  EXPECT_EQ(ask("get brake"), "BRAKE 0 OFF");
  EXPECT_EQ(ask("get tool_offset"), "TOOL_OFFSET 3.000000");
  EXPECT_EQ(ask("get time"), "TIME 1795259679.500000");
  EXPECT_EQ(ask("get timestamp"), "TIMESTAMP OFF OFF");
  EXPECT_EQ(ask("get timeout"), "TIMEOUT 0.000000");
  EXPECT_EQ(ask("get wait_mode"), "WAIT_MODE DONE");
  EXPECT_EQ(ask("get plat"), "PLAT Linux");
  EXPECT_EQ(ask("get debug"), "DEBUG 0x00000000");
  EXPECT_EQ(ask("get ini MACHINE EMC"), "INI [EMC]MACHINE=m");
  EXPECT_EQ(ask("get inifile"), "INIFILE m.ini");
  EXPECT_EQ(ask("get clients"), "CLIENTS 4 'c' LINKED ENABLED");
  EXPECT_EQ(ask("get program"), "PROGRAM NONE");
  EXPECT_EQ(ask("get user_linear_units"), "USER_LINEAR_UNITS MM");
  EXPECT_EQ(ask("  get\t  Estop  and more "), "ESTOP ON");
}

TEST_F(RshSession, SendsWhatTaskUnderstands) {
  enable();
  const std::pair<const char*, const char*> lines[]{
      {"set mode MDI", "mode mdi"},
      {"set mdi G1 X5  F100 (Text, as typed)", "mdi G1 X5  F100 (Text, as typed)"},
      {"set home -1", "home -1"},
      {"set joint_unhome 2", "unhome 2"},
      {"set jog 1 -600", "jog 1 -10 in-mode=on"},  // units a minute, as observed
      {"set jog_incr X 60 0.5", "jog x 1 0.5 in-mode=on"},
      {"set jog_stop x", "jog-stop x"},
      {"set teleop_enable on", "teleop on"},
      {"set spindle forward", "spindle forward spindle=0"},
      {"set spindle off -1", "spindle off spindle=0"},
      {"set brake off", "brake off spindle=0"},
      {"set spindle_override 0 80", "spindle-override 0.80000000000000004 spindle=0"},
      {"set feed_override 150", "feed-override 1.5"},
      {"set optional_stop 1", "optional-stop on"},
      {"set open part.ngc", "open /nc/part.ngc"},
      {"set run", "run 0"},
      {"set run 7", "run 7"},
      {"set debug 0x10", "debug 16"},
      {"set task_plan_init", "reset-interpreter"},
      {"set abort", "abort"},
  };
  for (const auto& [line, words] : lines) {
    machine.sent.clear();
    EXPECT_EQ(ask(line), "") << line;
    EXPECT_EQ(machine.sent, std::vector<std::string>{words}) << line;
  }
}

TEST_F(RshSession, WaitsUntilDoneAndKeepsTheOrderOfLines) {
  enable();
  ask("set verbose on");
  machine.answer = nullptr;
  EXPECT_EQ(ask("set mdi G0 X1"), "");
  EXPECT_TRUE(session.waits());
  EXPECT_EQ(ask("get joint_pos 0"), "");
  machine.now.joint_actual_position[0] = 1;
  machine.reply(1, CommandState::running);
  session.step(0);
  EXPECT_EQ(output(), "");
  machine.reply(1, CommandState::done);
  session.step(0);
  EXPECT_EQ(output(), "SET MDI ACK|JOINT_POS 0 1.000000");
}

TEST_F(RshSession, KeepsOrderWithinAScriptButLetsALaterStopPass) {
  enable();
  machine.answer = nullptr;
  session.feed("set run\r\nset abort\r\nget plat\r\n", 0);
  EXPECT_EQ(machine.sent, std::vector<std::string>{"run 0"});
  session.feed("set pause\r\n", 0);
  EXPECT_EQ(machine.sent, (std::vector<std::string>{"run 0", "pause"}));
  session.feed("set feed_override 20\r\n", 0);
  EXPECT_EQ(machine.sent.size(), 2U);
  machine.reply(1, CommandState::aborted, "program ended");
  session.step(0);
  EXPECT_EQ(output(), "SET RUN NAK");
  EXPECT_EQ(machine.sent.back(), "abort");
  machine.reply(3, CommandState::done);
  session.step(0);
  EXPECT_EQ(output(), "PLAT Linux");
  EXPECT_EQ(machine.sent.back(), "feed-override 0.20000000000000001");
}

TEST_F(RshSession, APauseEndsTheWaitForARun) {
  enable();
  machine.answer = nullptr;
  EXPECT_EQ(ask("set run"), "");
  EXPECT_EQ(ask("set pause"), "");
  EXPECT_EQ(ask("get program_status"), "");
  machine.reply(1, CommandState::running);
  session.step(0);
  EXPECT_TRUE(session.waits());
  machine.now.task_paused = true;
  machine.now.interp_state = 3;
  session.step(0);
  EXPECT_EQ(output(), "PROGRAM_STATUS PAUSED");
}

TEST_F(RshSession, FailsAfterItsTimeoutAndWaitsForTheSameCommandAgain) {
  enable();
  machine.answer = nullptr;
  ask("set timeout 2");
  EXPECT_EQ(ask("set mdi G0 X1"), "");
  EXPECT_EQ(session.wake_at(), 2 * rtapi::kSecond);
  session.step(2 * rtapi::kSecond - 1);
  EXPECT_EQ(output(), "");
  session.step(2 * rtapi::kSecond);
  EXPECT_EQ(output(), "error: No outcome within 2.000000 seconds, the command goes on|SET MDI NAK");
  EXPECT_EQ(ask("set wait done", 3 * rtapi::kSecond), "");
  EXPECT_TRUE(session.waits());
  machine.reply(1, CommandState::error, "beyond the limit");
  session.step(4 * rtapi::kSecond);
  EXPECT_EQ(output(), "SET WAIT NAK");
  EXPECT_EQ(ask("get error"), "ERROR beyond the limit");
  EXPECT_EQ(ask("get error"), "ERROR OK");
}

TEST_F(RshSession, DoesNotWaitInModeReceived) {
  enable();
  ask("set verbose on");
  EXPECT_EQ(ask("set wait_mode received"), "SET WAIT_MODE ACK");
  machine.answer = [](const auto&, std::uint64_t id) {
    return task::Reply{id, CommandState::received, {}};
  };
  EXPECT_EQ(ask("set run"), "SET RUN ACK");
  EXPECT_EQ(ask("get wait_mode"), "WAIT_MODE RECEIVED");
  EXPECT_EQ(ask("set wait received"), "SET WAIT ACK");
  machine.reply(1, CommandState::error, "joint 1 following error");
  EXPECT_EQ(ask("get error"), "ERROR joint 1 following error");
  EXPECT_EQ(ask("set wait done"), "SET WAIT NAK");
}

TEST_F(RshSession, ShowsEachMessageOnceAndNoFailureTwice) {
  enable();
  machine.tell(MessageKind::error, "first");
  machine.tell(MessageKind::text, "(MSG, hello)");
  machine.tell(MessageKind::display, "shown");
  machine.tell(MessageKind::error, "second\nwith what to do");
  EXPECT_EQ(ask("get error"), "ERROR first");
  EXPECT_EQ(ask("get error"), "ERROR second");
  EXPECT_EQ(ask("get error"), "ERROR OK");
  EXPECT_EQ(ask("get operator_text"), "OPERATOR_TEXT (MSG, hello)");
  EXPECT_EQ(ask("get operator_display"), "OPERATOR_DISPLAY shown");
  machine.answer = [this](const auto&, std::uint64_t id) {
    machine.tell(MessageKind::error, "MDI:1:4: Two g codes used from same modal group\nWrite ...");
    return task::Reply{id, CommandState::error, "MDI:1:4: Two g codes used from same modal group"};
  };
  EXPECT_EQ(ask("set mdi g99g98"), "SET MDI NAK");                              // (captured)
  EXPECT_EQ(ask("get error"), "ERROR Two g codes used from same modal group");  // (captured)
  EXPECT_EQ(ask("get error"), "ERROR OK");
}

TEST_F(RshSession, TakesAnyLineEndsAndLinesInPieces) {
  session.feed("get pl", 0);
  EXPECT_EQ(output(), "");
  session.feed("at\rget plat\n\n\r\n\rget plat", 0);
  EXPECT_EQ(output(), "PLAT Linux|PLAT Linux");
  session.feed("\n", 0);
  EXPECT_EQ(output(), "PLAT Linux");
}

TEST_F(RshSession, IgnoresOverlongLinesAndSaysSo) {
  session.feed(std::string(100000, 'x'), 0);
  session.feed("\nget plat\n", 0);
  EXPECT_EQ(output(), "error: Line of more than 4096 characters ignored|PLAT Linux");
}

TEST_F(RshSession, StampsRepliesWithTheTime) {
  enable();
  EXPECT_EQ(ask("set timestamp on"), "");
  EXPECT_EQ(ask("get plat"), "1795259679.500000 PLAT Linux");
  EXPECT_EQ(ask("get timestamp"), "1795259679.500000 TIMESTAMP ON OFF");
}

TEST_F(RshSession, AnswersWithOldValuesWhenUpdateIsNone) {
  enable();
  ask("set update none");
  machine.now.feedrate = 0.25;
  EXPECT_EQ(ask("get feed_override"), "FEED_OVERRIDE 100.000000");
  ask("set update_status");
  EXPECT_EQ(ask("get feed_override"), "FEED_OVERRIDE 25.000000");
  machine.now.feedrate = 0.5;
  ask("set update auto");
  EXPECT_EQ(ask("get feed_override"), "FEED_OVERRIDE 50.000000");
}

TEST_F(RshSession, WaitsForHomingAndForTaskToRunOn) {
  enable();
  EXPECT_EQ(ask("set joint_wait_homed 1"), "");
  EXPECT_TRUE(session.waits());
  machine.now.homed[1] = 1;
  session.step(0);
  EXPECT_FALSE(session.waits());
  ask("set verbose on");
  EXPECT_EQ(ask("set wait_heartbeat"), "");
  machine.now.heartbeat++;
  session.step(0);
  EXPECT_EQ(output(), "SET WAIT_HEARTBEAT ACK");
}

TEST_F(RshSession, EndsByQuitAndByShutdownOfWhoIsEnabled) {
  EXPECT_EQ(ask("shutdown"), "error: SHUTDOWN failed, not enabled|SHUTDOWN NAK");  // (captured)
  EXPECT_FALSE(shell.shutdown);
  enable();
  ask("shutdown");
  EXPECT_TRUE(shell.shutdown);
  EXPECT_TRUE(session.ended());
  Session other(shell, machine, 5);
  other.feed("quit\r\nget plat\r\n", 0);
  EXPECT_EQ(other.take_output(), "QUIT ACK\r\n");  // (captured)
  EXPECT_TRUE(other.ended());
}

TEST_F(RshSession, TellsWhatIsAskedAndWaitedForAndAnswers) {
  EXPECT_EQ(ask("get prompt"), "PROMPT NONE");
  EXPECT_EQ(ask("get waiting"), "WAITING NONE");
  enable();
  machine.now.prompt = {5, task::PromptKind::tool_change, 3, rtapi::FixedString<127>("M6: tool 3")};
  machine.now.waiting_for.object = rtapi::FixedString<63>("the tool change");
  machine.now.waiting_for.pin = rtapi::FixedString<63>("iocontrol.0.tool-changed");
  machine.now.waiting_for.net = rtapi::FixedString<63>("changed");
  EXPECT_EQ(ask("get prompt"), "PROMPT 5 tool-change M6: tool 3");
  EXPECT_EQ(ask("get waiting"), "WAITING the tool change: iocontrol.0.tool-changed, net changed");
  EXPECT_EQ(ask("set answer 5"), "");
  EXPECT_EQ(ask("set answer"), "");
  EXPECT_EQ(machine.sent, (std::vector<std::string>{"answer 5", "answer"}));
}

TEST_F(RshSession, HelpNamesEveryCommand) {
  EXPECT_EQ(ask("help").substr(0, 19), "Available commands:");
  const std::string get = ask("help get"), set = ask("help set");
  std::set<std::string> names;
  for (const Subcommand& row : subcommands()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(row.get != nullptr || row.set != nullptr) << row.name;
    EXPECT_TRUE(row.get == nullptr || get.find(form(row, false)) != std::string::npos) << row.name;
    EXPECT_TRUE(row.set == nullptr || set.find(form(row, true)) != std::string::npos) << row.name;
    EXPECT_NE(ask(std::string("help ") + row.name).find("Usage:"), std::string::npos);
  }
  EXPECT_EQ(ask("help set mode"),
            "Usage: Set Mode <manual|auto|mdi>|  Jogs (manual), programs (auto) or single lines "
            "(mdi).");
  EXPECT_EQ(ask("help bogus"), "BOGUS is not a valid command.");
}

TEST(RshManual, HasTheListOfCommands) {
  std::ifstream in(std::string(KERF_SOURCE_DIR) + "/docs/man/man1/linuxcncrsh.1");
  const std::string page{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_NE(page.find(manual_list()), std::string::npos)
      << "put the output of linuxcncrsh --man into docs/man/man1/linuxcncrsh.1";
}

}  // namespace
}  // namespace kerf::rsh::test
