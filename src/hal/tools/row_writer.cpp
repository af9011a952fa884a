#include "hal/tools/row_writer.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstdlib>
#include <cstring>

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Status;

namespace {

constexpr std::size_t kReadBytes = 65536;
/// A line longer than this is no row.
constexpr std::size_t kLongestLine = std::size_t{1} << 20U;

bool is_blank(char c) { return std::strchr(" \t\r\f\v", c) != nullptr && c != '\0'; }

/// One integer by strtol's rules: decimal, with sign; a negative one is an unsigned one's two's complement.
const char* parse_integer(Type type, const char* text, char** end, std::uint64_t& out) {
  errno = 0;
  bool fits = true;
  if (type == Type::s32 || type == Type::s64) {
    const long long value = std::strtoll(text, end, 10);
    fits = type == Type::s64 || (value >= INT32_MIN && value <= INT32_MAX);
    out = to_raw(std::int64_t{value});
  } else {
    const unsigned long long value = std::strtoull(text, end, 10);
    const bool negative = std::strchr(text, '-') != nullptr && value > INT64_MAX;
    fits = type == Type::u64 || value <= UINT32_MAX ||
           (negative && value >= std::uint64_t{0} - 0x80000000U);
    out = type == Type::u64 ? value : value & UINT32_MAX;
  }
  if (*end == text) return "bad character";
  return fits && errno != ERANGE ? nullptr : "number out of range";
}

const char* parse_bit(const char* text, char** end, std::uint64_t& out) {
  if (*text != '0' && *text != '1') return "bit value not 0 or 1";
  out = *text == '1' ? 1 : 0;
  *end = const_cast<char*>(text +
                           1);  // NOLINT(cppcoreguidelines-pro-type-const-cast): as strtol has it
  return nullptr;
}

/// One field; nullptr or what is wrong with it.
const char* parse_field(Type type, const char*& at, std::uint64_t& out) {
  while (is_blank(*at)) ++at;
  // A missing bit is named as a wrong one: what scripts have always seen.
  if (*at == '\0' && type != Type::bit) return "premature end of line";
  char* end = nullptr;
  const char* wrong = nullptr;
  if (type == Type::bit) {
    wrong = parse_bit(at, &end, out);
  } else if (type == Type::floating) {
    out = to_raw(std::strtod(at, &end));
    if (end == at) wrong = "bad character";
  } else {
    const std::string word(at, std::strcspn(at, " \t\r\f\v"));
    char* word_end = nullptr;
    wrong = parse_integer(type, word.c_str(), &word_end, out);
    end = const_cast<char*>(
        at + (word_end - word.c_str()));  // NOLINT(cppcoreguidelines-pro-type-const-cast): as above
  }
  if (wrong != nullptr) return wrong;
  if (*end != '\0' && !is_blank(*end)) return "bad character";
  at = end;
  return nullptr;
}

bool may_block(int fd) {
  struct stat info {};
  return ::fstat(fd, &info) == 0 && !S_ISREG(info.st_mode);
}

}  // namespace

Status parse_row(std::string_view types, const std::string& line, std::uint64_t* values) {
  const char* at = line.c_str();
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (const char* wrong = parse_field(stream_type(types[i]), at, values[i]); wrong != nullptr) {
      return fail(Errc::bad_argument, "field " + std::to_string(i) + ": " + wrong);
    }
  }
  return {};
}

RowWriter::RowWriter(Stream stream, int in, std::FILE* messages)
    : stream_(stream), in_(in), blocks_(may_block(in)), messages_(messages) {}

RowWriter::Input RowWriter::read_some() {
  text_.erase(0, used_);
  searched_ -= used_;
  used_ = 0;
  const std::size_t before = text_.size();
  text_.resize(before + kReadBytes);
  const ssize_t n = ::read(in_, text_.data() + before, kReadBytes);
  text_.resize(before + (n > 0 ? static_cast<std::size_t>(n) : 0));
  if (n > 0) return Input::more;
  if (n < 0 && (errno == EAGAIN || errno == EINTR)) return Input::wait;
  if (n < 0) finish(std::string("cannot read: ") + std::strerror(errno));
  end_of_input_ = true;
  return Input::end;
}

bool RowWriter::next_line(std::string& line) {
  const std::size_t end = text_.find('\n', searched_);
  searched_ = end == std::string::npos ? text_.size() : end;
  if (end == std::string::npos && !(end_of_input_ && used_ < text_.size())) return false;
  line.assign(text_, used_, searched_ - used_);
  return true;
}

bool RowWriter::put(const std::string& line) {
  if (!line.empty() && line[0] == '#') return true;
  std::uint64_t values[kStreamColumns];
  if (auto status = parse_row(stream_.types(), line, values); !status.ok()) {
    std::fprintf(messages_, "line %" PRId64 ", %s, skipping the line\n", line_number_,
                 status.error().message().c_str());
    return true;
  }
  return !stream_.full() && stream_.write(values);
}

void RowWriter::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  next.watch(stream_.room());
  if (stream_.closed()) return finish("the streamer was unloaded");
  std::string line;
  // One FIFO full at most, so that a fast streamer does not keep us from seeing a stop.
  for (std::uint32_t n = 0; n <= stream_.depth(); ++n) {
    while (!next_line(line)) {
      if (end_of_input_) return done() ? void() : finish();
      if (text_.size() - used_ > kLongestLine) return finish("a line is longer than a megabyte");
      if (blocks_ && n > 0) {  // something was done: look whether the input has more after that
        next.until = now;
        return;
      }
      if (read_some() != Input::wait) continue;
      next.watch_fd(in_);
      return;
    }
    if (!put(line)) return;  // the room cell wakes us
    ++line_number_;
    used_ = searched_ = std::min(searched_ + 1, text_.size());
  }
  next.until = now;
}

}  // namespace kerf::hal
