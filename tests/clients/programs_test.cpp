// linuxcncrsh and mdi as programs, with all true processes of a machine.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>

#include <array>
#include <cmath>

#include "machine/kerf_process.hpp"

namespace kerf::clients {
namespace {

using launcher::test::Kerf;
using launcher::test::Mill;

constexpr int kLimitMs = 60'000;

/// A connection to the remote shell.
class Shell {
 public:
  explicit Shell(int port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(static_cast<std::uint16_t>(port));
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
    EXPECT_EQ(ask("hello EMC test 1.1"), "HELLO ACK EMCNETSVR 1.1");
    send("set echo off\nset enable EMCTOO\nset verbose on\n");
    EXPECT_EQ(line(), "set echo off");
    EXPECT_EQ(line(), "SET VERBOSE ACK");
  }
  ~Shell() { leave(); }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;
  void leave() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  void send(const std::string& text) const {
    EXPECT_EQ(::send(fd_, text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  /// The next line of the answer; "" at the end, or when none comes.
  std::string line() {
    for (;;) {
      if (const auto end = text_.find("\r\n"); end != std::string::npos) {
        std::string out = text_.substr(0, end);
        text_.erase(0, end + 2);
        return out;
      }
      pollfd wait{fd_, POLLIN, 0};
      char buffer[4096];
      if (::poll(&wait, 1, kLimitMs) <= 0) return {};
      const ssize_t got = ::recv(fd_, buffer, sizeof buffer, 0);
      if (got <= 0) return {};
      text_.append(buffer, static_cast<std::size_t>(got));
    }
  }
  std::string ask(const std::string& request) {
    send(request + "\r\n");
    return line();
  }
  double position(const char* what) {
    const std::string reply = ask(std::string("get ") + what);
    return std::atof(reply.substr(reply.rfind(' ')).c_str());
  }

 private:
  int fd_;
  std::string text_;
};

int port_of(Kerf& kerf) {
  const std::string mark = "linuxcncrsh: listening on 127.0.0.1 port ";
  EXPECT_TRUE(kerf.wait_output(mark)) << kerf.output();
  const std::string said = kerf.output();
  const auto at = said.find(mark);
  return at == std::string::npos ? 0 : std::atoi(said.c_str() + at + mark.size());
}

/// Runs a command of the shell with our programs on the instance; gives what it printed, and its exit status at the end.
std::string run(const Kerf& kerf, const std::string& command) {
  const std::string line = "KERF_INSTANCE=" + kerf.instance() +
                           " PATH=" KERF_BUILD_DIR "/bin:$PATH; export KERF_INSTANCE PATH; " +
                           command + " 2>&1";
  std::FILE* pipe = ::popen(line.c_str(), "r");
  std::string out;
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) out += buffer.data();
  return out + "exit " + std::to_string(WEXITSTATUS(::pclose(pipe)));
}

void end(Kerf& kerf) {
  kerf.signal(SIGTERM);
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST(RemoteShellProgram, IsTheScreenOfAMachineAndEndsIt) {
  Mill mill("rsh");
  mill.change("[DISPLAY]", "[DISPLAY]\nDISPLAY = linuxcncrsh --port 0");
  Kerf kerf(mill, "rsh", {"--speed", "50"});
  const int port = port_of(kerf);
  ASSERT_GT(port, 0);
  Shell one(port);
  EXPECT_EQ(one.ask("set mdi G0 X1"), "SET MDI NAK");
  EXPECT_EQ(one.ask("set estop off"), "SET ESTOP ACK");
  EXPECT_EQ(one.ask("set machine on"), "SET MACHINE ACK");
  EXPECT_EQ(one.ask("set home -1"), "SET HOME ACK");
  EXPECT_EQ(one.ask("set mode mdi"), "SET MODE ACK");
  EXPECT_EQ(one.ask("set mdi G0 X10 Y5"), "SET MDI ACK");
  EXPECT_EQ(one.ask("get abs_cmd_pos x"), "ABS_CMD_POS X 10.000000");
  EXPECT_EQ(one.ask("get inifile"), "INIFILE " + mill.ini());
  EXPECT_EQ(one.ask("get ini MACHINE EMC"), "INI [EMC]MACHINE=simulated mill");

  // Each connection has its own settings, and sees all errors.
  Shell two(port);
  EXPECT_EQ(one.ask("get error").find("ERROR command"), 0U);
  EXPECT_EQ(one.ask("set mdi G99 G98"), "SET MDI NAK");
  EXPECT_EQ(one.ask("get error"), "ERROR Two g codes used from same modal group");
  EXPECT_EQ(two.ask("get error"), "ERROR Two g codes used from same modal group");
  EXPECT_EQ(two.ask("get error"), "ERROR OK");

  // A jog ends with its connection.
  EXPECT_EQ(two.ask("set mode manual"), "SET MODE ACK");
  EXPECT_EQ(two.ask("set teleop_enable off"), "SET TELEOP_ENABLE ACK");
  EXPECT_EQ(two.ask("set jog 0 600"), "SET JOG ACK");
  two.leave();
  double before = -1, now = one.position("joint_pos 0");
  for (int n = 0; n < 2000 && before != now; ++n) {
    before = now;
    for (int beats = 0; beats < 20; ++beats)
      EXPECT_EQ(one.ask("set wait_heartbeat"), "SET WAIT_HEARTBEAT ACK");
    now = one.position("joint_pos 0");
  }
  EXPECT_EQ(before, now);
  EXPECT_LT(now, 299);

  // Garbage moves nothing and disturbs nobody.
  {
    Shell rude(port);
    constexpr char kGarbage[] = "\0\xff\xfe garbage\nset jog 0\nset mdi";
    rude.send(std::string(kGarbage, sizeof kGarbage - 1) + std::string(9000, 'x'));
  }
  EXPECT_EQ(one.position("joint_pos 0"), now);

  // Who started a program that waits is gone: the others see for what, and end it.
  {
    Shell three(port);
    const std::string program =
        mill.write("waits.ngc", "G21 G90\nG0 X4\nM66 P1 L3 Q600\nG0 X40\nM2\n");
    EXPECT_EQ(three.ask("set mode auto"), "SET MODE ACK");
    EXPECT_EQ(three.ask("set open " + program), "SET OPEN ACK");
    three.send("set wait_mode received\nset run\n");
    EXPECT_EQ(three.line(), "SET WAIT_MODE ACK");
    EXPECT_EQ(three.line(), "SET RUN ACK");
    for (int n = 0; n < 4000 && one.ask("get waiting").find("digital") == std::string::npos; ++n)
      launcher::pause_ms(5);
  }
  launcher::pause_ms(50);
  EXPECT_EQ(one.ask("get waiting"), "WAITING digital input 1: motion.digital-in-01, not linked");
  EXPECT_EQ(one.ask("get program_status"), "PROGRAM_STATUS RUNNING");
  EXPECT_EQ(one.ask("set abort"), "SET ABORT ACK");
  EXPECT_EQ(one.ask("get waiting"), "WAITING NONE");
  EXPECT_EQ(one.ask("set mode mdi"), "SET MODE ACK");
  EXPECT_EQ(one.ask("set mdi G0 X1"), "SET MDI ACK");
  EXPECT_EQ(one.ask("get abs_cmd_pos x"), "ABS_CMD_POS X 1.000000");
  one.send("shutdown\r\n");
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST(RemoteShellProgram, ByHandItNamesATakenPortAndAWrongFile) {
  Mill mill("rshhand");
  mill.change("[DISPLAY]", "[DISPLAY]\nDISPLAY = linuxcncrsh -p 0 -w secret");
  Kerf kerf(mill, "rshhand", {"--speed", "50"});
  const int port = port_of(kerf);
  const std::string taken = run(kerf, "linuxcncrsh --port " + std::to_string(port));
  EXPECT_NE(taken.find("cannot listen on 127.0.0.1 port"), std::string::npos) << taken;
  EXPECT_NE(taken.find("--port"), std::string::npos);
  EXPECT_NE(taken.find("exit 1"), std::string::npos);
  const std::string nofile = run(kerf, "linuxcncrsh -p 0 -- -ini /nowhere.ini");
  EXPECT_NE(nofile.find("/nowhere.ini"), std::string::npos) << nofile;
  EXPECT_NE(nofile.find("exit 1"), std::string::npos);
  EXPECT_NE(run(kerf, "linuxcncrsh --sessions x").find("exit 2"), std::string::npos);
  EXPECT_NE(run(kerf, "linuxcncrsh --nonsense").find("exit 2"), std::string::npos);
  end(kerf);
}

TEST(MdiProgram, TakesWordsLinesAndAPipe) {
  Mill mill("mdiwords");
  Kerf kerf(mill, "mdiwords", {"--speed", "50"});
  ASSERT_TRUE(kerf.wait_output("runs; end it")) << kerf.output();
  EXPECT_EQ(run(kerf, "mdi ':state estop-reset' ':state on' :home"), "exit 0");
  EXPECT_EQ(run(kerf, "mdi g0 x7"), "exit 0");
  EXPECT_EQ(run(kerf, "mdi 'g0 y1' 'g0 y3'"), "exit 0");
  EXPECT_EQ(run(kerf, "printf 'g0 z-1\\n\\ng0 z-2' | mdi"), "exit 0");
  EXPECT_EQ(run(kerf, "halcmd getp joint.0.pos-cmd"), "7\nexit 0");
  EXPECT_EQ(run(kerf, "halcmd getp joint.1.pos-cmd"), "3\nexit 0");
  EXPECT_EQ(run(kerf, "halcmd getp joint.2.pos-cmd"), "-2\nexit 0");
  EXPECT_NE(run(kerf, "mdi g99g98").find("exit 1"), std::string::npos);
  end(kerf);
}

TEST(MdiProgram, AtATerminalShowsWhereTheMachineStands) {
  Mill mill("mditerm");
  Kerf kerf(mill, "mditerm", {"--speed", "50"});
  ASSERT_TRUE(kerf.wait_output("runs; end it")) << kerf.output();
  ASSERT_EQ(run(kerf, "mdi ':state estop-reset' ':state on' :home"), "exit 0");
  int terminal = -1;
  const pid_t pid = ::forkpty(&terminal, nullptr, nullptr, nullptr);
  if (pid == 0) {
    setenv("KERF_INSTANCE", kerf.instance().c_str(), 1);
    setenv("TERM", "dumb", 1);
    execl(KERF_BUILD_DIR "/bin/mdi", "mdi", nullptr);
    _exit(127);
  }
  ASSERT_GT(pid, 0);
  std::string said;
  const auto sees = [&](const std::string& text) {
    pollfd wait{terminal, POLLIN, 0};
    char buffer[1024];
    while (said.find(text) == std::string::npos) {
      if (::poll(&wait, 1, kLimitMs) <= 0) return false;
      const ssize_t got = ::read(terminal, buffer, sizeof buffer);
      if (got <= 0) return false;
      said.append(buffer, static_cast<std::size_t>(got));
    }
    said.clear();
    return true;
  };
  const auto type = [&](const std::string& text) {
    EXPECT_EQ(::write(terminal, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  };
  EXPECT_TRUE(sees("MDI> "));
  type("g0 x12.5 y1\n");
  EXPECT_TRUE(sees("X12.5000 Y1.0000 Z0.0000")) << said;
  type("g10 l2 p1 x2.5\n");
  EXPECT_TRUE(sees("X10.0000 Y1.0000 Z0.0000")) << said;
  type("g99g98\n");
  EXPECT_TRUE(sees("Two g codes used from same modal group")) << said;
  type("quit\n");
  int status = 0;
  EXPECT_EQ(waitpid(pid, &status, 0), pid);
  EXPECT_EQ(WEXITSTATUS(status), 1) << "a line failed";
  ::close(terminal);
  end(kerf);
}

}  // namespace
}  // namespace kerf::clients
