#include "hal/loader/server.hpp"
#include "harness/no_tsan.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/client/user_component.hpp"
#include "hal/loader/protocol.hpp"
#include "rtapi/shm/socket.hpp"
#include "unit/hal/fixture.hpp"

namespace kerf::hal::test {
namespace {

class ServerTest : public testing::Test {
 protected:
  ServerTest() {
    instance_ = "test-server-" + std::to_string(::getpid());
    segment_ = std::move(rtapi::Segment::create(instance_)).value();
    host_ = std::move(Host::create(*segment_, clock_, modules_)).value();
    server_ = std::move(Server::open(*host_, *segment_, instance_)).value();
  }
  ~ServerTest() override {
    server_.reset();
    host_.reset();
    segment_.reset();
    (void)rtapi::Segment::remove(instance_);
  }
  void serve() {
    while (server_->serve()) {
    }
  }
  std::string instance_;
  std::unique_ptr<rtapi::Segment> segment_;
  ManualClock clock_;
  StaticSource modules_{test_modules()};
  std::unique_ptr<Host> host_;
  std::unique_ptr<Server> server_;
};

TEST_F(ServerTest, PipelinedRequestsAreAnsweredInOrder) {
  auto session = std::move(SocketSession::connect(*segment_)).value();
  const std::vector<std::vector<std::string>> script = {{"loadrt", "adder", "names=a,b"},
                                                        {"net", "s", "a.out", "b.in"},
                                                        {"net", "s", "b.out"},
                                                        {"setp", "a.in", "4"}};
  for (const auto& line : script) ASSERT_TRUE(session->post(line).ok());
  serve();
  EXPECT_TRUE(session->collect()->ok());
  EXPECT_TRUE(session->collect()->ok());
  EXPECT_EQ(session->collect()->text,
            "Signal 's' can not add OUT pin 'b.out', it already has OUT pin 'a.out'");
  EXPECT_TRUE(session->collect()->ok());
  EXPECT_EQ(*View(*segment_).value("a.in"), "4");
}

TEST_F(ServerTest, MessagesOfACommandAreOutBeforeItsReply) {
  auto session = std::move(SocketSession::connect(*segment_)).value();
  std::vector<bool> seen;  // by the hook: the command has been done, nothing has been answered
  server_->before_reply([&] {
    pollfd reply{session->fd(), POLLIN, 0};
    seen.push_back(View(*segment_).value("a.in").ok() && ::poll(&reply, 1, 0) == 0);
  });
  ASSERT_TRUE(session->post(std::vector<std::string>{"loadrt", "adder", "names=a"}).ok());
  serve();
  EXPECT_TRUE(session->collect()->ok());
  EXPECT_EQ(seen, std::vector<bool>{true});
}

/// Whoever waits on it lets the host work, as on the virtual clock.
class ServingClock final : public rtapi::WaitClock {
 public:
  explicit ServingClock(Server& server) : server_(server) {}
  [[nodiscard]] rtapi::Nanos now() const noexcept override { return 0; }
  [[nodiscard]] bool is_virtual() const noexcept override { return true; }
  void wait(const rtapi::WaitSpec& spec) override {
    EXPECT_TRUE(spec.holds_time);
    EXPECT_FALSE(spec.fds.empty());
    ++waits;
    if (dead_host) return stop();
    (void)server_.serve();
  }
  void stop() noexcept override { stop_ = true; }
  [[nodiscard]] bool stopped() const noexcept override { return stop_; }
  int waits{0};
  bool dead_host{false};  ///< nobody answers, and the user's patience ends

 private:
  Server& server_;
  bool stop_{false};
};

TEST_F(ServerTest, AnyNumberOfRequestsCanBeUnderWay) {
  auto session = std::move(SocketSession::connect(*segment_)).value();
  ServingClock clock(*server_);
  session->use_clock(&clock);
  ASSERT_TRUE(host_->command({"loadrt", "adder"}).ok());
  constexpr int kRequests = 20'000;
  for (int i = 0; i < kRequests; ++i) {
    const std::string words[] = {"setp", i % 7 == 1 ? "adder.0.im" : "adder.0.in",
                                 std::to_string(i)};
    ASSERT_TRUE(session->post(words).ok());
  }
  EXPECT_GT(clock.waits, 0);  // there was no room, and the wait let the host work
  for (int i = 0; i < kRequests; ++i) {
    auto reply = session->collect();
    ASSERT_TRUE(reply.ok());
    ASSERT_EQ(reply->ok(), i % 7 != 1) << i << ": " << reply->text;
  }
  EXPECT_FALSE(session->collect().ok());  // nothing is outstanding, and that is no reason to wait
  EXPECT_EQ(*View(*segment_).value("adder.0.in"), std::to_string(kRequests - 1));
}

TEST_F(ServerTest, RepliesKeepStepAfterACancelledRequest) {
  auto session = std::move(SocketSession::connect(*segment_)).value();
  {
    ServingClock impatient(*server_);
    impatient.dead_host = true;
    session->use_clock(&impatient);
    EXPECT_EQ(session->request({"loadrt", "nothing-like-it"}).error().code, rtapi::Errc::cancelled);
    EXPECT_EQ(session->request({"newsig", "s"}).error().code, rtapi::Errc::cancelled);
  }
  ServingClock clock(*server_);
  session->use_clock(&clock);
  EXPECT_EQ(session->request({"setp", "x"})->text, "setp requires 2 arguments, 1 given");
  const std::string words[] = {"newsig", "s", "bit"};
  ASSERT_TRUE(session->post(words).ok());
  EXPECT_EQ(session->request({"newsig", "s", "bit"})->text, "duplicate signal 's'");
  EXPECT_TRUE(session->alive());
  server_.reset();
  EXPECT_FALSE(session->alive());
  EXPECT_EQ(session->request({"setp", "x"}).error().code, rtapi::Errc::dead);
}

TEST_F(ServerTest, AClientThatDoesNotReadBlocksNobody) {
  auto lazy = std::move(SocketSession::connect(*segment_)).value();
  auto busy = std::move(SocketSession::connect(*segment_)).value();
  const std::string words[] = {"net", std::string(3000, 'x')};
  const std::string good[] = {"loadrt", "adder"};
  for (int sent = 0; sent < 10'000; ++sent) {
    if (!rtapi::send_packet(lazy->fd(), encode_request(1, words)).ok()) {
      if (!server_->serve()) break;  // it is not read from any more
    }
  }
  ASSERT_TRUE(busy->post(good).ok());
  serve();
  EXPECT_TRUE(busy->collect()->ok());
  EXPECT_EQ(server_->clients(), 2U);
  // It starts to read, and all that it has asked for is done.
  int replies = 0;
  for (int idle = 0; idle < 3; ++idle) {
    for (auto packet = rtapi::receive_packet(lazy->fd()); packet.ok() && packet->has_value();
         packet = rtapi::receive_packet(lazy->fd())) {
      ++replies;
      idle = 0;
    }
    serve();
  }
  EXPECT_GT(replies, 64);
  EXPECT_EQ(server_->clients(), 2U);
}

TEST_F(ServerTest, EverybodyHasATurnBesideOneThatFloods) {
  auto flood = std::move(SocketSession::connect(*segment_)).value();
  std::vector<std::unique_ptr<SocketSession>> others;
  others.reserve(20);
  for (int i = 0; i < 20; ++i)
    others.push_back(std::move(SocketSession::connect(*segment_)).value());
  const std::string words[] = {"newsig", "s", "bit"};
  while (rtapi::send_packet(flood->fd(), encode_request(1, words)).ok()) {
  }
  for (auto& other : others) ASSERT_TRUE(other->post(words).ok());
  (void)server_->serve();  // accepts
  (void)server_->serve();
  for (auto& other : others) {
    EXPECT_TRUE(rtapi::receive_packet(other->fd())->has_value());
  }
}

class DescriptorLimit {
 public:
  explicit DescriptorLimit(rlim_t wanted) {
    ::getrlimit(RLIMIT_NOFILE, &old_);
    rlimit changed = old_;
    changed.rlim_cur = std::min(wanted, old_.rlim_max);
    ::setrlimit(RLIMIT_NOFILE, &changed);
    enough_ = changed.rlim_cur == wanted;
  }
  ~DescriptorLimit() { ::setrlimit(RLIMIT_NOFILE, &old_); }
  DescriptorLimit(const DescriptorLimit&) = delete;
  DescriptorLimit& operator=(const DescriptorLimit&) = delete;
  [[nodiscard]] bool enough() const { return enough_; }

 private:
  rlimit old_{};
  bool enough_{false};
};

TEST_F(ServerTest, AThousandClients) {
  const DescriptorLimit limit(4096);  // both ends of each are in this process
  if (!limit.enough()) GTEST_SKIP() << "this user may not open 4096 descriptors";
  constexpr int kClients = 1000;
  std::vector<std::unique_ptr<SocketSession>> clients;
  for (int i = 0; i < kClients; ++i) {
    clients.push_back(std::move(SocketSession::connect(*segment_)).value());
    const std::string words[] = {"comp-new", "u" + std::to_string(i)};
    ASSERT_TRUE(clients.back()->post(words).ok());
  }
  rtapi::WaitSpec spec;
  server_->watch(0, spec);
  EXPECT_EQ(spec.fds.size(), 1U);
  serve();
  EXPECT_EQ(server_->clients(), static_cast<std::size_t>(kClients));
  for (auto& client : clients) ASSERT_TRUE(client->collect()->ok());
  const View view(*segment_);
  EXPECT_EQ(view.components().size(), static_cast<std::size_t>(kClients));
  clients.resize(kClients / 2);
  serve();
  EXPECT_EQ(view.components().size(), static_cast<std::size_t>(kClients / 2));
  EXPECT_EQ(server_->clients(), static_cast<std::size_t>(kClients / 2));
}

TEST_F(ServerTest, WithoutDescriptorsOthersWaitAndNothingSpins) {
  auto first = std::move(SocketSession::connect(*segment_)).value();
  serve();
  std::vector<std::unique_ptr<SocketSession>> later;
  later.reserve(4);
  for (int i = 0; i < 4; ++i) later.push_back(std::move(SocketSession::connect(*segment_)).value());
  const std::string words[] = {"newsig", "s", "bit"};
  {
    const int next = ::dup(0);
    ::close(next);
    const DescriptorLimit limit(static_cast<rlim_t>(next) + 1);
    EXPECT_TRUE(server_->serve_all());  // done, as far as it goes
    rtapi::WaitSpec spec;
    server_->watch(1000, spec);
    EXPECT_GT(spec.until, 1000);
    EXPECT_LT(spec.until, rtapi::kForever);
    ASSERT_TRUE(first->post(words).ok());
    EXPECT_TRUE(server_->serve_all());
    EXPECT_TRUE(first->collect()->ok());
  }
  EXPECT_TRUE(server_->serve_all());
  EXPECT_EQ(server_->clients(), 5U);
}

TEST_F(ServerTest, BombsHurtTheirSenderOnly) {
  auto good = std::move(SocketSession::connect(*segment_)).value();
  const auto connect = [&] { return std::move(SocketSession::connect(*segment_)).value(); };
  // Longer than a packet may be: half of it must not pass for a command.
  std::vector<std::unique_ptr<SocketSession>> bombers;
  const int bytes = 1 << 20;
  bombers.push_back(connect());
  (void)::setsockopt(bombers.back()->fd(), SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  const std::string words[] = {"newsig", "s", "bit"};
  std::string big = encode_request(1, words);
  for (std::uint32_t i = 0; big.size() <= rtapi::kMaxPacket; ++i)
    big += std::string("\4\0\0\0word", 8);
  ASSERT_EQ(::send(bombers.back()->fd(), big.data(), big.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(big.size()));
  bombers.push_back(connect());
  ASSERT_EQ(::send(bombers.back()->fd(), "", 0, MSG_NOSIGNAL), 0);
  serve();
  EXPECT_EQ(server_->clients(), 1U);
  // Odd, but within the rules: an error, and the connection stays.
  const std::vector<std::vector<std::string>> odd = {
      std::vector<std::string>(40'000, ""),
      {std::string(150'000, 'n')},
      {"net", std::string(150'000, 's'), "p"},
      {"setp", std::string(50'000, 'p'), "1"},
      {"loadrt", std::string(100'000, '/')},
      {"loadrt", "adder", "count=" + std::string(100'000, '9')},
      {"loadrt", "adder", "count=99999999"},
      {"comp-new", std::string("a\0b", 3)},
      {"comp-new", ""},
      {"addf", "adder.0", "x", "99999999999999999999"}};
  for (const auto& line : odd) {
    ASSERT_TRUE(good->post(line).ok());
    serve();
    auto reply = good->collect();
    ASSERT_TRUE(reply.ok());
    EXPECT_FALSE(reply->ok()) << line[0].substr(0, 20);
  }
  EXPECT_EQ(server_->clients(), 1U);
  EXPECT_TRUE(View(*segment_).components().empty());
}

TEST_F(ServerTest, GarbageEndsTheConnectionOnly) {
  auto bad = std::move(SocketSession::connect(*segment_)).value();
  auto good = std::move(SocketSession::connect(*segment_)).value();
  for (const std::string& packet : {std::string("x"), std::string("\1\0\0\0\xff\xff\xff\xff", 8)}) {
    (void)rtapi::send_packet(bad->fd(), packet);
  }
  serve();
  EXPECT_EQ(server_->clients(), 1U);
  EXPECT_FALSE(bad->collect().ok());
  const std::string words[] = {"loadrt", "adder"};
  ASSERT_TRUE(good->post(words).ok());
  serve();
  EXPECT_TRUE(good->collect()->ok());
}

/// Kills a client after each possible number of requests: nothing of it may stay.
TEST_F(ServerTest, AKilledClientLeavesNothing) {
  KERF_NOT_UNDER_TSAN();
  ASSERT_TRUE(host_->command({"loadrt", "adder"}).ok());
  const std::vector<std::vector<std::string>> script = {
      {"comp-new", "u"},
      {"pin-new", "u", "u.in", "s32", "IN"},
      {"param-new", "u", "u.p", "bit", "RW", "TRUE"},
      {"net", "s", "adder.0.out", "u.in"},
      {"comp-ready", "u"},
      {"unlinkp", "u.in"}};
  const View view(*segment_);
  for (std::size_t n = 0; n <= script.size(); ++n) {
    int go[2];
    ASSERT_EQ(::pipe(go), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      auto session = SocketSession::connect(*segment_);
      for (std::size_t i = 0; session.ok() && i < n; ++i) (void)(*session)->post(script[i]);
      (void)!::write(go[1], "x", 1);
      ::pause();
      ::_exit(0);
    }
    char byte = 0;
    ASSERT_EQ(::read(go[0], &byte, 1), 1);
    if (n % 2 == 0) serve();  // half of the cases: the requests are read after the death
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    serve();
    EXPECT_EQ(server_->clients(), 0U) << n;
    EXPECT_FALSE(view.find_component("u").has_value()) << n;
    EXPECT_FALSE(view.find_pin("u.in").has_value()) << n;
    EXPECT_FALSE(view.find_param("u.p").has_value()) << n;
    EXPECT_TRUE(view.find_pin("adder.0.out").has_value()) << n;
    (void)host_->command({"delsig", "s"});
    ::close(go[0]);
    ::close(go[1]);
  }
}

TEST_F(ServerTest, ASecondHostIsRefused) {
  auto second = Server::open(*host_, *segment_, instance_);
  ASSERT_FALSE(second.ok());
}

TEST(Protocol, RoundTripAndShortPackets) {
  const std::string words[] = {"net", "", std::string("a\0b", 3)};
  const std::string packet = encode_request(77, words);
  const auto request = decode_request(packet);
  ASSERT_TRUE(request.has_value());
  EXPECT_EQ(request->id, 77U);
  EXPECT_THAT(request->argv, testing::ElementsAreArray(words));
  for (std::size_t n = 0; n < packet.size(); ++n) (void)decode_request(packet.substr(0, n));
  EXPECT_FALSE(decode_request(packet.substr(0, packet.size() - 1)).has_value());
  const auto reply = decode_reply(encode_reply({5, -3, "text"}));
  ASSERT_TRUE(reply.has_value());
  EXPECT_EQ(reply->status, -3);
  EXPECT_EQ(reply->text, "text");
}

}  // namespace
}  // namespace kerf::hal::test
