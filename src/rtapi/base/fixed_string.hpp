// A string with its storage inside: what shared memory and realtime code use instead of std::string.
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string_view>

namespace kerf::rtapi {

/// At most N bytes of text, always zero-terminated; longer text is cut and `truncated()` says so.
/// Trivially copyable, so it may live in shared memory and travel in messages.
template <std::size_t N>
class FixedString {
 public:
  constexpr FixedString() = default;
  constexpr FixedString(std::string_view text) { assign(text); }
  constexpr FixedString(const char* text) { assign(text); }

  constexpr void assign(std::string_view text) noexcept {
    truncated_ = text.size() > N ? 1 : 0;
    size_ = static_cast<std::uint16_t>(truncated_ != 0 ? N : text.size());
    for (std::size_t i = 0; i < size_; ++i) data_[i] = text[i];
    data_[size_] = '\0';
  }
  constexpr void append(std::string_view text) noexcept {
    for (const char c : text) {
      if (size_ == N) {
        truncated_ = 1;
        break;
      }
      data_[size_++] = c;
    }
    data_[size_] = '\0';
  }
  constexpr void clear() noexcept { assign({}); }

  [[nodiscard]] constexpr std::string_view view() const noexcept {
    // The size may come from shared memory: never trust it beyond the capacity.
    return {data_, size_ <= N ? size_ : N};
  }
  constexpr operator std::string_view() const noexcept { return view(); }
  [[nodiscard]] constexpr const char* c_str() const noexcept { return data_; }
  [[nodiscard]] constexpr std::size_t size() const noexcept { return view().size(); }
  [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] constexpr bool truncated() const noexcept { return truncated_ != 0; }
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return N; }

  friend constexpr bool operator==(const FixedString& a, std::string_view b) noexcept {
    return a.view() == b;
  }
  friend constexpr bool operator==(const FixedString& a, const FixedString& b) noexcept {
    return a.view() == b.view();
  }

 private:
  static_assert(N < 65535, "the size field has 16 bits");
  char data_[N + 1]{};
  std::uint16_t size_{0};
  std::uint16_t truncated_{0};
};

/// printf into a FixedString. Not for realtime code: snprintf may allocate for floating point.
template <std::size_t N>
[[gnu::format(printf, 1, 2)]] FixedString<N> format_fixed(const char* fmt, ...) {
  char buffer[N + 2];
  std::va_list args;
  va_start(args, fmt);
  const int n = std::vsnprintf(buffer, sizeof buffer, fmt, args);
  va_end(args);
  return FixedString<N>(std::string_view(buffer, n < 0 ? 0 : std::strlen(buffer)));
}

}  // namespace kerf::rtapi
