// The linuxcnc dialect: its families of codes and its letters.
#include <array>

#include "interp/codes/families.hpp"
#include "interp/source.hpp"

namespace kerf::interp {

namespace {

constexpr LetterRow kLetterRows[] = {
    {'d', "D word with no G41, G41.1, G42, G42.1, G71, G71.1, G71.2 G73, G83 or G96 to use it"},
    {'e', "E word with no G70, G76, M66, M67 or M68 to use it"},
    {'h', "H word with no G43 or G76 to use it"},
    {'i', "I word with no G2, G3, G5, G5.1, G10, G33.1, G76, or G87 to use it"},
    {'j', "J word with no G2, G3, G5, G5.1, G10, G76 or G87 to use it"},
    {'k', "K word with no G2, G3, G33, G33.1, G76, or G87 to use it"},
    {'l',
     "L word with no G10, cutter compensation, canned cycle, digital/analog input, M98 or NURBS "
     "code"},
    {'p',
     "P word with no G2 G3 G4 G10 G64 G5 G5.2 G6, G6.2, G76 G82 G86 G88 G89 or M50 M51 M52 M53 M62 "
     "M63 M64 "
     "M65 M66 M98 or user M code to use it"},
    {'q',
     "Q word with no G5, G6, G10, G64, G73, G76, G83, M19, M66, M67, M68 or user M code that uses "
     "it"},
    {'r', "R word with no g code that uses it"},
    {'$',
     "$ (spindle selection) word with no M3, M4, M5, M19, M51, G33, G33.1, G76, G95, G96 or G97 to "
     "use it"},
};

}  // namespace

const Dialect& linuxcnc_dialect() {
  static const std::array<std::span<const CodeRow>, 14> families = {
      motion_codes(), arc_codes(),     cycle_codes(), mode_codes(),    offset_codes(),
      tool_codes(),   spindle_codes(), io_codes(),    program_codes(), state_codes(),
      thread_codes(), spline_codes(),  comp_codes(),  lathe_codes(),
  };
  static const Dialect dialect{"linuxcnc", families, kLetterRows, true,        true,
                               199,        999,      10,          kLongestLine};
  return dialect;
}

}  // namespace kerf::interp
