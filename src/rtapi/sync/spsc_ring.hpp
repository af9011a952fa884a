// SpscRing: a bounded queue of one producer and one consumer, in shared memory.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "rtapi/base/fetch.hpp"

namespace kerf::rtapi {

/// Capacity N (a power of two) of trivially copyable T. Both sides are wait-free (@rt). Indices only grow, so full and
/// empty need no spare slot. An index that a dead or broken peer left out of range reads as empty or full, never past
/// the array.
template <class T, std::size_t N>
class SpscRing {
  static_assert(std::has_single_bit(N), "N is a power of two");
  static_assert(std::is_trivially_copyable_v<T>, "elements are copied as bytes");

 public:
  /// Producer. False: full.
  [[nodiscard]] bool push(const T& item) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);  // the producer's own
    // Acquire: the consumer has finished reading the slot that is written next.
    if (head - tail_.load(std::memory_order_acquire) >= N) return false;
    items_[head & (N - 1)] = item;
    // Release: whoever sees the new head sees the item.
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// Consumer. The oldest item, or nullptr; valid until pop().
  [[nodiscard]] const T* front() const noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);  // the consumer's own
    // Acquire: pairs with push.
    const std::uint64_t available = head_.load(std::memory_order_acquire) - tail;
    if (available == 0 || available > N) return nullptr;
    return &items_[tail & (N - 1)];
  }
  /// Consumer. The item `i` places behind the oldest, or nullptr.
  [[nodiscard]] const T* peek(std::uint64_t i) const noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    const std::uint64_t available = head_.load(std::memory_order_acquire) - tail;
    if (available > N || i >= available) return nullptr;
    return &items_[(tail + i) & (N - 1)];
  }
  /// Consumer. Begins to fetch the item `i` places behind the oldest. Who takes items now and then finds them far from his caches.
  void fetch(std::uint64_t i) const noexcept {
    rtapi::fetch(&items_[(tail_.load(std::memory_order_relaxed) + i) & (N - 1)], sizeof(T));
  }
  /// Consumer. Drops the oldest; nothing when empty.
  void pop() noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (head_.load(std::memory_order_acquire) == tail) return;
    // Release: our reads of the slot are done before the producer may write it.
    tail_.store(tail + 1, std::memory_order_release);
  }
  /// Consumer. Drops all that is there now; gives how many.
  std::uint64_t clear() noexcept {
    const std::uint64_t head = head_.load(std::memory_order_acquire);
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    tail_.store(head, std::memory_order_release);
    return head - tail;
  }
  /// Either side; a moment's truth.
  [[nodiscard]] std::uint64_t size() const noexcept {
    const std::uint64_t n =
        head_.load(std::memory_order_acquire) - tail_.load(std::memory_order_acquire);
    return n > N ? 0 : n;
  }
  [[nodiscard]] bool empty() const noexcept { return size() == 0; }
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return N; }
  /// How many were ever pushed, and popped.
  [[nodiscard]] std::uint64_t pushed() const noexcept {
    return head_.load(std::memory_order_acquire);
  }
  [[nodiscard]] std::uint64_t popped() const noexcept {
    return tail_.load(std::memory_order_acquire);
  }

 private:
  // On lines of their own, so that the two sides do not fight over one.
  alignas(64) std::atomic<std::uint64_t> head_{0};
  alignas(64) std::atomic<std::uint64_t> tail_{0};
  alignas(64) T items_[N]{};
};

}  // namespace kerf::rtapi
