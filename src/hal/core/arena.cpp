#include "hal/core/arena.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>

namespace kerf::hal {
namespace {

/// What is taken from the segment at a time.
constexpr std::size_t kChunkBytes = 256U << 10U;

constexpr std::size_t rounded(std::size_t bytes) {
  return (std::max<std::size_t>(bytes, 1) + Arena::kGrain - 1) / Arena::kGrain * Arena::kGrain;
}

}  // namespace

void Arena::insert(Offset offset, std::size_t bytes) {
  auto next = by_place_.lower_bound(offset);
  if (next != by_place_.end() && offset + bytes == next->first) {
    bytes += next->second;
    erase(next++);
  }
  if (next != by_place_.begin()) {
    const auto before = std::prev(next);
    if (before->first + before->second == offset) {
      offset = before->first;
      bytes += before->second;
      erase(before);
    }
  }
  by_place_.emplace(offset, bytes);
  by_size_.emplace(bytes, offset);
}

void Arena::erase(std::map<Offset, std::size_t>::iterator at) {
  by_size_.erase({at->second, at->first});
  by_place_.erase(at);
}

rtapi::Result<Offset> Arena::allocate(std::size_t bytes) {
  if (bytes > rtapi::Segment::kMostBytes)
    return rtapi::fail(rtapi::Errc::no_memory, "more memory asked for than any segment has");
  bytes = rounded(bytes);
  auto fit = by_size_.lower_bound({bytes, 0});
  if (fit == by_size_.end()) {
    // A whole chunk if the region has it, else exactly what is needed.
    std::size_t size = std::max(bytes, kChunkBytes);
    auto fresh = segment_.extend(region_, size);
    if (!fresh.ok() && size > bytes) {
      size = bytes;
      fresh = segment_.extend(region_, size);
    }
    if (!fresh.ok()) return rtapi::Failure{fresh.error()};
    bytes_taken_ += size;
    bytes_free_ += size;
    insert(*fresh, size);
    fit = by_size_.lower_bound({bytes, 0});
  }
  const auto [size, offset] = *fit;
  erase(by_place_.find(offset));
  if (size > bytes) insert(offset + bytes, size - bytes);
  bytes_free_ -= bytes;
  std::memset(segment_.at<std::byte>(offset), 0, bytes);
  return offset;
}

void Arena::give_back(Offset offset, std::size_t bytes) {
  insert(offset, rounded(bytes));
  bytes_free_ += rounded(bytes);
}

bool Arena::is_free(Offset offset, std::size_t bytes) const {
  const auto next = by_place_.lower_bound(offset + bytes);
  if (next == by_place_.begin()) return false;
  const auto before = std::prev(next);
  return before->first + before->second > offset;
}

const char* Arena::wrong() const {
  std::uint64_t sum = 0;
  Offset end = 0;
  for (const auto& [offset, bytes] : by_place_) {
    if (end != 0 && offset <= end) return "free pieces overlap or were not joined";
    end = offset + bytes;
    sum += bytes;
    if (by_size_.count({bytes, offset}) == 0) return "a free piece is not in the books by size";
    if (!segment_.in_use(offset, bytes)) return "a free piece was never taken from the segment";
  }
  if (by_size_.size() != by_place_.size()) return "the two books differ";
  return sum == bytes_free_ ? nullptr : "the sum of the free pieces is wrong";
}

}  // namespace kerf::hal
