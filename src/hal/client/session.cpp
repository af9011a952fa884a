#include "hal/client/session.hpp"

#include <poll.h>

#include "hal/loader/protocol.hpp"
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
  rtapi::close_fd(fd_);
  if (auto* inbox = rtapi::find_inbox(segment_, kHalService); inbox != nullptr) inbox->notify();
}

void SocketSession::wait_readable(bool writable) {
  if (clock_ != nullptr && !writable) {
    rtapi::WaitSpec spec;
    spec.watch_fd(fd_);
    spec.holds_time = true;
    clock_->wait(spec);
    return;
  }
  pollfd p{fd_, static_cast<short>(writable ? POLLOUT : POLLIN), 0};
  (void)::poll(&p, 1, -1);
}

Status SocketSession::post(std::span<const std::string> argv) {
  const std::string packet = encode_request(next_id_, argv);
  if (packet.size() > rtapi::kMaxPacket) {
    return rtapi::fail(Errc::bad_argument,
                       "command of " + std::to_string(packet.size()) + " bytes is too long");
  }
  while (true) {
    const auto sent = rtapi::send_packet(fd_, packet);
    if (sent.ok()) break;
    if (sent.error().code != Errc::busy) return sent;
    wait_readable(true);
  }
  ++next_id_;
  if (auto* inbox = rtapi::find_inbox(segment_, kHalService); inbox != nullptr) inbox->notify();
  return {};
}

Result<Reply> SocketSession::collect() {
  while (true) {
    KERF_TRY(auto packet, rtapi::receive_packet(fd_));
    if (packet.has_value()) {
      auto reply = decode_reply(*packet);
      if (!reply)
        return rtapi::fail(Errc::protocol, "the realtime host sent something that is not a reply");
      return Reply{reply->status, std::move(reply->text)};
    }
    if (clock_ != nullptr && clock_->stopped()) return rtapi::fail(Errc::cancelled, "stopped");
    wait_readable(false);
  }
}

Result<Reply> SocketSession::request(std::span<const std::string> argv) {
  KERF_CHECK(post(argv));
  return collect();
}

}  // namespace kerf::hal
