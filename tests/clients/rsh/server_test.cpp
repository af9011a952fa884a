// The remote shell's sockets: many clients, clients that vanish at every byte, clients that do not read.
#include "clients/rsh/server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "clients/rsh/fake_machine.hpp"

namespace kerf::rsh::test {
namespace {

/// What the machines of all sessions were told.
struct Record {
  std::vector<std::string> sent;
  int alive{0};
};

class RecordedMachine final : public Machine {
 public:
  explicit RecordedMachine(Record& record) : record_(record) { ++record_.alive; }
  ~RecordedMachine() override { --record_.alive; }
  [[nodiscard]] const clients::Stat& stat() const override { return inner_.stat(); }
  void refresh() override { inner_.refresh(); }
  rtapi::Result<std::uint64_t> send(const std::vector<std::string>& words) override {
    auto id = inner_.send(words);
    record_.sent.push_back(inner_.sent.back());
    return id;
  }
  [[nodiscard]] std::optional<task::Reply> outcome(std::uint64_t id) override {
    return inner_.outcome(id);
  }
  void forget(std::uint64_t id) override { inner_.forget(id); }
  [[nodiscard]] std::vector<task::OperatorMessage> new_messages() override { return {}; }
  [[nodiscard]] std::optional<std::string> ini(const std::string& a,
                                               const std::string& b) const override {
    return inner_.ini(a, b);
  }
  [[nodiscard]] std::string ini_name() const override { return inner_.ini_name(); }
  [[nodiscard]] std::optional<std::string> find_program(const std::string& n) const override {
    return inner_.find_program(n);
  }
  [[nodiscard]] double wall_time_s() const override { return 0; }

 private:
  Record& record_;
  FakeMachine inner_;
};

class Client {
 public:
  explicit Client(int port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(static_cast<std::uint16_t>(port));
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
  }
  ~Client() { leave(); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  void leave() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  /// By a reset, as when the computer is switched off.
  void vanish() {
    const linger now{1, 0};
    (void)setsockopt(fd_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    leave();
  }
  void end_input() const { (void)::shutdown(fd_, SHUT_WR); }
  void send(std::string_view text) const {
    ASSERT_EQ(::send(fd_, text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  void send_some(std::string_view text) const {
    (void)!::send(fd_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  }
  std::string received() {
    char buffer[65536];
    for (ssize_t got = 0; (got = ::recv(fd_, buffer, sizeof buffer, MSG_DONTWAIT)) >= 0;) {
      if (got == 0) {
        closed = true;
        break;
      }
      text_.append(buffer, static_cast<std::size_t>(got));
    }
    return text_;
  }
  bool closed{false};

 private:
  int fd_;
  std::string text_;
};

class RshServer : public testing::Test {
 protected:
  void start(int sessions = -1) {
    const auto listening =
        server.listen({.address = "127.0.0.1", .port = 0, .max_sessions = sessions});
    ASSERT_TRUE(listening.ok()) << listening.error().message();
  }
  void steps(int n = 5) {
    for (; n > 0; --n) {
      rtapi::WaitSpec next;
      server.step(now += rtapi::kMillisecond, next);
    }
  }
  template <class F>
  bool until(F&& done) {
    for (int n = 0; n < 20000; ++n) {
      if (done()) return true;
      steps(1);
    }
    return done();
  }

  Shell shell;
  Record record;
  Server server{shell, [this]() -> rtapi::Result<std::unique_ptr<Machine>> {
                  return std::unique_ptr<Machine>(new RecordedMachine(record));
                }};
  rtapi::Nanos now{0};
};

TEST_F(RshServer, ServesFiftyClientsEachWithItsOwnState) {
  start();
  std::vector<std::unique_ptr<Client>> clients;
  clients.reserve(50);
  for (int n = 0; n < 50; ++n) clients.push_back(std::make_unique<Client>(server.port()));
  for (int n = 0; n < 50; ++n) {
    const std::string name = "client" + std::to_string(n);
    clients[static_cast<std::size_t>(n)]->send("hello EMC " + name + " 1.1\r\nset echo off\r\n" +
                                               (n % 2 == 0 ? "set verbose on\r\n" : "") +
                                               "set timeout " + std::to_string(n) +
                                               "\r\nget timeout\r\n");
  }
  for (int n = 0; n < 50; ++n) {
    const std::string wanted = std::string("HELLO ACK EMCNETSVR 1.1\r\nset echo off\r\n") +
                               (n % 2 == 0 ? "SET VERBOSE ACK\r\nSET TIMEOUT ACK\r\n" : "") +
                               "TIMEOUT " + std::to_string(n) + ".000000\r\n";
    Client& client = *clients[static_cast<std::size_t>(n)];
    EXPECT_TRUE(until([&] { return client.received().size() >= wanted.size(); }));
    EXPECT_EQ(client.received(), wanted);
  }
  EXPECT_EQ(record.alive, 50);
  clients.clear();
  EXPECT_TRUE(until([&] { return record.alive == 0; }));
}

TEST_F(RshServer, OutlivesClientsThatLeaveAtEachByte) {
  start();
  const std::string script =
      "hello EMC c 1.1\r\nset enable EMCTOO\r\nset mode mdi\r\nset mdi G0 X10\r\nquit\r\n";
  const std::size_t moves = script.find("G0 X10") + 6;
  for (std::size_t n = 0; n <= script.size(); ++n) {
    record.sent.clear();
    {
      Client client(server.port());
      client.send(std::string_view(script).substr(0, n));
      if (n % 2 == 0) client.vanish();
    }
    ASSERT_TRUE(until([&] { return server.connections() == 0; }));
    steps();
    for (const auto& line : record.sent)
      EXPECT_TRUE(line.rfind("mdi", 0) != 0 || n > moves) << "half a line moved the machine";
    EXPECT_EQ(record.alive, 0);
  }
  Client next(server.port());
  next.send("get plat\n");
  EXPECT_TRUE(until([&] { return next.received() == "PLAT Linux\r\n"; }));
}

TEST_F(RshServer, CarriesOutAScriptWhoseSenderHasEndedItsInput) {
  start();
  Client client(server.port());
  client.send("hello EMC c 1.1\nset echo off\nget plat\nget plat");
  client.end_input();
  EXPECT_TRUE(until([&] { return client.received(), client.closed; }));
  EXPECT_EQ(client.received(), "HELLO ACK EMCNETSVR 1.1\r\nset echo off\r\nPLAT Linux\r\n");
}

TEST_F(RshServer, EndsASessionWithAJogWhenItsInputEnds) {
  start();
  Client client(server.port());
  client.send("hello EMC c 1.1\nset enable EMCTOO\nset jog 0 600\n");
  ASSERT_TRUE(until([&] { return !record.sent.empty(); }));
  EXPECT_EQ(record.sent[0], "jog 0 10 in-mode=on");
  client.end_input();
  EXPECT_TRUE(until([&] { return record.alive == 0; }));
}

TEST_F(RshServer, RefusesOneClientTooMany) {
  start(2);
  Client one(server.port()), two(server.port()), three(server.port());
  EXPECT_TRUE(until([&] { return three.received(), three.closed; }));
  EXPECT_EQ(three.received(), "error: Too many sessions, at most 2\r\n");
  one.leave();
  ASSERT_TRUE(until([&] { return server.connections() == 1; }));
  Client four(server.port());
  four.send("get plat\n");
  EXPECT_TRUE(until([&] { return four.received() == "PLAT Linux\r\n"; }));
}

TEST_F(RshServer, DropsAClientThatDoesNotReadAndServesTheOthers) {
  start();
  Client deaf(server.port()), other(server.port());
  std::string flood;
  for (int n = 0; n < 2000; ++n) flood += "help get\n";
  for (int n = 0; n < 400 && server.connections() != 1; ++n) {
    // Never waits for room: the server may have stopped reading from it.
    deaf.send_some(flood);
    steps(3);
  }
  EXPECT_EQ(server.connections(), 1U);
  other.send("get plat\n");
  EXPECT_TRUE(until([&] { return other.received() == "PLAT Linux\r\n"; }));
}

TEST_F(RshServer, NamesAnAddressThatIsNone) {
  const auto listening = server.listen({.address = "nowhere", .port = 0, .max_sessions = -1});
  ASSERT_FALSE(listening.ok());
  EXPECT_NE(listening.error().message().find("nowhere"), std::string::npos);
}

}  // namespace
}  // namespace kerf::rsh::test
