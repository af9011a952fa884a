// Commander: reading lines, from files and texts.
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "hal/cmd/commander.hpp"

namespace kerf::hal {

/// Gives whole lines: those that end in a backslash are put together with the next, nothing between them.
class Commander::Reader {
 public:
  Reader(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}
  Reader(std::FILE* file, std::string name) : file_(file), name_(std::move(name)) {}
  ~Reader() { std::free(buffer_); }  // NOLINT(cppcoreguidelines-no-malloc): getline's
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  bool next(std::string& line) {
    line.clear();
    std::string_view part;
    while (next_part(part)) {
      ++number_;
      if (!part.empty() && part.back() == '\r') {
        part.remove_suffix(1);
        dos_ = true;
      }
      const bool goes_on = !part.empty() && part.back() == '\\';
      if (goes_on) part.remove_suffix(1);
      line += part;
      if (!goes_on) return true;
    }
    return !line.empty();
  }
  /// Of the last line that next() took, as the peer counts.
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// True once, after the first line that ends as in DOS.
  bool take_dos() {
    const bool now = dos_ && !dos_told_;
    dos_told_ = dos_told_ || dos_;
    return now;
  }

 private:
  bool next_part(std::string_view& part) {
    if (file_ != nullptr) {
      // Line by line: stdin may be a pipe whose writer waits for answers.
      const ssize_t n = ::getline(&buffer_, &capacity_, file_);
      if (n < 0) return false;
      part = std::string_view(buffer_, static_cast<std::size_t>(n));
      if (!part.empty() && part.back() == '\n') part.remove_suffix(1);
      return true;
    }
    if (text_.empty()) return false;
    const auto end = std::min(text_.find('\n'), text_.size());
    part = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    return true;
  }

  std::FILE* file_{nullptr};
  std::string_view text_;
  std::string name_;
  char* buffer_{nullptr};
  std::size_t capacity_{0};
  int number_{0};
  bool dos_{false};
  bool dos_told_{false};
};

bool Commander::read_lines(Reader& reader, bool batched) {
  const bool old_batched = std::exchange(batched_, batched);
  bool good = true;
  std::string line;
  while (!quit_ && !stopped() && (good || keep_going_) && reader.next(line)) {
    const int number = reader.number();
    if (reader.take_dos()) {
      const std::string old_file = std::exchange(file_, reader.name());
      const int old_line = std::exchange(line_, number);
      error("Warning: File contains DOS-style line endings.");
      file_ = old_file;
      line_ = old_line;
    }
    good = run_line(line, reader.name(), number) && good;
  }
  // What waits now is followed by nothing; a stop that came meanwhile finds it not begun.
  if (stopped())
    waiting_.clear();
  else
    good = settle() && good;
  batched_ = old_batched;
  return good;
}

bool Commander::run_text(std::string_view text, const std::string& name) {
  Reader reader(text, name);
  return read_lines(reader, true);
}

bool Commander::run_file(const std::string& path) {
  if (path == "-") {
    Reader reader(stdin, "<stdin>");
    return read_lines(reader, false);
  }
  std::FILE* f = std::fopen(path.c_str(), "re");
  if (f == nullptr) {
    report("Could not open hal file '" + path + "': " + std::strerror(errno));
    return false;
  }
  struct stat st {};
  const bool regular = ::fstat(::fileno(f), &st) == 0 && S_ISREG(st.st_mode);
  Reader reader(f, path);
  const bool good = read_lines(reader, regular);
  std::fclose(f);
  return good;
}

bool Commander::run_line(std::string_view line, const std::string& file, int line_number) {
  const std::string old_file = std::exchange(file_, file);
  const int old_line = std::exchange(line_, line_number);
  const std::string bare = without_comment(line);
  if (echo_) sink_->err("(" + std::to_string(line_number) + ")<echo>: " + bare + "\n");
  const auto words_of = [&]() -> rtapi::Result<std::vector<std::string>> {
    KERF_TRY(const std::string text, substitute(bare, ini_));
    return split_words(text);
  };
  bool good = false;
  if (auto words = words_of(); words.ok()) {
    // A program is not to see the quotes; a command line's words have none of the script's.
    if (!words->empty() && words->front() == "loadusr")
      for (auto& word : *words) word = unquoted(word);
    good = run(std::move(*words));
  } else if (settle() || keep_going_) {
    report(words.error().message());
  }
  file_ = old_file;
  line_ = old_line;
  return good;
}

bool Commander::run_words(Words words) { return run({words.begin(), words.end()}); }

}  // namespace kerf::hal
