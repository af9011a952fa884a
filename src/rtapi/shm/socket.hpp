// Packet sockets between the processes of an instance: SOCK_SEQPACKET in the abstract namespace, so nothing is left behind
// and the end of a process is an end of file at its peers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rtapi/base/result.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::rtapi {

class Segment;

/// Largest packet that is sent or received.
inline constexpr std::size_t kMaxPacket = 192U << 10U;

/// All descriptors are non-blocking and close-on-exec. `address` comes from socket_name().
Result<int> listen_seqpacket(const std::string& address);
Result<int> connect_seqpacket(const std::string& address);
/// nullopt: nobody waits to be accepted.
Result<std::optional<int>> accept_seqpacket(int listener);
/// busy: the peer does not read (try later); dead: it is gone.
Status send_packet(int fd, std::string_view packet);
/// nullopt: nothing there at present; dead: closed by the peer.
Result<std::optional<std::string>> receive_packet(int fd);
/// 0 when unknown.
std::int64_t peer_pid(int fd);
void close_fd(int fd) noexcept;

/// Cell that whoever sends to a service notifies after sending, so that on the virtual clock the service runs at the same
/// instant. The service makes it; nullptr from find_inbox when it did not (yet).
Result<Cell*> make_inbox(Segment& segment, std::string_view service);
Cell* find_inbox(Segment& segment, std::string_view service);
/// A cell with a name of its own in the segment; made on first use, by a process that may make blocks.
Result<Cell*> make_cell(Segment& segment, const std::string& name);

}  // namespace kerf::rtapi
