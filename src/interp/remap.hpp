// Remap: one REMAP line of the INI ([RS274NGC]), which gives a code a new body. Manual: "Remap Extending G-code".
//
//     REMAP = M400 modalgroup=10 argspec=Pq ngc=myprocedure
//
// The body is an O-word sub (`ngc=`, with `prolog=` before and `epilog=` behind it) or a function of Python (`python=`).
// The functions of the documented standard glue (prepare_prolog ... ignore_m6) are built in: they need no Python.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::interp {

struct Remap {
  char letter{'m'};         ///< g, m, t, s, f
  std::int16_t code{0};     ///< G times ten; M; 0 for t, s, f
  std::int8_t group{0};     ///< modal group
  std::string name;         ///< "M400", as in messages
  std::string words;        ///< argspec letters: capital = required, small = optional
  bool positional{false};   ///< @: words become #1, #2, ...
  bool spindle{false};      ///< ^: the spindle must turn
  bool feed{false};         ///< >: there must be a feed
  bool line_number{false};  ///< n: #<n> is the number of the line
  std::string ngc, python, prolog, epilog;
  std::string text;  ///< the value of the key
};

struct RemapParse {
  std::optional<Remap> remap;
  std::string error;                  ///< when there is none
  std::vector<std::string> warnings;  ///< what is ignored
};

/// Reads the value of one REMAP key. Codes that cannot have a new body give a warning and no remap, as at the peer.
[[nodiscard]] RemapParse parse_remap(std::string_view text);

/// True for `prolog=`, `epilog=` and `python=` functions that need no Python.
[[nodiscard]] bool is_native_glue(std::string_view function);

}  // namespace kerf::interp
