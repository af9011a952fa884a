// The nearest known name, for messages that say "did you mean".
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::rtapi {

/// Edit distance that counts insertions, deletions, replacements and swaps of neighbours, ignoring case. A distance of more than
/// `limit` comes out as some number above it, and is found out sooner.
inline std::size_t edit_distance(std::string_view a, std::string_view b,
                                 std::size_t limit = SIZE_MAX - 1) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  const std::size_t apart = a.size() > b.size() ? a.size() - b.size() : b.size() - a.size();
  if (apart > limit) return limit + 1;
  limit = std::min(limit, std::max(a.size(), b.size()));
  // Three rows of the table, in one piece: the last but one, the last and the one that is filled in.
  const std::size_t width = b.size() + 1;
  std::size_t small[3 * 64];
  std::vector<std::size_t> large(width > 64 ? 3 * width : 0);
  std::size_t* before = width > 64 ? large.data() : small;
  std::size_t* last = before + width;
  std::size_t* row = last + width;
  for (std::size_t j = 0; j < width; ++j) before[j] = last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    // Cells further than `limit` from the diagonal are above it anyway.
    const std::size_t from = i > limit ? i - limit : 1;
    const std::size_t to = std::min(b.size(), i + limit);
    row[from - 1] = from == 1 ? i : limit + 1;
    std::size_t least = row[from - 1];
    for (std::size_t j = from; j <= to; ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      const std::size_t above = j == i + limit ? limit : last[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, last[j - 1] + (same ? 0U : 1U)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1]))
        row[j] = std::min(row[j], before[j - 2] + 1);
      least = std::min(least, row[j]);
    }
    if (to < b.size()) row[to + 1] = limit + 1;
    // A swap of neighbours may still build on the row before.
    if (least > limit && *std::min_element(last + from - 1, last + to + 1) >= limit)
      return limit + 1;
    std::size_t* free = before;
    before = last;
    last = row;
    row = free;
  }
  return last[b.size()];
}

/// The element of `known` (anything iterable as string_view) nearest to `name`, or "" when none is near enough to be worth saying.
template <class Range>
std::string nearest_name(std::string_view name, const Range& known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const auto& item : known) {
    const std::string_view candidate(item);
    const std::size_t d = edit_distance(name, candidate, best_distance - 1);
    // A name of two letters with both replaced is another name altogether.
    if (d < best_distance && d < std::max(name.size(), candidate.size())) {
      best_distance = d;
      best = std::string(candidate);
    }
    if (best_distance == 0) break;
  }
  return best;
}

/// "; did you mean 'x'?" or "".
template <class Range>
std::string did_you_mean(std::string_view name, const Range& known) {
  const std::string best = nearest_name(name, known);
  return best.empty() ? std::string() : "; did you mean '" + best + "'?";
}

}  // namespace kerf::rtapi
