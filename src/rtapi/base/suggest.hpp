// The nearest known name, for messages that say "did you mean".
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::rtapi {

/// Edit distance that counts insertions, deletions, replacements and swaps of neighbours, ignoring case.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0U : 1U)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1]))
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
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
    const std::size_t d = edit_distance(name, candidate);
    // A name of two letters with both replaced is another name altogether.
    if (d < best_distance && d < std::max(name.size(), candidate.size())) {
      best_distance = d;
      best = std::string(candidate);
    }
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
