// Cell: a counter that tells sleepers "something changed". The only way in Kerf to wake a waiter.
#pragma once

#include <atomic>
#include <cstdint>

namespace kerf::rtapi {

/// A change counter in the instance's segment (or in private memory in tests).
///
/// `notify()` is one atomic addition, so realtime code may call it (@rt). Waiters hand the value that they have
/// seen to Clock::wait; the wait ends when the counter differs. Nothing is lost: a change between reading
/// the counter and waiting ends the wait at once.
class Cell {
 public:
  /// @rt. Release: whoever sees the new count by `count()` (acquire) also sees all that was written before.
  void notify() noexcept { count_.fetch_add(1, std::memory_order_release); }
  /// @rt. Read it before reading the data that it guards.
  [[nodiscard]] std::uint64_t count() const noexcept {
    return count_.load(std::memory_order_acquire);
  }

 private:
  std::atomic<std::uint64_t> count_{0};
};

/// One atomic word shared between threads or processes; each word stands alone, nothing orders two of them.
/// Values that belong together travel in a SeqCell.
template <class T>
class Word {
 public:
  static_assert(std::atomic<T>::is_always_lock_free, "a word is never behind a lock");
  constexpr Word() = default;
  explicit constexpr Word(T value) : value_(value) {}
  /// @rt. Relaxed: see above.
  void set(T value) noexcept { value_.store(value, std::memory_order_relaxed); }
  [[nodiscard]] T get() const noexcept { return value_.load(std::memory_order_relaxed); }
  /// Release and acquire, for a word that says "what I wrote before is there".
  void publish(T value) noexcept { value_.store(value, std::memory_order_release); }
  [[nodiscard]] T observe() const noexcept { return value_.load(std::memory_order_acquire); }
  /// @rt. Adds and gives the new value. Relaxed: a counter orders nothing.
  T add(T n) noexcept { return value_.fetch_add(n, std::memory_order_relaxed) + n; }

 private:
  std::atomic<T> value_{};
};

/// Everything written before is visible before anything read after. For "publish, then look whether somebody still uses the old
/// one": a release store followed by a load may otherwise change places.
inline void full_fence() noexcept { std::atomic_thread_fence(std::memory_order_seq_cst); }

/// A request to stop, checked by whoever runs long. Set once, never cleared but by its owner between runs.
class StopWord {
 public:
  void request() noexcept { word_.publish(1); }
  void clear() noexcept { word_.publish(0); }
  [[nodiscard]] bool requested() const noexcept { return word_.observe() != 0; }

 private:
  Word<std::uint32_t> word_;
};

}  // namespace kerf::rtapi
