// The FIFO itself: rows, losses, numbers, memory that is not one.
#include "hal/stream.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <random>
#include <thread>
#include <vector>

namespace kerf::hal {
namespace {

struct Memory {
  explicit Memory(std::size_t size) : words(size / 8 + 16), bytes(size) {}
  std::byte* data() {
    void* at = words.data();
    std::size_t room = words.size() * 8;
    return static_cast<std::byte*>(std::align(64, bytes, at, room));
  }
  std::vector<std::uint64_t> words;
  std::size_t bytes;
};

class StreamTest : public testing::Test {
 protected:
  Memory memory{Stream::bytes(3, 2)};
  Stream writer{Stream::create(memory.data(), 3, "Sl")};
  Stream reader{Stream::attach(memory.data(), memory.bytes)};

  bool write(std::int64_t first, std::int64_t second) {
    const std::uint64_t row[2] = {to_raw(first), to_raw(second)};
    return writer.write(row);
  }
};

TEST_F(StreamTest, GivesRowsInOrderWithTheirNumbers) {
  EXPECT_TRUE(write(-1, 2));
  EXPECT_TRUE(write(-3, 4));
  EXPECT_EQ(reader.size(), 2U);
  std::uint64_t values[2]{};
  std::uint64_t number = 0;
  ASSERT_TRUE(reader.read(values, &number));
  EXPECT_EQ(number, 1U);
  EXPECT_EQ(from_raw<std::int32_t>(values[0]), -1);
  EXPECT_EQ(from_raw<std::int64_t>(values[1]), 2);
  ASSERT_TRUE(reader.read(values, &number));
  EXPECT_EQ(number, 2U);
  EXPECT_EQ(from_raw<std::int32_t>(values[0]), -3);
  EXPECT_TRUE(reader.empty());
}

TEST_F(StreamTest, CountsBothKindsOfLossAndUsesUpNumbers) {
  std::uint64_t values[2]{};
  EXPECT_FALSE(reader.read(values));
  EXPECT_FALSE(reader.read(values));
  EXPECT_EQ(writer.underruns(), 2U);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(write(i, i), i < 3);
  EXPECT_EQ(reader.overruns(), 2U);
  reader.pop();
  EXPECT_TRUE(write(7, 7));
  reader.pop();
  reader.pop();
  StreamRow row;
  ASSERT_TRUE(reader.front(row));
  EXPECT_EQ(row.number, 6U);
  EXPECT_EQ(row.lost_before, 2U);
  reader.pop();
  EXPECT_TRUE(write(8, 8));
  ASSERT_TRUE(reader.front(row));
  EXPECT_EQ(row.lost_before, 0U);
}

TEST_F(StreamTest, AWriterThatIsStartedAgainGoesOnWhereTheOldOneEnded) {
  for (int i = 0; i < 4; ++i) write(i, i);
  writer = Stream::attach(memory.data(), memory.bytes);
  reader.pop();
  EXPECT_TRUE(write(9, 9));
  reader.pop();
  reader.pop();
  StreamRow row;
  ASSERT_TRUE(reader.front(row));
  EXPECT_EQ(row.number, 5U);
  EXPECT_EQ(row.lost_before, 1U);
}

TEST_F(StreamTest, TellsBothSidesOfEachOthersDeedsAndOfTheEnd) {
  const auto changed = reader.changed().count();
  const auto room = writer.room().count();
  write(1, 1);
  EXPECT_NE(reader.changed().count(), changed);
  EXPECT_EQ(writer.room().count(), room);
  reader.pop();
  EXPECT_NE(writer.room().count(), room);
  EXPECT_FALSE(reader.closed());
  const auto before_end = reader.changed().count();
  writer.close();
  EXPECT_TRUE(reader.closed());
  EXPECT_NE(reader.changed().count(), before_end);
}

TEST_F(StreamTest, KnowsItsColumns) {
  EXPECT_EQ(reader.types(), "sl");
  EXPECT_EQ(reader.type(0), Type::s32);
  EXPECT_EQ(reader.type(1), Type::s64);
  EXPECT_TRUE(reader.matches("sL"));
  EXPECT_FALSE(reader.matches("s"));
  EXPECT_FALSE(reader.matches("slb"));
  EXPECT_FALSE(reader.matches("su"));
  EXPECT_FALSE(good_stream_types(""));
  EXPECT_FALSE(good_stream_types("bp"));
  EXPECT_FALSE(good_stream_types("bbbbbbbbbbbbbbbbbbbbbb"));
  EXPECT_TRUE(good_stream_types("bBfFsSuUlLkKbbbbbbbbb"));
  for (const char letter : {'b', 'f', 's', 'u', 'l', 'k'})
    EXPECT_EQ(stream_letter(stream_type(letter)), letter);
  EXPECT_EQ(stream_memory_name(kSamplerKey + 3).view(), "stream-48534133");
  EXPECT_EQ(stream_memory_name(0xf).view(), "stream-0000000f");
}

TEST(Stream, DoesNotAttachToMemoryThatDoesNotFit) {
  Memory memory(1024);
  EXPECT_FALSE(Stream::attach(memory.data(), 1024).valid());  // zeros: never created
  (void)Stream::create(memory.data(), 4, "bb");
  EXPECT_TRUE(Stream::attach(memory.data(), 1024).valid());
  EXPECT_FALSE(Stream::attach(memory.data(), Stream::bytes(4, 2) - 1).valid());
  EXPECT_FALSE(Stream::attach(memory.data(), 8).valid());
  for (const std::uint32_t columns : {0U, 22U, 0xffffffffU}) {
    reinterpret_cast<StreamHeader*>(memory.data())->columns = columns;
    EXPECT_FALSE(Stream::attach(memory.data(), 1024).valid()) << columns;
  }
}

TEST(Stream, StaysWithinItsMemoryWhateverAnotherProcessWritesThere) {
  std::mt19937_64 random(5);
  Memory memory(Stream::bytes(4, 3));
  for (int turn = 0; turn < 2000; ++turn) {
    Stream stream = Stream::create(memory.data(), 4, "fbu");
    Stream other = stream;
    // Anything but the two types at the front, which attach() has copied by now.
    auto* bytes = reinterpret_cast<unsigned char*>(memory.data());
    for (int i = 0; i < 40; ++i)
      bytes[random() % sizeof(StreamHeader)] = static_cast<unsigned char>(random());
    std::uint64_t values[3] = {1, 2, 3};
    for (int i = 0; i < 10; ++i) {
      (void)other.write(values);
      (void)stream.read(values);
      EXPECT_LE(stream.size(), 4U);
    }
  }
}

TEST(Stream, ValuesComeFromTheBytesOfTheirType) {
  EXPECT_EQ(stream_value(Type::bit, 0xffff'ff00U), 0U);
  EXPECT_EQ(stream_value(Type::bit, 0xffff'ff02U), 1U);
  EXPECT_EQ(stream_value(Type::u32, 0xdead'beef'8000'0001U), 0x8000'0001U);
  EXPECT_EQ(stream_value(Type::s32, 0xdead'beef'8000'0001U), 0xffff'ffff'8000'0001U);
  EXPECT_EQ(stream_value(Type::s64, 0xdead'beef'8000'0001U), 0xdead'beef'8000'0001U);
}

TEST(Stream, LosesAndMixesNothingBetweenTwoThreads) {
  constexpr std::uint64_t kRows = 200'000;
  Memory memory(Stream::bytes(16, 2));
  Stream writer = Stream::create(memory.data(), 16, "kk");
  Stream reader = Stream::attach(memory.data(), memory.bytes);
  std::uint64_t refused = 0;
  std::thread thread([&] {
    for (std::uint64_t i = 1; i <= kRows; ++i) {
      const std::uint64_t row[2] = {i, ~i};
      if (writer.write(row)) continue;
      ++refused;
      std::this_thread::yield();  // gives the reader a chance
    }
    writer.close();
  });
  std::uint64_t last = 0, got = 0, lost = 0;
  bool closed = false;
  StreamRow row;
  while (true) {
    if (!reader.front(row)) {
      if (closed) break;
      closed = reader.closed();
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(row.values[0], ~row.values[1]);
    ASSERT_EQ(row.number, row.values[0]);
    ASSERT_EQ(row.number, last + row.lost_before + 1);
    last = row.number;
    lost += row.lost_before;
    ++got;
    reader.pop();
  }
  thread.join();
  EXPECT_EQ(reader.overruns(), refused);
  EXPECT_EQ(got + refused, kRows);
  EXPECT_LE(lost, refused);
}

}  // namespace
}  // namespace kerf::hal
