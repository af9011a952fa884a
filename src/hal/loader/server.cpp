#include "hal/loader/server.hpp"

#include <algorithm>
#include <utility>

#include "hal/loader/protocol.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal {

using rtapi::Epoll;
using rtapi::Errc;
using rtapi::Result;

namespace {

/// Requests of one client that are done before the others have their turn.
constexpr int kBatch = 64;
/// Clients that never stop asking must not keep cycles, signals and the end of the supervisor waiting.
constexpr int kMostRequests = 1024;
constexpr rtapi::Nanos kMostTime = 20 * rtapi::kMillisecond;
/// Unread replies after which a client is not read from.
constexpr std::size_t kMostUnread = 4096;
constexpr std::size_t kMostUnreadBytes = 1U << 20U;
/// Without descriptors nobody can be accepted; looked at again after this time.
constexpr rtapi::Nanos kListenerPause = 100 * rtapi::kMillisecond;
/// A longer reply is cut: it quotes what the client has sent.
constexpr std::size_t kLongestText = rtapi::kMaxPacket - 64;

// Tags of the epoll: numbers of clients are odd, of processes even.
constexpr std::uint64_t kListenerTag = 0;
constexpr std::uint64_t client_tag(std::uint64_t number) { return number * 2 + 1; }
constexpr std::uint64_t process_tag(std::uint64_t number) { return number * 2; }

}  // namespace

Result<std::unique_ptr<Server>> Server::open(Host& host, rtapi::Segment& segment,
                                             const std::string& instance) {
  KERF_TRY(auto epoll, Epoll::open());
  KERF_TRY(const int listener, rtapi::listen_seqpacket(rtapi::socket_name(instance, kHalService)));
  auto inbox = rtapi::make_inbox(segment, kHalService);
  auto watched = epoll.add(listener, kListenerTag, Epoll::readable);
  if (!inbox.ok() || !watched.ok()) {
    rtapi::close_fd(listener);
    return rtapi::Failure{inbox.ok() ? watched.error() : inbox.error()};
  }
  return std::unique_ptr<Server>(new Server(host, listener, *inbox, std::move(epoll)));
}

Server::~Server() {
  while (!clients_.empty()) drop_client(clients_.begin()->first);
  for (const auto& [number, process] : processes_) rtapi::close_fd(process.pidfd);
  rtapi::close_fd(listener_);
}

void Server::pause_listener(bool paused) {
  if (paused == listener_paused_) return;
  listener_paused_ = paused;
  epoll_.change(listener_, kListenerTag, paused ? 0U : unsigned{Epoll::readable});
}

Server::Process& Server::process_of(int fd) {
  const std::int64_t pid = rtapi::peer_pid(fd);
  for (auto& [number, process] : processes_) {
    // Readable: that one is dead, and its number has been given again.
    if (process.pid == pid && process.pidfd >= 0 && !rtapi::is_readable(process.pidfd))
      return process;
  }
  const std::uint64_t number = next_number_++;
  const int pidfd = rtapi::open_pidfd(pid);
  if (pidfd >= 0) (void)epoll_.add(pidfd, process_tag(number), Epoll::readable);
  return processes_.emplace(number, Process{number, pid, pidfd, 0}).first->second;
}

void Server::accept_new(int& budget) {
  for (; budget > 0; --budget) {
    auto fd = rtapi::accept_seqpacket(listener_);
    if (!fd.ok()) {
      if (!std::exchange(accept_failed_, true)) rtapi::log_error(fd.error());
      pause_listener(true);
      return;
    }
    accept_failed_ = false;
    if (!fd->has_value()) return;
    Process& process = process_of(**fd);
    const std::uint64_t number = next_number_++;
    if (!epoll_.add(**fd, client_tag(number), Epoll::readable).ok()) {
      rtapi::close_fd(**fd);
      continue;
    }
    ++process.connections;
    Client client{};
    client.fd = **fd;
    client.number = number;
    client.process = process.number;
    client.watched = Epoll::readable;
    clients_.emplace(number, std::move(client));
  }
}

void Server::look_at_process(std::uint64_t number) {
  const auto it = processes_.find(number);
  if (it == processes_.end()) return;
  Process& process = it->second;
  if (process.pidfd >= 0 && rtapi::is_readable(process.pidfd)) {
    epoll_.remove(process.pidfd);
    rtapi::close_fd(process.pidfd);
    process.pidfd = -1;
  }
  if (process.connections > 0) return;
  // Without a trace in HAL its end is of no interest.
  if (process.pidfd >= 0 && host_.holds(number)) return;
  host_.process_gone(number);
  rtapi::close_fd(process.pidfd);
  processes_.erase(it);
}

void Server::drop_client(std::uint64_t number) {
  const auto it = clients_.find(number);
  const std::uint64_t process = it->second.process;
  host_.client_gone(number);
  rtapi::close_fd(it->second.fd);
  clients_.erase(it);
  if (const auto owner = processes_.find(process); owner != processes_.end())
    --owner->second.connections;
  look_at_process(process);
  pause_listener(false);
}

bool Server::flush(Client& client) {
  while (!client.unsent.empty()) {
    const auto sent = rtapi::send_packet(client.fd, client.unsent.front());
    if (!sent.ok()) return sent.error().code == Errc::busy;
    client.unsent_bytes -= client.unsent.front().size();
    client.unsent.pop_front();
  }
  return true;
}

void Server::watch_client(Client& client) {
  const bool full = client.unsent.size() >= kMostUnread || client.unsent_bytes >= kMostUnreadBytes;
  const unsigned what = (full ? 0U : unsigned{Epoll::readable}) |
                        (client.unsent.empty() ? 0U : unsigned{Epoll::writable});
  if (what == client.watched) return;
  client.watched = what;
  epoll_.change(client.fd, client_tag(client.number), what);
}

bool Server::serve_client(Client& client, int& budget) {
  --budget;  // also a client that only takes its replies has had a turn
  if (!flush(client)) return false;
  const Process& process = processes_.at(client.process);
  const Caller caller{client.number, process.pid, process.number};
  for (int i = 0; i < kBatch && budget > 0; ++i) {
    if (client.unsent.size() >= kMostUnread || client.unsent_bytes >= kMostUnreadBytes) break;
    auto packet = rtapi::receive_packet(client.fd);
    if (!packet.ok()) return false;
    if (!packet->has_value()) break;
    const auto request = decode_request(**packet);
    if (!request) return false;  // not one of ours: there is no telling what it wants
    --budget;
    Reply reply = host_.command(request->argv, caller);
    if (before_reply_) before_reply_();
    if (reply.text.size() > kLongestText) reply.text.resize(kLongestText);
    client.unsent.push_back(encode_reply({request->id, reply.status, std::move(reply.text)}));
    client.unsent_bytes += client.unsent.back().size();
    if (!flush(client)) return false;
  }
  watch_client(client);
  return true;
}

bool Server::serve_within(int& budget) {
  // Before looking: what comes from now on is seen by the next wait.
  inbox_seen_ = inbox_->count();
  auto tags = epoll_.ready(clients_.size() + processes_.size() + 2);
  if (tags.empty()) return false;
  // The order of connecting, begun after the one that was served last: the same in each run on the virtual clock, and fair when
  // the budget is used up in the middle.
  std::sort(tags.begin(), tags.end());
  std::vector<std::uint64_t> asking;
  for (const std::uint64_t tag : tags) {
    if (tag == kListenerTag)
      accept_new(budget);
    else if (tag % 2 == 0)
      look_at_process(tag / 2);
    else
      asking.push_back(tag / 2);
  }
  const auto next = std::upper_bound(asking.begin(), asking.end(), last_served_);
  std::rotate(asking.begin(), next, asking.end());
  const rtapi::Nanos begin = host_.clock().now();
  for (const std::uint64_t number : asking) {
    if (budget <= 0) break;
    const auto client = clients_.find(number);
    if (client == clients_.end()) continue;
    last_served_ = number;
    if (!serve_client(client->second, budget)) drop_client(number);
    if (host_.clock().now() - begin > kMostTime) budget = 0;
  }
  return true;
}

bool Server::serve() {
  int budget = kMostRequests;
  return serve_within(budget);
}

bool Server::serve_all() {
  if (listener_paused_) pause_listener(false);
  int budget = kMostRequests;
  while (budget > 0) {
    const int before = budget;
    if (!serve_within(budget)) return true;
    // Nothing but a listener that cannot accept.
    if (budget == before && listener_paused_) return true;
  }
  return false;
}

bool Server::was_told() const noexcept { return inbox_->count() != inbox_seen_; }

void Server::watch(rtapi::Nanos now, rtapi::WaitSpec& spec) const {
  // On the real clock the sockets are enough, and a cell would be looked at each millisecond.
  if (host_.clock().is_virtual()) (void)spec.cells.push_back({inbox_, inbox_seen_});
  spec.watch_fd(epoll_.fd());
  if (listener_paused_) spec.wake_at(now + kListenerPause);
}

}  // namespace kerf::hal
