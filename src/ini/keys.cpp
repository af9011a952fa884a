#include "ini/keys.hpp"

#include <array>
#include <charconv>

#include "ini/convert.hpp"
#include "ini/keys/rows.hpp"

namespace kerf::ini {

namespace {

constexpr std::string_view kAxisLetters = "XYZABCUVW";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Does `name` fit `pattern`, in which `hole` stands for a number ('n') or an axis letter ('L')?
bool fits(std::string_view name, std::string_view pattern, char hole) {
  const auto at = pattern.find(hole);
  if (at == std::string_view::npos) return name == pattern;
  const std::string_view tail = pattern.substr(at + 1);
  if (name.size() <= at + tail.size() || name.substr(0, at) != pattern.substr(0, at) ||
      name.substr(name.size() - tail.size()) != tail) {
    return false;
  }
  const std::string_view inside = name.substr(at, name.size() - at - tail.size());
  if (hole == 'L') {
    return inside.size() == 1 && kAxisLetters.find(inside[0]) != std::string_view::npos;
  }
  for (const char c : inside) {
    if (!is_digit(c)) return false;
  }
  return true;
}

std::string short_number(double value) {
  char text[64];
  const auto [end, code] = std::to_chars(text, text + sizeof text, value);
  return code == std::errc{} ? std::string(text, end) : std::string("?");
}

std::string range_text(const Key& key) {
  const bool has_min = key.min != -Key::kNone;
  const bool has_max = key.max != Key::kNone;
  const char* at_least = key.min_excluded ? " above " : " from ";
  return (has_min ? at_least + short_number(key.min) : std::string()) +
         (has_max ? " to " + short_number(key.max) : std::string());
}

/// One row in words, in the order of the columns.
std::array<std::string, 9> columns(const KeySection& section, const Key& key) {
  const By by = key.by == By::section ? section.by : key.by;
  return {std::string(section.name),
          std::string(key.name),
          kind_text(key),
          std::string(key.units),
          std::string(key.fallback_words.empty() ? key.fallback : key.fallback_words),
          key.is_required   ? "required"
          : key.is_repeated ? "repeated"
                            : "",
          std::string(by_name(by)),
          std::string(verdict_name(key.verdict)),
          std::string(key.meaning) + '\t' + std::string(key.note)};
}

std::string full_name(const std::string& section, const std::string& key) {
  std::string out = "[";
  out.append(section).append("]").append(key);
  return out;
}

bool contains_all(const std::string& text, const std::vector<std::string>& words) {
  for (const auto& word : words) {
    bool found = false;
    for (std::size_t i = 0; !found && i + word.size() <= text.size(); ++i)
      found = equal_ignoring_case(std::string_view(text).substr(i, word.size()), word);
    if (!found) return false;
  }
  return true;
}

}  // namespace

const KeySection* KeyTable::section(std::string_view name) const {
  for (const KeySection& s : sections_) {
    const bool by_letter = s.name.size() > 2 && s.name.substr(s.name.size() - 2) == "_L";
    const char hole = by_letter ? 'L' : 'n';
    if (fits(name, s.name, hole)) return &s;
  }
  return nullptr;
}

KeyPlace KeyTable::find(std::string_view section_name, std::string_view key) const {
  const KeySection* s = section(section_name);
  if (s == nullptr) return {};
  for (const Key& k : s->keys) {
    if (fits(key, k.name, 'n')) return {s, &k};
  }
  return {s, nullptr};
}

const KeyTable& machine_keys() {
  static const std::array all_sections{
      KeySection{"EMC", "the machine as a whole", keys::emc_keys, By::kerf},
      KeySection{"DISPLAY",
                 "the operator's screen; most keys are for the program that DISPLAY names, "
                 "which reads them itself",
                 keys::display_keys, By::screen},
      KeySection{"FILTER", "programs that make G-code of other files", keys::filter_keys,
                 By::screen, true},
      KeySection{"RS274NGC", "G-code", keys::rs274ngc_keys, By::interpreter},
      KeySection{"PYTHON", "Python in the interpreter", keys::python_keys, By::interpreter},
      KeySection{"WIZARD", "", keys::wizard_keys, By::interpreter},
      KeySection{"EMCMOT", "read by HAL files, which load motion control", keys::emcmot_keys,
                 By::hal},
      KeySection{"TASK", "the program that sequences the machine", keys::task_keys, By::task},
      KeySection{"HAL", "HAL files and programs with pins", keys::hal_keys, By::kerf},
      KeySection{"HALUI", "pins for operator's buttons", keys::halui_keys, By::halui},
      KeySection{"APPLICATIONS", "programs beside the screen", keys::applications_keys, By::kerf},
      KeySection{"TRAJ", "units, axes and the path", keys::traj_keys, By::motion},
      KeySection{"KINS", "joints and how axes move them", keys::kins_keys, By::task},
      KeySection{"AXIS_L", "an axis: AXIS_X to AXIS_W", keys::axis_keys, By::motion},
      KeySection{"JOINT_n", "a joint: JOINT_0 and so on", keys::joint_keys, By::motion},
      KeySection{"SPINDLE_n", "a spindle: SPINDLE_0 and so on", keys::spindle_keys, By::motion},
      KeySection{"EMCIO", "tools", keys::emcio_keys, By::task},
      KeySection{"MTCONNECT", "", keys::mtconnect_keys, By::nobody},
      KeySection{"KERF", "not in LinuxCNC, which ignores it", keys::kerf_keys, By::kerf},
      KeySection{"SAFE_STATE", "not in LinuxCNC, which ignores it", keys::safe_state_keys,
                 By::kerf},
  };
  static const KeyTable all_keys{all_sections};
  return all_keys;
}

std::vector<std::string> split_choices(std::string_view choices) {
  std::vector<std::string> out;
  while (!choices.empty()) {
    const auto end = choices.find(' ');
    out.emplace_back(choices.substr(0, end));
    choices.remove_prefix(end == std::string_view::npos ? choices.size() : end + 1);
  }
  return out;
}

std::string_view by_name(By by) {
  switch (by) {
    case By::kerf: return "kerf";
    case By::task: return "task";
    case By::interpreter: return "interpreter";
    case By::motion: return "motion";
    case By::halui: return "halui";
    case By::screen: return "screen";
    case By::hal: return "HAL files";
    case By::section:
    case By::nobody: break;
  }
  return "";
}

std::string_view verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::works: return "works";
    case Verdict::differs: return "differs";
    case Verdict::no: return "no";
    case Verdict::own: break;
  }
  return "own";
}

std::string kind_text(const Key& key) {
  switch (key.kind) {
    case Kind::text: return "text";
    case Kind::real: return "number" + range_text(key);
    case Kind::integer: return "integer" + range_text(key);
    case Kind::boolean: return "boolean";
    case Kind::choice: {
      std::string out;
      for (const auto& name : split_choices(key.choices)) out += (out.empty() ? "" : ", ") + name;
      return out;
    }
    case Kind::reals: {
      std::string counts;
      for (const auto& n : split_choices(key.choices)) counts += (counts.empty() ? "" : ", ") + n;
      return counts.empty() ? "numbers" : counts + " numbers";
    }
    case Kind::linear_unit: return "mm, cm, inch, in, metric, imperial, or units in 1 mm";
    case Kind::angular_unit: break;
  }
  return "deg, degree, rad, radian, grad, gon, or units in 1 degree";
}

std::string keys_as_tsv(const KeyTable& table) {
  std::string out = "section\tkey\ttype\tunit\tdefault\tneed\tby\tverdict\tmeaning\tnote\n";
  for (const KeySection& section : table.sections()) {
    out += "# " + std::string(section.name) + '\t' + std::string(section.meaning) + '\n';
    for (const Key& key : section.keys) {
      std::string line;
      for (const auto& cell : columns(section, key)) line += (line.empty() ? "" : "\t") + cell;
      out += line + '\n';
    }
  }
  return out;
}

std::string keys_as_text(const KeyTable& table, const std::vector<std::string>& words) {
  std::string out;
  for (const KeySection& section : table.sections()) {
    for (const Key& key : section.keys) {
      const auto row = columns(section, key);
      const auto& [of, name, kind, unit, fallback, need, by, verdict, last] = row;
      const std::string shown = full_name(of, name);
      std::string searched = shown;
      searched.append(" ").append(key.meaning);
      if (!contains_all(searched, words)) continue;
      out.append(shown).append(": ").append(kind);
      if (!unit.empty()) out += " [" + unit + ']';
      if (!fallback.empty()) out += ", default " + fallback;
      if (!need.empty()) out += ", " + need;
      out += '\n';
      if (!key.meaning.empty()) out += "    " + std::string(key.meaning) + '\n';
      if (key.verdict == Verdict::no) out += "    not supported: " + std::string(key.note) + '\n';
      if (key.verdict == Verdict::differs) out += "    differs: " + std::string(key.note) + '\n';
    }
  }
  return out;
}

}  // namespace kerf::ini
