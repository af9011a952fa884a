// A dialect for tests, of rows alone: statements without O-words, bare names, a function of its own, numbers that hold texts and codes
// that take a text. Nothing of it is in the interpreter.
#pragma once

#include <vector>

#include "interp/codes/families.hpp"
#include "interp/core.hpp"
#include "interp/dialect.hpp"

namespace kerf::interp {

inline constexpr StatementRow kShopStatements[] = {
    {"while", Flow::while_loop, true, "do"},
    {"while", Flow::while_loop, true, "", Joins::nesting},
    {"endwhile", Flow::endwhile, false, "", Joins::nesting},
    {"if", Flow::go_to, true, "thengoto", Joins::line},
    {"if", Flow::go_to, true, "goto", Joins::line},
    {"if", Flow::none, true, "then", Joins::rest, "else"},
    {"if", Flow::if_block, true, "", Joins::nesting},
    {"elseif", Flow::elseif, true, "", Joins::nesting},
    {"else", Flow::else_block, false, "", Joins::nesting},
    {"endif", Flow::endif, false, "", Joins::nesting},
    {"end", Flow::endwhile, false, ""},
    {"goto", Flow::go_to, false, "", Joins::line},
};
inline constexpr ExternalFunction kShopFunctions[] = {
    {"prm",
     [](Core& core, double& value) {
       if (value < 0) return core.fail(0, "", "No such setting");
       value = value * 10;
       return true;
     }},
};
inline constexpr std::int16_t kShopTextCodes[] = {130};
inline constexpr CodeRow kShopCodes[] = {
    {'m', 130, 130, 10, kOrderUser,
     [](Core& core, const Block& b, int) {
       core.out.call<&Canon::message>(core.out.keep(b.quoted));
       return true;
     },
     letters("l"), AxisUse::none},
};

inline const Dialect& shop_dialect() {
  static const std::vector<std::span<const CodeRow>> families = [] {
    const auto base = linuxcnc_dialect().families;
    std::vector<std::span<const CodeRow>> all(base.begin(), base.end());
    all.emplace_back(kShopCodes);
    return all;
  }();
  static const Dialect dialect = [] {
    Dialect d = linuxcnc_dialect();
    d.name = "shop";
    d.families = families;
    d.statements = kShopStatements;
    d.functions = kShopFunctions;
    d.bare_names = d.quotes = true;
    d.first_text = 300;
    d.last_text = 399;
    d.text_codes = kShopTextCodes;
    return d;
  }();
  return dialect;
}

}  // namespace kerf::interp
