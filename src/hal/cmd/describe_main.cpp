// `hal describe`: options.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "hal/cmd/apart.hpp"
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

/// The page, made in a process of its own: to be described, a component is made.
Result<std::string> page_of(Describer& describer, const Wanted& wanted, const Form& form) {
  auto done = do_apart([&](const Tell& tell) {
    tell(wanted.name);
    const auto made = describer.describe(wanted.name, wanted.words);
    // The first letter tells a page from an error.
    return made.ok() ? "+" + form.text(*made) : "-" + std::string(made.error().message());
  });
  if (!done.text) return fail(Errc::system, wanted.name + ": " + done.why);
  if (done.text->front() == '-') return fail(Errc::bad_argument, done.text->substr(1));
  return done.text->substr(1);
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
