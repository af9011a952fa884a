// What halstreamer makes of its input.
#include "hal/tools/row_writer.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "hal/stream.hpp"

namespace kerf::hal {
namespace {

class RowWriterTest : public testing::Test {
 protected:
  RowWriterTest() { messages = std::tmpfile(); }
  ~RowWriterTest() override { std::fclose(messages); }

  void make(std::uint32_t depth, std::string_view types) {
    words.resize(Stream::bytes(depth, types.size()) / 8 + 8);
    void* at = words.data();
    std::size_t room = words.size() * 8;
    stream = Stream::create(
        static_cast<std::byte*>(std::align(64, Stream::bytes(depth, types.size()), at, room)),
        depth, types);
  }
  /// A file with the text, to be read from its beginning.
  int input(const std::string& text) {
    std::FILE* file = std::tmpfile();
    std::fwrite(text.data(), 1, text.size(), file);
    std::rewind(file);
    const int fd = ::dup(::fileno(file));
    std::fclose(file);
    return fd;
  }
  std::string said() {
    std::fflush(messages);
    std::string text(static_cast<std::size_t>(std::ftell(messages)), ' ');
    std::rewind(messages);
    EXPECT_EQ(std::fread(text.data(), 1, text.size(), messages), text.size());
    return text;
  }
  std::string row() {
    std::uint64_t values[kStreamColumns];
    if (!stream.read(values)) return "none";
    std::string out;
    for (std::size_t i = 0; i < stream.columns(); ++i) {
      out += stream.type(i) == Type::floating ? std::to_string(from_raw<double>(values[i]))
                                              : std::to_string(from_raw<std::int64_t>(values[i]));
      out += ' ';
    }
    return out;
  }
  rtapi::WaitSpec step(RowWriter& writer) {
    rtapi::WaitSpec next;
    writer.step(0, next);
    return next;
  }

  std::vector<std::uint64_t> words;
  Stream stream;
  std::FILE* messages{nullptr};
};

// The messages are what LinuxCNC 2.9 prints for the same lines.
TEST_F(RowWriterTest, SkipsBadLinesAndNamesThem) {
  make(40, "bfsu");
  RowWriter writer(stream,
                   input("# comment\n1 1.5 -3 4\n0 2.5e1 0x10 0x20\n\n 1   7\t010  5  \n2 1 1 1\n"
                         "1 x 1 1\n1 1 1\n1 1 1 1 1\n1 1 1.5 1\n1 1 1 -1\n1 1 1 4294967295\n"
                         "1 inf 1 1\noverrun\n # c2\n01 3 4 5\nTRUE 1 1 1\n1 1 99999999999 1\n"
                         "1 1 1 4294967296\n0 9 9 9"),
                   messages);
  step(writer);
  EXPECT_TRUE(writer.done());
  EXPECT_EQ(writer.error(), "");
  EXPECT_EQ(said(),
            "line 2, field 2: bad character, skipping the line\n"
            "line 3, field 0: bit value not 0 or 1, skipping the line\n"
            "line 5, field 0: bit value not 0 or 1, skipping the line\n"
            "line 6, field 1: bad character, skipping the line\n"
            "line 7, field 3: premature end of line, skipping the line\n"
            "line 9, field 2: bad character, skipping the line\n"
            "line 13, field 0: bit value not 0 or 1, skipping the line\n"
            "line 14, field 0: bit value not 0 or 1, skipping the line\n"
            "line 15, field 0: bad character, skipping the line\n"
            "line 16, field 0: bit value not 0 or 1, skipping the line\n"
            "line 17, field 2: number out of range, skipping the line\n"
            "line 18, field 3: number out of range, skipping the line\n");
  for (const char* expected :
       {"1 1.500000 -3 4 ", "1 7.000000 10 5 ", "1 1.000000 1 1 ", "1 1.000000 1 4294967295 ",
        "1 1.000000 1 4294967295 ", "1 inf 1 1 ", "0 9.000000 9 9 ", "none"}) {
    EXPECT_EQ(row(), expected);
  }
}

TEST_F(RowWriterTest, TakesWholeNumbersOf64Bits) {
  make(4, "lk");
  RowWriter writer(stream,
                   input("-9223372036854775808 18446744073709551615\n9223372036854775807 -1\n"
                         "9223372036854775808 0\n0 18446744073709551616\n"),
                   messages);
  step(writer);
  EXPECT_EQ(said(),
            "line 2, field 0: number out of range, skipping the line\n"
            "line 3, field 1: number out of range, skipping the line\n");
  std::uint64_t values[2];
  ASSERT_TRUE(stream.read(values));
  EXPECT_EQ(from_raw<std::int64_t>(values[0]), INT64_MIN);
  EXPECT_EQ(values[1], UINT64_MAX);
  ASSERT_TRUE(stream.read(values));
  EXPECT_EQ(from_raw<std::int64_t>(values[0]), INT64_MAX);
  EXPECT_EQ(values[1], UINT64_MAX);
}

TEST_F(RowWriterTest, WaitsForRoomAndLosesNothing) {
  make(3, "s");
  std::string text;
  for (int i = 0; i < 1000; ++i) text += std::to_string(i) + "\n";
  RowWriter writer(stream, input(text), messages);
  int next = 0;
  while (!writer.done() || !stream.empty()) {
    const rtapi::WaitSpec spec = step(writer);
    if (!writer.done() && spec.until == rtapi::kForever) {
      ASSERT_TRUE(stream.full());
      ASSERT_EQ(spec.cells.size(), 1U);
      EXPECT_EQ(spec.cells[0].cell, &stream.room());
    }
    ASSERT_EQ(row(), std::to_string(next++) + " ");
  }
  EXPECT_EQ(next, 1000);
  EXPECT_EQ(stream.overruns(), 0U);
}

TEST_F(RowWriterTest, ReadsAPipeAsItComes) {
  make(10, "s");
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_NONBLOCK), 0);
  RowWriter writer(stream, ends[0], messages);
  rtapi::WaitSpec spec = step(writer);
  EXPECT_EQ(spec.fds.size(), 1U);
  ASSERT_EQ(::write(ends[1], "12\n3", 4), 4);
  spec = step(writer);
  if (spec.until == 0) spec = step(writer);
  EXPECT_EQ(spec.fds.size(), 1U);
  EXPECT_EQ(row(), "12 ");
  EXPECT_EQ(row(), "none");
  ASSERT_EQ(::write(ends[1], "4", 1), 1);
  ::close(ends[1]);
  for (int i = 0; i < 3 && !writer.done(); ++i) step(writer);
  EXPECT_TRUE(writer.done());
  EXPECT_EQ(row(), "34 ");
  ::close(ends[0]);
}

TEST_F(RowWriterTest, EndsWhenTheStreamerIsUnloaded) {
  make(1, "s");
  RowWriter writer(stream, input("1\n2\n3\n"), messages);
  step(writer);
  EXPECT_FALSE(writer.done());
  stream.close();
  step(writer);
  EXPECT_TRUE(writer.done());
  EXPECT_EQ(writer.error(), "the streamer was unloaded");
}

}  // namespace
}  // namespace kerf::hal
