// Port: a queue of bytes between one writer and one reader, the value of HAL's type `port`.
//
// The value of a port pin or signal is a 32-bit handle, the place of a PortHeader in the segment; 0: no queue, from which
// nothing can be read and into which nothing fits. `sets SIGNAL BYTES` makes the queue.
//
//   hal::Port port(base, handle);
//   char text[4];
//   if (port.read(text, sizeof text)) ...
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "rtapi/sync/cell.hpp"

namespace kerf::hal {

/// Largest size of a queue.
inline constexpr std::uint32_t kPortBytesMax = 65536;

struct PortHeader {
  std::uint32_t size{0};
  // Bytes ever written and read, on lines of their own. They never wrap, so full and empty differ.
  alignas(64) rtapi::Word<std::uint64_t> written{0};
  alignas(64) rtapi::Word<std::uint64_t> read{0};
  // `size` bytes follow.
  [[nodiscard]] char* bytes() noexcept { return reinterpret_cast<char*>(this + 1); }
};

/// A view of a queue. Copies share it. @rt, all of it: whatever does not fit or is not there is refused, nobody waits.
class Port {
 public:
  Port() = default;
  explicit Port(PortHeader* header) noexcept : header_(header) {}
  Port(std::byte* segment_base, std::uint32_t handle) noexcept
      : header_(handle == 0 ? nullptr : reinterpret_cast<PortHeader*>(segment_base + handle)) {}
  /// Memory that a queue of `size` bytes takes.
  static constexpr std::size_t bytes(std::uint32_t size) noexcept {
    return sizeof(PortHeader) + size;
  }

  [[nodiscard]] bool valid() const noexcept { return header_ != nullptr; }
  [[nodiscard]] std::uint32_t size() const noexcept {
    return header_ == nullptr ? 0 : limited(header_->size);
  }
  /// Bytes that wait for the reader. What a broken program left out of range counts as full.
  [[nodiscard]] std::uint32_t readable() const noexcept {
    if (header_ == nullptr) return 0;
    // Acquire: the bytes that the other side counted are there, or have been taken.
    const std::uint64_t n = header_->written.observe() - header_->read.observe();
    return n > size() ? size() : static_cast<std::uint32_t>(n);
  }
  [[nodiscard]] std::uint32_t writable() const noexcept { return size() - readable(); }

  /// Reader. Copies the next `count` bytes, all or none, and leaves them there.
  [[nodiscard]] bool peek(char* out, std::uint32_t count) const noexcept {
    if (header_ == nullptr) return count == 0;
    if (count > readable()) return false;
    if (count == 0) return true;
    const std::uint32_t at = place(header_->read.get());
    const std::uint32_t first = count < size() - at ? count : size() - at;
    std::memcpy(out, header_->bytes() + at, first);
    std::memcpy(out + first, header_->bytes(), count - first);
    return true;
  }
  /// Reader. Drops the next `count` bytes, all or none.
  bool peek_commit(std::uint32_t count) noexcept {
    if (count > readable()) return false;
    // Release: they have been copied before the writer may use their place.
    if (count > 0) header_->read.publish(header_->read.get() + count);
    return true;
  }
  /// Reader. All or none.
  bool read(char* out, std::uint32_t count) noexcept {
    return peek(out, count) && peek_commit(count);
  }
  /// Reader. Drops everything.
  void clear() noexcept {
    if (header_ != nullptr) header_->read.publish(header_->written.observe());
  }
  /// Writer. All or none.
  bool write(const char* data, std::uint32_t count) noexcept {
    if (count > writable()) return false;
    if (count == 0) return true;
    const std::uint64_t written = header_->written.get();
    const std::uint32_t at = place(written);
    const std::uint32_t first = count < size() - at ? count : size() - at;
    std::memcpy(header_->bytes() + at, data, first);
    std::memcpy(header_->bytes(), data + first, count - first);
    // Release: the bytes are there before they are counted.
    header_->written.publish(written + count);
    return true;
  }

 private:
  static constexpr std::uint32_t limited(std::uint32_t size) noexcept {
    return size > kPortBytesMax ? kPortBytesMax : size;
  }
  [[nodiscard]] std::uint32_t place(std::uint64_t count) const noexcept {
    return static_cast<std::uint32_t>(count % size());
  }

  PortHeader* header_{nullptr};
};

}  // namespace kerf::hal
