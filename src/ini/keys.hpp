// The table of INI keys: every key that LinuxCNC's manual names, and Kerf's own, each declared once.
//
// Its readers: ini::Reader (types, ranges, defaults), check_keys (kerf check, and the launcher at each start), `kerf keys`,
// docs/configuration.md. A new key is a row in src/ini/keys/; run scripts/ini_keys afterwards.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::ini {

/// What a value looks like.
enum class Kind : std::uint8_t {
  text,         ///< anything
  real,         ///< a number
  integer,      ///< a whole number, also 0x1F
  boolean,      ///< TRUE YES ON 1 / FALSE NO OFF 0
  choice,       ///< one of Key::choices, in any case
  reals,        ///< numbers separated by blanks; Key::choices holds the counts that are allowed
  linear_unit,  ///< mm, inch ...
  angular_unit  ///< degree, rad ...
};

/// Who acts on a key. Keys of screens and HAL files are not read by Kerf: these read the INI themselves.
enum class By : std::uint8_t {
  section,      ///< as for the whole section
  kerf,         ///< the launcher
  task,         ///< milltask, iocontrol included
  interpreter,  ///< the G-code interpreter: milltask and rs274
  motion,       ///< motion control
  halui,
  screen,  ///< the program of [DISPLAY]DISPLAY
  hal,     ///< HAL files, as [SECTION]KEY
  nobody
};

/// How a key compares with the same key of LinuxCNC.
enum class Verdict : std::uint8_t { works, differs, no, own };

/// One key. Made by real(), text() ... and refined: real("HOME", "...").unit("units").either("0").
struct Key {
  static constexpr double kNone = std::numeric_limits<double>::max();

  std::string_view name;  ///< a lower-case n stands for a number: MIN_SPINDLE_n_SPEED
  Kind kind{Kind::text};
  std::string_view meaning;
  std::string_view fallback{};        ///< the default, as it would be written; "" none
  std::string_view fallback_words{};  ///< a default that depends on other things, in words
  std::string_view units{};
  std::string_view choices{};  ///< separated by blanks
  std::string_view note{};     ///< how it differs, why it is not supported
  double min{-kNone}, max{kNone};
  bool min_excluded{false};
  bool is_required{false};
  bool is_repeated{false};  ///< each line counts; else only the first
  By by{By::section};
  Verdict verdict{Verdict::works};

  [[nodiscard]] constexpr Key otherwise(std::string_view value) const {
    Key k = *this;
    k.fallback = value;
    return k;
  }
  [[nodiscard]] constexpr Key otherwise_as(std::string_view words) const {
    Key k = *this;
    k.fallback_words = words;
    return k;
  }
  [[nodiscard]] constexpr Key unit(std::string_view name_of_unit) const {
    Key k = *this;
    k.units = name_of_unit;
    return k;
  }
  [[nodiscard]] constexpr Key from(double least) const {
    Key k = *this;
    k.min = least;
    return k;
  }
  [[nodiscard]] constexpr Key above(double least) const {
    Key k = from(least);
    k.min_excluded = true;
    return k;
  }
  [[nodiscard]] constexpr Key to(double most) const {
    Key k = *this;
    k.max = most;
    return k;
  }
  [[nodiscard]] constexpr Key required() const {
    Key k = *this;
    k.is_required = true;
    return k;
  }
  [[nodiscard]] constexpr Key repeated() const {
    Key k = *this;
    k.is_repeated = true;
    return k;
  }
  [[nodiscard]] constexpr Key read_by(By who) const {
    Key k = *this;
    k.by = who;
    return k;
  }
  [[nodiscard]] constexpr Key differs(std::string_view how) const {
    Key k = *this;
    k.verdict = Verdict::differs;
    k.note = how;
    return k;
  }
  /// Accepted, and nobody reads it: `why` begins with "without effect".
  [[nodiscard]] constexpr Key idle(std::string_view why) const {
    Key k = differs(why);
    k.by = By::nobody;
    return k;
  }
  /// Not supported.
  [[nodiscard]] constexpr Key no(std::string_view why) const {
    Key k = *this;
    k.verdict = Verdict::no;
    k.note = why;
    k.by = By::nobody;
    return k;
  }
  /// Not a key of LinuxCNC.
  [[nodiscard]] constexpr Key own() const {
    Key k = *this;
    k.verdict = Verdict::own;
    return k;
  }
};

constexpr Key make_key(std::string_view name, Kind kind, std::string_view meaning) {
  Key k;
  k.name = name;
  k.kind = kind;
  k.meaning = meaning;
  return k;
}
constexpr Key text(std::string_view name, std::string_view meaning) {
  return make_key(name, Kind::text, meaning);
}
constexpr Key real(std::string_view name, std::string_view meaning) {
  return make_key(name, Kind::real, meaning);
}
constexpr Key integer(std::string_view name, std::string_view meaning) {
  return make_key(name, Kind::integer, meaning);
}
constexpr Key boolean(std::string_view name, std::string_view meaning) {
  return make_key(name, Kind::boolean, meaning);
}
constexpr Key choice(std::string_view name, std::string_view choices, std::string_view meaning) {
  Key k = make_key(name, Kind::choice, meaning);
  k.choices = choices;
  return k;
}
constexpr Key reals(std::string_view name, std::string_view counts, std::string_view meaning) {
  Key k = make_key(name, Kind::reals, meaning);
  k.choices = counts;
  return k;
}

struct KeySection {
  std::string_view name;  ///< AXIS_L: a letter of XYZABCUVW; JOINT_n: a number
  std::string_view meaning;
  std::span<const Key> keys;
  By by;             ///< who acts on its keys, unless the key says otherwise
  bool open{false};  ///< other keys are the user's own business
};

/// Where a key stands in the table; both null when it does not.
struct KeyPlace {
  const KeySection* section{nullptr};
  const Key* key{nullptr};

  [[nodiscard]] By by() const { return key->by == By::section ? section->by : key->by; }
};

class KeyTable {
 public:
  constexpr explicit KeyTable(std::span<const KeySection> sections) : sections_(sections) {}

  [[nodiscard]] std::span<const KeySection> sections() const { return sections_; }
  /// The section that JOINT_3, AXIS_X or TRAJ belongs to, or null.
  [[nodiscard]] const KeySection* section(std::string_view name) const;
  [[nodiscard]] KeyPlace find(std::string_view section, std::string_view key) const;

 private:
  std::span<const KeySection> sections_;
};

/// The keys of a machine file.
[[nodiscard]] const KeyTable& machine_keys();

/// The names in a `choices` text.
[[nodiscard]] std::vector<std::string> split_choices(std::string_view choices);

/// "task", "the screen" ...
[[nodiscard]] std::string_view by_name(By by);
[[nodiscard]] std::string_view verdict_name(Verdict verdict);
/// "number above 0", "one of LINEAR, ANGULAR".
[[nodiscard]] std::string kind_text(const Key& key);

/// The table for people, or, with tabs between the columns, for programs. `words`: only rows that contain all of them.
[[nodiscard]] std::string keys_as_text(const KeyTable& table,
                                       const std::vector<std::string>& words);
[[nodiscard]] std::string keys_as_tsv(const KeyTable& table);

}  // namespace kerf::ini
