#include "hal/capi/messages.hpp"

#include <rtapi.h>

#include "hal/capi/format.hpp"

namespace kerf::hal::capi {
namespace {

MessageRing ring;
std::uint64_t ring_seen = 0;
DirectOutput direct = nullptr;
bool use_ring = false;
rtapi::Word<const void*> ordinary_thread{nullptr};
rtapi::Word<std::int32_t> msg_level{RTAPI_MSG_ERR};

void default_handler(msg_level_t level, const char* fmt, std::va_list args) {
  if (!in_ordinary_thread()) {
    ring.write(level, fmt, args);
    return;
  }
  if (direct == nullptr) return;
  if (use_ring) drain_messages();  // what was said before comes first
  char text[Message::kText + 1];
  format_text(text, sizeof text, fmt, args);
  direct(level, text);
}

rtapi::Word<rtapi_msg_handler_t> handler{&default_handler};

}  // namespace

void MessageRing::write(std::int32_t level, const char* fmt, std::va_list args) noexcept {
  Message message;
  format_text(message.text, sizeof message.text, fmt, args);
  message.number = next_.add(1);
  message.level = level;
  slot_[message.number % kSlots].write(message);
}

void start_messages(DirectOutput output, bool with_ring) noexcept {
  direct = output;
  use_ring = with_ring;
  let_this_thread_in();
}

void let_this_thread_in() noexcept { ordinary_thread.set(__builtin_thread_pointer()); }

int drain_messages() noexcept {
  if (direct == nullptr) return 0;
  const std::uint64_t newest = ring.newest();
  int printed = 0;
  if (newest - ring_seen > MessageRing::kSlots) {
    char text[80];
    const auto lost = newest - ring_seen - MessageRing::kSlots;
    const auto put = [&](const char* fmt, ...) {
      std::va_list args;
      va_start(args, fmt);
      format_text(text, sizeof text, fmt, args);
      va_end(args);
    };
    put("%llu messages of realtime functions were lost\n", static_cast<unsigned long long>(lost));
    direct(RTAPI_MSG_ERR, text);
    ring_seen = newest - MessageRing::kSlots;
  }
  while (ring_seen < newest) {
    Message message;
    if (!ring.read(ring_seen + 1, message)) {
      // Being written now: the next call prints it. Overwritten meanwhile: gone.
      if (ring.newest() - ring_seen <= MessageRing::kSlots) break;
    } else {
      direct(message.level, message.text);
      ++printed;
    }
    ++ring_seen;
  }
  return printed;
}

bool in_ordinary_thread() noexcept {
  return !use_ring || __builtin_thread_pointer() == ordinary_thread.get();
}

void say(int level, const char* fmt, ...) noexcept {
  if (level > msg_level.get()) return;
  std::va_list args;
  va_start(args, fmt);
  handler.get()(static_cast<msg_level_t>(level), fmt, args);
  va_end(args);
}

}  // namespace kerf::hal::capi

using namespace kerf::hal::capi;  // NOLINT(google-build-using-namespace): the published names

extern "C" {

int rtapi_vsnprintf(char* buffer, unsigned long size, const char* fmt, std::va_list ap) {
  return format_text(buffer, size, fmt, ap);
}

int rtapi_snprintf(char* buffer, unsigned long size, const char* fmt, ...) {
  std::va_list args;
  va_start(args, fmt);
  const int n = format_text(buffer, size, fmt, args);
  va_end(args);
  return n;
}

void rtapi_print(const char* fmt, ...) {
  std::va_list args;
  va_start(args, fmt);
  handler.get()(RTAPI_MSG_ALL, fmt, args);
  va_end(args);
}

void rtapi_print_msg(msg_level_t level, const char* fmt, ...) {
  if (static_cast<int>(level) > msg_level.get() || msg_level.get() == RTAPI_MSG_NONE) return;
  std::va_list args;
  va_start(args, fmt);
  handler.get()(level, fmt, args);
  va_end(args);
}

int rtapi_set_msg_level(int level) {
  msg_level.set(level);
  return 0;
}

int rtapi_get_msg_level(void) { return msg_level.get(); }

void rtapi_set_msg_handler(rtapi_msg_handler_t new_handler) {
  handler.set(new_handler != nullptr ? new_handler : &default_handler);
}

rtapi_msg_handler_t rtapi_get_msg_handler(void) { return handler.get(); }

}  // extern "C"
