// I/O ports: reads and writes that a right was got for. Realtime.
#include <rtapi.h>
#include <rtapi_io.h>

#include <cerrno>

#include "hal/capi/messages.hpp"
#include "rtapi/sync/cell.hpp"

#if defined(__x86_64__) || defined(__i386__)
#include <sys/io.h>
#define KERF_HAS_PORTS 1
#else
#define KERF_HAS_PORTS 0
#endif

namespace kerf::hal::capi {
namespace {

constexpr unsigned kPorts = 65536;
constexpr unsigned kWordBits = 64;
rtapi::Word<std::uint64_t> granted[kPorts / kWordBits];
rtapi::Word<std::uint32_t> complained{0};

}  // namespace

/// Ordinary thread only.
void grant_ports(unsigned long from, unsigned long count, bool on) noexcept {
  for (unsigned long port = from; port < from + count && port < kPorts; ++port) {
    auto& word = granted[port / kWordBits];
    const std::uint64_t bit = std::uint64_t{1} << (port % kWordBits);
    word.publish(on ? word.get() | bit : word.get() & ~bit);
  }
}

/// @rt. `width` bytes from `port` may be used; if not, it is said once.
bool may_use(unsigned port, unsigned width) noexcept {
  bool ok = KERF_HAS_PORTS != 0 && port + width <= kPorts;
  for (unsigned i = 0; ok && i < width; ++i) {
    const unsigned at = port + i;
    ok = ((granted[at / kWordBits].observe() >> (at % kWordBits)) & 1U) != 0;
  }
  if (!ok && complained.add(1) == 1) {
    say(RTAPI_MSG_ERR,
        "RTAPI: ERROR: no right to I/O port 0x%x: nothing is read or written; start as root or "
        "with "
        "CAP_SYS_RAWIO, and ask for the port with rtapi_ioperm or rtapi_parport_get\n",
        port);
  }
  return ok;
}

}  // namespace kerf::hal::capi

using kerf::hal::capi::may_use;

extern "C" {
#if KERF_HAS_PORTS
unsigned char rtapi_inb(unsigned int port) {
  return may_use(port, 1) ? inb(static_cast<unsigned short>(port)) : 0xff;
}
unsigned short rtapi_inw(unsigned int port) {
  return may_use(port, 2) ? inw(static_cast<unsigned short>(port)) : 0xffff;
}
unsigned int rtapi_inl(unsigned int port) {
  return may_use(port, 4) ? inl(static_cast<unsigned short>(port)) : 0xffffffffU;
}
void rtapi_outb(unsigned char byte, unsigned int port) {
  if (may_use(port, 1)) outb(byte, static_cast<unsigned short>(port));
}
void rtapi_outw(unsigned short value, unsigned int port) {
  if (may_use(port, 2)) outw(value, static_cast<unsigned short>(port));
}
void rtapi_outl(unsigned int value, unsigned int port) {
  if (may_use(port, 4)) outl(value, static_cast<unsigned short>(port));
}
#else
unsigned char rtapi_inb(unsigned int port) { return may_use(port, 1) ? 0 : 0xff; }
unsigned short rtapi_inw(unsigned int port) { return may_use(port, 2) ? 0 : 0xffff; }
unsigned int rtapi_inl(unsigned int port) { return may_use(port, 4) ? 0 : 0xffffffffU; }
void rtapi_outb(unsigned char, unsigned int port) { (void)may_use(port, 1); }
void rtapi_outw(unsigned short, unsigned int port) { (void)may_use(port, 2); }
void rtapi_outl(unsigned int, unsigned int port) { (void)may_use(port, 4); }
#endif
}  // extern "C"
