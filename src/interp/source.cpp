#include "interp/source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "interp/parser.hpp"

namespace kerf::interp {

namespace {

std::string_view without_return(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

class TextSource final : public LineSource {
 public:
  explicit TextSource(std::string text) : text_(std::move(text)) {}
  LineRead read(std::uint64_t offset, std::string_view& line, std::uint64_t& next) override {
    if (offset >= text_.size()) return LineRead::end;
    const std::size_t start = static_cast<std::size_t>(offset);
    const std::size_t end = text_.find('\n', start);
    const std::size_t stop = end == std::string::npos ? text_.size() : end;
    line = without_return(std::string_view(text_).substr(start, stop - start));
    next = end == std::string::npos ? stop : end + 1;
    return line.size() > kLongestLine ? LineRead::too_long : LineRead::line;
  }

 private:
  std::string text_;
};

class FileSource final : public LineSource {
 public:
  FileSource(int fd, const struct stat& st) : fd_(fd), opened_(st), buffer_(kChunk) {}
  ~FileSource() override { ::close(fd_); }
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  LineRead read(std::uint64_t offset, std::string_view& line, std::uint64_t& next) override {
    for (int attempt = 0; attempt < 2; ++attempt) {
      if (offset >= start_ && offset < start_ + filled_) {
        const std::size_t at = static_cast<std::size_t>(offset - start_);
        const auto* from = buffer_.data() + at;
        const std::size_t left = filled_ - at;
        const auto* end = static_cast<const char*>(std::memchr(from, '\n', left));
        const bool last = start_ + filled_ >= size();
        if (end != nullptr || last) {
          const std::size_t length = end != nullptr ? static_cast<std::size_t>(end - from) : left;
          line = without_return({from, length});
          next = offset + length + (end != nullptr ? 1 : 0);
          return length > kLongestLine ? LineRead::too_long : LineRead::line;
        }
        if (at == 0) {  // a whole chunk without an end of line: hand it out, the parser refuses it
          line = {from, left};
          next = offset + left;
          return LineRead::too_long;
        }
      } else if (offset >= size()) {
        return LineRead::end;
      }
      const LineRead r = fill(offset);
      if (r != LineRead::line) return r;
    }
    return LineRead::failed;
  }

 private:
  static constexpr std::size_t kChunk = 256 * 1024;

  [[nodiscard]] std::uint64_t size() const { return static_cast<std::uint64_t>(opened_.st_size); }

  LineRead fill(std::uint64_t offset) {
    struct stat now {};
    if (::fstat(fd_, &now) != 0) return LineRead::failed;
    if (now.st_size != opened_.st_size || now.st_mtim.tv_sec != opened_.st_mtim.tv_sec ||
        now.st_mtim.tv_nsec != opened_.st_mtim.tv_nsec)
      return LineRead::changed;
    start_ = offset;
    filled_ = 0;
    while (filled_ < kChunk) {
      const ssize_t n = ::pread(fd_, buffer_.data() + filled_, kChunk - filled_,
                                static_cast<off_t>(offset + filled_));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return LineRead::failed;
      if (n == 0) break;
      filled_ += static_cast<std::size_t>(n);
    }
    return filled_ > 0 ? LineRead::line : LineRead::end;
  }

  int fd_;
  struct stat opened_;
  std::vector<char> buffer_;
  std::uint64_t start_{0};
  std::size_t filled_{0};
};

}  // namespace

rtapi::Result<std::unique_ptr<LineSource>> open_file_source(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat st {};
  if (fd < 0 || ::fstat(fd, &st) != 0 || !S_ISREG(st.st_mode)) {
    const int cause = fd < 0 ? errno : EINVAL;
    if (fd >= 0) ::close(fd);
    return rtapi::fail(rtapi::Errc::not_found,
                       "Unable to open file <" + path + ">\n" +
                           (cause == EINVAL ? "it is not a regular file" : std::strerror(cause)));
  }
  return std::unique_ptr<LineSource>(std::make_unique<FileSource>(fd, st));
}

std::unique_ptr<LineSource> make_text_source(std::string text) {
  return std::make_unique<TextSource>(std::move(text));
}

}  // namespace kerf::interp
