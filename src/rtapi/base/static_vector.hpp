// A vector with its storage inside and a capacity in its type.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

namespace kerf::rtapi {

/// At most N trivially copyable elements. `push_back` returns false when full: overflow is a value, not a surprise.
template <class T, std::size_t N>
class StaticVector {
  static_assert(std::is_trivially_copyable_v<T>, "elements are copied as bytes");

 public:
  [[nodiscard]] constexpr bool push_back(const T& value) noexcept {
    if (size_ == N) return false;
    items_[size_++] = value;
    return true;
  }
  constexpr void pop_back() noexcept {
    if (size_ > 0) --size_;
  }
  constexpr void clear() noexcept { size_ = 0; }
  /// Elements that become visible keep the value they had before.
  [[nodiscard]] constexpr bool resize(std::size_t n) noexcept {
    if (n > N) return false;
    size_ = n;
    return true;
  }
  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] constexpr bool full() const noexcept { return size_ == N; }
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return N; }

  constexpr T& operator[](std::size_t i) noexcept { return items_[i]; }
  constexpr const T& operator[](std::size_t i) const noexcept { return items_[i]; }
  constexpr T& back() noexcept { return items_[size_ - 1]; }
  constexpr const T& back() const noexcept { return items_[size_ - 1]; }
  constexpr T* begin() noexcept { return items_.data(); }
  constexpr T* end() noexcept { return items_.data() + size_; }
  constexpr const T* begin() const noexcept { return items_.data(); }
  constexpr const T* end() const noexcept { return items_.data() + size_; }
  constexpr operator std::span<const T>() const noexcept { return {items_.data(), size_}; }

 private:
  std::array<T, N> items_{};
  std::size_t size_{0};
};

}  // namespace kerf::rtapi
