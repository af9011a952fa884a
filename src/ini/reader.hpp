// Typed reading of an IniFile: each key with its type, range, unit and default, every complaint
// collected, so that a user sees all bad keys of a machine at once.
//
//   Reader r(file);
//   const double v = r.real("JOINT_0", "MAX_VELOCITY");  // type, range and default: src/ini/keys/
//   const bool random = r.boolean("EMCIO", "RANDOM_TOOLCHANGER");
//   for (const auto& c : r.complaints()) std::fputs((c.message() + "\n").c_str(), stderr);
//   if (r.failed()) return 1;
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "ini/ini_file.hpp"
#include "ini/keys.hpp"

namespace kerf::ini {

/// What a numeric key may hold. Omitted fields: no limit, not required, no unit, default 0.
template <class T>
struct NumberSpec {
  T fallback{};  ///< the value when the key is absent or bad
  T min{std::numeric_limits<T>::lowest()};
  T max{std::numeric_limits<T>::max()};
  bool min_excluded{false};  ///< the value must be greater than `min`
  bool required{false};      ///< absence is an error
  std::string_view unit{};   ///< for messages only: "mm/s"
  std::size_t num{1};        ///< which instance of a repeated key
};
using RealSpec = NumberSpec<double>;
using IntSpec = NumberSpec<std::int64_t>;
using UintSpec = NumberSpec<std::uint64_t>;

/// What a text or boolean key may hold.
struct StringSpec {
  std::string_view fallback{};
  bool required{false};
  std::size_t num{1};
};
struct BoolSpec {
  bool fallback{false};
  bool required{false};
  std::size_t num{1};
};

/// One key's value, or why there is none. `value` is the fallback unless the key is there and good.
template <class T>
struct Value {
  T value{};
  bool found{false};                    ///< the key is in the file (good or bad)
  Position at;                          ///< where, if found
  std::vector<Diagnostic> diagnostics;  ///< one error at most, and warnings

  [[nodiscard]] bool ok() const {
    for (const auto& d : diagnostics) {
      if (d.is_error) return false;
    }
    return true;
  }
  /// The error as "FILE:LINE: error: ...", or "".
  [[nodiscard]] std::string error() const {
    for (const auto& d : diagnostics) {
      if (d.is_error) return d.message();
    }
    return {};
  }
};

/// Single keys. Errors name file and line, the value, the expected type, range and unit; for an
/// absent required key also the nearest existing key of the section, or another section that has
/// the key. Trailing text is a warning ("1.5" read as an integer, "1 000"), a comment is not.
[[nodiscard]] Value<double> get_real(const IniFile& file, std::string_view section,
                                     std::string_view key, const RealSpec& spec = {});
[[nodiscard]] Value<std::int64_t> get_int(const IniFile& file, std::string_view section,
                                          std::string_view key, const IntSpec& spec = {});
/// Unlike inivalue, a negative number is an error here: nobody means 18446744073709551613.
[[nodiscard]] Value<std::uint64_t> get_uint(const IniFile& file, std::string_view section,
                                            std::string_view key, const UintSpec& spec = {});
[[nodiscard]] Value<bool> get_bool(const IniFile& file, std::string_view section,
                                   std::string_view key, const BoolSpec& spec = {});
[[nodiscard]] Value<std::string> get_string(const IniFile& file, std::string_view section,
                                            std::string_view key, const StringSpec& spec = {});

/// Reads keys as the table declares them, and collects what is wrong. File and table must outlive it.
class Reader {
 public:
  explicit Reader(const IniFile& file, const KeyTable& table = machine_keys())
      : file_(file), table_(table) {}

  /// Type, range, unit, default and whether the key is required come from the table. Pass `fallback` only for a default
  /// that depends on other keys.
  double real(std::string_view section, std::string_view key);
  double real(std::string_view section, std::string_view key, double fallback);
  std::int64_t integer(std::string_view section, std::string_view key);
  std::int64_t integer(std::string_view section, std::string_view key, std::int64_t fallback);
  bool boolean(std::string_view section, std::string_view key);
  bool boolean(std::string_view section, std::string_view key, bool fallback);
  std::string string(std::string_view section, std::string_view key);
  /// Every instance of a repeated key (HALFILE, HALCMD), in file order.
  std::vector<std::string> strings(std::string_view section, std::string_view key);
  /// The index in the key's choices (any case) of the value; else a complaint that lists them.
  std::size_t choice(std::string_view section, std::string_view key);
  /// The numbers of the value; none after a complaint, or without the key.
  std::vector<double> reals(std::string_view section, std::string_view key);
  /// Millimetres per linear unit, degrees per angular unit.
  double linear_unit(std::string_view section, std::string_view key, double fallback_mm = 1.0);
  double angular_unit(std::string_view section, std::string_view key, double fallback_deg = 1.0);

  [[nodiscard]] bool has(std::string_view section, std::string_view key) const {
    return file_.find(section, key) != nullptr;
  }

  [[nodiscard]] const IniFile& file() const { return file_; }

  /// Adds a complaint of the caller's own about a key (its value contradicts another one ...).
  void complain(std::string_view section, std::string_view key, const std::string& text,
                bool is_error = true);

  [[nodiscard]] const std::vector<Diagnostic>& complaints() const { return complaints_; }
  /// There is an error among the complaints.
  [[nodiscard]] bool failed() const;

 private:
  /// The row of the table; a key that is not in it is a complaint of its own.
  const Key& row(std::string_view section, std::string_view key);
  template <class T>
  T take(Value<T> value);

  const IniFile& file_;
  const KeyTable& table_;
  std::vector<Diagnostic> complaints_;
};

/// What is wrong with one value of a key, by its row in the table: one error at most, and warnings.
[[nodiscard]] std::vector<Diagnostic> check_value(const IniFile& file, const Key& key,
                                                  std::string_view section, std::string_view name,
                                                  std::size_t num);

}  // namespace kerf::ini
