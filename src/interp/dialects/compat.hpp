// CompatRow: what the manuals of older releases say otherwise ([RS274NGC]COMPAT), as data.
#pragma once

#include "interp/environment.hpp"

namespace kerf::interp {

struct CompatRow {
  Compat release;
  bool spindle_word;   ///< $ exists
  int absent_spindle;  ///< M3, M4 and M5 without $: -1 all spindles, 0 the first
};

/// 2.7 has one spindle; in 2.8 M3, M4 and M5 without $ are for all of them.
inline constexpr CompatRow kCompatRows[] = {
    {Compat::v2_7, false, 0},
    {Compat::v2_8, true, -1},
    {Compat::newest, true, 0},
};

[[nodiscard]] constexpr const CompatRow& compat_row(Compat release) {
  for (const CompatRow& row : kCompatRows) {
    if (row.release == release) return row;
  }
  return kCompatRows[2];
}

}  // namespace kerf::interp
