// Clients of the command thread: packets in, replies out, leases.
#include <algorithm>

#include "rtapi/shm/socket.hpp"
#include "task/command/command_participant.hpp"

namespace kerf::task {

namespace {
constexpr int kPacketsPerStep = 16;  ///< of one client: nobody may keep the heartbeat waiting
constexpr rtapi::Nanos kAcceptPause = 100 * rtapi::kMillisecond;  ///< after a failed accept
constexpr std::size_t kMaxOutbox = 4096;     ///< a client that does not read is dropped
constexpr std::size_t kKeptReplies = 10000;  ///< of submit()
}  // namespace

rtapi::Status CommandParticipant::listen(const std::string& address) {
  auto fd = rtapi::listen_seqpacket(address);
  if (!fd.ok()) return rtapi::Failure{fd.error()};
  listener_ = *fd;
  return {};
}

void CommandParticipant::serve_clients() {
  while (accepts()) {
    auto fd = rtapi::accept_seqpacket(listener_);
    if (!fd.ok()) accept_again_ = now_ + kAcceptPause;
    if (!fd.ok() || !fd->has_value()) break;
    auto client = std::make_unique<ClientLink>();
    client->number = ++last_client_;
    client->fd = **fd;
    client->heard = now_;
    clients_.push_back(std::move(client));
  }
  while (!local_in_.empty()) {
    const std::string packet = std::move(local_in_.front());
    local_in_.pop_front();
    heard_local_ = now_;
    take_packet(kLocal, packet);
  }
  for (std::size_t i = 0; i < clients_.size(); ++i) {
    ClientLink& client = *clients_[i];
    for (int n = 0; n < kPacketsPerStep; ++n) {
      auto packet = rtapi::receive_packet(client.fd);
      if (!packet.ok()) client.dead = true;
      if (!packet.ok() || !packet->has_value()) break;
      client.heard = now_;
      take_packet(client.number, **packet);
    }
    if (client.dead) client_gone(client);
  }
  std::erase_if(clients_, [](const auto& c) { return c->dead; });
}

void CommandParticipant::client_gone(ClientLink& client) {
  stop_jogs(client.number);
  // Its commands go on; nobody is told how they end, but they are counted.
  for (auto& [ticket, pending] : pending_)
    if (pending.client == client.number) pending.client = kNobody;
  rtapi::close_fd(client.fd);
  client.fd = -1;
}

void CommandParticipant::take_packet(int client, const std::string& packet) {
  ++counters_.received;
  auto request = parse_request(packet);
  if (!request.ok()) {
    ++counters_.errors;
    reply_to(client, Reply{request.error().id, CommandState::error, request.error().text});
    return;
  }
  if (client != kLocal) echo_serial_ = std::max(echo_serial_, request->id);
  const Ticket ticket = open_ticket(client, *request);
  execute(ticket, *request, client);
  // What is not carried out at once is acknowledged.
  if (pending_.contains(ticket)) reply_to(client, Reply{request->id, CommandState::received, {}});
}

Ticket CommandParticipant::open_ticket(int client, const Request& request) {
  const Ticket ticket = ++last_ticket_;
  Pending& pending = pending_[ticket];
  pending.client = client;
  pending.id = request.id;
  pending.command = request.command->id;
  pending.from_cycle = status_.cycle;
  pending.fault_mark = faults_seen_;
  pending.epoch = epoch_;
  return ticket;
}

Ticket CommandParticipant::internal_ticket(CommandId command) {
  const Ticket ticket = ++last_ticket_;
  ++counters_.received;
  Pending& pending = pending_[ticket];
  pending.command = command;
  pending.from_cycle = status_.cycle;
  pending.epoch = epoch_;
  return ticket;
}

void CommandParticipant::reply(Ticket ticket, CommandState state, const std::string& text) {
  const auto at = pending_.find(ticket);
  if (at == pending_.end()) return;
  const int client = at->second.client;
  // Every client's screen shows what was refused, whoever asked for it; what was said already for this answer is not said twice.
  if (state == CommandState::error && client != kNobody) {
    if (last_said_.empty() || text.find(last_said_) == std::string::npos)
      say(MessageKind::error, text);
    last_said_.clear();
  }
  reply_to(client, Reply{at->second.id, state, text});
  if (!is_terminal(state)) return;
  if (is_program(at->second.command) && at->second.order) journal_end(state, text);
  last_failed_ = state != CommandState::done;
  ++(state == CommandState::done    ? counters_.done
     : state == CommandState::error ? counters_.errors
                                    : counters_.aborted);
  pending_.erase(at);
}

void CommandParticipant::reply_to(int client, const Reply& reply) {
  if (client == kNobody) return;
  if (client == kLocal) {
    local_out_[reply.id] = reply;
    while (local_out_.size() > kKeptReplies) local_out_.erase(local_out_.begin());
    return;
  }
  for (auto& c : clients_)
    if (c->number == client) c->outbox.push_back(format_reply(reply));
}

void CommandParticipant::send_replies() {
  bool sent = false;
  for (auto& c : clients_) {
    while (!c->outbox.empty()) {
      auto status = rtapi::send_packet(c->fd, c->outbox.front());
      if (!status.ok() && status.error().code == rtapi::Errc::busy && c->outbox.size() < kMaxOutbox)
        break;
      if (!status.ok()) {
        c->outbox.clear();
        client_gone(*c);
        c->dead = true;
        break;
      }
      c->outbox.pop_front();
      sent = true;
    }
  }
  std::erase_if(clients_, [](const auto& c) { return c->dead; });
  if (sent) p_.shared.reply_cell.notify();
}

std::uint64_t CommandParticipant::submit(const std::vector<std::string>& words) {
  const std::uint64_t id = ++last_local_id_;
  auto json = request_from_words(id, words);
  if (json.ok()) {
    submit_json(*json);
  } else {
    local_out_[id] = Reply{id, CommandState::error, std::string(json.error().what.view())};
  }
  return id;
}

void CommandParticipant::submit_json(std::string json) {
  local_in_.push_back(std::move(json));
  p_.shared.inbox.notify();
}

std::optional<Reply> CommandParticipant::outcome(std::uint64_t id) const {
  const auto at = local_out_.find(id);
  if (at == local_out_.end()) return std::nullopt;
  return at->second;
}

}  // namespace kerf::task
