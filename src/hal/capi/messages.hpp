// rtapi_print and its kin: text from realtime functions through a ring, from everything else straight out.
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdint>

#include "rtapi/sync/cell.hpp"
#include "rtapi/sync/seq_cell.hpp"

namespace kerf::hal::capi {

/// A message on its way out of a realtime thread. Longer ones are cut.
struct Message {
  static constexpr std::size_t kText = 1023;
  std::uint64_t number{0};  ///< 1, 2, 3 ...
  std::int32_t level{0};
  char text[kText + 1]{};
};

/// Writers: any number of realtime threads, each message takes a slot of its own. Reader: the ordinary thread. A reader that is kSlots
/// behind has lost the oldest and sees it from the numbers.
class MessageRing {
 public:
  static constexpr std::uint64_t kSlots = 64;
  /// @rt.
  void write(std::int32_t level, const char* fmt, std::va_list args) noexcept;
  [[nodiscard]] std::uint64_t newest() const noexcept { return next_.get(); }
  /// False while the slot is being written or when the message is gone.
  [[nodiscard]] bool read(std::uint64_t number, Message& out) const noexcept {
    return slot_[number % kSlots].read(out) && out.number == number;
  }

 private:
  rtapi::Word<std::uint64_t> next_{0};
  rtapi::SeqCell<Message> slot_[kSlots];
};

/// Puts text out at once; `level` 5 is rtapi_print's. Called by ordinary threads only.
using DirectOutput = void (*)(int level, const char* text);
/// Until this is called nothing is printed. With `ring` false every thread of the process prints directly (programs); with true
/// only the calling thread does.
void start_messages(DirectOutput output, bool ring) noexcept;
/// Ordinary thread: prints what realtime functions have said since, and how many messages were lost. Gives how many.
int drain_messages() noexcept;
/// From now on the calling thread is the ordinary one, and not the one that was.
void let_this_thread_in() noexcept;
/// True in the ordinary thread, which at first is the one that called start_messages(), and everywhere in programs.
[[nodiscard]] bool in_ordinary_thread() noexcept;
/// @rt. What rtapi_print_msg does.
[[gnu::format(printf, 2, 3)]] void say(int level, const char* fmt, ...) noexcept;

}  // namespace kerf::hal::capi
