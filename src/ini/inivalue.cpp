#include "ini/inivalue.hpp"

#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <string_view>

#include "ini/convert.hpp"
#include "ini/ini_file.hpp"

namespace kerf::ini {

namespace {

struct OptionName {
  char letter;
  std::string_view name;
  bool has_value;
};
constexpr std::array<OptionName, 16> kOptions{{{'V', "var", true},
                                               {'S', "sec", true},
                                               {'N', "num", true},
                                               {'a', "all", false},
                                               {'y', "type", true},
                                               {'m', "minimum", true},
                                               {'M', "maximum", true},
                                               {'b', "boolnum", false},
                                               {'B', "boolpy", false},
                                               {'T', "tildeexpand", false},
                                               {'q', "quiet", false},
                                               {'e', "sections", false},
                                               {'o', "variables", false},
                                               {'c', "content", false},
                                               {'p', "prefix", false},
                                               {'h', "help", false}}};

constexpr const char* kUsage =
    "Usage: inivalue [options] FILE\n"
    "Prints a value of an INI file.\n"
    "  -V, --var=KEY        the key to print (default: the first of the section)\n"
    "  -S, --sec=SECTION    only look there (default: the first section that has the key)\n"
    "  -N, --num=N          print the N-th instance, from 1\n"
    "  -a, --all            print all instances, with --num those from the N-th on\n"
    "  -y, --type=T         convert: i integer, u unsigned, r real, s string, b boolean\n"
    "  -m, --minimum=X      least value (give --type first)\n"
    "  -M, --maximum=X      greatest value (give --type first)\n"
    "  -b, --boolnum        print booleans as 1 and 0\n"
    "  -B, --boolpy         print booleans as True and False\n"
    "  -T, --tildeexpand    replace a leading ~/ by the home directory\n"
    "  -q, --quiet          no messages\n"
    "  -e, --sections       print the section names\n"
    "  -o, --variables      print the keys (of --sec, if given)\n"
    "  -c, --content        with --variables: print values too\n"
    "  -p, --prefix         with --variables: print the section before each key\n"
    "  -h, --help           print this\n"
    "Exit: 0 found, 1 bad call or bad file, 2 not found, 3 not convertible or out of range.\n";

struct Call {
  std::string var, sec, minimum, maximum, file;
  std::optional<std::size_t> num;
  char type{0};
  bool all{false}, bool_num{false}, bool_py{false}, tilde{false}, quiet{false};
  bool sections{false}, variables{false}, content{false}, prefix{false}, help{false};
};

/// Command line to Call. Long names may be shortened, `-oc` groups letters, options may follow FILE.
class CallParser {
 public:
  /// The error text, or "".
  std::string parse(const std::vector<std::string>& args, Call& call) {
    bool only_files = false;
    for (std::size_t i = 0; i < args.size() && error_.empty(); ++i) {
      const std::string& arg = args[i];
      if (only_files || arg.size() < 2 || arg[0] != '-') {
        if (!call.file.empty()) return "error: More than one ini-file: '" + arg + "'";
        call.file = arg;
      } else if (arg == "--") {
        only_files = true;
      } else if (arg[1] == '-') {
        long_option(args, i, call);
      } else {
        letters(args, i, call);
      }
    }
    if (error_.empty() && call.file.empty() && !call.help) return "error: Missing ini-file";
    return error_;
  }

 private:
  static const OptionName* by_letter(char letter) {
    for (const auto& o : kOptions) {
      if (o.letter == letter) return &o;
    }
    return nullptr;
  }

  static const OptionName* by_name(std::string_view name) {
    const OptionName* found = nullptr;
    int hits = 0;
    for (const auto& o : kOptions) {
      if (o.name == name) return &o;
      if (o.name.substr(0, name.size()) != name) continue;
      found = &o;
      ++hits;
    }
    return hits == 1 ? found : nullptr;
  }

  void long_option(const std::vector<std::string>& args, std::size_t& i, Call& call) {
    const std::string_view text = std::string_view(args[i]).substr(2);
    const auto equals = text.find('=');
    const OptionName* option = by_name(text.substr(0, equals));
    if (option == nullptr) {
      error_ = "error: Unknown option '" + args[i] + "'";
    } else if (!option->has_value && equals != std::string_view::npos) {
      error_ = "error: Option '--" + std::string(option->name) + "' takes no argument";
    } else if (option->has_value && equals != std::string_view::npos) {
      set(option->letter, std::string(text.substr(equals + 1)), call);
    } else if (option->has_value && ++i >= args.size()) {
      error_ = "error: Missing argument to '--" + std::string(option->name) + "'";
    } else {
      set(option->letter, option->has_value ? args[i] : std::string(), call);
    }
  }

  void letters(const std::vector<std::string>& args, std::size_t& i, Call& call) {
    const std::string& word = args[i];
    for (std::size_t k = 1; k < word.size() && error_.empty(); ++k) {
      const OptionName* option = by_letter(word[k]);
      if (option == nullptr) {
        error_ = std::string("error: Unknown option '-") + word[k] + "'";
      } else if (!option->has_value) {
        set(option->letter, {}, call);
      } else if (k + 1 < word.size()) {
        set(option->letter, word.substr(k + 1), call);
        return;
      } else if (++i >= args.size()) {
        error_ = std::string("error: Missing argument to '-") + word[k] + "'";
      } else {
        set(option->letter, args[i], call);
      }
    }
  }

  void set(char letter, const std::string& value, Call& call) {
    switch (letter) {
      case 'V': call.var = value; break;
      case 'S': call.sec = value; break;
      case 'N': set_num(value, call); break;
      case 'a': call.all = true; break;
      case 'y': set_type(value, call); break;
      case 'm': set_limit(value, "minimum", call, call.minimum); break;
      case 'M': set_limit(value, "maximum", call, call.maximum); break;
      case 'b': call.bool_num = true; break;
      case 'B': call.bool_py = true; break;
      case 'T': call.tilde = true; break;
      case 'q': call.quiet = true; break;
      case 'e': call.sections = true; break;
      case 'o': call.variables = true; break;
      case 'c': call.content = true; break;
      case 'p': call.prefix = true; break;
      default: call.help = true; break;
    }
  }

  void set_num(const std::string& value, Call& call) {
    const auto n = to_int(value);
    if (!n.valid || !n.rest.empty() || n.value < 1) {
      error_ = "error: Invalid number '" + value + "' in --num argument";
    } else {
      call.num = static_cast<std::size_t>(n.value);
    }
  }

  void set_type(const std::string& value, Call& call) {
    constexpr std::string_view kTypes = "iubsr";
    if (value.size() != 1 || kTypes.find(value[0]) == std::string_view::npos) {
      error_ = "error: Invalid type identifier '" + value + "' accepted={i,u,b,s,r}";
    } else {
      call.type = value[0];
    }
  }

  void set_limit(const std::string& value, const char* name, const Call& call, std::string& limit) {
    if (call.type == 0) {
      error_ = std::string("error: Must first specify --type before ") + name;
      return;
    }
    const bool good = call.type == 'i'   ? to_int(value).valid
                      : call.type == 'u' ? to_uint(value).valid
                                         : to_real(value).valid;
    if (!good) error_ = "error: Invalid number '" + value + "' in --" + name + " argument";
    limit = value;
  }

  std::string error_;
};

std::string text_of(std::int64_t value) { return std::to_string(value); }
std::string text_of(std::uint64_t value) { return std::to_string(value); }
std::string text_of(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.15e", value);
  return text;
}
/// A limit in a message, as short as it goes.
template <class T>
std::string limit_text(T value) {
  return std::to_string(value);
}
std::string limit_text(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// How a numeric type is called in the reader's messages and in inivalue's own.
struct TypeWords {
  const char* reader;
  const char* range;
};

class Inivalue {
 public:
  CommandOutput run(const std::vector<std::string>& args) {
    if (const std::string error = CallParser().parse(args, call_); !error.empty()) {
      return fail(InivalueExit::bad_call, error);
    }
    if (call_.help) {
      result_.out = kUsage;
      return result_;
    }
    LoadResult loaded = IniFile::load(call_.file);
    for (const auto& d : loaded.diagnostics) say(d.message());
    if (!loaded.ok) return fail(InivalueExit::bad_call, {});
    file_ = std::move(loaded.file);
    if (call_.sections) {
      for (const auto& name : file_.sections()) result_.out += name + '\n';
    } else if (call_.variables) {
      list_variables();
    } else {
      print_values();
    }
    return std::move(result_);
  }

 private:
  void say(const std::string& line) {
    if (!call_.quiet && !line.empty()) result_.err += line + '\n';
  }

  CommandOutput fail(InivalueExit code, const std::string& line) {
    say(line);
    result_.exit_code = static_cast<int>(code);
    return result_;
  }

  [[nodiscard]] std::string asked_name() const { return '[' + call_.sec + ']' + call_.var; }

  void list_variables() {
    for (const Entry* entry : file_.variables(call_.sec)) {
      if (call_.prefix) result_.out += '[' + entry->section + ']';
      result_.out += entry->key;
      if (call_.content) result_.out += '=' + entry->value;
      result_.out += '\n';
    }
  }

  void print_values() {
    const std::size_t first = call_.num.value_or(1);
    if (!call_.all) {
      const Entry* entry = file_.find(call_.sec, call_.var, first);
      if (entry == nullptr) {
        fail(InivalueExit::not_found,
             "error: Cannot find instance " + std::to_string(first) + " of '" + asked_name() + "'");
      } else {
        print(*entry);
      }
      return;
    }
    const auto entries = file_.find_all(call_.sec, call_.var);
    if (call_.num && first > entries.size()) {
      fail(InivalueExit::not_found,
           "error: No instance " + std::to_string(first) + " or more of '" + asked_name() + "'");
      return;
    }
    for (std::size_t i = first - 1; i < entries.size(); ++i) {
      if (!print(*entries[i])) return;
    }
  }

  bool print(const Entry& entry) {
    switch (call_.type) {
      case 'i': return print_number(entry, &to_int, {"signed integer", "integer"});
      case 'u': return print_number(entry, &to_uint, {"unsigned integer", "unsigned"});
      case 'r': return print_number(entry, &to_real, {"floating point", "real"});
      case 'b': return print_bool(entry);
      default:
        result_.out += (call_.tilde ? expand_tilde(entry.value) : entry.value) + '\n';
        return true;
    }
  }

  static std::string reader_name(const Entry& entry) {
    return '[' + entry.section + ']' + entry.key + "='" + entry.value + "'";
  }

  bool print_bool(const Entry& entry) {
    const auto value = to_bool(entry.value);
    if (!value) {
      fail(InivalueExit::bad_value,
           Diagnostic{entry.at, true, "Invalid boolean value " + reader_name(entry)}.message());
      return false;
    }
    result_.out += call_.bool_num  ? (*value ? "1" : "0")
                   : call_.bool_py ? (*value ? "True" : "False")
                                   : (*value ? "true" : "false");
    result_.out += '\n';
    return true;
  }

  template <class T>
  bool print_number(const Entry& entry, Number<T> (*convert)(std::string_view), TypeWords words) {
    const T min =
        call_.minimum.empty() ? std::numeric_limits<T>::lowest() : convert(call_.minimum).value;
    const T max =
        call_.maximum.empty() ? std::numeric_limits<T>::max() : convert(call_.maximum).value;
    if (min > max) {
      fail(InivalueExit::bad_value, std::string("error: Invalid ") + words.range + " range min '" +
                                        limit_text(min) + "' > max '" + limit_text(max) + "'");
      return false;
    }
    const Number<T> number = convert(entry.value);
    if (!number.valid) {
      say(Diagnostic{entry.at, true,
                     std::string("Invalid ") + words.reader + ' ' + reader_name(entry)}
              .message());
    } else {
      warn(entry, number, words);
    }
    if (!number.valid || number.value < min || number.value > max) {
      fail(InivalueExit::bad_value, std::string("error: Invalid ") + words.range + ' ' +
                                        asked_name() + "='" + entry.value + "' or out of range [" +
                                        limit_text(min) + ',' + limit_text(max) + ']');
      return false;
    }
    result_.out += text_of(number.value) + '\n';
    return true;
  }

  template <class T>
  void warn(const Entry& entry, const Number<T>& number, TypeWords words) {
    if (std::numeric_limits<T>::is_integer && !std::numeric_limits<T>::is_signed &&
        number.negated) {
      say(Diagnostic{entry.at, false,
                     "Unsigned integer conversion detected a leading minus sign (-)"}
              .message());
    }
    if (number.has_trailing()) {
      say(Diagnostic{entry.at, false,
                     std::string("Trailing character(s) in ") + words.reader + " conversion (" +
                         reader_name(entry) + ')'}
              .message());
    }
  }

  Call call_;
  IniFile file_;
  CommandOutput result_;
};

}  // namespace

CommandOutput run_inivalue(const std::vector<std::string>& args) { return Inivalue().run(args); }

CommandOutput run_inivar(const std::vector<std::string>& args) {
  struct Wanted {
    std::string_view name;
    std::optional<std::string> value;
  };
  std::array<Wanted, 4> wanted{{{"-var", {}}, {"-sec", {}}, {"-num", {}}, {"-ini", {}}}};
  bool tilde = false;
  const auto refuse = [](const std::string& text) {
    return CommandOutput{static_cast<int>(InivalueExit::bad_call), {}, "inivar: " + text + '\n'};
  };
  for (std::size_t i = 0; i < args.size(); ++i) {
    const std::string& arg = args[i];
    if (arg == "--help" || arg == "-h") {
      return {0,
              "Usage: inivar -var VARIABLE [-sec SECTION] [-num N] [-ini FILE] [-tildeexpand]\n"
              "Prints the value of a variable of an INI file (default emc.ini); inivalue can do "
              "more.\n",
              {}};
    }
    if (arg == "-tildeexpand") {
      tilde = true;
      continue;
    }
    Wanted* option = nullptr;
    for (auto& w : wanted) {
      if (w.name == arg) option = &w;
    }
    if (option == nullptr) return refuse("Invalid option '" + arg + "'");
    if (option->value) return refuse("Duplicate " + arg + " option");
    if (++i >= args.size()) return refuse("Missing argument to " + arg);
    option->value = args[i];
  }
  const auto& [var, sec, num, ini] = wanted;
  if (!var.value || var.value->empty()) return refuse("No variable supplied (missing -var)");
  std::vector<std::string> call{"--var=" + *var.value};
  if (sec.value) call.push_back("--sec=" + *sec.value);
  if (num.value) call.push_back("--num=" + *num.value);
  if (tilde) call.emplace_back("--tildeexpand");
  call.emplace_back("--");
  call.push_back(ini.value.value_or("emc.ini"));
  return run_inivalue(call);
}

}  // namespace kerf::ini
