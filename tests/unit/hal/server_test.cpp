#include "hal/loader/server.hpp"

#include <signal.h>
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

TEST_F(ServerTest, AClientThatDoesNotReadBlocksNobody) {
  auto lazy = std::move(SocketSession::connect(*segment_)).value();
  auto busy = std::move(SocketSession::connect(*segment_)).value();
  const std::string words[] = {"net", std::string(3000, 'x')};
  int sent = 0;
  for (; sent < 3000; ++sent) {
    if (!rtapi::send_packet(lazy->fd(), encode_request(1, words)).ok()) serve();
  }
  const std::string good[] = {"loadrt", "adder"};
  ASSERT_TRUE(busy->post(good).ok());
  serve();
  EXPECT_TRUE(busy->collect()->ok());
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
