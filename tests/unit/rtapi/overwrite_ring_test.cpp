#include "rtapi/sync/overwrite_ring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "rtapi/sync/cell.hpp"

namespace kerf::rtapi {
namespace {

/// Zero-filled memory and the writer's handle.
struct Memory {
  explicit Memory(std::size_t words)
      : block(std::make_unique<Line[]>(OverwriteRing::bytes(words) / sizeof(Line))),
        ring(block.get(), words) {}
  struct alignas(64) Line {
    std::uint64_t word[8]{};
  };
  std::unique_ptr<Line[]> block;
  OverwriteRing ring;
};

struct Record {
  OverwriteRing::Head head;
  std::vector<std::uint64_t> words;
};
std::vector<Record> records(const OverwriteRing& ring) {
  std::vector<Record> out;
  OverwriteRing::for_each(ring.copy(),
                          [&](const OverwriteRing::Head& head, const std::uint64_t* words) {
                            out.push_back({head, {words, words + head.words}});
                          });
  return out;
}

void write(const OverwriteRing& ring, std::uint64_t number, const std::vector<std::uint64_t>& words,
           const std::vector<std::uint64_t>& more = {}) {
  OverwriteRing::Head head;
  head.kind = 7;
  head.extra = static_cast<std::uint32_t>(number * 3);
  head.number = number;
  ring.write(head, words.data(), words.size(), more.data(), more.size());
}

TEST(OverwriteRing, GivesBackWhatWasWritten) {
  const Memory m(64);
  EXPECT_TRUE(records(m.ring).empty());
  EXPECT_FALSE(m.ring.lost());
  write(m.ring, 1, {10, 11});
  write(m.ring, 2, {});
  write(m.ring, 3, {30}, {31, 32});
  const auto all = records(m.ring);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].words, (std::vector<std::uint64_t>{10, 11}));
  EXPECT_TRUE(all[1].words.empty());
  EXPECT_EQ(all[2].words, (std::vector<std::uint64_t>{30, 31, 32}));
  EXPECT_EQ(all[2].head.number, 3U);
  EXPECT_EQ(all[2].head.kind, 7U);
  EXPECT_EQ(all[2].head.extra, 9U);
  EXPECT_FALSE(m.ring.lost());
}

TEST(OverwriteRing, TheOldestGiveWayWhole) {
  const Memory m(64);
  for (std::uint64_t n = 1; n <= 1000; ++n) {
    write(m.ring, n, std::vector<std::uint64_t>(n % 12, n));
    const auto all = records(m.ring);
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(all.back().head.number, n);
    std::size_t used = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(all[i].head.number, n - all.size() + 1 + i);
      EXPECT_EQ(all[i].words.size(), all[i].head.number % 12);
      for (const std::uint64_t word : all[i].words) EXPECT_EQ(word, all[i].head.number);
      used += OverwriteRing::kHeadWords + all[i].words.size();
    }
    // No more went than had to: one before would not have found room.
    if (m.ring.lost()) {
      EXPECT_GT(used + OverwriteRing::kHeadWords + 12, 64U);
    }
  }
  EXPECT_TRUE(m.ring.lost());
}

TEST(OverwriteRing, LongRecordsAreCut) {
  const Memory m(64);
  EXPECT_EQ(m.ring.most_words(), 16U);
  write(m.ring, 1, std::vector<std::uint64_t>(14, 1), std::vector<std::uint64_t>(14, 2));
  write(m.ring, 2, std::vector<std::uint64_t>(40, 3), {4});
  const auto all = records(m.ring);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].words.size(), 16U);
  EXPECT_EQ(all[0].words.back(), 2U);
  EXPECT_EQ(all[1].words, std::vector<std::uint64_t>(16, 3));
}

TEST(OverwriteRing, WithoutMemoryNothingHappens) {
  const OverwriteRing none, odd(nullptr, 64);
  write(none, 1, {1});
  write(odd, 1, {1});
  EXPECT_TRUE(none.copy().empty());
  EXPECT_FALSE(odd.lost());
}

/// Another program can write there. The writer stays within its memory, ends, and goes on with whole records.
TEST(OverwriteRing, DamagedMemoryIsOvercome) {
  for (const std::uint64_t bad :
       {std::uint64_t{0}, std::uint64_t{3}, ~std::uint64_t{0}, std::uint64_t{1} << 60U}) {
    for (const std::size_t line : {0U, 1U, 2U, 3U}) {
      const Memory m(64);
      for (std::uint64_t n = 1; n <= 50; ++n) write(m.ring, n, {n, n, n});
      m.block[line].word[0] = bad;
      for (std::uint64_t n = 51; n <= 100; ++n) write(m.ring, n, {n, n, n});
      const auto all = records(m.ring);
      ASSERT_FALSE(all.empty()) << bad << " in line " << line;
      EXPECT_EQ(all.back().head.number, 100U);
      for (const auto& record : all) EXPECT_EQ(record.words.size(), 3U);
    }
  }
}

/// What gives way while it is being read is left out, also when all of it does.
TEST(OverwriteRing, AReaderThatIsOvertakenLeavesOutWhatMayBeTorn) {
  for (std::uint64_t written = 0; written <= 40; ++written) {
    const Memory m(64);
    for (std::uint64_t n = 1; n <= 50; ++n) write(m.ring, n, {n, n, n});
    const auto words = m.ring.copy([&] {
      for (std::uint64_t n = 51; n <= 50 + written; ++n) write(m.ring, n, {n, n, n});
    });
    // Five words each: twelve records find room.
    std::uint64_t expected = 50 - 12 + 1 + written;
    OverwriteRing::for_each(words, [&](const OverwriteRing::Head& head, const std::uint64_t* w) {
      EXPECT_EQ(head.number, expected) << written;
      EXPECT_EQ(w[2], expected) << written;
      ++expected;
    });
    EXPECT_EQ(expected, std::max<std::uint64_t>(51, 39 + written)) << written;
  }
}

TEST(OverwriteRing, AReaderSeesWholeRecordsWhileTheWriterRuns) {
  const Memory m(256);
  const OverwriteRing reader(m.block.get(), 256);
  StopWord stop;
  std::uint64_t newest = 0;  // the writer's; read behind the join
  std::thread writer([&] {
    std::uint64_t words[16];
    OverwriteRing::Head head;
    for (std::uint64_t n = 1; !stop.requested(); ++n) {
      newest = head.number = n;
      head.extra = static_cast<std::uint32_t>(n);
      for (auto& word : words) word = n;
      m.ring.write(head, words, n % 17);
    }
  });
  // How often the threads get to run is the computer's affair: the rounds go on until there was news a hundred times.
  std::uint64_t last = 0;
  for (int round = 0, news = 0; round < 20'000 || news < 100; ++round) {
    std::uint64_t before = 0;
    for (const Record& record : records(reader)) {
      const std::uint64_t n = record.head.number;
      ASSERT_TRUE(before == 0 || n == before + 1) << n << " behind " << before;
      ASSERT_EQ(record.head.extra, static_cast<std::uint32_t>(n));
      ASSERT_EQ(record.words.size(), n % 17);
      for (const std::uint64_t word : record.words) ASSERT_EQ(word, n);
      before = n;
    }
    if (before != 0) {
      ASSERT_GE(before, last);
      if (before > last) ++news;
      last = before;
    }
    if (round % 100 == 0) std::this_thread::yield();
  }
  stop.request();
  writer.join();
  const auto rest = records(reader);
  ASSERT_FALSE(rest.empty());
  EXPECT_EQ(rest.back().head.number, newest);
}

}  // namespace
}  // namespace kerf::rtapi
