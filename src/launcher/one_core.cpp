#include "launcher/one_core.hpp"

#include <string>

#include "rtapi/shm/socket.hpp"

namespace kerf::launcher {

OneCore::~OneCore() { rtapi::close_fd(mark_); }

bool OneCore::take() {
  if (mark_ >= 0 || sched_getaffinity(0, sizeof all_, &all_) != 0 || CPU_COUNT(&all_) < 2)
    return false;
  const int here = sched_getcpu();
  for (int k = 0; k < CPU_SETSIZE; ++k) {
    const int core = here >= 0 ? (here + k) % CPU_SETSIZE : k;
    if (!CPU_ISSET(static_cast<unsigned>(core), &all_)) continue;
    // An address that one process has at a time, and that is free again with its end, however it ends.
    const auto mark = rtapi::listen_seqpacket("kerf-core-" + std::to_string(core));
    if (!mark.ok()) continue;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<unsigned>(core), &one);
    if (sched_setaffinity(0, sizeof one, &one) == 0) {
      mark_ = *mark;
      return true;
    }
    rtapi::close_fd(*mark);
  }
  return false;
}

}  // namespace kerf::launcher
