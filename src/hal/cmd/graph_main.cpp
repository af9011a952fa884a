// `halcmd graph`: options, and graphviz.
#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "hal/cmd/apart.hpp"
#include "hal/cmd/check.hpp"
#include "hal/cmd/front_doors.hpp"
#include "hal/cmd/graph.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/segment.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX has no header for it

namespace kerf::hal {

namespace {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Status;

Status write_file(const std::string& path, const std::string& text) {
  std::FILE* f = std::fopen(path.c_str(), "we");
  if (f == nullptr) return fail(Errc::system, path + ": " + std::strerror(errno));
  const bool written = std::fwrite(text.data(), 1, text.size(), f) == text.size();
  if (std::fclose(f) != 0 || !written) return fail(Errc::system, path + ": cannot be written");
  return {};
}

/// Runs `dot -Tformat -o path` on the text. not_found: there is no dot.
Status run_dot(const std::string& text, const std::string& format, const std::string& path) {
  const int in = ::memfd_create("graph.dot", MFD_CLOEXEC);
  if (in < 0 || ::write(in, text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      ::lseek(in, 0, SEEK_SET) != 0) {
    if (in >= 0) ::close(in);
    return fail(Errc::system,
                std::string("no memory for the picture's text: ") + std::strerror(errno));
  }
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, in, 0);
  std::string words[] = {"dot", "-T" + format, "-o", path};
  char* argv[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  pid_t pid = 0;
  const int why = ::posix_spawnp(&pid, "dot", &actions, nullptr, argv, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(in);
  if (why == ENOENT) return fail(Errc::not_found, "there is no program dot");
  if (why != 0) return fail(Errc::system, std::string("dot: ") + std::strerror(why));
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    return fail(Errc::system, "dot could not make " + path);
  return {};
}

Status write_picture(const std::string& text, const std::string& path) {
  const std::filesystem::path file(path);
  const std::string format = file.extension().empty() ? "" : file.extension().string().substr(1);
  if (format == "dot" || format == "gv") return write_file(path, text);
  if (format != "svg" && format != "png" && format != "pdf")
    return fail(Errc::bad_argument, path + ": the file's ending must be svg, png, pdf or dot");
  auto done = run_dot(text, format, path);
  if (done.ok() || done.error().code != Errc::not_found) return done;
  const std::string dot_path = std::filesystem::path(file).replace_extension(".dot").string();
  KERF_CHECK(write_file(dot_path, text));
  return fail(Errc::not_found, "the program dot is missing: install Debian's package graphviz; " +
                                   dot_path + " is written, `dot -T" + format + " -o " + path +
                                   " " + dot_path + "` makes the picture of it");
}

rtapi::Result<std::string> of_running_hal(const GraphOptions& options) {
  KERF_TRY(const auto segment, rtapi::Segment::attach(rtapi::default_instance()));
  const View view(*segment);
  if (!view.attached()) return fail(Errc::not_found, "HAL is not running; --from draws HAL files");
  return graph_dot(view, options);
}

/// As far as the files are right; what is wrong with them goes to stderr.
std::string of_files(const GraphOptions& options, const std::vector<std::string>& files,
                     const ini::IniFile* ini) {
  return do_apart_without_broken([&](ModuleSource& modules) {
    ScriptCheck check(modules, ini);
    if (files.empty()) check.run_ini_files();
    for (const auto& file : files) check.run_file(file);
    for (const auto& finding : check.finish())
      if (finding.level == Finding::Level::error)
        std::fprintf(stderr, "%s\n", finding.text_line().c_str());
    std::vector<StrangePin> strangers;
    for (const auto& pin : check.trace().unchecked)
      strangers.push_back({pin.name, pin.signal, pin.dir});
    return graph_dot(check.view(), options, strangers);
  });
}

}  // namespace

int graph_main(std::span<const std::string> words) {
  CLI::App app{"Draws HAL: boxes with pins, signals between them, threads by colour.",
               "halcmd graph"};
  GraphOptions options;
  std::vector<std::string> files;
  std::string out_path, ini_path;
  app.add_option("PATTERN", options.patterns, "what to draw, with all that is linked to it");
  app.add_option("-o", out_path,
                 "picture: FILE.svg, .png, .pdf or .dot; without, dot text to stdout");
  app.add_option("--from", files, "draw this HAL file, not the running HAL")
      ->allow_extra_args(false);
  app.add_option("-i", ini_path, "INI file for --from; alone, the HAL files it names");
  app.add_flag("--values", options.values, "write values at pins and signals");
  app.add_flag("--all-pins", options.all_pins, "pins that are not linked too");
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1));
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  rtapi::Result<std::string> text = std::string();
  if (files.empty() && ini_path.empty()) {
    text = of_running_hal(options);
  } else {
    const std::string here = std::filesystem::current_path().string();
    ini::LoadResult ini;
    if (!ini_path.empty() && !load_machine_ini(ini_path, files.empty(), ini)) return 1;
    text = of_files(options, files, ini_path.empty() ? nullptr : &ini.file);
    std::error_code error;
    std::filesystem::current_path(here, error);
  }
  if (!text.ok()) {
    rtapi::log_error(text.error());
    return 1;
  }
  if (out_path.empty()) {
    std::fputs(text->c_str(), stdout);
    return 0;
  }
  if (const auto done = write_picture(*text, out_path); !done.ok()) {
    rtapi::log_error(done.error());
    return done.error().code == Errc::bad_argument ? 2 : 1;
  }
  return 0;
}

}  // namespace kerf::hal
