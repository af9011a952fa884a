#include "interp/parser.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "interp/expression.hpp"

namespace kerf::interp {

namespace {

/// Brackets inside brackets: more is a mistake, and the parser is recursive in them.
constexpr int kDeepest = 48;

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// Settings of parameters on one line: more is no program, and a line of a megabyte must not take a hundred.
constexpr std::size_t kMostAssignments = 10000;

/// Powers of ten that are exact numbers.
constexpr auto kPowers = [] {
  std::array<double, 19> p{};
  double v = 1;
  for (double& x : p) x = v, v *= 10;
  return p;
}();
constexpr std::uint64_t kExact = std::uint64_t{1} << 53;

/// The code of a constant G or M word, -1 when it is none.
std::int16_t code_of(char letter, double v) {
  const double scaled = letter == 'g' ? v * 10 : v;
  if (!(scaled >= 0 && scaled < 30000)) return -1;
  const double rounded = std::floor(scaled + 0.5);
  return std::fabs(scaled - rounded) <= kTolerance ? static_cast<std::int16_t>(rounded)
                                                   : std::int16_t{-1};
}

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }

struct FunctionRow {
  std::string_view name;
  Op op;
};
constexpr FunctionRow kFunctions[] = {
    {"abs", Op::abs}, {"acos", Op::acos},   {"asin", Op::asin}, {"atan", Op::atan},
    {"cos", Op::cos}, {"exp", Op::exp},     {"fix", Op::fix},   {"fup", Op::fup},
    {"ln", Op::ln},   {"round", Op::round}, {"sin", Op::sin},   {"sqrt", Op::sqrt},
    {"tan", Op::tan},
};

struct OperatorRow {
  std::string_view name;
  Op op;
  int level;  ///< 5 binds strongest
};
constexpr OperatorRow kOperators[] = {
    {"**", Op::power, 5},   {"*", Op::times, 4},  {"/", Op::divide, 4},   {"mod", Op::modulo, 4},
    {"+", Op::plus, 3},     {"-", Op::minus, 3},  {"eq", Op::eq, 2},      {"ne", Op::ne, 2},
    {"gt", Op::gt, 2},      {"ge", Op::ge, 2},    {"lt", Op::lt, 2},      {"le", Op::le, 2},
    {"and", Op::op_and, 1}, {"or", Op::op_or, 1}, {"xor", Op::op_xor, 1},
};
constexpr int kStrongest = 5;

struct FlowRow {
  std::string_view name;
  Flow flow;
};
// Longer names first where one begins another.
constexpr FlowRow kFlows[] = {
    {"sub", Flow::sub},
    {"endsub", Flow::endsub},
    {"call", Flow::call},
    {"return", Flow::ret},
    {"if", Flow::if_block},
    {"elseif", Flow::elseif},
    {"else", Flow::else_block},
    {"endif", Flow::endif},
    {"while", Flow::while_loop},
    {"endwhile", Flow::endwhile},
    {"do", Flow::do_loop},
    {"repeat", Flow::repeat_loop},
    {"endrepeat", Flow::endrepeat},
    {"break", Flow::break_loop},
    {"continue", Flow::continue_loop},
};

struct CommentRow {
  std::string_view name;
  CommentKind kind;
  bool comma;
};
constexpr CommentRow kComments[] = {
    {"msg", CommentKind::msg, true},
    {"debug", CommentKind::debug, true},
    {"print", CommentKind::print, true},
    {"log", CommentKind::log, true},
    {"logopen", CommentKind::log_open, true},
    {"logappend", CommentKind::log_append, true},
    {"logclose", CommentKind::log_close, false},
    {"probeclose", CommentKind::probe_close, false},
    {"abort", CommentKind::abort, true},
    {"py", CommentKind::script, true},
};
constexpr std::string_view kProbeOpen = "probeopen";

}  // namespace

CommentKind classify_comment(std::string_view text, std::string_view& rest) {
  char head[12];
  std::size_t n = 0, i = 0;
  for (; i < text.size() && text[i] != ',' && n < sizeof head; ++i) {
    if (!is_blank(text[i])) head[n++] = lower(text[i]);
  }
  const std::string_view name(head, n);
  const bool comma = i < text.size() && text[i] == ',';
  for (const CommentRow& row : kComments) {
    if (row.name != name || (row.comma && !comma)) continue;
    rest = row.kind == CommentKind::probe_close ? text
           : comma                              ? text.substr(i + 1)
                                                : std::string_view();
    return row.kind;
  }
  rest = text;
  return name.substr(0, kProbeOpen.size()) == kProbeOpen && probe_file(text).size() > 0
             ? CommentKind::probe_open
             : CommentKind::plain;
}

std::string_view probe_file(std::string_view text) {
  const auto behind = [&](std::size_t i, const char* what) {
    i = text.find_first_not_of(what, i);
    return i == std::string_view::npos ? text.size() : i;
  };
  const std::size_t first = behind(behind(0, " \t") + kProbeOpen.size(), " \t,");
  const std::size_t last = text.find_last_not_of(" \t");
  return first >= text.size() ? std::string_view() : text.substr(first, last - first + 1);
}

// Behind ; only active comments matter (manual: "Comments").
void Parser::trailing_comment(std::string_view line, std::size_t semicolon, ParsedBlock& out) {
  std::size_t i = semicolon + 1;
  while (i < line.size() && is_blank(line[i])) ++i;
  constexpr std::string_view kFirst = "mdplaMDPLA";
  if (i == line.size() || kFirst.find(line[i]) == std::string_view::npos) return;
  std::string_view rest;
  const CommentKind kind = classify_comment(line.substr(semicolon + 1), rest);
  if (kind == CommentKind::plain) return;
  out.comment = kind;
  out.comment_text = rest;
}

bool Parser::fail(const char* format, ...) {
  std::va_list args;
  va_start(args, format);
  std::vsnprintf(error_, sizeof error_, format, args);
  va_end(args);
  at_ = pos_;
  return false;
}

void Parser::push(Op op, std::size_t at, double number, std::uint32_t id) {
  const auto constant = [this](std::size_t back) {
    return ops_.size() >= back && ops_[ops_.size() - back].op == Op::number;
  };
  if (op >= Op::first_function && constant(1)) {
    ExprOp& last = ops_.back();
    double v = last.value;
    // What cannot be computed is said when the line runs, as for any other operand.
    if (!is_binary(op)) {
      if (compute(op, v) == nullptr && std::isfinite(v)) {
        last.value = v;
        return;
      }
    } else if (constant(2)) {
      const double a = ops_[ops_.size() - 2].value;
      if (refusal(op, a, v) == nullptr && std::isfinite(v = compute(op, a, v))) {
        ops_.pop_back();
        ops_.back().value = v;
        return;
      }
    }
  }
  if (op == Op::parameter && constant(1)) {
    if (const int index = whole_index(ops_.back().value); index > 0) {
      ops_.back() = {Op::parameter_at, static_cast<std::uint32_t>(at),
                     static_cast<std::uint32_t>(index), 0};
      return;
    }
  }
  ops_.push_back({op, static_cast<std::uint32_t>(at), id, number});
}

int Parser::column_of(std::string_view line, std::size_t normalised) const {
  std::size_t n = 0;
  bool in_comment = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (!in_comment && is_blank(line[i])) continue;
    if (n == normalised) return static_cast<int>(i) + 1;
    if (line[i] == '"' && dialect_.quotes) in_comment = !in_comment;
    if (line[i] == '(') in_comment = true;
    if (line[i] == ')') in_comment = false;
    ++n;
  }
  return static_cast<int>(line.size()) + 1;
}

// Blanks go, letters become small, comments stay as they are; ; ends the line.
bool Parser::normalise(std::string_view line) {
  size_ = 0;
  pos_ = 0;
  semicolon_ = std::string_view::npos;
  if (buffer_.size() < line.size() + 2) buffer_.resize(line.size() + 2);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (is_blank(c)) continue;
    if (c == ';') {
      semicolon_ = i;
      break;
    }
    if (c == '(') {
      const std::size_t end = line.find_first_of("()", i + 1);
      pos_ = size_;
      if (end == std::string_view::npos) return fail("Unclosed comment found");
      if (line[end] == '(') return fail("Nested comment found");
      std::memcpy(buffer_.data() + size_, line.data() + i, end - i + 1);
      size_ += end - i + 1;
      i = end;
      continue;
    }
    if (c == '"' && dialect_.quotes) {
      const std::size_t end = line.find('"', i + 1);
      pos_ = size_;
      if (end == std::string_view::npos) return fail("Unclosed quotation found");
      std::memcpy(buffer_.data() + size_, line.data() + i, end - i + 1);
      size_ += end - i + 1;
      i = end;
      continue;
    }
    buffer_[size_++] = lower(c);
  }
  buffer_[size_] = '\0';
  pos_ = 0;
  return true;
}

bool Parser::parse(std::string_view line, ParsedBlock& out) {
  out = {};
  words_.clear();
  if (plain(line, out)) return true;
  out_ = &out;
  out.sequence = -1;
  words_.clear();
  assignments_.clear();
  ops_.clear();
  arguments_.clear();
  depth_ = 0;
  std::size_t first = 0;
  while (first < line.size() && is_blank(line[first])) ++first;
  if (first < line.size() && line[first] == '%' &&
      line.find_first_not_of(" \t\r", first + 1) == std::string_view::npos) {
    out.percent = true;
    return true;
  }
  if (!normalise(line)) return false;
  if (dialect_.block_delete && peek() == '/') {
    out.skip = true;
    ++pos_;
  }
  if (!sequence() || !items()) return false;
  if (semicolon_ != std::string_view::npos) trailing_comment(line, semicolon_, out);
  show(out);
  return true;
}

void Parser::show(ParsedBlock& out) const {
  out.words = words_;
  out.assignments = assignments_;
  out.ops = ops_;
  out.arguments = arguments_;
}

// Places are counted as in the normalised line, and numbers are those that from_chars reads: up to 2^53 over a power of ten
// is one exact division.
bool Parser::plain(std::string_view line, ParsedBlock& out) {
  const char* p = line.data();
  const char* const end = p + line.size();
  std::uint32_t at = 0;
  const auto blanks = [&] {
    while (p != end && is_blank(*p)) ++p;
  };
  for (blanks(); p != end; blanks()) {
    if (*p == ';') {
      trailing_comment(line, static_cast<std::size_t>(p - line.data()), out);
      break;
    }
    const char letter = lower(*p);
    if (letter < 'a' || letter > 'z' || letter == 'o') return false;
    ParsedWord w;
    w.letter = static_cast<std::uint8_t>(letter - 'a');
    w.at = at++;
    ++p;
    blanks();
    bool minus = false;
    if (p != end && (*p == '-' || *p == '+')) {
      minus = *p == '-';
      ++p, ++at;
    }
    std::uint64_t digits = 0;
    const char* const first = p;
    while (p != end && is_digit(*p)) digits = digits * 10 + static_cast<unsigned>(*p++ - '0');
    auto count = p - first;
    std::ptrdiff_t decimals = 0;
    bool point = false;
    if (p != end && *p == '.') {
      point = true;
      const char* const behind = ++p;
      while (p != end && is_digit(*p)) digits = digits * 10 + static_cast<unsigned>(*p++ - '0');
      decimals = p - behind;
      count += decimals;
    }
    if (count == 0 || count > 18 || digits >= kExact) return false;
    at += static_cast<std::uint32_t>(p - first);
    blanks();
    if (p != end && (is_digit(*p) || *p == '.')) return false;  // a number with blanks
    if (letter == 'm' && words_.empty() && (digits == 98 || digits == 99)) return false;
    if (letter == 'n') {
      if (!words_.empty() || out.sequence >= 0 || p == end || point || minus || first[-1] == '+' ||
          count > 9)
        return false;
      out.sequence = static_cast<std::int32_t>(digits);
      continue;
    }
    const double v = static_cast<double>(digits) / kPowers[static_cast<std::size_t>(decimals)];
    w.value = minus ? -v : v;
    if (letter == 'g' || letter == 'm') w.code = code_of(letter, w.value);
    words_.push_back(w);
  }
  out.words = words_;
  return true;
}

bool Parser::peek_flow(std::string_view line, ParsedBlock& out) {
  std::size_t i = 0;
  const auto blanks = [&] {
    while (i < line.size() && is_blank(line[i])) ++i;
  };
  blanks();
  if (i < line.size() && line[i] == '/') ++i;
  blanks();
  if (i < line.size() && lower(line[i]) == 'n') {
    ++i;
    while (i < line.size() && (is_digit(line[i]) || is_blank(line[i]))) ++i;
  }
  if (i >= line.size() || (lower(line[i]) != 'o' && dialect_.statements.empty())) return false;
  return parse(line, out) && out.flow != Flow::none;
}

std::int64_t Parser::peek_sequence(std::string_view line) const {
  std::size_t i = 0;
  const auto next = [&] {
    while (i < line.size() && is_blank(line[i])) ++i;
    return i < line.size() ? lower(line[i]) : '\0';
  };
  if (dialect_.block_delete && next() == '/') ++i;
  if (next() != 'n') return -1;
  ++i;
  std::int64_t n = -1;
  for (; is_digit(next()) && n < 1000000000; ++i)
    n = std::max<std::int64_t>(n, 0) * 10 + (line[i] - '0');
  return n;
}

bool Parser::sequence() {
  if (peek() != 'n') return true;
  const std::size_t start = ++pos_;
  if (!is_digit(peek())) return fail("Bad format unsigned integer");
  std::int64_t n = 0;
  while (is_digit(peek()) && pos_ - start < 10) n = n * 10 + (buffer_[pos_++] - '0');
  // A fraction of a line number is allowed and means nothing (manual: "Line Number").
  if (peek() == '.') {
    ++pos_;
    while (is_digit(peek())) ++pos_;
  }
  out_->sequence = n > 2147483647 ? 2147483647 : static_cast<std::int32_t>(n);
  return true;
}

bool Parser::items() {
  if (peek() == 'o' && dialect_.o_words) return flow();
  // M98 and M99 direct the flow when they begin a line; their words are read like those of other codes.
  if (peek() == 'm' && dialect_.o_words && (starts("m98") || starts("m99"))) {
    const char after = pos_ + 3 < size_ ? buffer_[pos_ + 3] : '\0';
    if (!is_digit(after) && after != '.')
      out_->flow = buffer_[pos_ + 2] == '8' ? Flow::call_number : Flow::return_number;
  }
  for (const StatementRow& row : dialect_.statements) {
    if (starts(row.word)) return statement(row.word);
  }
  return words_to({});
}

bool Parser::words_to(std::string_view stop) {
  while (pos_ < size_ && (stop.empty() || !starts(stop))) {
    const char c = buffer_[pos_];
    if (c == '(') {
      if (!comment()) return false;
    } else if (c == '#') {
      if (!assignment()) return false;
    } else if (c == '"' && dialect_.quotes) {
      out_->quoted = quoted();
    } else {
      const int letter = letter_index(c);
      if (letter < 0 || c == 'n' || c == 'o') return fail("Bad character '%c' used", c);
      if (!word(letter)) return false;
    }
  }
  return true;
}

// Its end was found by normalise(). The text's name + 1.
std::uint32_t Parser::quoted() {
  const std::size_t end = std::string_view(buffer_).find('"', pos_ + 1);
  const std::uint32_t id = names_.intern(std::string_view(buffer_).substr(pos_, end - pos_));
  pos_ = end + 1;
  return id + 1;
}

bool Parser::statement(std::string_view word) {
  pos_ += word.size();
  char expected[100] = "";
  for (const StatementRow& row : dialect_.statements) {
    if (row.word != word) continue;
    if (row.condition && arguments_.empty()) {
      const auto first = ops_.size();
      if (!expression()) return false;
      arguments_.push_back(since(first));
    }
    const bool bare = row.behind.empty() && row.joins == Joins::nesting;
    if (starts(row.behind) && (!bare || pos_ == size_ || peek() == '(')) {
      pos_ += row.behind.size();
      return end_of_statement(row);
    }
    const std::size_t used = std::strlen(expected);
    std::snprintf(expected + used, sizeof expected - used,
                  row.behind.empty() ? "%sthe end of the line" : "%s'%.*s'", used > 0 ? " or " : "",
                  static_cast<int>(row.behind.size()), row.behind.data());
  }
  return fail("%s expected", expected);
}

bool Parser::end_of_statement(const StatementRow& row) {
  if (row.joins == Joins::rest) {
    out_->conditional = true;
    if (!words_to(row.otherwise)) return false;
    out_->else_words = static_cast<std::uint32_t>(words_.size());
    out_->else_assignments = static_cast<std::uint32_t>(assignments_.size());
    if (pos_ < size_) pos_ += row.otherwise.size();
    return words_to({});
  }
  out_->flow = row.flow;
  out_->statement = true;
  const std::size_t digits = pos_;
  while (row.joins != Joins::nesting && is_digit(peek())) ++pos_;
  if (row.joins == Joins::nesting) {
    out_->nested = true;
    out_->label = Label::nested;
  } else if (pos_ > digits) {
    out_->label = labels_.number(std::string_view(buffer_).substr(digits, pos_ - digits));
  } else if (row.joins == Joins::line && (peek() == '[' || peek() == '#')) {
    const auto first = ops_.size();
    if (!value()) return false;
    out_->label_expr = since(first);
  } else {
    return fail("Bad format unsigned integer");
  }
  while (pos_ < size_) {
    if (peek() != '(') return fail("Unexpected character after statement");
    if (!comment()) return false;
  }
  return true;
}

bool Parser::word(int letter) {
  ParsedWord w;
  w.letter = static_cast<std::uint8_t>(letter);
  w.at = static_cast<std::uint32_t>(pos_++);
  const auto first = ops_.size();
  if (!value()) return false;
  w.expr = since(first);
  if (w.expr.count == 1 && ops_.back().op == Op::number) {
    w.value = ops_.back().value;
    w.expr = {};
    ops_.pop_back();
    const char name = kLetterNames[w.letter];
    if (name == 'g' || name == 'm') w.code = code_of(name, w.value);
  } else {
    w.constant = false;
  }
  words_.push_back(w);
  return true;
}

bool Parser::comment() {
  const std::size_t end = std::string_view(buffer_.data(), size_).find(')', pos_);
  std::string_view rest;
  // Only the last comment of a line acts (manual: "Repeated Items").
  out_->comment =
      classify_comment(std::string_view(buffer_).substr(pos_ + 1, end - pos_ - 1), rest);
  out_->comment_text = rest;
  pos_ = end + 1;
  return true;
}

bool Parser::assignment() {
  if (assignments_.size() == kMostAssignments)
    return fail("Too many parameter settings on one line");
  Assignment a;
  a.at = static_cast<std::uint32_t>(pos_++);
  if (peek() == '<') {
    if (!parameter_name(a.id)) return false;
    a.named = true;
  } else {
    const auto first = ops_.size();
    if (!value()) return false;
    a.index = since(first);
    const int index =
        a.index.count == 1 && ops_.back().op == Op::number ? whole_index(ops_.back().value) : 0;
    if (index > 0) {
      ops_.pop_back();
      a.index = {};
      a.id = static_cast<std::uint32_t>(index);
    }
  }
  if (peek() != '=') return fail("Equal sign missing in parameter setting");
  ++pos_;
  const auto first = ops_.size();
  if (peek() == '"' && dialect_.quotes)
    a.text = quoted();
  else if (!value())
    return false;
  a.value = since(first);
  assignments_.push_back(a);
  return true;
}

bool Parser::flow() {
  const std::size_t label = ++pos_;
  if (peek() == '<') {
    std::string_view text;
    if (!name(text)) return false;
    text = std::string_view(buffer_).substr(label, pos_ - label);
    if (!labels_.has_room(text)) return fail("Too many O-word labels");
    out_->label = labels_.named(text);
  } else if (std::size_t start = pos_; is_digit(peek())) {
    while (is_digit(peek())) ++pos_;
    if (peek() == '.') return fail("Non integer value for integer");
    while (start + 1 < pos_ && buffer_[start] == '0') ++start;
    out_->label = labels_.number(std::string_view(buffer_).substr(start, pos_ - start));
  } else {
    const auto first = ops_.size();
    if (!value()) return false;
    out_->label_expr = since(first);
  }
  const std::size_t start = pos_;
  while (peek() >= 'a' && peek() <= 'z') ++pos_;
  const std::string_view word = std::string_view(buffer_).substr(start, pos_ - start);
  std::size_t length = 0;  // the longest that fits: what stands behind it is one character too many
  for (const FlowRow& row : kFlows) {
    if (row.name.size() <= length || !word.starts_with(row.name)) continue;
    length = row.name.size();
    out_->flow = row.flow;
  }
  if (length > 0) pos_ = start + length;
  if (word.empty() && (pos_ == size_ || peek() == '(')) out_->flow = Flow::program_number;
  if (out_->flow == Flow::none) {
    pos_ = start;
    return fail("Unknown control command in o word");
  }
  return flow_arguments();
}

bool Parser::flow_arguments() {
  const Flow f = out_->flow;
  const bool needs =
      f == Flow::if_block || f == Flow::elseif || f == Flow::while_loop || f == Flow::repeat_loop;
  const std::size_t most = f == Flow::call                                ? kSubArguments
                           : needs || f == Flow::ret || f == Flow::endsub ? 1
                                                                          : 0;
  while (peek() == '[') {
    if (arguments_.size() == most) {
      return most == kSubArguments ? fail("Too many subroutine parameters")
                                   : fail("Unexpected character after O-word");
    }
    const auto first = ops_.size();
    if (!value()) return false;
    arguments_.push_back(since(first));
  }
  if (needs && arguments_.empty())
    return fail("Left bracket missing after '%s'", f == Flow::if_block     ? "if"
                                                   : f == Flow::elseif     ? "elseif"
                                                   : f == Flow::while_loop ? "while"
                                                                           : "repeat");
  while (pos_ < size_) {
    if (peek() != '(') return fail("Unexpected character after O-word");
    if (!comment()) return false;
  }
  return true;
}

// "<name>"; blanks and capitals are gone already.
bool Parser::name(std::string_view& out) {
  const std::size_t start = ++pos_;
  while (pos_ < size_ && buffer_[pos_] != '>') ++pos_;
  if (pos_ == size_) return fail("Named parameter not terminated");
  out = std::string_view(buffer_).substr(start, pos_ - start);
  ++pos_;
  return true;
}

bool Parser::parameter_name(std::uint32_t& id) {
  std::string_view text;
  if (!name(text)) return false;
  if (!names_.has_room(text)) return fail("Too many named parameters");
  id = names_.intern(text);
  return true;
}

bool Parser::number(double sign) {
  const std::size_t start = pos_;
  while (is_digit(peek()) || peek() == '.') ++pos_;
  double v = 0;
  const char* const end = buffer_.data() + pos_;
  const auto r = std::from_chars(buffer_.data() + start, end, v, std::chars_format::fixed);
  if (r.ec != std::errc() || r.ptr != end) {
    const std::string_view text(buffer_.data() + start, pos_ - start);
    pos_ = start;
    return fail("bad number format (%s) parsing '%.*s'",
                r.ec != std::errc() ? "conversion failed" : "trailing characters",
                static_cast<int>(text.size()), text.data());
  }
  push(Op::number, pos_, sign * v);
  return true;
}

bool Parser::value() {
  const char c = peek();
  if (is_digit(c) || c == '.') return number(1);
  if (c == '[') return expression();
  if (c == '#') return parameter();
  if (c == '_' && dialect_.bare_names) {
    const std::size_t first = pos_;
    while (peek() == '_' || is_digit(peek()) || (peek() >= 'a' && peek() <= 'z')) ++pos_;
    push(Op::named, first, 0, names_.intern(std::string_view(buffer_).substr(first, pos_ - first)));
    return true;
  }
  if (c == '+' || c == '-') {
    const char after = pos_ + 1 < size_ ? buffer_[pos_ + 1] : '\0';
    if (is_digit(after) || after == '.') {
      ++pos_;
      return number(c == '-' ? -1 : 1);
    }
    if (after != '[' && after != '#' && after != '+' && after != '-' && letter_index(after) < 0)
      return fail("bad number format (conversion failed) parsing '%c'", c);
    ++pos_;
    if (++depth_ > kDeepest) return fail("Expression nested too deeply");
    if (!value()) return false;
    --depth_;
    if (c == '-') push(Op::negate, pos_);
    return true;
  }
  if (c >= 'a' && c <= 'z') return function();
  if (c == '\0') return fail("No characters found in reading real value");
  if (c == '=' || c == ']' || c == '(')
    return fail("bad number format (conversion failed) parsing ''");
  return fail("bad number format (conversion failed) parsing '%c'", c);
}

bool Parser::expression() {
  if (peek() != '[') return fail("Left bracket missing");
  const std::size_t open = pos_++;
  if (++depth_ > kDeepest) return fail("Expression nested too deeply");
  if (!binary(1)) return false;
  if (peek() != ']') {
    if (pos_ < size_) return fail("Unknown operation");
    pos_ = open;
    return fail("Unclosed expression");
  }
  ++pos_;
  --depth_;
  return true;
}

int Parser::operator_at(Op& op, std::size_t& length) const {
  for (const OperatorRow& row : kOperators) {
    if (!starts(row.name)) continue;
    op = row.op;
    length = row.name.size();
    return row.level;
  }
  return 0;
}

bool Parser::binary(int level) {
  if (level > kStrongest) return value();
  if (!binary(level + 1)) return false;
  for (;;) {
    Op op{};
    std::size_t length = 0;
    if (operator_at(op, length) != level) return true;
    const std::size_t place = pos_;
    pos_ += length;
    if (!binary(level + 1)) return false;
    push(op, place);
  }
}

bool Parser::parameter() {
  const std::size_t place = pos_++;
  if (peek() == '<') {
    std::uint32_t id = 0;
    if (!parameter_name(id)) return false;
    push(Op::named, place, 0, id);
    return true;
  }
  if (++depth_ > kDeepest) return fail("Expression nested too deeply");
  if (!value()) return false;
  --depth_;
  push(Op::parameter, place);
  return true;
}

bool Parser::function() {
  for (std::uint32_t i = 0; i < dialect_.functions.size(); ++i) {
    const std::string_view word = dialect_.functions[i].name;
    if (!starts(word) || pos_ + word.size() >= size_ || buffer_[pos_ + word.size()] != '[')
      continue;
    const std::size_t place = pos_;
    pos_ += word.size();
    if (!expression()) return false;
    push(Op::external, place, 0, i);
    return true;
  }
  if (starts("exists[")) {
    const std::size_t place = pos_;
    pos_ += 7;
    if (peek() != '#') return fail("Expected # reading parameter");
    ++pos_;
    if (peek() == '<') {
      std::uint32_t id = 0;
      if (!parameter_name(id)) return false;
      push(Op::exists_named, place, 0, id);
    } else {
      if (!value()) return false;
      push(Op::exists_numbered, place);
    }
    if (peek() != ']') return fail("Expected ] reading bracketed parameter");
    ++pos_;
    return true;
  }
  for (const FunctionRow& row : kFunctions) {
    if (!starts(row.name)) continue;
    const std::size_t place = pos_;
    pos_ += row.name.size();
    if (peek() != '[') return fail("Left bracket missing after unary operation name");
    if (!expression()) return false;
    if (row.op == Op::atan) {
      if (peek() != '/') return fail("Slash missing after first atan argument");
      ++pos_;
      if (peek() != '[') return fail("Left bracket missing after slash with atan");
      if (!expression()) return false;
    }
    push(row.op, place);
    return true;
  }
  constexpr std::string_view kFirst = "acefrlst";
  return kFirst.find(peek()) == std::string_view::npos
             ? fail("Unknown word where unary operation could be")
             : fail("Unknown word starting with %c", peek());
}

}  // namespace kerf::interp
