// OverwriteRing: the newest records of one writer, in shared memory. The oldest ones give way; nobody waits, and what is there outlives
// the writer's process.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kerf::rtapi {

/// A handle: the ring is bytes(words) bytes of memory, zero-filled at first, aligned to 64. Each process has a handle of its own, so that what
/// stands in the memory never tells the writer where to write. `words` (a power of two) of 64 bits are its room; 0: write() does nothing.
/// A record is a head, a number of the writer's choice (time, cycle), and up to most_words() words.
///
/// Memory orders. Writer: it raises `tail` past all records that it is about to overwrite, then (release fence) stores words, then
/// raises `head` with release. Reader: head with acquire, so the words before it are there; then words; then (acquire fence) `tail`. A reader
/// that has met a word of a later record has, behind the fence, the tail that was raised before it; so records from that tail on
/// are whole. All words are atomic and relaxed: a torn record is one that is thrown away, not a data race.
class OverwriteRing {
 public:
  static constexpr std::size_t kHeadWords = 2;
  /// head and tail have a cache line each.
  static constexpr std::size_t kLineWords = 8;

  struct Head {
    std::uint16_t words{0};  ///< behind the head
    std::uint16_t kind{0};
    std::uint32_t extra{0};
    std::uint64_t number{0};
  };

  static constexpr std::size_t bytes(std::size_t words) noexcept {
    return (2 * kLineWords + words) * sizeof(std::uint64_t);
  }

  OverwriteRing() = default;
  OverwriteRing(void* memory, std::size_t words) noexcept
      : memory_(static_cast<std::uint64_t*>(memory)),
        words_(memory != nullptr && (words & (words - 1)) == 0 ? words : 0) {}

  [[nodiscard]] std::size_t words() const noexcept { return words_; }
  [[nodiscard]] std::size_t most_words() const noexcept {
    return std::min<std::size_t>(0xffff, words_ / 4);
  }

  /// @rt. One writer. Longer records than most_words() are cut. The words come from `part[0]`, then from `part2[0]`.
  void write(Head head, const std::uint64_t* part, std::size_t n,
             const std::uint64_t* part2 = nullptr, std::size_t n2 = 0) const noexcept {
    if (words_ == 0) return;
    n = std::min(n, most_words());
    n2 = std::min(n2, most_words() - n);
    head.words = static_cast<std::uint16_t>(n + n2);
    const std::uint64_t at = head_word().load(std::memory_order_relaxed);  // ours alone to change
    std::uint64_t tail = tail_word().load(std::memory_order_relaxed);
    // What no writer of ours has left there begins anew.
    if (at - tail > words_) tail = at;
    const std::uint64_t end = at + kHeadWords + n + n2;
    while (end - tail > words_) {
      const std::uint64_t step = kHeadWords + (load(tail) & 0xffff);
      tail = step > at - tail ? at : tail + step;
    }
    tail_word().store(tail, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    store(at, std::uint64_t{head.words} | std::uint64_t{head.kind} << 16U |
                  std::uint64_t{head.extra} << 32U);
    store(at + 1, head.number);
    store(at + kHeadWords, part, n);
    store(at + kHeadWords + n, part2, n2);
    head_word().store(end, std::memory_order_release);
  }

  /// @rt. The writer's: begins to fetch the place of the next `n` words, which is far from its caches as a rule.
  void fetch(std::size_t n) const noexcept {
    if (words_ == 0) return;
    const std::uint64_t at = head_word().load(std::memory_order_relaxed);
    for (std::size_t i = 0; i < n + kLineWords; i += kLineWords)
      __builtin_prefetch(&memory_[2 * kLineWords + ((at + i) & (words_ - 1))], 1);
  }

  /// Any thread or process, also when the writer is dead: all whole records, oldest first, as they stand.
  [[nodiscard]] std::vector<std::uint64_t> copy() const {
    return copy([] {});
  }
  /// `between` is called when the words have been read and it is not known yet which of them are good; for tests.
  template <class Between>
  [[nodiscard]] std::vector<std::uint64_t> copy(Between&& between) const {
    if (words_ == 0) return {};
    const std::uint64_t head = head_word().load(std::memory_order_acquire);
    const std::uint64_t from = tail_word().load(std::memory_order_relaxed);
    if (head - from > words_) return {};
    std::vector<std::uint64_t> out(static_cast<std::size_t>(head - from));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = load(from + i);
    between();
    std::atomic_thread_fence(std::memory_order_acquire);
    const std::uint64_t tail = tail_word().load(std::memory_order_relaxed);
    if (tail > from)
      out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(
                                               std::min<std::uint64_t>(tail - from, out.size())));
    return out;
  }

  /// Something has given way already.
  [[nodiscard]] bool lost() const noexcept {
    return words_ != 0 && tail_word().load(std::memory_order_relaxed) > 0;
  }

  /// Calls f(Head, const uint64_t* words) for each record of copy(); ends at the first that is not whole.
  template <class F>
  static void for_each(const std::vector<std::uint64_t>& words, F&& f) {
    for (std::size_t at = 0; at + kHeadWords <= words.size();) {
      Head head;
      head.words = static_cast<std::uint16_t>(words[at]);
      head.kind = static_cast<std::uint16_t>(words[at] >> 16U);
      head.extra = static_cast<std::uint32_t>(words[at] >> 32U);
      head.number = words[at + 1];
      if (at + kHeadWords + head.words > words.size()) return;
      f(head, words.data() + at + kHeadWords);
      at += kHeadWords + head.words;
    }
  }

 private:
  using Word = std::atomic_ref<std::uint64_t>;
  [[nodiscard]] Word head_word() const noexcept { return Word(memory_[0]); }
  [[nodiscard]] Word tail_word() const noexcept { return Word(memory_[kLineWords]); }
  [[nodiscard]] Word word(std::uint64_t at) const noexcept {
    return Word(memory_[2 * kLineWords + (at & (words_ - 1))]);
  }
  void store(std::uint64_t at, std::uint64_t value) const noexcept {
    word(at).store(value, std::memory_order_relaxed);
  }
  /// n <= words_. Up to the end of the memory, then from its beginning.
  void store(std::uint64_t at, const std::uint64_t* values, std::size_t n) const noexcept {
    std::uint64_t* const begin = memory_ + 2 * kLineWords;
    const std::size_t place = at & (words_ - 1), first = std::min(n, words_ - place);
    for (std::size_t i = 0; i < first; ++i)
      Word(begin[place + i]).store(values[i], std::memory_order_relaxed);
    for (std::size_t i = first; i < n; ++i)
      Word(begin[i - first]).store(values[i], std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t load(std::uint64_t at) const noexcept {
    return word(at).load(std::memory_order_relaxed);
  }

  std::uint64_t* memory_{nullptr};
  std::size_t words_{0};
};

}  // namespace kerf::rtapi
