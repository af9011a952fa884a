// Which 64-bit words of a value are in use, where much of it is room for what most machines do not have.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kerf::rtapi {

/// Words `first` up to, not including, `end`.
struct WordPart {
  std::uint32_t first{0}, end{0};
};

/// The bytes from `begin` to `end`, and what shares a word with them.
constexpr WordPart words_of(std::size_t begin, std::size_t end) noexcept {
  return {static_cast<std::uint32_t>(begin / 8), static_cast<std::uint32_t>((end + 7) / 8)};
}

}  // namespace kerf::rtapi
