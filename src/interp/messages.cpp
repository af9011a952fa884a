// Active comments: MSG, DEBUG, PRINT, LOG..., abort. Manual: "Messages", "Logging", "Comment Parameters".
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "interp/core.hpp"

namespace kerf::interp {

namespace {
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A longer number is printed as one that does not exist, as the peer does.
constexpr int kLongestNumber = 29;

/// Length of a format (%d, %f, %.3f) at the start of `text`, 0 for anything else; `decimals` is what it asks for. Of one that begins
/// with %. and is none the peer leaves out the %.
std::size_t format_length(std::string_view text, int& decimals) {
  if (text.starts_with("%d")) return decimals = 0, 2;
  if (text.starts_with("%f")) return decimals = 4, 2;
  if (text.size() >= 4 && text[1] == '.' && is_digit(text[2]) && text[3] == 'f')
    return decimals = text[2] - '0', 4;
  return text.starts_with("%.") ? 1 : 0;
}
}  // namespace

void Core::expand_text(std::string_view text, std::string& result) {
  result.clear();
  int decimals = 6;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '%') {
      if (const std::size_t n = format_length(text.substr(i), decimals); n > 0) {
        i += n;
        continue;
      }
    }
    Value value;
    bool exists = true, parameter_here = false;
    if (c == '#' && i + 1 < text.size() && is_digit(text[i + 1])) {
      int index = 0;
      const auto r = std::from_chars(text.data() + i + 1, text.data() + text.size(), index);
      parameter_here = true;
      exists = r.ec == std::errc() && index > 0 && index < kParameterCount;
      if (exists) value = {parameter(index), params.text(index)};
      i = static_cast<std::size_t>(r.ptr - text.data());
    } else if (const std::size_t end = text.find('>', i); c == '#' && i + 1 < text.size() &&
                                                          text[i + 1] == '<' &&
                                                          end != std::string_view::npos) {
      std::string name;
      for (const char n : text.substr(i + 2, end - i - 2)) {
        if (n != ' ' && n != '\t') name += n >= 'A' && n <= 'Z' ? static_cast<char>(n + 32) : n;
      }
      // Names of HAL keep their case: a pin may have capitals.
      if (settings.no_downcase_oword && name.starts_with("_hal["))
        name = "_hal[" + std::string(text.substr(i + 7, end - i - 7));
      parameter_here = true;
      exists = params.has_room(name);
      if (exists) (void)read_named(params.intern(name), value, exists);
      i = end + 1;
    }
    if (!parameter_here) {
      result += c;
      ++i;
    } else if (!exists) {
      result += "######";
    } else if (value.text != nullptr) {
      result += *value.text;
    } else {
      // Rounding noise reads as 0, as the peer prints it.
      if (std::fabs(value.number) < 1e-4) value.number = 0;
      char number[352];
      const int length = std::snprintf(number, sizeof number, "%.*f", decimals, value.number);
      result += length > kLongestNumber ? "######" : number;
    }
  }
}

bool Core::run_comment(const ParsedBlock& b) {
  if (b.comment == CommentKind::none) return true;
  const std::string_view text = b.comment_text;
  const auto keep = [this](std::string_view t) { return out.keep(t); };
  switch (b.comment) {
    case CommentKind::none: break;
    case CommentKind::plain:
      if (!text.empty()) comment(text.substr(std::min(text.find_first_not_of(" \t"), text.size())));
      break;
    case CommentKind::msg: out.call<&Canon::message>(keep(text)); break;
    case CommentKind::debug:
      if (params.get(kDebugEnable) == 0) break;
      expand_text(text, message_);
      out.call<&Canon::message>(keep(message_));
      break;
    case CommentKind::print:
      expand_text(text, message_);
      out.call<&Canon::print>(keep(message_));
      break;
    case CommentKind::log:
      expand_text(text, message_);
      out.call<&Canon::log>(keep(message_));
      break;
    case CommentKind::log_open:
    case CommentKind::log_append:
      out.call<&Canon::log_open>(keep(text), b.comment == CommentKind::log_append);
      break;
    case CommentKind::script: return run_statement(text);
    case CommentKind::log_close: out.call<&Canon::log_close>(); break;
    case CommentKind::probe_open:
      comment(text);
      out.call<&Canon::probe_log_open>(keep(probe_file(text)));
      break;
    case CommentKind::probe_close:
      comment(text);
      out.call<&Canon::probe_log_close>();
      break;
    case CommentKind::abort:
      expand_text(text, message_);
      if (*message_.c_str() == '\0') message_ = "(abort,) without a reason";  // a zero byte too
      return fail(0, "The program asked to stop here", "%s", message_.c_str());
  }
  return true;
}

}  // namespace kerf::interp
