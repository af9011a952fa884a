// A declaration as manual page, Markdown, plain text and JSON.
#include <cmath>
#include <nlohmann/json.hpp>

#include "hal/cmd/describe.hpp"
#include "hal/core/value_text.hpp"

namespace kerf::hal {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFunctionItems =
    "Each function FUNCT also has the pin FUNCT.time (s32 out), the time of its last run in ns, "
    "and "
    "the parameters FUNCT.tmax (s32 rw), the longest one, and FUNCT.tmax-increased (bit ro).";

std::string dir_word(Dir dir) {
  switch (dir) {
    case Dir::in: return "in";
    case Dir::out: return "out";
    case Dir::io: return "io";
    case Dir::ro: return "r";
    default: return "rw";
  }
}

std::string head(const ItemGroup& g) {
  return g.name + " " + std::string(type_name(g.item->type)) + " " + dir_word(g.item->dir);
}

/// What stands behind the head: the default of what a user may set, and the range.
std::string remark(const ItemGroup& g) {
  std::string out;
  const bool settable = g.item->dir != Dir::out && g.item->dir != Dir::ro;
  if (settable && g.item->initial != 0)
    out = "default: " + plain_value_text(g.item->type, g.item->initial);
  if (!g.range.empty()) out += (out.empty() ? "" : "; ") + g.range;
  return out.empty() ? "" : "(" + out + ")";
}

/// The lines of loadrt, by what the loader and the component take.
std::vector<std::string> synopsis(const Declaration& d) {
  std::string own;
  for (const auto& a : d.arguments)
    own += " [" + a.name + "=" + (a.default_text.empty() ? "VALUE" : a.default_text) + "]";
  if (d.singleton) return {"loadrt " + d.name + own};
  return {"loadrt " + d.name + " [count=N | names=NAME1[,NAME2...]]" + own};
}

// ---- man ----------------------------------------------------------------------------------------

std::string roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'' || (c == '.' && out.empty()))
      out += c == '.' ? "\\&." : "\\(aq";
    else
      out += c;
  }
  return out;
}

/// Prose: a hyphen is one, and each sentence begins a line, as roff wants it.
std::string prose(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool line_start = out.empty() || out.back() == '\n';
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == ' ' && i > 0 && i + 1 < text.size() && text[i - 1] == '.' &&
             std::isupper(static_cast<unsigned char>(text[i + 1])) != 0)
      out += '\n';
    else
      out += c;
  }
  return out;
}

std::string entry(const std::string& bold, const std::string& after, const std::string& doc) {
  return ".TP\n\\fB" + roff(bold) + "\\fR" + (after.empty() ? "" : " " + roff(after)) + "\n" +
         prose(doc) + "\n";
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

std::string man_page(const Declaration& d) {
  std::string out =
      ".\\\" Made from the component's declaration by `hal describe`; not to be edited.\n";
  out += ".TH " + upper(d.name) + " 9 \"\" \"Kerf\" \"HAL components\"\n";
  out += ".SH NAME\n" + roff(d.name) + " \\- " + prose(d.summary) + "\n.SH SYNOPSIS\n";
  for (const auto& line : synopsis(d)) out += "\\fB" + roff(line) + "\\fR\n";
  if (!d.notes.empty()) out += ".SH DESCRIPTION\n" + prose(d.notes) + "\n";
  if (!d.arguments.empty()) {
    out += ".SH \"LOADRT PARAMETERS\"\n";
    for (const auto& a : d.arguments)
      out += entry(a.name + "=", a.default_text.empty() ? "" : "(default: " + a.default_text + ")",
                   a.doc);
  }
  if (!d.threads.empty()) {
    out += ".SH THREADS\n";
    for (const auto& t : d.threads)
      out += entry(t.name, "", "Period " + std::to_string(t.period_ns) + " ns");
  }
  if (!d.functions.empty()) {
    out += ".SH FUNCTIONS\n";
    for (const auto& f : d.functions) out += entry(f.name, "", f.doc);
    out += ".PP\n" + prose(kFunctionItems) + "\n";
  }
  for (const bool pins : {true, false}) {
    const auto groups = grouped(d, pins);
    if (groups.empty()) continue;
    out += pins ? ".SH PINS\n" : ".SH PARAMETERS\n";
    for (const auto& g : groups) out += entry(head(g), remark(g), g.item->doc);
  }
  if (!d.example.empty())
    out += ".SH EXAMPLE\nThe pins above are those of\n.PP\n.RS\nloadrt " +
           roff(d.name + " " + d.example) + "\n.RE\n";
  if (!d.incomplete.empty())
    out += ".SH BUGS\nThis page is not complete: " + prose(d.incomplete) + "\n";
  out += ".SH LICENSE\n" + prose(d.license) + "\n.SH SEE ALSO\n.BR halcmd (1)\n";
  return out;
}

// ---- Markdown -----------------------------------------------------------------------------------

namespace {

std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2)
    text.insert(i, "\\");
  return text;
}

std::string markdown_items(const Declaration& d, bool pins) {
  const auto groups = grouped(d, pins);
  if (groups.empty()) return {};
  std::string out = pins ? "\n## Pins\n\n" : "\n## Parameters\n\n";
  out += "| name | type | dir | default | |\n|---|---|---|---|---|\n";
  for (const auto& g : groups) {
    const bool settable = g.item->dir != Dir::out && g.item->dir != Dir::ro;
    out += "| `" + g.name + "`" + (g.range.empty() ? "" : " (" + g.range + ")") + " | " +
           std::string(type_name(g.item->type)) + " | " + dir_word(g.item->dir) + " | " +
           (settable ? plain_value_text(g.item->type, g.item->initial) : "") + " | " +
           cell(g.item->doc) + " |\n";
  }
  return out;
}

}  // namespace

std::string markdown_page(const Declaration& d) {
  std::string out = "# " + d.name + "\n\n" + d.summary + "\n\n";
  for (const auto& line : synopsis(d)) out += "    " + line + "\n";
  if (!d.notes.empty()) out += "\n" + d.notes + "\n";
  if (!d.arguments.empty()) {
    out += "\n## loadrt parameters\n\n| name | default | |\n|---|---|---|\n";
    for (const auto& a : d.arguments)
      out += "| `" + a.name + "=` | " + cell(a.default_text) + " | " + cell(a.doc) + " |\n";
  }
  if (!d.threads.empty()) {
    out += "\n## Threads\n\n";
    for (const auto& t : d.threads)
      out += "* `" + t.name + "`, " + std::to_string(t.period_ns) + " ns\n";
  }
  if (!d.functions.empty()) {
    out += "\n## Functions\n\n";
    for (const auto& f : d.functions)
      out += "* `" + f.name + (f.doc.empty() ? "`" : "`: ") + f.doc + "\n";
  }
  out += markdown_items(d, true) + markdown_items(d, false);
  if (!d.example.empty())
    out += "\nThe pins are those of `loadrt " + d.name + " " + d.example + "`.\n";
  if (!d.incomplete.empty()) out += "\nThis page is not complete: " + d.incomplete + "\n";
  return out;
}

// ---- plain text ---------------------------------------------------------------------------------

namespace {

/// Lines of at most 79 characters.
std::string wrapped(const std::string& text, std::size_t indent) {
  const std::string margin(indent, ' ');
  std::string out, line = margin;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    if (line.size() > indent && line.size() + 1 + word.size() > 79) {
      out += line + "\n";
      line = margin;
    }
    line += (line.size() > indent ? " " : "") + word;
  }
  return out + line + "\n";
}

std::string text_entry(const std::string& first, const std::string& after, const std::string& doc) {
  return "  " + first + (after.empty() ? "" : "  " + after) + "\n" +
         (doc.empty() ? "" : wrapped(doc, 6));
}

}  // namespace

std::string text_page(const Declaration& d) {
  std::string out = d.name + " - " + d.summary + "\n\n";
  for (const auto& line : synopsis(d)) out += "  " + line + "\n";
  if (!d.notes.empty()) out += "\n" + wrapped(d.notes, 2);
  if (!d.arguments.empty()) {
    out += "\nLoadrt parameters\n";
    for (const auto& a : d.arguments)
      out += text_entry(a.name + "=",
                        a.default_text.empty() ? "" : "(default: " + a.default_text + ")", a.doc);
  }
  if (!d.threads.empty()) {
    out += "\nThreads\n";
    for (const auto& t : d.threads)
      out += text_entry(t.name, "", "Period " + std::to_string(t.period_ns) + " ns");
  }
  if (!d.functions.empty()) {
    out += "\nFunctions\n";
    for (const auto& f : d.functions) out += text_entry(f.name, "", f.doc);
  }
  for (const bool pins : {true, false}) {
    const auto groups = grouped(d, pins);
    if (groups.empty()) continue;
    out += pins ? "\nPins\n" : "\nParameters\n";
    for (const auto& g : groups) out += text_entry(head(g), remark(g), g.item->doc);
  }
  if (!d.example.empty())
    out += "\nThe pins above are those of: loadrt " + d.name + " " + d.example + "\n";
  if (!d.incomplete.empty()) out += "\nNot complete: " + d.incomplete + "\n";
  return out;
}

// ---- JSON ---------------------------------------------------------------------------------------

namespace {

Json initial_json(const Declaration::Item& item) {
  switch (item.type) {
    case Type::bit: return from_raw<bool>(item.initial);
    case Type::floating: {
      const auto value = from_raw<double>(item.initial);
      return std::isfinite(value) ? Json(value) : Json(plain_value_text(item.type, item.initial));
    }
    case Type::u32:
    case Type::u64: return from_raw<std::uint64_t>(item.initial);
    default: return from_raw<std::int64_t>(item.initial);
  }
}

Json items_json(const Declaration& d, bool pins) {
  Json out = Json::array();
  for (const auto& item : d.items) {
    if (item.is_pin() != pins) continue;
    Json one;
    one["name"] = item.name;
    one["type"] = type_name(item.type);
    one["dir"] = item.dir == Dir::ro ? "ro" : dir_word(item.dir);
    one["default"] = initial_json(item);
    one["doc"] = item.doc;
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

std::string declaration_json(const Declaration& d) {
  Json arguments = Json::array(), functions = Json::array(), threads = Json::array();
  for (const auto& a : d.arguments)
    arguments.push_back({{"name", a.name}, {"default", a.default_text}, {"doc", a.doc}});
  for (const auto& f : d.functions) functions.push_back({{"name", f.name}, {"doc", f.doc}});
  for (const auto& t : d.threads) threads.push_back({{"name", t.name}, {"period_ns", t.period_ns}});
  Json out;
  out["name"] = d.name;
  out["summary"] = d.summary;
  out["notes"] = d.notes;
  out["license"] = d.license;
  out["singleton"] = d.singleton;
  out["example"] = d.example;
  out["arguments"] = std::move(arguments);
  out["threads"] = std::move(threads);
  out["functions"] = std::move(functions);
  out["pins"] = items_json(d, true);
  out["parameters"] = items_json(d, false);
  out["incomplete"] = d.incomplete;
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace kerf::hal
