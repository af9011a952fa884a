// The client protocol: one table, exact words, and a client over a real socket.
#include <gmock/gmock.h>

#include "served.hpp"

namespace kerf::task::testing {
namespace {

using ::testing::HasSubstr;

TEST(Protocol, table_is_complete_and_in_order) {
  int n = 0;
  for (const auto& c : commands()) {
    EXPECT_EQ(static_cast<int>(c.id), n++);
    EXPECT_NE(std::string(c.help), "") << c.name;
    EXPECT_EQ(find_command(c.name), &c);
    EXPECT_THAT(help_text(), HasSubstr(c.name));
    EXPECT_THAT(protocol_markdown(), HasSubstr(c.name));
  }
}

std::string error_of(const std::string& json) {
  const auto r = parse_request(json);
  EXPECT_FALSE(r.ok());
  return r.ok() ? "" : r.error().text;
}

TEST(Protocol, refusals_say_what_was_expected) {
  EXPECT_THAT(error_of("x"), HasSubstr("not a JSON object"));
  EXPECT_THAT(error_of("{}"), HasSubstr("no id"));
  EXPECT_THAT(error_of(R"({"id":1,"cmd":"mdii","text":"G0"})"), HasSubstr("did you mean 'mdi'"));
  EXPECT_THAT(error_of(R"({"id":1,"cmd":"mdi"})"), HasSubstr("text is missing"));
  EXPECT_THAT(error_of(R"({"id":1,"cmd":"mode","mode":"manuel"})"),
              HasSubstr("did you mean 'manual'"));
  EXPECT_THAT(error_of(R"({"id":1,"cmd":"feed-override","value":"much"})"),
              HasSubstr("expected a number"));
  EXPECT_THAT(error_of(R"({"id":1,"cmd":"feed-override","valu":1})"),
              HasSubstr("did you mean 'value'"));
  EXPECT_THAT(error_of(R"({"id":1,"cmd":"home","joint":1.5})"), HasSubstr("whole number"));
}

TEST(Protocol, words_become_requests) {
  const auto json = request_from_words(7, {"jog", "x", "-10", "distance=2.5"});
  ASSERT_TRUE(json.ok());
  const auto r = parse_request(*json);
  ASSERT_TRUE(r.ok());
  EXPECT_EQ(r->id, 7u);
  EXPECT_EQ(r->text("what"), "x");
  EXPECT_EQ(r->number("speed"), -10);
  EXPECT_EQ(r->number("distance"), 2.5);
  EXPECT_TRUE(parse_request(*request_from_words(1, {"mdi", "G0", "X1"})).ok());
  EXPECT_EQ(parse_request(*request_from_words(1, {"mdi", "G0", "X1"}))->text("text"), "G0 X1");
  EXPECT_TRUE(parse_request(*request_from_words(1, {"flood", "on"}))->flag("on"));
  EXPECT_FALSE(request_from_words(1, {"home", "1", "2"}).ok());
}

TEST(Protocol, replies_survive_the_wire) {
  const auto r = parse_reply(format_reply({9, CommandState::error, "line \"3\"\nand more"}));
  ASSERT_TRUE(r.ok());
  EXPECT_EQ(r->id, 9u);
  EXPECT_EQ(r->state, CommandState::error);
  EXPECT_EQ(r->text, "line \"3\"\nand more");
  EXPECT_FALSE(parse_reply("{\"id\":1}").ok());
}

TEST(Protocol, client_gets_each_outcome_once_and_the_messages) {
  Served rig;
  auto connected = Client::connect(*rig.segment);
  ASSERT_TRUE(connected.ok()) << connected.error().message();
  Client& client = **connected;
  const auto wait = [&](std::uint64_t id) {
    rig.run_until([&] { return (void)client.poll(), client.finished(id); }, 10);
    return client.outcome(id).value_or(Reply{});
  };
  EXPECT_EQ(wait(*client.send({"state", "estop-reset"})).state, CommandState::done);
  EXPECT_EQ(wait(*client.send({"state", "on"})).state, CommandState::done);
  EXPECT_EQ(wait(*client.send({"mdi", "G0 X1"})).state, CommandState::error);
  const auto messages = client.new_messages();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].text.view(), "Can't issue MDI command when not homed");
  EXPECT_TRUE(client.new_messages().empty());
  EXPECT_EQ(wait(*client.send({"home"})).state, CommandState::done);
  EXPECT_EQ(wait(*client.send({"mdi", "G0 X1"})).state, CommandState::done);
  TaskStatus status;
  ASSERT_TRUE(client.status(status));
  EXPECT_EQ(status.clients, 1);
  ASSERT_TRUE(client.send_json("not json").ok());
  EXPECT_THAT(wait(*client.send({"errors", "0"})).text, HasSubstr("not homed"));
}

TEST(Protocol, end_of_the_connection_stops_its_jogs_and_no_others) {
  Served rig;
  rig.power_on();
  auto one = std::move(Client::connect(*rig.segment).value());
  auto two = std::move(Client::connect(*rig.segment).value());
  (void)one->send({"jog", "0", "5"});
  (void)two->send({"jog", "1", "5"});
  rig.run_for(0.05);
  EXPECT_EQ(rig.fake->intent.joint_jog[0].kind, motion::JogIntent::Kind::continuous);
  one.reset();
  rig.run_for(0.05);
  EXPECT_EQ(rig.fake->intent.joint_jog[0].kind, motion::JogIntent::Kind::none);
  EXPECT_EQ(rig.fake->intent.joint_jog[1].kind, motion::JogIntent::Kind::continuous);
}

TEST(Protocol, client_sees_the_end_of_task) {
  Served rig;
  auto client = std::move(Client::connect(*rig.segment).value());
  const auto id = *client->send({"wait"});
  rig.stop();
  EXPECT_FALSE(client->poll().ok());
  EXPECT_TRUE(client->finished(id));
  EXPECT_FALSE(client->connected());
  EXPECT_FALSE(Client::connect(*rig.segment).ok());
}

}  // namespace
}  // namespace kerf::task::testing
