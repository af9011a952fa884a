#include "task/api/client.hpp"

#include "rtapi/shm/socket.hpp"
#include "task/api/message_reader.hpp"

namespace kerf::task {

using rtapi::Errc;
using rtapi::fail;

namespace {
constexpr std::size_t kKeptReplies = 1000;
}

rtapi::Result<std::unique_ptr<Client>> Client::connect(rtapi::Segment& segment) {
  auto block = segment.find<TaskShared>(kTaskBlock, kTaskAbi);
  if (!block.ok()) return rtapi::Failure{block.error()};
  if ((*block)->ready.observe() == 0)
    return fail(Errc::not_found,
                "milltask of instance '" + segment.instance() + "' is not ready yet");
  auto fd = rtapi::connect_seqpacket(rtapi::socket_name(segment.instance(), kTaskService));
  if (!fd.ok()) return rtapi::Failure{fd.error()};
  std::unique_ptr<Client> client(new Client());
  client->shared_ = *block;
  client->fd_ = *fd;
  client->cursor_ = client->shared_->messages.newest.observe();
  client->shared_->inbox.notify();
  return client;
}

Client::~Client() { end_connection("closed"); }

void Client::end_connection(const char* why) {
  if (fd_ < 0) return;
  rtapi::close_fd(fd_);
  fd_ = -1;
  shared_->inbox.notify();
  for (auto& [id, reply] : replies_)
    if (!is_terminal(reply.state)) reply.state = CommandState::error, reply.text = why;
}

rtapi::Result<std::uint64_t> Client::send(const std::vector<std::string>& words) {
  const std::uint64_t id = next_id();
  KERF_TRY(const std::string packet, request_from_words(id, words));
  KERF_CHECK(send_json(packet));
  replies_[id] = Reply{id, CommandState::received, {}};
  return id;
}

rtapi::Status Client::send_json(const std::string& json) {
  if (fd_ < 0) return fail(Errc::dead, "the connection to milltask has ended");
  auto sent = rtapi::send_packet(fd_, json);
  if (!sent.ok() && sent.error().code == Errc::dead) end_connection("milltask has ended");
  if (sent.ok()) shared_->inbox.notify();
  return sent;
}

rtapi::Status Client::poll() {
  while (fd_ >= 0) {
    auto packet = rtapi::receive_packet(fd_);
    if (!packet.ok()) {
      end_connection("milltask has ended");
      if (packet.error().code == Errc::dead) return fail(Errc::dead, "milltask has ended");
      return rtapi::Failure{packet.error()};
    }
    if (!packet->has_value()) return {};
    auto reply = parse_reply(**packet);
    if (!reply.ok()) return rtapi::Failure{reply.error()};
    replies_[reply->id] = *reply;
    while (replies_.size() > kKeptReplies) replies_.erase(replies_.begin());
  }
  return fail(Errc::dead, "the connection to milltask has ended");
}

std::optional<Reply> Client::outcome(std::uint64_t id) const {
  const auto at = replies_.find(id);
  if (at == replies_.end()) return std::nullopt;
  return at->second;
}

bool Client::finished(std::uint64_t id) const {
  const auto reply = outcome(id);
  return reply && is_terminal(reply->state);
}

rtapi::Result<Reply> Client::wait(std::uint64_t id, rtapi::WaitClock& clock, rtapi::Nanos limit) {
  for (;;) {
    rtapi::WaitSpec spec;
    add_to(spec);
    (void)poll();
    if (finished(id)) return *outcome(id);
    if (fd_ < 0) return fail(Errc::dead, "milltask has ended");
    if (clock.stopped()) return fail(Errc::cancelled, "stopped");
    if (clock.now() >= limit) return fail(Errc::busy, "no outcome in time");
    spec.wake_at(limit);
    clock.wait(spec);
  }
}

void Client::add_to(rtapi::WaitSpec& spec) const {
  add_replies_to(spec);
  spec.watch(shared_->status_cell);
}

void Client::add_replies_to(rtapi::WaitSpec& spec) const {
  spec.watch(shared_->reply_cell);
  if (fd_ >= 0) spec.watch_fd(fd_);
}

std::vector<OperatorMessage> Client::new_messages(std::uint64_t* lost) {
  return read_messages(shared_->messages, cursor_, lost);
}

}  // namespace kerf::task
