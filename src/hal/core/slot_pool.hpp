// SlotPool: 8-byte slots, packed, lowest place first, so that what is made together stands together also after reloads.
#pragma once

#include <bit>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>

#include "hal/core/arena.hpp"

namespace kerf::hal {

class SlotPool {
 public:
  static constexpr std::size_t kSlotBytes = 8;
  static constexpr std::size_t kPageSlots = 512;

  explicit SlotPool(Arena& arena) : arena_(arena) {}

  rtapi::Result<Offset> take() {
    if (with_room_.empty()) {
      KERF_TRY(const Offset page, arena_.allocate(kPageSlots * kSlotBytes));
      Page& fresh = pages_[page];
      for (auto& word : fresh.free) word = ~std::uint64_t{0};
      with_room_.insert(page);
    }
    const Offset at = *with_room_.begin();
    Page& page = pages_[at];
    std::size_t word = 0;
    while (page.free[word] == 0) ++word;
    const auto bit = static_cast<std::size_t>(std::countr_zero(page.free[word]));
    page.free[word] &= page.free[word] - 1;
    if (++page.taken == kPageSlots) with_room_.erase(at);
    ++taken_;
    return at + (word * 64 + bit) * kSlotBytes;
  }
  void give_back(Offset slot) {
    const auto it = std::prev(pages_.upper_bound(slot));
    const std::size_t index = (slot - it->first) / kSlotBytes;
    it->second.free[index / 64] |= std::uint64_t{1} << (index % 64);
    --it->second.taken;
    --taken_;
    with_room_.insert(it->first);
  }
  /// True for a slot that was taken and not given back.
  [[nodiscard]] bool holds(Offset slot) const {
    const auto next = pages_.upper_bound(slot);
    if (next == pages_.begin()) return false;
    const auto it = std::prev(next);
    const std::size_t index = (slot - it->first) / kSlotBytes;
    return index < kPageSlots && slot % kSlotBytes == 0 &&
           (it->second.free[index / 64] >> (index % 64) & 1U) == 0;
  }
  [[nodiscard]] std::size_t taken() const noexcept { return taken_; }

 private:
  struct Page {
    std::uint64_t free[kPageSlots / 64]{};
    std::size_t taken{0};
  };
  Arena& arena_;
  std::map<Offset, Page> pages_;
  std::set<Offset> with_room_;
  std::size_t taken_{0};
};

}  // namespace kerf::hal
