#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <thread>

#include "rtapi/sync/cell.hpp"
#include "rtapi/sync/seq_cell.hpp"
#include "rtapi/sync/spsc_ring.hpp"
#include "rtapi/sync/used_words.hpp"

namespace kerf::rtapi {
namespace {

TEST(SpscRing, FullAndEmpty) {
  SpscRing<int, 4> ring;
  EXPECT_EQ(ring.front(), nullptr);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_FALSE(ring.push(4));
  EXPECT_EQ(*ring.peek(3), 3);
  EXPECT_EQ(ring.peek(4), nullptr);
  EXPECT_EQ(*ring.front(), 0);
  ring.pop();
  EXPECT_TRUE(ring.push(4));
  EXPECT_EQ(ring.clear(), 4U);
  EXPECT_TRUE(ring.empty());
}

TEST(SpscRing, KeepsOrderBetweenTwoThreads) {
  constexpr int kItems = 200000;
  auto ring = std::make_unique<SpscRing<int, 64>>();
  std::thread producer([&] {
    for (int i = 0; i < kItems;)
      if (ring->push(i))
        ++i;
      else
        std::this_thread::yield();
  });
  for (int expected = 0; expected < kItems;) {
    if (const int* item = ring->front()) {
      ASSERT_EQ(*item, expected);
      ring->pop();
      ++expected;
    } else {
      std::this_thread::yield();
    }
  }
  producer.join();
}

struct Wide {
  std::uint64_t value[40];
};

TEST(SeqCell, ReadersSeeWholeWrites) {
  auto cell = std::make_unique<SeqCell<Wide>>();
  StopWord stop;
  std::thread writer([&] {
    for (std::uint64_t n = 1; !stop.requested(); ++n) {
      Wide w{};
      for (auto& v : w.value) v = n;
      cell->write(w);
      if (n % 64 == 0) std::this_thread::yield();
    }
  });
  std::uint64_t last = 0;
  for (int reads = 0; reads < 20000;) {
    Wide w{};
    if (!cell->read(w)) {
      std::this_thread::yield();
      continue;
    }
    ++reads;
    for (const auto v : w.value) ASSERT_EQ(v, w.value[0]);
    ASSERT_GE(w.value[0], last);
    last = w.value[0];
  }
  stop.request();
  writer.join();
}

/// 12 and a bit: the last word is not a whole one.
struct Odd {
  std::uint32_t value[25];
};

TEST(SeqCell, AWriteOfPartsLeavesTheOthers) {
  auto cell = std::make_unique<SeqCell<Odd>>();
  const auto all = [](std::uint32_t v) {
    Odd odd{};
    std::fill(std::begin(odd.value), std::end(odd.value), v);
    return odd;
  };
  cell->write(all(1));
  const WordPart parts[] = {words_of(8, 20), words_of(48, 48), words_of(92, 100)};
  cell->write(all(2), parts);
  Odd seen{};
  ASSERT_TRUE(cell->read(seen));
  for (std::size_t i = 0; i < 25; ++i) {
    const bool written = (i >= 2 && i < 6) || i >= 22;  // with what shares a word
    EXPECT_EQ(seen.value[i], written ? 2U : 1U) << i;
  }
  EXPECT_EQ(cell->version(), 2U);
  cell->write(all(3));
  ASSERT_TRUE(cell->read(seen));
  for (const auto v : seen.value) EXPECT_EQ(v, 3U);
}

/// Rooms for five, of which two or all are used; a member behind them.
struct Roomy {
  std::uint64_t before;
  std::uint64_t wide[5];
  std::uint32_t narrow[5], behind;
};

TEST(UsedWords, AreAllButTheEndsOfArrays) {
  using R = Roomy;
  const auto parts =
      words_but<R>(unused(offsetof(R, narrow), 4, 1, 5), unused(offsetof(R, wide), 8, 2, 5));
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].first, 0U);
  EXPECT_EQ(parts[0].end, 3U);
  EXPECT_EQ(parts[1].first, 6U);
  EXPECT_EQ(parts[1].end, 7U);    // narrow[1] shares the word of narrow[0]
  EXPECT_EQ(parts[2].first, 8U);  // and narrow[4] that of `behind`
  EXPECT_EQ(parts[2].end, 9U);
  const auto all = words_but<R>(unused(offsetof(R, wide), 8, 5, 5));
  EXPECT_EQ(all[0].end, 6U);
  EXPECT_EQ(all[1].first, 6U);
  EXPECT_EQ(all[1].end, 9U);
}

TEST(SeqCell, DeadWriterMakesReadsFailNotHang) {
  SeqCell<Wide> cell;
  cell.write({});
  // The first word of the cell is its count: an odd one is a write that never ended.
  *reinterpret_cast<std::uint64_t*>(&cell) += 1;
  Wide w{};
  EXPECT_FALSE(cell.read(w, 50));
}

TEST(Cell, CountsChanges) {
  Cell cell;
  const auto before = cell.count();
  cell.notify();
  EXPECT_EQ(cell.count(), before + 1);
}

}  // namespace
}  // namespace kerf::rtapi
