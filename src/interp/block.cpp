// From a parsed line to a Block: computes the words, finds the codes, decides who takes the axis words, and refuses what
// no code of the line uses. Manual: "Modal Groups", "Repeated Items", "Common Error Messages".
#include <algorithm>
#include <cmath>
#include <string>

#include "interp/core.hpp"

namespace kerf::interp {

namespace {
constexpr int kCancelMotion = 800;
/// Of several words without a use the first in this order is named.
constexpr std::string_view kCheckOrder = "abcd$efghijklmnopqrstuvwxyz@^";
}  // namespace

bool near_integer(double v, double& rounded) {
  rounded = std::nearbyint(v);
  return std::fabs(v - rounded) <= kTolerance;
}

bool Core::build(const ParsedBlock& p, Block& b) {
  return read_words(p, b) && (p.quoted == 0 || check_quoted(p, b)) && assign(p) &&
         choose_motion(b) && check_letters(b);
}

bool Core::check_quoted(const ParsedBlock& p, Block& b) {
  for (int i = 0; i < b.row_count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    if (b.rows[n]->letter != 'm') continue;
    for (const std::int16_t code : dialect.text_codes) {
      if (code != b.codes[n]) continue;
      b.quoted = std::string_view(params.name(p.quoted - 1)).substr(1);
      return true;
    }
  }
  return fail(0, "No code of this line takes a text", "Bad character '\"' used");
}

// Values of the words, and rows of the codes.
bool Core::read_words(const ParsedBlock& p, Block& b) {
  b.mask = 0;
  b.row_count = 0;
  b.motion = nullptr;
  b.motion_code = -1;
  b.motion_is_modal = b.axis_by_other = b.g53 = false;
  b.source = &p;
  for (const ParsedWord& w : p.words) {
    double v = w.value;
    if (!w.constant && !evaluate(p, w.expr, v)) return false;
    const char name = kLetterNames[w.letter];
    if (name == 'g' || name == 'm') {
      if (!add_code(b, name, v, w.code))
        return error.column = parser_.column_of(p.text, w.at), false;
      continue;
    }
    const LetterMask bit = LetterMask{1} << w.letter;
    if ((b.mask & bit) != 0)
      return fail_at(w.at, "Keep one of them", "Multiple %c words on one line", name);
    b.mask |= bit;
    b.value[w.letter] = v;
    b.at[w.letter] = w.at;
    if (!check_word(name, v)) return false;
  }
  return true;
}

// What is wrong with a word whatever the codes are.
bool Core::check_word(char name, double v) {
  double rounded = 0;
  switch (name) {
    case 's':
      return v >= 0 || fail('s', "Write a positive speed; M4 turns the other way",
                            "Negative spindle speed used");
    case 'f': return v >= 0 || fail('f', "Write a positive feed", "Negative f word used");
    case 'l':
      return v >= 0 || fail('l', "L counts or chooses; it is 0 or more", "Negative l word used");
    case 't': return near_integer(v, rounded) || fail('t', "", "Non integer value for integer");
    default: return true;
  }
}

// "The nearest codes are G10 and G17".
std::string Core::nearest_codes(char letter, int code) const {
  std::string names;
  for (const int step : {-1, 1}) {
    for (int i = code + step; i >= 0 && i < 1000; i += step) {
      const CodeRow* r = row(letter, i);
      if (r == nullptr || r->last > r->code + 10) continue;  // user codes are no near name
      names += names.empty() ? "The nearest codes are " : " and ";
      names += letter == 'g' ? 'G' : 'M';
      names += std::to_string(letter == 'g' ? i / 10 : i);
      if (letter == 'g' && i % 10 != 0) names += '.' + std::to_string(i % 10);
      break;
    }
  }
  return names;
}

// `known`: the code when the parser has found it, else -1.
bool Core::add_code(Block& b, char letter, double value, int known) {
  double rounded = known;
  const bool g = letter == 'g';
  const bool whole = known >= 0 || near_integer(g ? value * 10 : value, rounded);
  if (g) {
    if (rounded > dialect.last_g_code || value < 0)
      return fail(0, "G-codes go from 0 to 99",
                  value < 0 ? "Negative g code used" : "G-code out of range");
  } else {
    if (value < 0) return fail(0, "", "Negative m code used");
    if (rounded > dialect.last_m_code &&
        (rounded > 999 || row(letter, static_cast<int>(rounded)) == nullptr))
      return fail(0, "M-codes go from 0 to 199", "M-code greater than %d: M%d", dialect.last_m_code,
                  static_cast<int>(std::min(rounded, 1e9)));
    if (!whole) return fail(0, "", "Non integer value for integer");
  }
  const int code = static_cast<int>(rounded);
  const CodeRow* r = whole ? row(letter, code) : nullptr;
  if (r == nullptr) {
    const std::string near = nearest_codes(letter, code);
    return g ? fail(0, near.c_str(), "Unknown g code used")
             : fail(0, near.c_str(), "Unknown m code used: M%d", code);
  }
  for (int i = 0; i < b.row_count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const CodeRow* other = b.rows[n];
    if (other->letter != letter || other->group != r->group) continue;
    // G80 beside another motion code means nothing more than that code.
    const bool first_cancels = g && b.codes[n] == kCancelMotion;
    if (first_cancels && code == kCancelMotion) return true;
    if (first_cancels != (g && code == kCancelMotion)) {
      if (first_cancels) b.rows[n] = r, b.codes[n] = static_cast<std::int16_t>(code);
      return true;
    }
    return fail(0, "Write them on separate lines", "Two %c codes used from same modal group",
                letter);
  }
  if (b.row_count == kRowSlots)
    return fail(0, "Write them on separate lines", "Too many codes on one line");
  b.rows[static_cast<std::size_t>(b.row_count)] = r;
  b.codes[static_cast<std::size_t>(b.row_count++)] = static_cast<std::int16_t>(code);
  return true;
}

bool Core::choose_motion(Block& b) {
  for (int i = 0; i < b.row_count; ++i) {
    const CodeRow* r = b.rows[static_cast<std::size_t>(i)];
    if (r->letter != 'g') continue;
    if (r->group == 1) {
      b.motion = r;
      b.motion_code = b.codes[static_cast<std::size_t>(i)];
    } else if (r->run == nullptr) {
      b.g53 = true;
    } else if (r->axes != AxisUse::none) {
      b.axis_by_other = true;
    }
  }
  if (b.axis_by_other && b.motion != nullptr && b.motion->axes != AxisUse::none)
    return fail(0, "Write them on separate lines",
                "Cannot use two g codes that both use axis values");
  if (b.has_axes() && !b.axis_by_other) {
    if (b.motion == nullptr) {
      b.motion = state.motion == kCancelMotion ? nullptr : row('g', state.motion);
      b.motion_code = state.motion;
      b.motion_is_modal = true;
    }
    if (b.motion == nullptr)
      return fail(0, "Write G0, G1 or another motion code before the axis words",
                  "Cannot use axis values without a g code that uses them");
    if (b.motion->axes == AxisUse::none)
      return fail(0, "Write the move on a line of its own", "Cannot use axis values with g80");
  }
  if (b.has('@') || b.has('^')) {
    if (b.axis_by_other)
      return fail(b.has('@') ? '@' : '^', "Write X and Y",
                  "Polar coordinates can only be used for motion");
  }
  if (b.motion != nullptr && b.motion->axes == AxisUse::required && !b.has_axes())
    return fail(0, "Write where to go, e.g. X0", "All axes missing with motion code");
  if (b.g53 && (b.motion == nullptr || (b.motion_code != 0 && b.motion_code != 10)))
    return fail(0, "Write G53 G0 or G53 G1", "Must use g0 or g1 with g53");
  return check_indexers(b);
}

/// [AXIS_L]LOCKING_INDEXER_JOINT: it is unlocked for a G0 that moves nothing else.
bool Core::check_indexers(const Block& b) {
  constexpr int kFirstCycle = 700;
  if (settings.indexer_mask == 0 || b.motion == nullptr || b.motion->remap != nullptr ||
      b.axis_by_other || (b.motion_code >= kFirstCycle && b.motion_code < 1000))
    return true;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (!b.has_axis(i) || (settings.indexer_mask >> i & 1U) == 0) continue;
    const char letter = rtapi::kAxisLetters[i];
    const auto word = static_cast<char>(std::tolower(letter));
    if (b.motion_code != 0)
      return fail(word, "Turn it with G0 on a line of its own",
                  "Indexing axis %c can only be moved with G0", letter);
    bool alone = !b.has('@') && !b.has('^');
    for (std::size_t k = 0; k < rtapi::kAxes; ++k) alone = alone && (k == i || !b.has_axis(k));
    if (!alone)
      return fail(word, "Write its word on a line of its own",
                  "Indexing axis %c can only be moved alone", letter);
    if (compensation.bends() && !compensation.leaving())
      return fail(word, "Write G40 before",
                  "Indexing axis %c cannot be moved with cutter radius compensation on", letter);
  }
  return true;
}

bool Core::check_letters(const Block& b) {
  LetterMask used = letters("fstn") | kAxisMask;
  const auto words_of = [this](const CodeRow& r) {
    // The body of a remapped code may use any word.
    return r.remap != nullptr && body_of(*r.remap) == nullptr ? ~LetterMask{0} : r.words;
  };
  for (int i = 0; i < b.row_count; ++i) used |= words_of(*b.rows[static_cast<std::size_t>(i)]);
  if (b.motion != nullptr) used |= words_of(*b.motion);
  if (b.has('s')) used |= letters("$");
  const LetterMask left = b.mask & ~used;
  if (left != 0) {
    for (const char name : kCheckOrder) {
      const int i = letter_index(name);
      if ((left >> i & 1U) == 0) continue;
      const char* text = unused_[static_cast<std::size_t>(i)];
      return fail(name, "Delete the word, or add the code that it belongs to", "%s",
                  text != nullptr ? text : "Word that no code of this line uses");
    }
  }
  return !b.has_axes() || check_axes(b);
}

// All values are found before any is stored (manual: "Numbered Parameters").
bool Core::assign(const ParsedBlock& p) {
  assigned_.clear();
  for (const Assignment& a : p.assignments) {
    double v = 0;
    if (a.text == 0 && !evaluate(p, a.value, v)) return false;
    int index = static_cast<int>(a.id);
    if (a.named) {
      if (params.is_global(a.id)) {
        const std::string& name = params.name(a.id);
        if (predefined_.by_id(a.id, name) != nullptr || name.starts_with("_hal[") ||
            name.starts_with("_ini["))
          return fail_at(a.at, "", "Cannot assign to read-only parameter #<%s>", name.c_str());
      }
    } else {
      if (a.index.count > 0) {
        double number = 0, rounded = 0;
        if (!evaluate(p, a.index, number)) return false;
        if (!near_integer(number, rounded))
          return fail_at(a.at, "", "Non integer value for integer");
        if (rounded < 1 || rounded >= kParameterCount)
          return fail_at(a.at, "Numbers go from 1 to 5602", "Parameter number out of range");
        index = static_cast<int>(rounded);
      }
      if (ParameterTable::read_only(index)) return fail_at(a.at, "", "Parameter is readonly");
      if (a.text != 0 && (index < dialect.first_text || index > dialect.last_text))
        return fail_at(a.at, "Use a number that holds texts", "Parameter #%d cannot hold a text",
                       index);
    }
    assigned_.emplace_back(index, Value{v, a.text == 0 ? nullptr : quoted_text(a.text)});
  }
  return true;
}

std::shared_ptr<const std::string> Core::quoted_text(std::uint32_t text) const {
  return std::make_shared<const std::string>(params.name(text - 1).substr(1));
}

bool Core::store(const ParsedBlock& p) {
  for (std::size_t i = 0; i < assigned_.size(); ++i) {
    if (p.assignments[i].named)
      params.set_named(p.assignments[i].id, std::move(assigned_[i].second));
    else if (assigned_[i].second.text == nullptr)
      params.set(assigned_[i].first, assigned_[i].second.number);
    else
      params.set_text(assigned_[i].first, std::move(assigned_[i].second.text));
  }
  return true;
}

bool Core::check_axes(const Block& b) {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (b.has_axis(i) && (settings.axis_mask >> i & 1U) == 0) {
      const char axis = kLetterNames[static_cast<std::size_t>(kAxisLetter[i])];
      return fail(axis, "[TRAJ]COORDINATES lists the axes of this machine",
                  "Bad character '%c' used", axis);
    }
  }
  return true;
}

}  // namespace kerf::interp
