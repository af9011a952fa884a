// A user component for tests: probe_component NAME exports NAME.in and NAME.out and copies one to the other until it is ended.
#include <signal.h>

#include <cstdio>
#include <string>

#include "hal/client/user_component.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/segment.hpp"

namespace {
kerf::rtapi::WaitClock* running = nullptr;
void on_signal(int /*signal*/) {
  if (running != nullptr) running->stop();
}
}  // namespace

int main(int argc, char** argv) {
  using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file
  const std::string name = argc > 1 ? argv[1] : "probe";
  auto segment = rtapi::Segment::attach(rtapi::default_instance());
  if (!segment.ok()) return 2;
  auto session = hal::SocketSession::connect(**segment);
  if (!session.ok()) return 3;
  auto clock = rtapi::join_clock(**segment, rtapi::Role::user_component, name);
  if (!clock.ok()) return 4;
  (*session)->use_clock(clock->get());
  running = clock->get();
  ::signal(SIGTERM, on_signal);
  {
    hal::UserComponent comp(**session, name);
    auto in = comp.pin<hal::LinkIn<double>>("in");
    auto out = comp.pin<hal::LinkOut<double>>("out");
    if (const auto ready = comp.ready(); !ready.ok()) {
      std::fprintf(stderr, "%s\n", ready.error().message().c_str());
      return 5;
    }
    while (!(*clock)->stopped()) {
      out = in.get();
      rtapi::WaitSpec spec;
      spec.wake_at((*clock)->now() + rtapi::kMillisecond);
      (*clock)->wait(spec);
    }
  }
  running = nullptr;
  return 0;
}
