// Port pins of a realtime component: bytes from a program or another component, in order, as many as a cycle has time for.
//
//   hal::PortIn program_{pin<hal::PortIn>("program", "Bytes to work on")};
//   hal::PortOut answer_{pin<hal::PortOut>("answer", "Bytes for the reader")};
//   ...
//   char four[4];
//   if (program_.read(four, sizeof four)) (void)answer_.write(four, sizeof four);
//
// A port leads to no queue until `setp PIN BYTES`, or `sets SIGNAL BYTES` of the signal that joins the writer and the reader: one of
// each. Without one nothing can be read and nothing fits. All of it is @rt: what is not there or does not fit is refused whole, and
// nobody waits. As with any pin the signal may change between two calls, so a result of readable() holds within one function, and
// what was read is all that a component may rely on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hal/component.hpp"
#include "hal/core/port.hpp"

namespace kerf::hal {

/// What a Builder is asked for to find the queues; nullptr where nothing will ever run.
inline constexpr std::string_view kPortsService = "ports";

namespace detail {
template <Dir kDirection>
class PortPin {
 public:
  /// A port has no value to start with.
  struct Item {};
  static constexpr Dir kDir = kDirection;

  PortPin() = default;
  PortPin(Builder& b, std::string_view whole_name, std::string_view doc,
          Item /*initial*/ = {}) noexcept {
    declare(b, whole_name, doc);
  }
  PortPin(const PortPin&) = delete;
  PortPin& operator=(const PortPin&) = delete;
  /// For a name that is known only in the constructor's body.
  void declare(Builder& b, std::string_view whole_name, std::string_view doc) noexcept {
    base_ = static_cast<std::byte*>(b.find_service(kPortsService));
    b.add_pin(whole_name, Type::port, kDir, 0, doc, &cell_);
  }
  /// Bytes that the queue has room for; 0: there is none.
  [[nodiscard]] std::uint32_t size() const noexcept { return port().size(); }

 protected:
  [[nodiscard]] Port port() const noexcept {
    if (base_ == nullptr) return {};
    return {base_, static_cast<std::uint32_t>(cell_.slot().load(std::memory_order_acquire))};
  }

 private:
  std::byte* base_{nullptr};
  PinCell cell_;
};
}  // namespace detail

/// A port that the component reads.
class PortIn : public detail::PortPin<Dir::in> {
 public:
  using PortPin::PortPin;
  [[nodiscard]] std::uint32_t readable() const noexcept { return port().readable(); }
  /// The next `count` bytes, which stay there.
  [[nodiscard]] bool peek(char* out, std::uint32_t count) const noexcept {
    return port().peek(out, count);
  }
  bool read(char* out, std::uint32_t count) noexcept { return port().read(out, count); }
  /// Forgets the next `count` bytes.
  bool skip(std::uint32_t count) noexcept { return port().peek_commit(count); }
  /// Forgets all that is there.
  void clear() noexcept { port().clear(); }
};

/// A port that the component writes.
class PortOut : public detail::PortPin<Dir::out> {
 public:
  using PortPin::PortPin;
  [[nodiscard]] std::uint32_t writable() const noexcept { return port().writable(); }
  bool write(const char* data, std::uint32_t count) noexcept { return port().write(data, count); }
};

}  // namespace kerf::hal
