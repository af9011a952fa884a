// SeqCell: one writer, many readers, a value of any size, nobody waits.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "rtapi/sync/word_part.hpp"

namespace kerf::rtapi {

/// A sequence lock over a trivially copyable T. The writer never waits (@rt); a reader copies and checks that no write
/// ran meanwhile, a bounded number of times: a writer that died in the middle of a write makes reads fail, not hang.
///
/// The bytes are copied word by word through relaxed atomics, so that a torn read is a detected event and not a data
/// race (H.-J. Boehm, "Can seqlocks get along with programming language memory models?", MSPC 2012).
template <class T>
class SeqCell {
  static_assert(std::is_trivially_copyable_v<T>, "bytes are copied");
  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;

 public:
  /// @rt. One writer only.
  void write(const T& value) noexcept {
    const WordPart all{0, kWords};
    write(value, {&all, 1});
  }
  /// @rt. The same where only these words may differ from what was written before.
  void write(const T& value, std::span<const WordPart> parts) noexcept {
    const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
    const std::uint64_t s = sequence_.load(std::memory_order_relaxed);  // ours alone to change
    sequence_.store(s + 1, std::memory_order_relaxed);
    // The fence keeps the words below from becoming visible before the odd count.
    std::atomic_thread_fence(std::memory_order_release);
    for (const WordPart part : parts) {
      const std::size_t whole = std::min<std::size_t>(part.end, sizeof(T) / 8);
      std::size_t i = part.first;
      // Four at a time: compilers unroll no loop over atomics, and the status of the machine is written in every servo cycle.
      for (; i + 4 <= whole; i += 4) {
        store(i, bytes + i * 8, 8);
        store(i + 1, bytes + i * 8 + 8, 8);
        store(i + 2, bytes + i * 8 + 16, 8);
        store(i + 3, bytes + i * 8 + 24, 8);
      }
      for (; i < whole; ++i) store(i, bytes + i * 8, 8);
      if (part.end > whole) store(whole, bytes + whole * 8, sizeof(T) % 8);
    }
    // Release: a reader that sees the even count sees all the words of this write.
    sequence_.store(s + 2, std::memory_order_release);
  }

  /// @rt for T small enough for the stack. False when no stable copy was had in `tries` (the writer is dead or busy).
  [[nodiscard]] bool read(T& out, int tries = 1000) const noexcept {
    std::uint64_t words[kWords];
    for (; tries > 0; --tries) {
      // Acquire: the words are read after the count.
      const std::uint64_t before = sequence_.load(std::memory_order_acquire);
      if ((before & 1U) != 0) continue;
      for (std::size_t i = 0; i < kWords; ++i) words[i] = words_[i].load(std::memory_order_relaxed);
      // The fence keeps the second look at the count after the words.
      std::atomic_thread_fence(std::memory_order_acquire);
      if (sequence_.load(std::memory_order_relaxed) == before) {
        std::memcpy(static_cast<void*>(&out), words, sizeof(T));
        return true;
      }
    }
    return false;
  }

  /// How many writes have finished; 0: never written.
  [[nodiscard]] std::uint64_t version() const noexcept {
    return sequence_.load(std::memory_order_acquire) / 2;
  }

 private:
  void store(std::size_t i, const std::byte* bytes, std::size_t n) noexcept {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, n);
    words_[i].store(word, std::memory_order_relaxed);
  }

  std::atomic<std::uint64_t> sequence_{0};
  std::atomic<std::uint64_t> words_[kWords]{};
};

}  // namespace kerf::rtapi
