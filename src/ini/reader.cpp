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

namespace {

RealSpec real_spec(const Key& key, double fallback, std::size_t num = 1) {
  RealSpec spec;
  spec.fallback = fallback;
  if (key.min != -Key::kNone) spec.min = key.min;
  if (key.max != Key::kNone) spec.max = key.max;
  spec.min_excluded = key.min_excluded;
  spec.required = key.is_required;
  spec.unit = key.units;
  spec.num = num;
  return spec;
}

IntSpec int_spec(const Key& key, std::int64_t fallback, std::size_t num = 1) {
  IntSpec spec;
  spec.fallback = fallback;
  if (key.min != -Key::kNone) spec.min = static_cast<std::int64_t>(key.min);
  if (key.max != Key::kNone) spec.max = static_cast<std::int64_t>(key.max);
  spec.min_excluded = key.min_excluded;
  spec.required = key.is_required;
  spec.unit = key.units;
  spec.num = num;
  return spec;
}

Value<std::size_t> get_choice(const IniFile& file, std::string_view section, std::string_view name,
                              const Key& key, std::size_t num = 1) {
  const std::vector<std::string> names = split_choices(key.choices);
  Value<std::size_t> out;
  std::string expected = "one of";
  for (std::size_t i = 0; i < names.size(); ++i) {
    expected += ' ' + names[i];
    if (names[i] == key.fallback) out.value = i;
  }
  const Entry* entry = file.find(section, name, num);
  if (entry == nullptr) {
    if (key.is_required) out.diagnostics.push_back(missing(file, section, name, expected));
    return out;
  }
  out.found = true;
  out.at = entry->at;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!equal_ignoring_case(names[i], entry->value)) continue;
    out.value = i;
    return out;
  }
  const std::string near = nearest_name(entry->value, names);
  if (!near.empty()) expected += "; did you mean '" + near + "'?";
  out.diagnostics.push_back(bad_value(*entry, expected));
  return out;
}

std::string expected_reals(const Key& key) {
  const std::vector<std::string> counts = split_choices(key.choices);
  std::string out;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    out += (i == 0 ? "" : i + 1 == counts.size() ? " or " : ", ") + counts[i];
  }
  return (out.empty() ? out : out + ' ') + "numbers" +
         (key.units.empty() ? "" : " [" + std::string(key.units) + ']');
}

Value<std::vector<double>> get_reals(const IniFile& file, std::string_view section,
                                     std::string_view name, const Key& key, std::size_t num = 1) {
  Value<std::vector<double>> out;
  const Entry* entry = file.find(section, name, num);
  if (entry == nullptr) {
    if (key.is_required)
      out.diagnostics.push_back(missing(file, section, name, expected_reals(key)));
    return out;
  }
  out.found = true;
  out.at = entry->at;
  bool good = true;
  for (std::string_view rest = entry->value; good;) {
    const auto first = rest.find_first_not_of(" \t");
    if (first == std::string_view::npos) break;
    const Number<double> number = to_real(rest.substr(first));
    good = number.valid && !number.has_trailing();
    out.value.push_back(number.value);
    rest = number.rest;
  }
  bool fits = key.choices.empty() || out.value.empty();
  for (const std::string& count : split_choices(key.choices))
    fits = fits || count == std::to_string(out.value.size());
  if (good && fits) return out;
  out.value.clear();
  out.diagnostics.push_back(bad_value(*entry, expected_reals(key)));
  return out;
}

Value<double> get_unit(const IniFile& file, std::string_view section, std::string_view name,
                       bool is_linear, double fallback, std::size_t num = 1) {
  Value<double> out;
  out.value = fallback;
  const Entry* entry = file.find(section, name, num);
  if (entry == nullptr) return out;
  out.found = true;
  out.at = entry->at;
  if (const auto unit = is_linear ? mm_per_unit(entry->value) : deg_per_unit(entry->value)) {
    out.value = *unit;
  } else {
    out.diagnostics.push_back(bad_value(*entry, is_linear
                                                    ? "one of mm cm inch in metric imperial"
                                                    : "one of deg degree rad radian grad gon"));
  }
  return out;
}

}  // namespace

const Key& Reader::row(std::string_view section, std::string_view key) {
  if (const KeyPlace place = table_.find(section, key); place.key != nullptr) return *place.key;
  complain(section, key, "is not in the table of INI keys (src/ini/keys)");
  static constexpr Key kNoRow{};
  return kNoRow;
}

template <class T>
T Reader::take(Value<T> value) {
  for (auto& d : value.diagnostics) complaints_.push_back(std::move(d));
  return std::move(value.value);
}

double Reader::real(std::string_view section, std::string_view key) {
  const Key& k = row(section, key);
  return take(get_real(file_, section, key, real_spec(k, to_real(k.fallback).value)));
}

double Reader::real(std::string_view section, std::string_view key, double fallback) {
  return take(get_real(file_, section, key, real_spec(row(section, key), fallback)));
}

std::int64_t Reader::integer(std::string_view section, std::string_view key) {
  const Key& k = row(section, key);
  return take(get_int(file_, section, key, int_spec(k, to_int(k.fallback).value)));
}

std::int64_t Reader::integer(std::string_view section, std::string_view key,
                             std::int64_t fallback) {
  return take(get_int(file_, section, key, int_spec(row(section, key), fallback)));
}

bool Reader::boolean(std::string_view section, std::string_view key) {
  return boolean(section, key, to_bool(row(section, key).fallback).value_or(false));
}

bool Reader::boolean(std::string_view section, std::string_view key, bool fallback) {
  const Key& k = row(section, key);
  return take(get_bool(file_, section, key, {.fallback = fallback, .required = k.is_required}));
}

std::string Reader::string(std::string_view section, std::string_view key) {
  const Key& k = row(section, key);
  return take(get_string(file_, section, key, {.fallback = k.fallback, .required = k.is_required}));
}

std::vector<std::string> Reader::strings(std::string_view section, std::string_view key) {
  (void)row(section, key);
  std::vector<std::string> out;
  for (const Entry* entry : file_.find_all(section, key)) out.push_back(entry->value);
  return out;
}

std::size_t Reader::choice(std::string_view section, std::string_view key) {
  return take(get_choice(file_, section, key, row(section, key)));
}

std::vector<double> Reader::reals(std::string_view section, std::string_view key) {
  return take(get_reals(file_, section, key, row(section, key)));
}

double Reader::linear_unit(std::string_view section, std::string_view key, double fallback_mm) {
  (void)row(section, key);
  return take(get_unit(file_, section, key, true, fallback_mm));
}

double Reader::angular_unit(std::string_view section, std::string_view key, double fallback_deg) {
  (void)row(section, key);
  return take(get_unit(file_, section, key, false, fallback_deg));
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

std::vector<Diagnostic> check_value(const IniFile& file, const Key& key, std::string_view section,
                                    std::string_view name, std::size_t num) {
  switch (key.kind) {
    case Kind::text: break;
    case Kind::real: return get_real(file, section, name, real_spec(key, 0, num)).diagnostics;
    case Kind::integer: return get_int(file, section, name, int_spec(key, 0, num)).diagnostics;
    case Kind::boolean: return get_bool(file, section, name, {.num = num}).diagnostics;
    case Kind::choice: return get_choice(file, section, name, key, num).diagnostics;
    case Kind::reals: return get_reals(file, section, name, key, num).diagnostics;
    case Kind::linear_unit: return get_unit(file, section, name, true, 1, num).diagnostics;
    case Kind::angular_unit: return get_unit(file, section, name, false, 1, num).diagnostics;
  }
  return {};
}

}  // namespace kerf::ini
