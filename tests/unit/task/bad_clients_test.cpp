// What clients may send that nobody should: the sender alone gets an error, the others are answered, the machine stands.
#include <gmock/gmock.h>

#include <random>

#include "rtapi/shm/socket.hpp"
#include "served.hpp"

namespace kerf::task::testing {
namespace {

/// A client that sends bytes, without the checks of Client.
class RawClient {
 public:
  explicit RawClient(const std::string& instance) {
    auto fd = rtapi::connect_seqpacket(rtapi::socket_name(instance, kTaskService));
    EXPECT_TRUE(fd.ok()) << fd.error().message();
    if (fd.ok()) fd_ = *fd;
  }
  ~RawClient() { close(); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  void close() {
    if (fd_ >= 0) rtapi::close_fd(fd_);
    fd_ = -1;
  }
  bool send(std::string_view packet) const { return rtapi::send_packet(fd_, packet).ok(); }
  std::vector<Reply> replies() const {
    std::vector<Reply> out;
    for (;;) {
      const auto packet = rtapi::receive_packet(fd_);
      if (!packet.ok() || !packet->has_value()) return out;
      auto reply = parse_reply(**packet);
      EXPECT_TRUE(reply.ok()) << **packet;
      if (reply.ok()) out.push_back(*reply);
    }
  }

 private:
  int fd_{-1};
};

std::string packet_of(std::uint64_t id, const std::vector<std::string>& words) {
  return request_from_words(id, words).value();
}

double way(const Rig& rig) { return std::abs(rig.fake->status.pos_cmd.x); }

struct BadClients : ::testing::Test {
  BadClients() { rig.ready(); }
  /// A new client is answered.
  void expect_service() {
    RawClient next(rig.instance);
    ASSERT_TRUE(next.send(packet_of(77, {"message", "here"})));
    rig.run_for(0.05);
    const auto replies = next.replies();
    ASSERT_FALSE(replies.empty());
    EXPECT_EQ(replies.back().id, 77U);
    EXPECT_EQ(replies.back().state, CommandState::done) << replies.back().text;
  }
  Served rig;
};

TEST_F(BadClients, each_beginning_of_a_packet_is_refused_and_moves_nothing) {
  const std::string whole = packet_of(5, {"mdi", "G0 X3"});
  RawClient client(rig.instance);
  for (std::size_t length = 1; length < whole.size(); ++length) {
    ASSERT_TRUE(client.send(whole.substr(0, length)));
    rig.run_for(0.2);
    const auto replies = client.replies();
    ASSERT_EQ(replies.size(), 1U) << whole.substr(0, length);
    EXPECT_EQ(replies[0].state, CommandState::error);
    EXPECT_FALSE(replies[0].text.empty());
  }
  EXPECT_EQ(way(rig), 0);
  ASSERT_TRUE(client.send(whole));
  rig.run_for(1);
  EXPECT_EQ(way(rig), 3) << "the same client is served when its packet is whole";
}

TEST_F(BadClients, those_that_leave_in_the_middle_of_a_packet_leave_nothing_behind) {
  const std::string whole = packet_of(5, {"mdi", "G0 X3"});
  for (std::size_t length = 0; length < whole.size(); ++length) {
    RawClient client(rig.instance);
    if (length > 0) {
      ASSERT_TRUE(client.send(whole.substr(0, length)));
    }
    if (length % 2 == 0) rig.run_for(0.002);
    client.close();
    rig.run_for(0.002);
  }
  rig.run_for(0.02);  // a beat: in virtual time sockets are looked at then
  EXPECT_EQ(way(rig), 0);
  EXPECT_EQ(rig.status().clients, 0);
  expect_service();
}

TEST_F(BadClients, fifty_of_them_half_with_garbage) {
  std::mt19937 dice(4711);
  const auto before = rig.status().commands;
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int n = 0; n < 50; ++n) {
    clients.push_back(std::make_unique<RawClient>(rig.instance));
    rig.run_for(0.002);
  }
  const std::vector<std::string> wrong = {std::string(2, char{0}),
                                          "[]",
                                          "null",
                                          "\xff\xfe\xfd",
                                          R"({"id":-1,"cmd":"mdi","text":"G0 X9"})",
                                          R"({"id":1e99,"cmd":"mdi","text":"G0 X9"})",
                                          R"({"id":1,"cmd":["mdi"],"text":"G0 X9"})",
                                          R"({"id":1,"cmd":"mdi","text":[7]})",
                                          R"({"id":1,"cmd":"mdi","text":"G0 X9","more":1})",
                                          R"({"id":1,"cmd":"jog","what":"x","speed":"fast"})",
                                          std::string(100, '{'),
                                          std::string(5000, '['),
                                          std::string(60000, 'G')};
  std::vector<int> sent(50);
  for (int round = 0; round < 20; ++round) {
    for (int n = 0; n < 50; ++n) {
      RawClient& client = *clients[static_cast<std::size_t>(n)];
      if (n % 2 == 0) {
        ASSERT_TRUE(client.send(
            packet_of(static_cast<std::uint64_t>(1000 * n + round + 1), {"message", "good"})));
      } else if (round % 2 == 0) {
        ASSERT_TRUE(client.send(wrong[dice() % wrong.size()]));
      } else {
        std::string noise(1 + dice() % 200, '\0');
        for (char& c : noise) c = static_cast<char>(dice());
        ASSERT_TRUE(client.send(noise));
      }
      ++sent[static_cast<std::size_t>(n)];
    }
    rig.run_for(0.02);
  }
  for (int n = 0; n < 50; ++n) {
    const auto replies = clients[static_cast<std::size_t>(n)]->replies();
    int ended = 0;
    for (const Reply& reply : replies) {
      ended += is_terminal(reply.state) ? 1 : 0;
      if (n % 2 == 0) {
        EXPECT_EQ(reply.id / 1000, static_cast<std::uint64_t>(n)) << "what another one asked for";
        EXPECT_NE(reply.state, CommandState::error) << reply.text;
      } else {
        EXPECT_EQ(reply.state, CommandState::error) << reply.id << " " << reply.text;
      }
    }
    EXPECT_EQ(ended, sent[static_cast<std::size_t>(n)]) << "client " << n;
  }
  const auto after = rig.status().commands;
  EXPECT_EQ(after.errors - before.errors, 500U);
  EXPECT_EQ(after.done - before.done, 500U);
  EXPECT_EQ(way(rig), 0);
  clients.clear();
  rig.run_for(0.01);
  expect_service();
}

TEST_F(BadClients, commands_in_the_wrong_state_are_refused_to_their_sender) {
  rig.does({"state", "off"});
  RawClient one(rig.instance);
  RawClient other(rig.instance);
  std::uint64_t id = 0;
  for (const auto& words : std::vector<std::vector<std::string>>{{"mdi", "G0 X3"},
                                                                 {"jog", "0", "5"},
                                                                 {"home"},
                                                                 {"run"},
                                                                 {"step"},
                                                                 {"spindle", "forward", "100"}}) {
    ASSERT_TRUE(one.send(packet_of(++id, words)));
    rig.run_for(0.2);
    const auto replies = one.replies();
    ASSERT_FALSE(replies.empty()) << words[0];
    EXPECT_EQ(replies.back().id, id);
    EXPECT_EQ(replies.back().state, CommandState::error) << words[0];
    EXPECT_TRUE(other.replies().empty());
  }
  EXPECT_EQ(way(rig), 0);
  expect_service();
}

}  // namespace
}  // namespace kerf::task::testing
