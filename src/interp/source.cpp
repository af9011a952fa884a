#include "interp/source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

namespace kerf::interp {

namespace {

std::string_view without_return(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

class TextSource final : public LineSource {
 public:
  TextSource(std::string text, std::size_t longest_line)
      : text_(std::move(text)), longest_line_(longest_line) {}
  LineRead read(std::uint64_t offset, std::string_view& line, std::uint64_t& next) override {
    if (offset >= text_.size()) return LineRead::end;
    const std::size_t start = static_cast<std::size_t>(offset);
    const std::size_t end = text_.find('\n', start);
    const std::size_t stop = end == std::string::npos ? text_.size() : end;
    line = without_return(std::string_view(text_).substr(start, stop - start));
    next = end == std::string::npos ? stop : end + 1;
    return line.size() > longest_line_ ? LineRead::too_long : LineRead::line;
  }

 private:
  std::string text_;
  std::size_t longest_line_;
};

class FileSource final : public LineSource {
 public:
  FileSource(int fd, const struct stat& st, std::size_t longest_line)
      : fd_(fd), opened_(st), longest_line_(longest_line) {
    buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size() + 1, kChunk)));
    // A file of one chunk needs no descriptor, and later edits cannot tear it.
    if (size() < kChunk && fill(0) != LineRead::failed) {
      opened_.st_size = static_cast<off_t>(filled_);
      close();
    }
  }
  ~FileSource() override { close(); }
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  LineRead read(std::uint64_t offset, std::string_view& line, std::uint64_t& next) override {
    for (;;) {
      if (offset >= size()) return LineRead::end;
      if (offset >= start_ && offset < start_ + filled_) {
        const std::size_t at = static_cast<std::size_t>(offset - start_);
        const char* const from = buffer_.data() + at;
        const std::size_t left = filled_ - at;
        const auto* const end = static_cast<const char*>(std::memchr(from, '\n', left));
        if (end != nullptr || start_ + filled_ >= size()) {
          const std::size_t length = end != nullptr ? static_cast<std::size_t>(end - from) : left;
          line = without_return({from, length});
          next = offset + length + (end != nullptr ? 1 : 0);
          return line.size() > longest_line_ ? LineRead::too_long : LineRead::line;
        }
        if (at == 0) {  // a line longer than the buffer
          if (left > longest_line_) return skip_line(offset + left, next);
          buffer_.resize(std::min(2 * buffer_.size(), longest_line_ + 2));
        }
      }
      if (const LineRead r = fill(offset); r != LineRead::line) return r;
    }
  }

 private:
  static constexpr std::size_t kChunk = std::size_t{64} * 1024;
  /// Of a line that is too long: further than this is no text.
  static constexpr std::uint64_t kLookForEnd = std::uint64_t{16} * 1024 * 1024;

  [[nodiscard]] std::uint64_t size() const { return static_cast<std::uint64_t>(opened_.st_size); }

  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }

  LineRead skip_line(std::uint64_t from, std::uint64_t& next) {
    for (std::uint64_t at = from; at < size() && at < from + kLookForEnd; at += filled_) {
      if (const LineRead r = fill(at); r != LineRead::line) return r;
      if (const void* end = std::memchr(buffer_.data(), '\n', filled_); end != nullptr) {
        next = at + static_cast<std::uint64_t>(static_cast<const char*>(end) - buffer_.data()) + 1;
        return LineRead::too_long;
      }
    }
    next = size();
    return LineRead::too_long;
  }

  LineRead fill(std::uint64_t offset) {
    struct stat now {};
    if (fd_ < 0 || ::fstat(fd_, &now) != 0) return LineRead::failed;
    if (now.st_size != opened_.st_size || now.st_mtim.tv_sec != opened_.st_mtim.tv_sec ||
        now.st_mtim.tv_nsec != opened_.st_mtim.tv_nsec)
      return LineRead::changed;
    start_ = offset;
    filled_ = 0;
    while (filled_ < buffer_.size()) {
      const ssize_t n = ::pread(fd_, buffer_.data() + filled_, buffer_.size() - filled_,
                                static_cast<off_t>(offset + filled_));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return LineRead::failed;
      if (n == 0) break;
      filled_ += static_cast<std::size_t>(n);
    }
    return filled_ > 0 ? LineRead::line : LineRead::changed;
  }

  int fd_;
  struct stat opened_;
  std::size_t longest_line_;
  std::vector<char> buffer_;
  std::uint64_t start_{0};
  std::size_t filled_{0};
};

/// What a line costs besides its text; an estimate.
constexpr std::size_t kPerLine = 100;

}  // namespace

rtapi::Status LineStream::push(std::string_view line) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  line = without_return(line);
  if (bytes_ + line.size() + kPerLine > kMostKept)
    return rtapi::fail(rtapi::Errc::no_memory,
                       "More lines than can be kept\nend the loop or the sub, or open a file");
  lines_.emplace(end_, line);
  bytes_ += line.size() + kPerLine;
  end_ += line.size() + 1;
  return {};
}

LineRead LineStream::read(std::uint64_t offset, std::string_view& line, std::uint64_t& next) {
  if (offset >= end_) return ended_ ? LineRead::end : LineRead::none_yet;
  const auto hit = lines_.find(offset);
  if (hit == lines_.end()) return LineRead::failed;
  line = hit->second;
  next = offset + line.size() + 1;
  return line.size() > longest_line_ ? LineRead::too_long : LineRead::line;
}

void LineStream::forget_before(std::uint64_t offset) {
  auto i = lines_.lower_bound(fresh_);
  while (i != lines_.end() && i->first < offset) {
    bytes_ -= i->second.size() + kPerLine;
    i = lines_.erase(i);
  }
  fresh_ = std::max(fresh_, offset);
}

std::int32_t LineStream::drop_from(std::uint64_t offset) {
  std::int32_t count = 0;
  for (auto i = lines_.lower_bound(offset); i != lines_.end(); ++i) ++count;
  forget_before(end_);
  return count;
}

rtapi::Result<std::unique_ptr<LineSource>> open_file_source(const std::string& path,
                                                            std::size_t longest_line) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat st {};
  if (fd < 0 || ::fstat(fd, &st) != 0 || !S_ISREG(st.st_mode)) {
    const int cause = fd < 0 ? errno : EINVAL;
    if (fd >= 0) ::close(fd);
    return rtapi::fail(rtapi::Errc::not_found,
                       "Unable to open file <" + path + ">\n" +
                           (cause == EINVAL ? "it is not a regular file" : std::strerror(cause)));
  }
  return std::unique_ptr<LineSource>(std::make_unique<FileSource>(fd, st, longest_line));
}

std::unique_ptr<LineSource> make_text_source(std::string text, std::size_t longest_line) {
  return std::make_unique<TextSource>(std::move(text), longest_line);
}

}  // namespace kerf::interp
