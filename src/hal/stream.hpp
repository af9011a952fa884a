// Stream: a FIFO of rows of HAL values between two components, of which one may be realtime (sampler and halsampler, streamer
// and halstreamer, hal_stream_* of the C API, hal.stream of Python: all are this).
//
// It lives in named memory of the instance, found by the stream's key: a header, then `depth` rows. One side writes rows, the
// other reads them; neither waits. The writer drops a row that finds no room, and the next row that does says how many were
// dropped before it, so that a reader can mark each gap exactly where it is. Both counts of losses stand in the header, so
// either side may end and be started again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <string_view>

#include "hal/core/types.hpp"
#include "rtapi/base/fixed_string.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::hal {

/// Columns that a row can have.
inline constexpr std::size_t kStreamColumns = 21;
/// Rows that a stream can have.
inline constexpr std::uint32_t kMaxStreamDepth = 10'000'000;
/// Keys of the streams of sampler.0 and streamer.0; channel N has the N-th after it. Numbers of the published interface.
inline constexpr std::uint32_t kSamplerKey = 0x48534130;
inline constexpr std::uint32_t kStreamerKey = 0x48535430;
/// Raised when StreamHeader or the rows change.
inline constexpr std::uint64_t kStreamAbi = 0x6b73'7472'0000'0002ULL;

struct StreamHeader {
  std::uint32_t depth{0};
  std::uint32_t columns{0};
  char types[24]{};                      ///< a letter a column: b f s u l k
  rtapi::Word<std::uint32_t> closed{0};  ///< 1: the component was unloaded; nothing more will come
  rtapi::Cell changed;                   ///< notified for each row that came and at the end
  rtapi::Cell room;                      ///< notified for each row that was taken and at the end
  // On lines of their own, so that the two sides do not fight over one.
  alignas(64) rtapi::Word<std::uint64_t> written{0};
  rtapi::Word<std::uint64_t> number{0};  ///< of the last row, whether there was room for it or not
  rtapi::Word<std::uint64_t> lost{0};    ///< rows dropped since the last one that was handed over
  rtapi::Word<std::uint32_t> overruns{0};
  alignas(64) rtapi::Word<std::uint64_t> read{0};
  rtapi::Word<std::uint32_t> underruns{0};
};

/// One row as the reader sees it.
struct StreamRow {
  std::uint64_t number{0};       ///< rows are numbered from 1
  std::uint64_t lost_before{0};  ///< rows that were dropped between the row before and this one
  const std::uint64_t* values{nullptr};
};

/// Type of a column letter of either case; unspecified for any other letter.
constexpr Type stream_type(char letter) noexcept {
  switch (letter) {
    case 'b':
    case 'B': return Type::bit;
    case 'f':
    case 'F': return Type::floating;
    case 's':
    case 'S': return Type::s32;
    case 'u':
    case 'U': return Type::u32;
    case 'k':
    case 'K': return Type::u64;
    case 'l':
    case 'L': return Type::s64;
    default: return Type::unspecified;
  }
}
/// The letter of a type, in lower case; '?' for a type that no stream has.
constexpr char stream_letter(Type type) noexcept {
  for (const char letter : {'b', 'f', 's', 'u', 'k', 'l'}) {
    if (stream_type(letter) == type) return letter;
  }
  return '?';
}
/// True for one to kStreamColumns letters that stream_type() knows.
constexpr bool good_stream_types(std::string_view types) noexcept {
  for (const char letter : types) {
    if (stream_type(letter) == Type::unspecified) return false;
  }
  return !types.empty() && types.size() <= kStreamColumns;
}

/// What stands in the bytes that the type has, as a whole slot: C code writes no more of it than its own type.
constexpr std::uint64_t stream_value(Type type, std::uint64_t raw) noexcept {
  switch (type) {
    case Type::bit: return (raw & 0xffU) != 0 ? 1 : 0;
    case Type::s32: return to_raw(static_cast<std::int32_t>(static_cast<std::uint32_t>(raw)));
    case Type::u32: return static_cast<std::uint32_t>(raw);
    default: return raw;
  }
}

/// Name of the stream's memory: "stream-48534130".
inline rtapi::FixedString<47> stream_memory_name(std::uint32_t key) noexcept {
  rtapi::FixedString<47> name("stream-");
  for (int shift = 28; shift >= 0; shift -= 4) {
    const char digit = "0123456789abcdef"[(key >> static_cast<unsigned>(shift)) & 0xfU];
    name.append(std::string_view(&digit, 1));
  }
  return name;
}

/// A view of the memory. Copies share it.
class Stream {
 public:
  Stream() = default;

  /// Bytes of the memory.
  static constexpr std::size_t bytes(std::uint32_t depth, std::size_t columns) noexcept {
    return sizeof(StreamHeader) + std::size_t{depth} * row_words(columns) * sizeof(std::uint64_t);
  }
  /// Fills in new memory of bytes(depth, types.size()). `depth` 1 to kMaxStreamDepth, `types` good_stream_types().
  static Stream create(std::byte* memory, std::uint32_t depth, std::string_view types) noexcept {
    auto* header = new (memory) StreamHeader();
    header->depth = depth;
    header->columns = static_cast<std::uint32_t>(types.size());
    for (std::size_t i = 0; i < types.size(); ++i) {
      header->types[i] = stream_letter(stream_type(types[i]));
    }
    return Stream(header);
  }
  /// A view of memory that another process made; not valid() when its header does not fit its size.
  static Stream attach(std::byte* memory, std::size_t memory_bytes) noexcept {
    auto* header = std::launder(reinterpret_cast<StreamHeader*>(memory));
    if (memory_bytes < sizeof(StreamHeader) || header->depth == 0 ||
        header->depth > kMaxStreamDepth || header->columns == 0 ||
        header->columns > kStreamColumns || bytes(header->depth, header->columns) > memory_bytes) {
      return {};
    }
    return Stream(header);
  }

  [[nodiscard]] bool valid() const noexcept { return header_ != nullptr; }
  /// Rows that it has room for.
  [[nodiscard]] std::uint32_t depth() const noexcept { return depth_; }
  [[nodiscard]] std::size_t columns() const noexcept { return columns_; }
  [[nodiscard]] Type type(std::size_t column) const noexcept {
    return stream_type(header_->types[column]);
  }
  /// The letters of the columns.
  [[nodiscard]] std::string_view types() const noexcept { return {header_->types, columns_}; }
  /// True when `letters` (of either case) say the same types.
  [[nodiscard]] bool matches(std::string_view letters) const noexcept {
    if (letters.size() != columns_) return false;
    for (std::size_t i = 0; i < columns_; ++i) {
      if (stream_type(letters[i]) != type(i)) return false;
    }
    return true;
  }
  /// For waiting: notified when a row came, or when one was taken; both at the end.
  [[nodiscard]] const rtapi::Cell& changed() const noexcept { return header_->changed; }
  [[nodiscard]] const rtapi::Cell& room() const noexcept { return header_->room; }
  [[nodiscard]] bool closed() const noexcept { return header_->closed.observe() != 0; }

  /// @rt. Rows that wait to be read; what a broken partner left out of range counts as full.
  [[nodiscard]] std::uint32_t size() const noexcept {
    const std::uint64_t n = header_->written.observe() - header_->read.observe();
    return n > depth_ ? depth_ : static_cast<std::uint32_t>(n);
  }
  [[nodiscard]] bool full() const noexcept { return size() == depth_; }
  [[nodiscard]] bool empty() const noexcept { return size() == 0; }
  /// Rows that found no room, and reads that found no row, since the stream was made.
  [[nodiscard]] std::uint32_t overruns() const noexcept { return header_->overruns.get(); }
  [[nodiscard]] std::uint32_t underruns() const noexcept { return header_->underruns.get(); }

  /// @rt, writer. One row of columns() values, each a whole slot; false, and counted as an overrun, when there is no room. Its
  /// number is used up either way.
  bool write(const std::uint64_t* values) noexcept {
    std::uint64_t* to = begin_row();
    const std::uint64_t number = header_->number.get() + 1;
    if (to == nullptr) {
      header_->number.set(number);
      return false;
    }
    for (std::size_t i = 0; i < columns_; ++i) to[i] = values[i];
    commit(number);
    return true;
  }
  /// @rt, writer. The values of the next row, to be filled in before commit(); nullptr, and counted as an overrun, when there
  /// is no room.
  [[nodiscard]] std::uint64_t* begin_row() noexcept {
    if (!full()) return row(header_->written.get()) + 2;
    header_->lost.add(1);
    header_->overruns.add(1);
    return nullptr;
  }
  /// @rt, writer. Hands the row over under a number of the writer's choice.
  void commit(std::uint64_t number) noexcept {
    const std::uint64_t at = header_->written.get();
    std::uint64_t* words = row(at);
    words[0] = number;
    words[1] = header_->lost.get();
    header_->lost.set(0);
    header_->number.set(number);
    header_->written.publish(at + 1);
    header_->changed.notify();
  }
  /// Tells the other side that nothing more will come.
  void close() noexcept {
    header_->closed.publish(1);
    header_->changed.notify();
    header_->room.notify();
  }

  /// @rt, reader. Copies the oldest row to `values` and takes it out; false, and counted as an underrun, when there is none.
  bool read(std::uint64_t* values, std::uint64_t* number = nullptr) noexcept {
    StreamRow out;
    if (!front(out)) {
      header_->underruns.add(1);
      return false;
    }
    for (std::size_t i = 0; i < columns_; ++i) values[i] = out.values[i];
    if (number != nullptr) *number = out.number;
    pop();
    return true;
  }
  /// @rt, reader. The oldest row, valid until pop(); false when there is none.
  [[nodiscard]] bool front(StreamRow& out) const noexcept {
    const std::uint64_t at = header_->read.get();
    const std::uint64_t n = header_->written.observe() - at;
    if (n == 0 || n > depth_) return false;
    const std::uint64_t* words = row(at);
    out = {words[0], words[1], words + 2};
    return true;
  }
  /// @rt, reader. Drops the row that front() gave.
  void pop() noexcept {
    header_->read.publish(header_->read.get() + 1);
    header_->room.notify();
  }

 private:
  explicit Stream(StreamHeader* header) noexcept
      : header_(header), depth_(header->depth), columns_(header->columns) {}
  static constexpr std::size_t row_words(std::size_t columns) noexcept { return columns + 2; }
  [[nodiscard]] std::uint64_t* row(std::uint64_t index) const noexcept {
    auto* rows = reinterpret_cast<std::uint64_t*>(header_ + 1);
    return rows + (index % depth_) * row_words(columns_);
  }

  StreamHeader* header_{nullptr};
  // Copies: what another process does to the header must not lead us out of the memory.
  std::uint32_t depth_{0};
  std::uint32_t columns_{0};
};

}  // namespace kerf::hal
