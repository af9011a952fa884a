#include "io/tool_table.hpp"

#include <cctype>
#include <charconv>
#include <cstdio>

#include "rtapi/base/suggest.hpp"

namespace kerf::io {
namespace {

using rtapi::Errc;
using rtapi::fail;

constexpr std::string_view kLetters = "TPXYZABCUVWDIJQ";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// A number that fills the whole of `text`.
bool read_number(std::string_view text, double& out) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc() && end == text.data() + text.size() && out == out;
}

bool read_whole(std::string_view text, int& out) {
  double value = 0;
  if (!read_number(text, value) || value < -2e9 || value > 2e9) return false;
  out = static_cast<int>(value);
  return static_cast<double>(out) == value;
}

/// Shortest text that reads back as the same number, at most as long as people like.
std::string number_text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.6f", value);
  double back = 0;
  std::string_view text(buffer);
  if (!read_number(text, back) || back != value) {
    const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
    return error == std::errc() ? std::string(buffer, end) : std::string("0");
  }
  while (text.ends_with('0')) text.remove_suffix(1);
  if (text.ends_with('.')) text.remove_suffix(1);
  return std::string(text == "-0" ? "0" : text);
}

/// A letter and a number, whichever, such as T1 or P-5.
bool begins_with_word(std::string_view line) {
  if (line.size() < 2 || std::isalpha(static_cast<unsigned char>(line[0])) == 0) return false;
  return std::isalpha(static_cast<unsigned char>(line[1])) == 0;
}

/// Reads the words of one line.
class LineReader {
 public:
  LineReader(const std::string& file, int line, double unit_mm, bool random,
             std::string& complaints)
      : file_(file), line_(line), unit_mm_(unit_mm), random_(random), complaints_(complaints) {}

  void complain(const std::string& text) {
    if (!complaints_.empty()) complaints_ += '\n';
    complaints_ += file_ + ':' + std::to_string(line_) + ": " + text;
    bad_ = true;
  }

  void word(std::string_view word) {
    const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(word[0])));
    const auto at = kLetters.find(letter);
    if (at == std::string_view::npos) {
      complain(
          "'" + std::string(word) +
          "': expected one of T P X Y Z A B C U V W D I J Q and a number, or ';' and a remark");
      return;
    }
    if ((seen_ & (1U << at)) != 0) {
      complain(std::string("two ") + letter + " on one line");
      return;
    }
    seen_ |= 1U << at;
    value(letter, word.substr(1));
  }

  bool finish() {
    if (bad_) return false;
    if ((seen_ & 1U) == 0) complain("no tool number: expected T and a whole number");
    if ((seen_ & 2U) == 0) complain("no pocket number: expected P and a whole number");
    return !bad_;
  }
  ToolEntry entry;

 private:
  void value(char letter, std::string_view text) {
    int* whole = letter == 'T'   ? &entry.number
                 : letter == 'P' ? &entry.pocket
                 : letter == 'Q' ? &entry.orientation
                                 : nullptr;
    if (whole != nullptr) {
      const int top = letter == 'P' && random_ ? ToolTable::kMaxPocket
                      : letter == 'Q'          ? 9
                                               : 2'000'000'000;
      if (!read_whole(text, *whole) || *whole < 0 || *whole > top)
        complain(std::string(1, letter) + std::string(text) +
                 ": expected a whole number from 0 to " + std::to_string(top) + " behind " +
                 letter);
      return;
    }
    double number = 0;
    if (!read_number(text, number)) {
      complain(std::string(1, letter) + std::string(text) + ": expected a number behind " + letter);
      return;
    }
    if (letter == 'D')
      entry.diameter_mm = number * unit_mm_;
    else if (letter == 'I')
      entry.front_angle_deg = number;
    else if (letter == 'J')
      entry.back_angle_deg = number;
    else {
      const auto axis = static_cast<std::size_t>(rtapi::axis_index(letter));
      entry.offset[axis] = rtapi::is_rotary(axis) ? number : number * unit_mm_;
    }
  }

  const std::string& file_;
  int line_;
  double unit_mm_;
  bool random_;
  std::string& complaints_;
  std::uint32_t seen_{0};
  bool bad_{false};
};

}  // namespace

rtapi::Result<ToolTable> ToolTable::parse(std::string_view text, const std::string& file,
                                          double unit_mm, bool random) {
  ToolTable table;
  std::string complaints;
  int line = 0;
  while (!text.empty()) {
    const auto end = text.find('\n');
    std::string_view row = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++line;
    const auto semicolon = row.find(';');
    std::string_view data = row.substr(0, semicolon);
    while (!data.empty() && is_blank(data.back())) data.remove_suffix(1);
    while (!data.empty() && is_blank(data.front())) data.remove_prefix(1);
    if (!row.empty() && row.back() == '\r') row.remove_suffix(1);
    if (data.empty()) {
      table.lines_.push_back({-1, std::string(row)});
      continue;
    }
    // Headings, and lines of old formats without letters: LinuxCNC skips them too.
    if (!begins_with_word(data)) {
      table.warnings_.push_back(file + ':' + std::to_string(line) +
                                ": not a line of a tool, skipped: expected T and a number first");
      table.lines_.push_back({-1, std::string(row)});
      continue;
    }
    LineReader reader(file, line, unit_mm, random, complaints);
    while (!data.empty()) {
      std::size_t n = 0;
      while (n < data.size() && !is_blank(data[n])) ++n;
      reader.word(data.substr(0, n));
      while (n < data.size() && is_blank(data[n])) ++n;
      data.remove_prefix(n);
    }
    if (!reader.finish()) continue;
    ToolEntry& entry = reader.entry;
    if (semicolon != std::string_view::npos) entry.remark = std::string(row.substr(semicolon + 1));
    if (table.find(entry.number) != nullptr) {
      // LinuxCNC's tables have such lines, and it takes the first.
      table.warnings_.push_back(file + ':' + std::to_string(line) + ": tool T" +
                                std::to_string(entry.number) +
                                " is defined twice; the first line counts");
      table.lines_.push_back({-1, std::string(row)});
      continue;
    }
    if (const ToolEntry* other = random ? table.find_pocket(entry.pocket) : nullptr;
        other != nullptr) {
      reader.complain("tool T" + std::to_string(entry.number) + " is in pocket P" +
                      std::to_string(entry.pocket) + ", where T" + std::to_string(other->number) +
                      " is already");
      continue;
    }
    table.lines_.push_back({static_cast<int>(table.tools_.size()), {}});
    table.tools_.push_back(entry);
  }
  if (!complaints.empty()) return fail(Errc::syntax, complaints);
  return table;
}

rtapi::Result<ToolTable> ToolTable::load(const std::string& file, double unit_mm, bool random) {
  KERF_TRY(const std::string text, read_file(file));
  return parse(text, file, unit_mm, random);
}

std::string ToolTable::text(double unit_mm) const {
  std::string out;
  for (const Line& line : lines_) {
    if (line.tool < 0) {
      out += line.text + '\n';
      continue;
    }
    const ToolEntry& t = tools_[static_cast<std::size_t>(line.tool)];
    out += 'T' + std::to_string(t.number) + " P" + std::to_string(t.pocket);
    for (std::size_t axis = 0; axis < rtapi::kAxes; ++axis) {
      if (t.offset[axis] == 0.0) continue;
      const double value = rtapi::is_rotary(axis) ? t.offset[axis] : t.offset[axis] / unit_mm;
      out += std::string(" ") + rtapi::kAxisLetters[axis] + number_text(value);
    }
    out += " D" + number_text(t.diameter_mm / unit_mm);
    if (t.front_angle_deg != 0.0) out += " I" + number_text(t.front_angle_deg);
    if (t.back_angle_deg != 0.0) out += " J" + number_text(t.back_angle_deg);
    if (t.orientation != 0) out += " Q" + std::to_string(t.orientation);
    if (!t.remark.empty()) out += " ;" + t.remark;
    out += '\n';
  }
  return out;
}

rtapi::Status ToolTable::save(const std::string& file, double unit_mm) const {
  return write_file_whole(file, text(unit_mm));
}

const ToolEntry* ToolTable::find(int number) const noexcept {
  for (const ToolEntry& t : tools_)
    if (t.number == number) return &t;
  return nullptr;
}

const ToolEntry* ToolTable::find_pocket(int pocket) const noexcept {
  for (const ToolEntry& t : tools_)
    if (t.pocket == pocket) return &t;
  return nullptr;
}

int ToolTable::index_of(int number) const noexcept {
  for (std::size_t i = 0; i < tools_.size(); ++i)
    if (tools_[i].number == number) return static_cast<int>(i);
  return -1;
}

void ToolTable::put(const ToolEntry& entry) {
  const int at = index_of(entry.number);
  if (at < 0) {
    lines_.push_back({static_cast<int>(tools_.size()), {}});
    tools_.push_back(entry);
    return;
  }
  ToolEntry& old = tools_[static_cast<std::size_t>(at)];
  const std::string remark = entry.remark.empty() ? old.remark : entry.remark;
  old = entry;
  old.remark = remark;
}

void ToolTable::set_pocket(int number, int pocket) noexcept {
  const int at = index_of(number);
  if (at >= 0) tools_[static_cast<std::size_t>(at)].pocket = pocket;
}

}  // namespace kerf::io
