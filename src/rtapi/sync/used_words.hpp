// Which words of a value carry something, told by what does not.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

#include "rtapi/sync/word_part.hpp"

namespace kerf::rtapi {

/// The end of an array that this machine does not use, in bytes of the value that holds the array.
struct UnusedBytes {
  std::size_t begin{0}, end{0};
};

/// Of an array at `offset` with `room` items of `item` bytes, the first `used` of which are used.
constexpr UnusedBytes unused(std::size_t offset, std::size_t item, std::size_t used,
                             std::size_t room) noexcept {
  return {offset + used * item, offset + room * item};
}

/// All words of a T but those gaps; what shares a word with something else stays in. So a member that is new is carried without a word here.
template <class T, class... Gaps>
constexpr std::array<WordPart, sizeof...(Gaps) + 1> words_but(Gaps... gaps) noexcept {
  UnusedBytes all[] = {gaps..., {sizeof(T), sizeof(T)}};
  std::sort(std::begin(all), std::end(all),
            [](const UnusedBytes& a, const UnusedBytes& b) { return a.begin < b.begin; });
  std::array<WordPart, sizeof...(Gaps) + 1> parts{};
  std::size_t begin = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i] = words_of(begin, all[i].begin);
    begin = all[i].end;
  }
  return parts;
}

}  // namespace kerf::rtapi
