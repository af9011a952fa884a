// kerf with its true processes: from the INI file to the drawing, and every way in which it may end.
#include "machine/kerf_process.hpp"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <sstream>

namespace kerf::launcher {
namespace {

using test::Kerf;
using test::Mill;

constexpr const char* kFirstPart = KERF_SOURCE_DIR "/nc_files/examples/first_part.ngc";

testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "'" << part << "' is not in:\n" << text;
}

/// A joint log with its times counted from its first cycle.
std::string from_its_start(const std::string& log) {
  std::string out;
  std::istringstream in(log);
  long long begin = -1;
  for (std::string line; std::getline(in, line); out += '\n') {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t end = line.find(' ');
    const long long time = std::stoll(line.substr(0, end));
    if (begin < 0) begin = time;
    out += std::to_string(time - begin) + line.substr(end);
  }
  return out;
}

TEST(KerfOnce, TwoVirtualRunsAreByteIdentical) {
  std::string log[2], svg[2];
  for (int i = 0; i < 2; ++i) {
    Mill mill("once" + std::to_string(i));
    Kerf kerf(
        mill, "once",
        {"--virtual", "--once", "--program", kFirstPart, "--log-joints", mill.path("joints.log")});
    ASSERT_EQ(kerf.wait_exit(), 0) << kerf.output();
    EXPECT_TRUE(contains(kerf.output(), "first_part.ngc"));
    EXPECT_TRUE(contains(kerf.output(), "machine time"));
    EXPECT_TRUE(contains(kerf.output(), "peak acceleration / limit"));
    EXPECT_EQ(kerf.output().find("not recorded"), std::string::npos) << kerf.output();
    EXPECT_EQ(kerf.leftovers(), "");
    log[i] = test::read_file(mill.path("joints.log"));
    svg[i] = test::read_file(mill.path("once.svg"));
  }
  EXPECT_GT(log[0].size(), 1'000'000U);
  EXPECT_TRUE(log[0] == log[1]) << "the joint logs differ";
  EXPECT_TRUE(svg[0] == svg[1]) << "the drawings differ";
  EXPECT_TRUE(contains(svg[0], "<g id='isometric'>"));
}

TEST(KerfOnce, TwoInstancesAtOnceDoNotMeet) {
  Mill mill_a("pair_a"), mill_b("pair_b");
  Kerf a(mill_a, "paira",
         {"--virtual", "--once", "--program", kFirstPart, "--log-joints", mill_a.path("j.log")});
  Kerf b(mill_b, "pairb",
         {"--virtual", "--once", "--program", kFirstPart, "--log-joints", mill_b.path("j.log")});
  EXPECT_EQ(a.wait_exit(), 0) << a.output();
  EXPECT_EQ(b.wait_exit(), 0) << b.output();
  EXPECT_TRUE(test::read_file(mill_a.path("j.log")) == test::read_file(mill_b.path("j.log")));
  EXPECT_EQ(a.leftovers() + b.leftovers(), "");
}

/// Eight machines at once, each with a program, a component and outputs of its own: each does to the last bit what it does alone,
/// and its programs see its pins only. None goes on before all are there.
TEST(KerfOnce, EightInstancesAtOnceDoNotMeet) {
  constexpr int kMachines = 8;
  std::vector<std::unique_ptr<Mill>> mills;
  const auto log = [](int i, bool alone) {
    return std::string(alone ? "alone" : "beside") + std::to_string(i) + ".log";
  };
  const auto start = [&](int i, bool alone) {
    return std::make_unique<Kerf>(
        *mills[static_cast<std::size_t>(i)], (alone ? "alone" : "beside") + std::to_string(i),
        std::vector<std::string>{"--virtual", "--once", "--program",
                                 mills[static_cast<std::size_t>(i)]->path("p.ngc"), "--log-joints",
                                 mills[static_cast<std::size_t>(i)]->path(log(i, alone))});
  };
  const std::string hall = testing::TempDir() + "kerf_hall_" + std::to_string(getpid());
  std::filesystem::create_directories(hall);
  for (int i = 0; i < kMachines; ++i) {
    mills.push_back(std::make_unique<Mill>("eight" + std::to_string(i)));
    const std::string n = std::to_string(i);
    const std::string enter = mills.back()->write(
        "enter", "#!/bin/sh\ntouch " + hall + "/" + n + "\nuntil [ $(ls " + hall +
                     " | wc -l) -ge " + std::to_string(kMachines) +
                     " ]; do sleep 0.05; done\nhalcmd show pin >pins.txt\nhalcmd setp own" + n +
                     ".in 1\n");
    chmod(enter.c_str(), 0755);
    // Ends with an error when an output is not what this machine has written.
    std::string text =
        "G21 G90\nM68 E0 Q<n>\nG1 X<n>5 F3000\nM66 E0 L0\nG2 X<n>5 Y10 J5\n"
        "o1 if [#5399 NE <n>]\n(abort,input #5399)\no1 endif\nG0 Z-<n>\nM2\n";
    test::replace(text, "<n>", n);
    mills.back()->write("p.ngc", text);
    mills.back()->change("HALCMD = setp spindle-motor.acceleration 100",
                         "HALCMD = setp spindle-motor.acceleration 100\n"
                         "HALCMD = net loop motion.analog-out-00 motion.analog-in-00\n"
                         "HALCMD = loadrt not names=own" +
                             n + "\nHALCMD = loadusr -w ./enter");
  }
  std::vector<std::unique_ptr<Kerf>> running;
  running.reserve(kMachines);
  for (int i = 0; i < kMachines; ++i) running.push_back(start(i, false));
  for (auto& kerf : running) EXPECT_EQ(kerf->wait_exit(), 0) << kerf->output();
  for (auto& kerf : running) EXPECT_EQ(kerf->leftovers(), "");
  for (int i = 0; i < kMachines; ++i) {
    const std::string pins = test::read_file(mills[static_cast<std::size_t>(i)]->path("pins.txt"));
    for (int other = 0; other < kMachines; ++other)
      EXPECT_EQ(pins.find("own" + std::to_string(other) + ".in") != std::string::npos, other == i)
          << "machine " << i << ":\n"
          << pins;
  }
  for (int i = 0; i < kMachines; i += 3) {
    const auto kerf = start(i, true);
    EXPECT_EQ(kerf->wait_exit(), 0) << kerf->output();
    const Mill& mill = *mills[static_cast<std::size_t>(i)];
    // Those that were there first have slept, in time of their own, until the last one came.
    const std::string beside = from_its_start(test::read_file(mill.path(log(i, false))));
    EXPECT_GT(beside.size(), 10'000U);
    EXPECT_TRUE(beside == from_its_start(test::read_file(mill.path(log(i, true)))))
        << "machine " << i;
  }
  std::filesystem::remove_all(hall);
}

TEST(KerfOnce, RealTime) {
  Mill mill("real");
  mill.take_silence();
  const std::string program = mill.write("p.ngc", "G21 G90\nG0 X5 Y5\nG1 X10 F1200\nM2\n");
  Kerf kerf(mill, "real", {"--once", "--program", program});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_TRUE(contains(kerf.output(), "machine time"));
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST(KerfOnce, PausesDoNotHoldItWhenNobodyIsThere) {
  Mill mill("pause");
  const std::string program = mill.write("p.ngc", "G21 G90\nM0\nG1 X10 F1200\nM60\nG0 X0\nM2\n");
  Kerf kerf(mill, "pause", {"--virtual", "--once", "--program", program});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_TRUE(contains(kerf.output(), "pauses at line 2; nobody is there, so it goes on"));
}

struct BadProgram {
  const char* text;
  const char* message;
};
class KerfBadProgram : public testing::TestWithParam<BadProgram> {};
TEST_P(KerfBadProgram, EndsWithItsMessage) {
  Mill mill("badprogram");
  const std::string program = mill.write("p.ngc", GetParam().text);
  Kerf kerf(mill, "badp", {"--virtual", "--once", "--program", program});
  EXPECT_EQ(kerf.wait_exit(), 1) << kerf.output();
  EXPECT_TRUE(contains(kerf.output(), program + GetParam().message));
  EXPECT_EQ(kerf.leftovers(), "");
}
INSTANTIATE_TEST_SUITE_P(
    All, KerfBadProgram,
    testing::Values(BadProgram{"G21\nG1 Xfoo F100\nM2\n", ":2"},
                    BadProgram{
                        "G21 G90\nG53 G0 X500\nM2\n",
                        ":2: Move would take axis X to 500.0000, above its MAX_LIMIT of 300.0000"},
                    BadProgram{"G21\n\nT99 M6\nM2\n", ":3"}));

struct BadFile {
  const char* from;  ///< in the INI file
  const char* to;
  const char* hal;   ///< content of bad.hal
  const char* line;  ///< of the INI file that the message names; "" none
  const char* message;
};
class KerfBadFile : public testing::TestWithParam<BadFile> {};
TEST_P(KerfBadFile, IsNamedWithItsPlace) {
  const BadFile& bad = GetParam();
  Mill mill("badfile");
  mill.write("bad.hal", bad.hal);
  mill.change(bad.from, bad.to);
  Kerf kerf(mill, "badf", {"--virtual", "--once"});
  EXPECT_EQ(kerf.wait_exit(), 1) << kerf.output();
  EXPECT_TRUE(contains(kerf.output(), bad.message));
  if (*bad.line != '\0') {
    EXPECT_TRUE(
        contains(kerf.output(), mill.ini() + ":" + std::to_string(mill.line_of(bad.line)) + ": "));
  }
  EXPECT_EQ(kerf.leftovers(), "");
}
INSTANTIATE_TEST_SUITE_P(
    All, KerfBadFile,
    testing::Values(BadFile{"HALFILE = spindle.hal", "HALFILE = spindel.hal", "",
                            "HALFILE = spindel.hal", "did you mean 'spindle.hal'?"},
                    BadFile{"HALFILE = spindle.hal", "HALFILE = spindle.tcl", "",
                            "HALFILE = spindle.tcl", "no file 'spindle.tcl'"},
                    BadFile{"CLOCK = real", "CLOCK = rael", "", "CLOCK = rael", "real"},
                    BadFile{"HALFILE = panel.hal", "HALFILE = bad.hal",
                            "\nnet x motion.in-positon\n", "HALFILE = bad.hal",
                            "bad.hal:2: Pin 'motion.in-positon' does not exist; did you mean "
                            "'motion.in-position'?"},
                    BadFile{"HALFILE = panel.hal", "HALFILE = bad.hal", "loadrt and22\n",
                            "HALFILE = bad.hal", "bad.hal:1: "},
                    BadFile{"HALFILE = mill.hal", "HALFILE = bad.hal", "# no motion\n", "", ""},
                    BadFile{"[TASK]\nTASK = milltask", "[TASK]\nTASK = miltask", "", "",
                            "cannot start 'miltask'"}));

TEST(KerfStays, UntilASignalAndRefusesASecondOfItsName) {
  Mill mill("stays");
  mill.change("[DISPLAY]", "[DISPLAY]\nDISPLAY = no-such-screen");
  Kerf first(mill, "stays", {});
  ASSERT_TRUE(first.wait_output("simulated mill runs")) << first.output();
  EXPECT_TRUE(contains(first.output(), "no-such-screen: not found: staying in the terminal"));
  Mill other("stays2");
  Kerf second(other, "stays", {});
  EXPECT_EQ(second.wait_exit(), 1);
  EXPECT_TRUE(contains(second.output(), "in use by process " + std::to_string(first.pid())));
  EXPECT_EQ(first.parts("milltask").size(), 1U);
  first.signal(SIGTERM);
  EXPECT_EQ(first.wait_exit(), 0) << first.output();
  EXPECT_EQ(first.leftovers(), "");
}

TEST(KerfStays, MdiAndHalcmdReachTheRunningMachine) {
  Mill mill("mdi");
  Kerf kerf(mill, "mdi", {"--speed", "50"});
  ASSERT_TRUE(kerf.wait_output("simulated mill runs")) << kerf.output();
  const auto run = [&](const std::string& words) {
    const std::string command = "KERF_INSTANCE=" + kerf.instance() + " timeout 60 " +
                                KERF_BUILD_DIR + "/bin/" + words + " >" + mill.path("words.out") +
                                " 2>&1 </dev/null";
    const int status = std::system(command.c_str());
    return WEXITSTATUS(status);
  };
  EXPECT_EQ(run("mdi 'G0 X10'"), 1);
  EXPECT_TRUE(contains(test::read_file(mill.path("words.out")), "out of E-stop and turned on"))
      << test::read_file(mill.path("words.out"));
  EXPECT_EQ(run("mdi ':state estop-reset' ':state on' ':home' 'G21 G53 G0 X10 Y5'"), 0)
      << test::read_file(mill.path("words.out"));
  EXPECT_EQ(run("halcmd getp joint.0.pos-cmd"), 0);
  EXPECT_EQ(test::read_file(mill.path("words.out")), "10\n");
  EXPECT_EQ(run("mdi 'G1 X400 F100'"), 1);
  EXPECT_EQ(run("halcmd getp joint.0.pos-cmd"), 0);
  EXPECT_EQ(test::read_file(mill.path("words.out")), "10\n");
  kerf.signal(SIGINT);
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST(KerfStays, ManualToolChangeStopsTheSpindleAndAsksForTheTool) {
  Mill mill("toolchange");
  std::string panel = test::read_file(mill.path("panel.hal"));
  test::replace(panel, "=>  iocontrol.0.tool-changed", "=>  hal_manualtoolchange.change");
  test::replace(panel, "net tool-number    iocontrol.0.tool-number",
                "net tool-changed   hal_manualtoolchange.changed  =>  iocontrol.0.tool-changed\n"
                "net tool-number    iocontrol.0.tool-prep-number  =>  hal_manualtoolchange.number");
  mill.write("panel.hal", "loadusr -W hal_manualtoolchange --text\n" + panel);
  Kerf kerf(mill, "toolchange", {"--speed", "50"});
  ASSERT_TRUE(kerf.wait_output("simulated mill runs")) << kerf.output();
  const auto command = [&](const std::string& words) {
    return "KERF_INSTANCE=" + kerf.instance() + " timeout 60 " + KERF_BUILD_DIR + "/bin/" + words +
           " >" + mill.path("words.out") + " 2>&1 </dev/null";
  };
  const auto run = [&](const std::string& words) {
    return WEXITSTATUS(std::system(command(words).c_str()));
  };
  const auto pin = [&](const std::string& name) {
    EXPECT_EQ(run("halcmd getp " + name), 0) << test::read_file(mill.path("words.out"));
    return test::read_file(mill.path("words.out"));
  };
  ASSERT_EQ(run("mdi ':state estop-reset' ':state on' ':home' 'M3 S500' 'T2'"), 0)
      << test::read_file(mill.path("words.out"));
  EXPECT_EQ(pin("spindle.0.on"), "TRUE\n");
  // In the background: it waits for the operator.
  ASSERT_EQ(std::system(("KERF_INSTANCE=" + kerf.instance() + " timeout 60 " + KERF_BUILD_DIR +
                         "/bin/mdi M6 >" + mill.path("m6.out") + " 2>&1 </dev/null &")
                            .c_str()),
            0);
  ASSERT_TRUE(kerf.wait_output("Insert tool 2")) << kerf.output();
  EXPECT_EQ(pin("spindle.0.on"), "FALSE\n");
  EXPECT_EQ(pin("iocontrol.0.tool-change"), "TRUE\n");
  EXPECT_EQ(pin("iocontrol.0.tool-number"), "0\n") << "not before the operator says so";
  EXPECT_EQ(run("halcmd setp hal_manualtoolchange.change_button 1"), 0);
  std::string number;
  for (int waited = 0; waited < 10'000 && number != "2\n"; waited += 50) {
    number = pin("iocontrol.0.tool-number");
    pause_ms(50);
  }
  EXPECT_EQ(number, "2\n") << test::read_file(mill.path("m6.out"));
  kerf.signal(SIGINT);
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_EQ(kerf.leftovers(), "");
}

// A fault, its file, and the file run again: to the last bit.
TEST(KerfStays, AFaultLeavesAFlightRecordThatRunsAgain) {
  Mill mill("flight");
  mill.change("CLOCK = real",
              "CLOCK = real\nRECORD_DIR = flights\nRECORD_KEEP = 1\nRECORD_PIN = spindle.0.on\n"
              "RECORD_PIN = motion.in-positon");
  const std::string program = mill.write(
      "p.ngc", "G21 G90\nG0 X5 Y5\nS500 M3\no1 while [1]\nG1 X200 F2400\nG1 X5\no1 endwhile\nM2\n");
  // As long as the record holds the start of the program this may take: a minute, half a minute by the clock.
  Kerf kerf(mill, "flight", {"--speed", "2", "--program", program});
  ASSERT_TRUE(kerf.wait_output("running p.ngc")) << kerf.output();
  const auto run = [&](const std::string& words) {
    const std::string command = "KERF_INSTANCE=" + kerf.instance() + " timeout 60 " +
                                KERF_BUILD_DIR + "/bin/" + words + " >" + mill.path("words.out") +
                                " 2>&1 </dev/null";
    return WEXITSTATUS(std::system(command.c_str()));
  };
  const auto said = [&] { return test::read_file(mill.path("words.out")); };
  // What the machine does now, without a fault.
  ASSERT_EQ(run("kerf record dump " + mill.path("now.flight") + " --instance " + kerf.instance()),
            0)
      << said();
  EXPECT_EQ(run("kerf replay " + mill.path("now.flight")), 0) << said();
  EXPECT_TRUE(contains(said(), "no fault, as recorded"));
  // The encoder of X is cut off, in the loop.
  do {
    ASSERT_EQ(run("halcmd getp spindle.0.on"), 0) << said();
  } while (said() != "TRUE\n");
  ASSERT_EQ(run("halcmd unlinkp joint.0.motor-pos-fb"), 0) << said();
  const std::string file = mill.path("flights/0001-following-error.flight");
  ASSERT_TRUE(kerf.wait_output("flight record: " + file)) << kerf.output();
  EXPECT_TRUE(contains(kerf.output(), "[KERF]RECORD_PIN = motion.in-positon: "));
  EXPECT_TRUE(contains(kerf.output(), "did you mean 'motion.in-position'?"));
  EXPECT_EQ(run("kerf replay " + file), 0) << said();
  EXPECT_TRUE(contains(said(), "replayed: following-error of 0 in cycle"));
  EXPECT_TRUE(contains(said(), "the same faults in the same cycles"));
  EXPECT_TRUE(contains(said(), "all positions are those recorded, to the last bit"));
  ASSERT_EQ(run("kerf record show " + file), 0) << said();
  EXPECT_TRUE(contains(said(), "ferror.2 spindle.0.on\n"));
  EXPECT_TRUE(contains(said(), "# fault: following-error of 0"));
  EXPECT_TRUE(contains(said(), " TRUE\n")) << "the spindle was on";
  EXPECT_TRUE(contains(said(), " FALSE\n")) << "the fault has stopped it";
  // One that is cut short is refused.
  std::filesystem::resize_file(mill.path("now.flight"), 3000);
  EXPECT_EQ(run("kerf replay " + mill.path("now.flight")), 1);
  EXPECT_TRUE(contains(said(), "it ends in the middle"));
  // The death of the host leaves one, too; only one is kept.
  const std::vector<pid_t> hosts = kerf.parts("rtapi_app");
  ASSERT_EQ(hosts.size(), 1U);
  kill(hosts[0], SIGKILL);
  EXPECT_NE(kerf.wait_exit(), 0);
  const std::string last = mill.path("flights/0002-process-died.flight");
  EXPECT_TRUE(contains(kerf.output(), "flight record: " + last));
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(run("kerf replay " + last), 0) << said();
  EXPECT_TRUE(contains(said(), "the same faults in the same cycles"));
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST(KerfStays, AnInterruptedProgramIsAFailure) {
  Mill mill("interrupt");
  Kerf kerf(mill, "interrupt", {"--speed", "5", "--once", "--program", kFirstPart});
  ASSERT_TRUE(kerf.wait_output("running first_part.ngc")) << kerf.output();
  kerf.signal(SIGINT);
  EXPECT_EQ(kerf.wait_exit(), 1);
  EXPECT_TRUE(contains(kerf.output(), "interrupted"));
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST(KerfStays, TheEndOfTheScreenIsTheEndOfTheMachine) {
  Mill mill("screen");
  mill.change("[DISPLAY]", "[DISPLAY]\nDISPLAY = sh -c \"sleep 0.2\"");
  const std::string screen =
      mill.write("screen", "#!/bin/sh\n[ \"$1\" = -ini ] && [ -f \"$2\" ] && exit 0\nexit 5\n");
  chmod(screen.c_str(), 0755);
  mill.change("sh -c \"sleep 0.2\"", screen);
  Kerf kerf(mill, "screen", {});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_EQ(kerf.leftovers(), "");
}

/// What ends a run before anybody kills a part of it: task's silence. The part then ends in order, and the reason is told.
TEST(KerfOnce, ATaskThatIsSilentTooLongEndsTheRunWithItsReason) {
  Mill mill("silent");
  mill.change("HEARTBEAT_TIMEOUT = 1\n", "HEARTBEAT_TIMEOUT = 0.3\n");
  Kerf kerf(mill, "silent", {"--once", "--program", kFirstPart});
  ASSERT_TRUE(kerf.wait_output("running first_part.ngc")) << kerf.output();
  const std::vector<pid_t> task = kerf.parts("milltask");
  ASSERT_EQ(task.size(), 1U);
  kill(task[0], SIGSTOP);
  pause_ms(600);
  kill(task[0], SIGCONT);
  EXPECT_EQ(kerf.wait_exit(), 1) << kerf.output();
  EXPECT_TRUE(contains(kerf.output(), "Task has not answered for 0.3"));
  EXPECT_EQ(kerf.output().find("was killed"), std::string::npos) << kerf.output();
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST(KerfKilled, NothingIsLeftAndTheNextStartWorks) {
  Mill mill("killed");
  mill.take_silence();
  std::mt19937 random(20261121);
  std::uniform_int_distribution<int> delay_ms(0, 1500);
  const char* const victims[] = {"rtapi_app", "milltask", "kerf"};
  const char* const given = std::getenv("KERF_COUNT");
  const int count = given != nullptr ? std::max(3, std::atoi(given)) : 21;
  // Tests beside this one have machines, too: only those of this process count.
  const auto left_in_memory = [] {
    int n = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm"))
      if (contains(entry.path().filename().string(), std::to_string(getpid()))) ++n;
    return n;
  };
  for (int round = 0; round < count; ++round) {
    const std::string victim = victims[round % 3];
    std::vector<std::string> arguments{"--once", "--program", kFirstPart};
    // 20 s of the clock: no test computer is so busy that the program ends before the kill.
    if (round % 2 == 0) arguments.insert(arguments.end(), {"--speed", "5"});
    Kerf kerf(mill, "killed", arguments);
    const int delay = delay_ms(random);
    SCOPED_TRACE(victim + " after " + std::to_string(delay) + " ms, round " +
                 std::to_string(round));
    pause_ms(delay);
    if (victim == "kerf") {
      kerf.signal(SIGKILL);
      EXPECT_EQ(kerf.wait_exit(), 128 + SIGKILL);
    } else {
      std::vector<pid_t> found;
      for (int i = 0; i < 4000 && (found = kerf.parts(victim)).empty(); ++i) pause_ms(5);
      ASSERT_EQ(found.size(), 1U) << kerf.output();
      kill(found[0], SIGKILL);
      EXPECT_EQ(kerf.wait_exit(), 1) << kerf.output();
      EXPECT_TRUE(contains(kerf.output(), victim + " (process " + std::to_string(found[0]) +
                                              ") was killed by signal 9"));
    }
    EXPECT_EQ(kerf.leftovers(), "");
    EXPECT_EQ(left_in_memory(), 0);
  }
  const std::string program = mill.write("p.ngc", "G21 G90\nG0 X5\nM2\n");
  Kerf kerf(mill, "killed", {"--virtual", "--once", "--program", program});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_EQ(kerf.leftovers(), "");
  EXPECT_EQ(left_in_memory(), 0);
  std::printf("[ figures ] kill -9 at random moments from the start on: %d times, then a start\n",
              count);
}

}  // namespace
}  // namespace kerf::launcher
