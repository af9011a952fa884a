#include "hal/client/session.hpp"

#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/socket.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::Result;
using rtapi::Status;

Result<std::string> ask(Session& session, std::initializer_list<std::string> argv) {
  KERF_TRY(Reply reply, session.request(argv));
  if (!reply.ok()) return rtapi::fail(static_cast<Errc>(reply.status), reply.text);
  return std::move(reply.text);
}

Result<std::unique_ptr<SocketSession>> SocketSession::connect(rtapi::Segment& segment) {
  KERF_TRY(const int fd,
           rtapi::connect_seqpacket(rtapi::socket_name(segment.instance(), kHalService)));
  return std::unique_ptr<SocketSession>(new SocketSession(segment, fd));
}

SocketSession::~SocketSession() {
  rtapi::close_fd(room_fd_);
  rtapi::close_fd(fd_);
  notify_host();
}

void SocketSession::notify_host() {
  if (inbox_ == nullptr) inbox_ = rtapi::find_inbox(segment_, kHalService);
  if (inbox_ != nullptr) inbox_->notify();
}

Status SocketSession::wait(bool room) {
  auto* const clock = clock_ != nullptr ? clock_ : rtapi::shim_clock(false);
  if (clock == nullptr) {
    pollfd p{fd_, static_cast<short>(room ? POLLIN | POLLOUT : POLLIN), 0};
    // Not poll(): in a program that is not ready yet, libkerf_time.so would join the virtual clock for it, or not, as fast as the
    // host happens to answer.
    (void)::syscall(SYS_ppoll, &p, 1, nullptr, nullptr, 0);
    return {};
  }
  if (clock->stopped()) return rtapi::fail(Errc::cancelled, "stopped");
  rtapi::WaitSpec spec;
  spec.watch_fd(fd_);
  if (room) {
    if (room_fd_ < 0) {
      KERF_TRY(room_fd_, rtapi::open_room_watch(fd_));
    }
    spec.watch_fd(room_fd_);
  }
  spec.holds_time = true;
  clock->wait(spec);
  return {};
}

Result<bool> SocketSession::take_replies() {
  bool any = false;
  while (true) {
    KERF_TRY(auto packet, rtapi::receive_packet(fd_));
    if (!packet.has_value()) return any;
    auto reply = decode_reply(*packet);
    if (!reply)
      return rtapi::fail(Errc::protocol, "the realtime host sent something that is not a reply");
    replies_.push_back(std::move(*reply));
    any = true;
  }
}

bool SocketSession::alive() { return take_replies().ok(); }

Status SocketSession::post(std::span<const std::string> argv) {
  // From here on others may act on the component's pins: on a virtual clock it has its turns from now, not from its first wait.
  if (clock_ == nullptr && !argv.empty() && argv[0] == "comp-ready") (void)rtapi::shim_clock(true);
  const std::string packet = encode_request(next_id_, argv);
  if (packet.size() > rtapi::kMaxPacket) {
    return rtapi::fail(Errc::bad_argument,
                       "command of " + std::to_string(packet.size()) + " bytes is too long");
  }
  while (true) {
    const auto sent = rtapi::send_packet(fd_, packet);
    if (sent.ok()) break;
    if (sent.error().code != Errc::busy) return sent;
    // The host may be waiting for us to read.
    KERF_TRY(const bool any, take_replies());
    if (!any) KERF_CHECK(wait(true));
  }
  ++next_id_;
  notify_host();
  return {};
}

Result<Reply> SocketSession::collect() {
  if (next_reply_ == next_id_) return rtapi::fail(Errc::bad_argument, "no reply is outstanding");
  const std::uint32_t wanted = next_reply_++;
  while (true) {
    while (!replies_.empty()) {
      ReplyPacket reply = std::move(replies_.front());
      replies_.pop_front();
      if (reply.id == wanted) return Reply{reply.status, std::move(reply.text)};
      // An older one was given up. The difference, not the numbers: they wrap.
      if (static_cast<std::int32_t>(reply.id - wanted) > 0) {
        return rtapi::fail(Errc::protocol, "the realtime host left out a reply");
      }
    }
    KERF_TRY(const bool any, take_replies());
    if (!any) KERF_CHECK(wait(false));
  }
}

Result<Reply> SocketSession::request(std::span<const std::string> argv) {
  KERF_CHECK(post(argv));
  // Replies to posts before it that nobody has collected are not this one's.
  next_reply_ = next_id_ - 1;
  return collect();
}

}  // namespace kerf::hal
