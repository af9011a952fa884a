#include "ini/check.hpp"

#include <algorithm>
#include <map>

#include "ini/convert.hpp"
#include "ini/nearest.hpp"
#include "ini/reader.hpp"

namespace kerf::ini {

namespace {

bool is_name_char(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
}

std::string_view name_at(std::string_view text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && is_name_char(text[end])) ++end;
  return text.substr(at, end - at);
}

std::string full_name(const Entry& entry) { return '[' + entry.section + ']' + entry.key; }

class KeyCheck {
 public:
  KeyCheck(const IniFile& file, const HalUse& hal, const KeyTable& table)
      : file_(file), hal_(hal), table_(table) {}

  std::vector<Diagnostic> run() {
    for (const std::string& section : file_.sections()) unknown_section(section);
    for (const Entry* entry : file_.variables({})) check(*entry);
    std::stable_sort(out_.begin(), out_.end(), [](const Diagnostic& a, const Diagnostic& b) {
      return a.at.file == b.at.file && a.at.line < b.at.line;
    });
    return std::move(out_);
  }

 private:
  void warn(const Position& at, std::string text) { out_.push_back({at, false, std::move(text)}); }

  /// [JOINT0] and [DISPLY] are mistakes; [MY_PROBE] is a section of the user's own.
  void unknown_section(const std::string& name) {
    if (table_.section(name) != nullptr || hal_.uses_section(name)) return;
    std::vector<std::string> known;
    for (const KeySection& s : table_.sections()) {
      std::string text(s.name);
      if (text.back() == 'n') {
        // The digits are the user's: JOINT0 is near JOINT_0.
        const auto digit = name.find_first_of("0123456789");
        if (digit == std::string::npos) continue;
        text = text.substr(0, text.size() - 1) + name.substr(digit);
      }
      if (text == "AXIS_L") text = std::string("AXIS_") + name.back();
      if (table_.section(text) != nullptr) known.push_back(std::move(text));
    }
    if (name.rfind("AXIS_", 0) == 0 && name.find_first_not_of("0123456789", 5) == name.npos) {
      warn(file_.section_position(name), "section [" + name +
                                             "] is from before LinuxCNC 2.8: joints are in "
                                             "[JOINT_n], axes in [AXIS_X] and so on");
      return;
    }
    const std::string near = nearest_name(name, known);
    if (!near.empty())
      warn(file_.section_position(name),
           "nothing reads section [" + name + "]; did you mean [" + near + "]?");
  }

  void check(const Entry& entry) {
    const std::size_t num = ++seen_[{entry.section, entry.key}];
    const KeyPlace place = table_.find(entry.section, entry.key);
    if (place.section == nullptr) return;
    if (place.key == nullptr) {
      if (num == 1 && !place.section->open && !hal_.uses(entry.section, entry.key))
        unknown_key(entry, *place.section);
      return;
    }
    const Key& key = *place.key;
    const bool in_hal = hal_.uses(entry.section, entry.key);
    if (num > 1 && !key.is_repeated) {
      warn(entry.at, full_name(entry) + " again: the first one counts, in " +
                         file_.find(entry.section, entry.key)->at.text());
      return;
    }
    if (key.verdict == Verdict::no) {
      if (!in_hal && num == 1 && !is_neutral(entry))
        warn(entry.at, full_name(entry) + " is not supported: " + std::string(key.note));
      return;
    }
    const bool ours = place.by() != By::screen && place.by() != By::hal;
    for (Diagnostic& d : check_value(file_, key, entry.section, entry.key, num)) {
      d.is_error = d.is_error && ours;
      out_.push_back(std::move(d));
    }
    if (entry.section == "EMC" && entry.key == "VERSION" && entry.value != key.fallback)
      warn(entry.at, full_name(entry) + " = " + entry.value + ": " + std::string(key.note));
  }

  /// BACKLASH = 0 asks for nothing, so nothing is missed.
  static bool is_neutral(const Entry& entry) {
    const Number<double> number = to_real(entry.value);
    return entry.value.empty() || (number.valid && number.value == 0 && !number.has_trailing());
  }

  void unknown_key(const Entry& entry, const KeySection& section) {
    std::vector<std::string> known;
    for (const Key& key : section.keys) known.emplace_back(key.name);
    std::string text = "unknown key " + full_name(entry);
    const std::string near = nearest_name(entry.key, known);
    if (!near.empty()) text += "; did you mean '" + near + "'?";
    warn(entry.at, std::move(text));
  }

  const IniFile& file_;
  const HalUse& hal_;
  const KeyTable& table_;
  std::map<std::pair<std::string, std::string>, std::size_t> seen_;
  std::vector<Diagnostic> out_;
};

}  // namespace

void HalUse::add_text(std::string_view text) {
  for (std::size_t i = 0; (i = text.find('[', i)) != std::string_view::npos; ++i) {
    const std::string_view section = name_at(text, i + 1);
    std::size_t at = i + 1 + section.size();
    if (section.empty() || at >= text.size() || text[at] != ']') continue;
    ++at;
    if (at < text.size() && text[at] == '(') ++at;
    if (const std::string_view key = name_at(text, at); !key.empty()) pairs_.emplace(section, key);
  }
}

void HalUse::add_script(std::string_view text) {
  add_text(text);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view word = name_at(text, i);
    if (!word.empty()) words_.emplace(word);
    i += word.size();
  }
}

bool HalUse::uses(std::string_view section, std::string_view key) const {
  return words_.find(key) != words_.end() ||
         pairs_.find(std::pair(std::string(section), std::string(key))) != pairs_.end();
}

bool HalUse::uses_section(std::string_view section) const {
  const auto at = pairs_.lower_bound(std::pair(std::string(section), std::string()));
  return (at != pairs_.end() && at->first == section) || words_.find(section) != words_.end();
}

std::vector<Diagnostic> check_keys(const IniFile& file, const HalUse& hal, const KeyTable& table) {
  return KeyCheck(file, hal, table).run();
}

}  // namespace kerf::ini
