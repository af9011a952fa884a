#include "ini/reader.hpp"

#include <charconv>
#include <optional>
#include <type_traits>

#include "ini/convert.hpp"
#include "ini/nearest.hpp"

namespace kerf::ini {

namespace {

std::string full_name(std::string_view section, std::string_view key) {
  return '[' + std::string(section) + ']' + std::string(key);
}

template <class T>
std::string number_text(T value) {
  char text[64];
  const auto [end, code] = std::to_chars(text, text + sizeof text, value);
  return code == std::errc{} ? std::string(text, end) : std::string("?");
}

/// "a number from 0 to 100 [mm/s]", "an integer above 0".
template <class T>
std::string expected_number(const NumberSpec<T>& spec) {
  std::string out = std::is_floating_point_v<T> ? "a number" : "an integer";
  // An unsigned key has a lower limit to show even when the caller gave none.
  const bool has_min = std::is_unsigned_v<T> || spec.min != std::numeric_limits<T>::lowest();
  const bool has_max = spec.max != std::numeric_limits<T>::max();
  if (has_min && spec.min_excluded) {
    out += " above " + number_text(spec.min);
    if (has_max) out += " and at most " + number_text(spec.max);
  } else if (has_min && has_max) {
    out += " from " + number_text(spec.min) + " to " + number_text(spec.max);
  } else if (has_min) {
    out += " of at least " + number_text(spec.min);
  } else if (has_max) {
    out += " of at most " + number_text(spec.max);
  }
  if (!spec.unit.empty()) out += " [" + std::string(spec.unit) + ']';
  return out;
}

std::vector<std::string> keys_of(const IniFile& file, std::string_view section) {
  std::vector<std::string> out;
  for (const Entry* entry : file.variables(section)) out.push_back(entry->key);
  return out;
}

/// What an absent key may have been meant to be: "; did you mean ...", or "".
std::string hint_for_missing(const IniFile& file, std::string_view section, std::string_view key) {
  if (!file.has_section(section)) {
    const std::string near = nearest_name(section, file.sections());
    if (!near.empty()) {
      return "; there is no section [" + std::string(section) + "], did you mean [" + near +
             "] at " + file.section_position(near).text() + '?';
    }
  } else if (const std::string near = nearest_name(key, keys_of(file, section)); !near.empty()) {
    return "; did you mean '" + near + "' at " + file.find(section, near)->at.text() + '?';
  }
  if (const Entry* other = file.find({}, key); other != nullptr) {
    return "; " + full_name(other->section, key) + " exists at " + other->at.text();
  }
  return file.has_section(section) ? "" : "; there is no section [" + std::string(section) + ']';
}

Diagnostic missing(const IniFile& file, std::string_view section, std::string_view key,
                   const std::string& expected) {
  return {file.section_position(section), true,
          full_name(section, key) + " is missing: expected " + expected +
              hint_for_missing(file, section, key)};
}

Diagnostic bad_value(const Entry& entry, const std::string& expected) {
  std::string text =
      full_name(entry.section, entry.key) + " = '" + entry.value + "': expected " + expected;
  if (entry.value.find_first_of("#;") != std::string::npos) {
    text += "; a comment after a value belongs to the value, put it on a line of its own";
  }
  return {entry.at, true, std::move(text)};
}

/// Text after a number is only dropped silently when it is a comment.
template <class T>
void warn_about_rest(const Entry& entry, const Number<T>& number,
                     std::vector<Diagnostic>& diagnostics) {
  const auto first = number.rest.find_first_not_of(" \t");
  if (first == std::string_view::npos) return;
  if (first > 0 && (number.rest[first] == '#' || number.rest[first] == ';')) return;
  diagnostics.push_back({entry.at, false,
                         full_name(entry.section, entry.key) + " = '" + entry.value + "': '" +
                             std::string(number.rest.substr(first)) +
                             "' after the number is ignored"});
}

template <class T>
Value<T> get_number(const IniFile& file, std::string_view section, std::string_view key,
                    const NumberSpec<T>& spec, Number<T> (*convert)(std::string_view)) {
  Value<T> out;
  out.value = spec.fallback;
  const Entry* entry = file.find(section, key, spec.num);
  if (entry == nullptr) {
    if (spec.required) {
      out.diagnostics.push_back(missing(file, section, key, expected_number(spec)));
    }
    return out;
  }
  out.found = true;
  out.at = entry->at;
  const Number<T> number = convert(entry->value);
  const bool wrapped = std::is_unsigned_v<T> && number.negated && number.value != 0;
  const bool above_min = spec.min_excluded ? number.value > spec.min : number.value >= spec.min;
  if (!number.valid || wrapped || !above_min || number.value > spec.max) {
    out.diagnostics.push_back(bad_value(*entry, expected_number(spec)));
    return out;
  }
  out.value = number.value;
  warn_about_rest(*entry, number, out.diagnostics);
  return out;
}

}  // namespace

Value<double> get_real(const IniFile& file, std::string_view section, std::string_view key,
                       const RealSpec& spec) {
  return get_number(file, section, key, spec, &to_real);
}

Value<std::int64_t> get_int(const IniFile& file, std::string_view section, std::string_view key,
                            const IntSpec& spec) {
  return get_number(file, section, key, spec, &to_int);
}

Value<std::uint64_t> get_uint(const IniFile& file, std::string_view section, std::string_view key,
                              const UintSpec& spec) {
  return get_number(file, section, key, spec, &to_uint);
}

Value<bool> get_bool(const IniFile& file, std::string_view section, std::string_view key,
                     const BoolSpec& spec) {
  constexpr const char* kExpected = "one of TRUE YES ON 1 FALSE NO OFF 0";
  Value<bool> out;
  out.value = spec.fallback;
  const Entry* entry = file.find(section, key, spec.num);
  if (entry == nullptr) {
    if (spec.required) out.diagnostics.push_back(missing(file, section, key, kExpected));
    return out;
  }
  out.found = true;
  out.at = entry->at;
  if (const auto value = to_bool(entry->value)) {
    out.value = *value;
  } else {
    out.diagnostics.push_back(bad_value(*entry, kExpected));
  }
  return out;
}

Value<std::string> get_string(const IniFile& file, std::string_view section, std::string_view key,
                              const StringSpec& spec) {
  Value<std::string> out;
  out.value = spec.fallback;
  const Entry* entry = file.find(section, key, spec.num);
  if (entry == nullptr) {
    if (spec.required) out.diagnostics.push_back(missing(file, section, key, "a text"));
    return out;
  }
  out.found = true;
  out.at = entry->at;
  out.value = entry->value;
  return out;
}

template <class T>
T Reader::take(std::string_view section, std::string_view key, Value<T> value) {
  known_key(section, key);
  for (auto& d : value.diagnostics) complaints_.push_back(std::move(d));
  return std::move(value.value);
}

double Reader::real(std::string_view section, std::string_view key, const RealSpec& spec) {
  return take(section, key, get_real(file_, section, key, spec));
}

std::int64_t Reader::integer(std::string_view section, std::string_view key, const IntSpec& spec) {
  return take(section, key, get_int(file_, section, key, spec));
}

std::uint64_t Reader::unsigned_integer(std::string_view section, std::string_view key,
                                       const UintSpec& spec) {
  return take(section, key, get_uint(file_, section, key, spec));
}

bool Reader::boolean(std::string_view section, std::string_view key, const BoolSpec& spec) {
  return take(section, key, get_bool(file_, section, key, spec));
}

std::string Reader::string(std::string_view section, std::string_view key, const StringSpec& spec) {
  return take(section, key, get_string(file_, section, key, spec));
}

std::vector<std::string> Reader::strings(std::string_view section, std::string_view key) {
  known_key(section, key);
  std::vector<std::string> out;
  for (const Entry* entry : file_.find_all(section, key)) out.push_back(entry->value);
  return out;
}

std::size_t Reader::choice(std::string_view section, std::string_view key,
                           const std::vector<std::string>& names, std::size_t fallback,
                           bool required) {
  known_key(section, key);
  std::string expected = "one of";
  for (const auto& name : names) expected += ' ' + name;
  const Entry* entry = file_.find(section, key);
  if (entry == nullptr) {
    if (required) complaints_.push_back(missing(file_, section, key, expected));
    return fallback;
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (equal_ignoring_case(names[i], entry->value)) return i;
  }
  const std::string near = nearest_name(entry->value, names);
  if (!near.empty()) expected += "; did you mean '" + near + "'?";
  complaints_.push_back(bad_value(*entry, expected));
  return fallback;
}

double Reader::linear_unit(std::string_view section, std::string_view key, double fallback_mm) {
  known_key(section, key);
  const Entry* entry = file_.find(section, key);
  if (entry == nullptr) return fallback_mm;
  if (const auto mm = mm_per_unit(entry->value)) return *mm;
  complaints_.push_back(bad_value(*entry, "one of mm cm inch in metric imperial"));
  return fallback_mm;
}

double Reader::angular_unit(std::string_view section, std::string_view key, double fallback_deg) {
  known_key(section, key);
  const Entry* entry = file_.find(section, key);
  if (entry == nullptr) return fallback_deg;
  if (const auto deg = deg_per_unit(entry->value)) return *deg;
  complaints_.push_back(bad_value(*entry, "one of deg degree rad radian grad gon"));
  return fallback_deg;
}

bool Reader::has(std::string_view section, std::string_view key) {
  known_key(section, key);
  return file_.find(section, key) != nullptr;
}

void Reader::known_key(std::string_view section, std::string_view key) {
  asked_.emplace(section, key);
}

void Reader::complain(std::string_view section, std::string_view key, const std::string& text,
                      bool is_error) {
  const Entry* entry = file_.find(section, key);
  complaints_.push_back({entry != nullptr ? entry->at : file_.section_position(section), is_error,
                         full_name(section, key) + ": " + text});
}

bool Reader::failed() const {
  for (const auto& d : complaints_) {
    if (d.is_error) return true;
  }
  return false;
}

std::vector<Diagnostic> Reader::unknown_keys(const std::vector<std::string>& sections) const {
  std::vector<Diagnostic> out;
  for (const auto& section : sections) {
    std::vector<std::string> known;
    for (const auto& [asked_section, key] : asked_) {
      if (asked_section == section) known.push_back(key);
    }
    std::set<std::string_view> told;
    for (const Entry* entry : file_.variables(section)) {
      if (asked_.count({section, entry->key}) != 0 || !told.insert(entry->key).second) continue;
      std::string text = "unknown key " + full_name(section, entry->key);
      const std::string near = nearest_name(entry->key, known);
      if (!near.empty()) text += "; did you mean '" + near + "'?";
      out.push_back({entry->at, false, std::move(text)});
    }
  }
  return out;
}

}  // namespace kerf::ini
