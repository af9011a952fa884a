// `hal describe`: options.
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "hal/cmd/describe.hpp"
#include "hal/cmd/front_doors.hpp"
#include "rtapi/log/log.hpp"

namespace kerf::hal {

namespace {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

struct Form {
  const char* option;
  const char* help;
  const char* ending;
  std::string (*text)(const Declaration&);
};
constexpr Form kForms[] = {
    {"--man", "as a manual page for `man -l`", ".9", man_page},
    {"--markdown", "as Markdown", ".md", markdown_page},
    {"--json", "as JSON", ".json", declaration_json},
    {"--text", "as plain text; this is the default", ".txt", text_page},
};

Status write_file(const std::string& path, const std::string& text) {
  std::FILE* f = std::fopen(path.c_str(), "we");
  if (f == nullptr) return fail(Errc::system, path + ": " + std::strerror(errno));
  const bool written = std::fwrite(text.data(), 1, text.size(), f) == text.size();
  if (std::fclose(f) != 0 || !written) return fail(Errc::system, path + ": cannot be written");
  return {};
}

/// A component, and the words that loadrt would have behind it.
struct Wanted {
  std::string name;
  std::vector<std::string> words;
};

/// A module that takes longer to be made does not come back.
constexpr int kPatienceMs = 20000;

/// All that comes through the pipe. busy: nothing came for too long.
Result<std::string> read_all(int pipe) {
  std::string text;
  std::array<char, 4096> piece{};
  for (;;) {
    pollfd wanted{pipe, POLLIN, 0};
    const int ready = ::poll(&wanted, 1, kPatienceMs);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return fail(Errc::busy, "nothing came");
    const ssize_t got = ::read(pipe, piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(piece.data(), static_cast<std::size_t>(got));
  }
}

bool write_all(int pipe, std::string_view text) {
  while (!text.empty()) {
    const ssize_t put = ::write(pipe, text.data(), text.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

/// The page, made in a process of its own: to be described, a component is made, and its code may crash or never return.
Result<std::string> page_of(Describer& describer, const Wanted& wanted, const Form& form) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    return fail(Errc::system, std::string("pipe: ") + std::strerror(errno));
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) return fail(Errc::system, std::string("fork: ") + std::strerror(errno));
  if (child == 0) {
    ::close(ends[0]);
    const auto made = describer.describe(wanted.name, wanted.words);
    // The first letter tells a page from an error.
    const std::string text =
        made.ok() ? "+" + form.text(*made) : "-" + std::string(made.error().message());
    const bool whole = write_all(ends[1], text);
    std::fflush(nullptr);
    ::_exit(whole ? 0 : 1);
  }
  ::close(ends[1]);
  auto text = read_all(ends[0]);
  ::close(ends[0]);
  if (!text.ok()) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const std::string begin = wanted.name + ": its code ";
  if (!text.ok())
    return fail(Errc::busy, begin + "does not return from being made: it was ended after " +
                                std::to_string(kPatienceMs / 1000) + " s");
  if (WIFSIGNALED(status))
    return fail(Errc::system, begin + "crashed while the component was made: signal " +
                                  std::to_string(WTERMSIG(status)) + " (" +
                                  ::strsignal(WTERMSIG(status)) + ")");
  if (text->empty())
    return fail(Errc::system, begin + "ended the program while the component was made, status " +
                                  std::to_string(WEXITSTATUS(status)));
  if (text->front() == '-') return fail(Errc::bad_argument, text->substr(1));
  return text->substr(1);
}

Status write_pages(const std::vector<std::string>& names, const Form& form,
                   const std::string& folder) {
  DlopenSource modules;
  if (!folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return fail(Errc::system, folder + ": " + error.message());
  }
  Describer describer(modules);
  std::vector<Wanted> wanted;
  for (const auto& word : names.empty() ? modules.names() : names) {
    if (word.find('=') == std::string::npos)
      wanted.push_back({word, {}});
    else if (!wanted.empty())
      wanted.back().words.push_back(word);
    else
      return fail(Errc::bad_argument, word + ": a component comes before its parameters");
  }
  for (const auto& one : wanted) {
    const auto page = page_of(describer, one, form);
    if (!page.ok() && names.empty()) {
      rtapi::log_error(page.error());
      continue;
    }
    if (!page.ok()) return rtapi::Failure{page.error()};
    if (folder.empty())
      std::fputs(page->c_str(), stdout);
    else
      KERF_CHECK(
          write_file(std::string(folder).append("/").append(one.name).append(form.ending), *page));
  }
  return {};
}

}  // namespace

int describe_main(std::span<const std::string> words) {
  CLI::App app{"Prints the manual page of components, made from their own declarations.",
               "hal describe"};
  std::vector<std::string> names;
  std::string folder;
  bool all = false;
  bool chosen[std::size(kForms)]{};
  app.add_option("COMPONENT", names,
                 "as loadrt takes it; one written in C may have its parameters behind it");
  app.add_flag("--all", all, "every component there is");
  app.add_option("-o", folder, "write a file for each into this folder");
  for (std::size_t i = 0; i < std::size(kForms); ++i)
    app.add_flag(kForms[i].option, chosen[i], kForms[i].help);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1));
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  if (names.empty() == !all) {
    std::fputs("hal describe: name components, or --all\n", stderr);
    return 2;
  }
  const Form* form = &kForms[std::size(kForms) - 1];
  for (std::size_t i = std::size(kForms); i-- > 0;)
    if (chosen[i]) form = &kForms[i];
  if (const auto done = write_pages(names, *form, folder); !done.ok()) {
    rtapi::log_error(done.error());
    return 1;
  }
  return 0;
}

}  // namespace kerf::hal
