#include "hal/loader/server.hpp"

#include "hal/loader/protocol.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/shm/socket.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::Result;

namespace {
/// Requests of one client that are done before the others have their turn.
constexpr int kBatch = 64;
/// A client that never stops asking must not keep cycles, signals and the end of the supervisor waiting.
constexpr int kMostRounds = 16;
}  // namespace

Result<std::unique_ptr<Server>> Server::open(Host& host, rtapi::Segment& segment,
                                             const std::string& instance) {
  KERF_TRY(const int listener, rtapi::listen_seqpacket(rtapi::socket_name(instance, kHalService)));
  auto inbox = rtapi::make_inbox(segment, kHalService);
  if (!inbox.ok()) {
    rtapi::close_fd(listener);
    return rtapi::Failure{inbox.error()};
  }
  return std::unique_ptr<Server>(new Server(host, listener, *inbox));
}

Server::~Server() {
  for (const auto& client : clients_) {
    host_.client_gone(client->number);
    rtapi::close_fd(client->fd);
  }
  rtapi::close_fd(listener_);
}

bool Server::accept_new() {
  bool any = false;
  while (clients_.size() < kMostClients) {
    auto fd = rtapi::accept_seqpacket(listener_);
    if (!fd.ok() || !fd->has_value()) break;
    clients_.push_back(
        std::make_unique<Client>(Client{**fd, next_number_++, rtapi::peer_pid(**fd), {}}));
    any = true;
  }
  return any;
}

bool Server::flush(Client& client) {
  while (!client.unsent.empty()) {
    const auto sent = rtapi::send_packet(client.fd, client.unsent.front());
    if (!sent.ok()) return sent.error().code == Errc::busy;
    client.unsent.pop_front();
  }
  return true;
}

bool Server::serve_client(Client& client, bool& worked) {
  if (!flush(client)) return false;
  for (int i = 0; i < kBatch; ++i) {
    auto packet = rtapi::receive_packet(client.fd);
    if (!packet.ok()) return false;
    if (!packet->has_value()) return true;
    worked = true;
    const auto request = decode_request(**packet);
    if (!request) return false;  // not one of ours: there is no telling what it wants
    const Reply reply = host_.command(request->argv, client.number, client.pid);
    client.unsent.push_back(encode_reply({request->id, reply.status, reply.text}));
    if (client.unsent.size() > kMostUnread || !flush(client)) return false;
  }
  return true;
}

bool Server::serve() {
  inbox_seen_ = inbox_->count();
  bool worked = accept_new();
  for (std::size_t i = 0; i < clients_.size();) {
    Client& client = *clients_[i];
    if (serve_client(client, worked)) {
      ++i;
      continue;
    }
    worked = true;
    host_.client_gone(client.number);
    rtapi::close_fd(client.fd);
    clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return worked;
}

bool Server::serve_all() {
  for (int round = 0; round < kMostRounds; ++round)
    if (!serve()) return true;
  return false;
}

void Server::watch(rtapi::Nanos now, rtapi::WaitSpec& spec) const {
  (void)spec.cells.push_back({inbox_, inbox_seen_});
  if (clients_.size() < kMostClients) spec.watch_fd(listener_);
  for (const auto& client : clients_) {
    spec.watch_fd(client->fd);
    // A full socket is looked at again: WaitSpec knows only readable ones.
    if (!client->unsent.empty()) spec.wake_at(now + rtapi::kMillisecond);
  }
}

}  // namespace kerf::hal
