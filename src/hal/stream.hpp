// Stream: a FIFO of rows of HAL values between a realtime component and an ordinary program (sampler and halsampler).
//
// It lives in a block of the instance's segment: a header, then `depth` rows. One side writes rows, the other reads them;
// neither waits. The writer drops a row that finds no room, and the next row that does says how many were dropped before
// it, so that a reader can mark each gap exactly where it is.
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
/// Raised when StreamHeader or the rows change.
inline constexpr std::uint64_t kStreamAbi = 0x6b73'7472'0000'0001ULL;

struct StreamHeader {
  std::uint32_t depth{0};
  std::uint32_t columns{0};
  char types[24]{};                      ///< a letter a column: b f s u k l
  rtapi::Word<std::uint32_t> closed{0};  ///< 1: the component was unloaded; nothing more will come
  rtapi::Cell changed;                   ///< notified for each row and at the end
  // On lines of their own, so that the two sides do not fight over one.
  alignas(64) rtapi::Word<std::uint64_t> written{0};
  alignas(64) rtapi::Word<std::uint64_t> read{0};
};

/// One row as the reader sees it.
struct StreamRow {
  std::int64_t number;        ///< the sample's number
  std::uint64_t lost_before;  ///< rows that were dropped between the row before and this one
  const std::uint64_t* values;
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

/// Name of the block: "hal.sampler.0".
inline rtapi::FixedString<47> stream_block_name(std::string_view component,
                                                std::size_t channel) noexcept {
  rtapi::FixedString<47> name("hal.");
  name.append(component);
  char digits[2] = {'.', '0'};
  digits[1] = static_cast<char>('0' + channel % 10);
  if (channel < 10) {
    name.append(std::string_view(digits, 2));
    return name;
  }
  digits[1] = static_cast<char>('0' + channel / 10 % 10);
  name.append(std::string_view(digits, 2));
  digits[1] = static_cast<char>('0' + channel % 10);
  name.append(std::string_view(digits + 1, 1));
  return name;
}

/// A view of the block. Copies share it.
class Stream {
 public:
  Stream() = default;

  /// Bytes of the block.
  static constexpr std::size_t bytes(std::uint32_t depth, std::size_t columns) noexcept {
    return sizeof(StreamHeader) + std::size_t{depth} * row_words(columns) * sizeof(std::uint64_t);
  }
  /// Fills in a new block of bytes(depth, types.size()). At most kStreamColumns letters that stream_type() knows.
  static Stream create(std::byte* block, std::uint32_t depth, std::string_view types) noexcept {
    auto* header = new (block) StreamHeader();
    header->depth = depth;
    header->columns = static_cast<std::uint32_t>(types.size());
    for (std::size_t i = 0; i < types.size(); ++i) header->types[i] = types[i];
    return Stream(header);
  }
  /// A view of a block that another process made; not valid() when its header does not fit its size.
  static Stream attach(std::byte* block, std::size_t block_bytes) noexcept {
    auto* header = std::launder(reinterpret_cast<StreamHeader*>(block));
    if (block_bytes < sizeof(StreamHeader) || header->depth == 0 || header->columns == 0 ||
        header->columns > kStreamColumns || bytes(header->depth, header->columns) > block_bytes) {
      return {};
    }
    return Stream(header);
  }

  [[nodiscard]] bool valid() const noexcept { return header_ != nullptr; }
  [[nodiscard]] std::uint32_t depth() const noexcept { return header_->depth; }
  [[nodiscard]] std::size_t columns() const noexcept { return header_->columns; }
  [[nodiscard]] Type type(std::size_t column) const noexcept {
    return stream_type(header_->types[column]);
  }
  [[nodiscard]] const rtapi::Cell& changed() const noexcept { return header_->changed; }
  [[nodiscard]] bool closed() const noexcept { return header_->closed.observe() != 0; }

  /// @rt. Rows that wait to be read; what a broken reader left out of range counts as full.
  [[nodiscard]] std::uint32_t size() const noexcept {
    const std::uint64_t n = header_->written.observe() - header_->read.observe();
    return n > header_->depth ? header_->depth : static_cast<std::uint32_t>(n);
  }
  [[nodiscard]] bool full() const noexcept { return size() == header_->depth; }

  /// @rt, writer. The values of the next row, to be filled in before commit(); nullptr when there is no room.
  [[nodiscard]] std::uint64_t* begin_row() noexcept {
    return full() ? nullptr : row(header_->written.get()) + 2;
  }
  /// @rt, writer. Hands the row over.
  void commit(std::int64_t number, std::uint64_t lost_before) noexcept {
    const std::uint64_t at = header_->written.get();
    std::uint64_t* words = row(at);
    words[0] = static_cast<std::uint64_t>(number);
    words[1] = lost_before;
    header_->written.publish(at + 1);
    header_->changed.notify();
  }
  /// Writer. Tells the reader that nothing more will come.
  void close() noexcept {
    header_->closed.publish(1);
    header_->changed.notify();
  }

  /// Reader. The oldest row, valid until pop(); false when there is none.
  [[nodiscard]] bool front(StreamRow& out) const noexcept {
    const std::uint64_t at = header_->read.get();
    const std::uint64_t n = header_->written.observe() - at;
    if (n == 0 || n > header_->depth) return false;
    const std::uint64_t* words = row(at);
    out = {static_cast<std::int64_t>(words[0]), words[1], words + 2};
    return true;
  }
  /// Reader. Drops the row that front() gave.
  void pop() noexcept { header_->read.publish(header_->read.get() + 1); }

 private:
  explicit Stream(StreamHeader* header) noexcept : header_(header) {}
  static constexpr std::size_t row_words(std::size_t columns) noexcept { return columns + 2; }
  [[nodiscard]] std::uint64_t* row(std::uint64_t index) const noexcept {
    auto* rows = reinterpret_cast<std::uint64_t*>(header_ + 1);
    return rows + (index % header_->depth) * row_words(header_->columns);
  }

  StreamHeader* header_{nullptr};
};

}  // namespace kerf::hal
