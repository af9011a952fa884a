// Arena: gives out and takes back memory of one region of the segment. Its books are private memory of the writer's process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "rtapi/base/result.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal {

using rtapi::Offset;

/// Best fit with joining of neighbours, so that loading and unloading in any order and of any sizes does not grow the segment
/// for ever. Sizes are rounded up to a cache line.
class Arena {
 public:
  static constexpr std::size_t kGrain = 64;

  Arena(rtapi::Segment& segment, rtapi::Region region) : segment_(segment), region_(region) {}

  /// Zero-filled, aligned to kGrain.
  rtapi::Result<Offset> allocate(std::size_t bytes);
  /// `bytes` as they were asked for.
  void give_back(Offset offset, std::size_t bytes);

  /// Taken from the segment, ever.
  [[nodiscard]] std::uint64_t bytes_taken() const noexcept { return bytes_taken_; }
  [[nodiscard]] std::uint64_t bytes_free() const noexcept { return bytes_free_; }
  /// nullptr, or what is wrong with the books.
  [[nodiscard]] const char* wrong() const;
  /// True when some of the bytes are free.
  [[nodiscard]] bool is_free(Offset offset, std::size_t bytes) const;

 private:
  void insert(Offset offset, std::size_t bytes);
  void erase(std::map<Offset, std::size_t>::iterator at);

  rtapi::Segment& segment_;
  rtapi::Region region_;
  std::map<Offset, std::size_t> by_place_;
  std::set<std::pair<std::size_t, Offset>> by_size_;
  std::uint64_t bytes_taken_{0};
  std::uint64_t bytes_free_{0};
};

}  // namespace kerf::hal
