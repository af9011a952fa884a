// rs274: interprets a G-code file and prints the canonical calls. Options as the peer's (rs274 -x lists them).
#include <getopt.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "ini/ini_file.hpp"
#include "interp/config/ini_settings.hpp"
#include "interp/config/script_library.hpp"
#include "interp/interpreter.hpp"
#include "interp/parameters.hpp"
#include "interp/rs274/bench_environment.hpp"
#include "interp/rs274/options.hpp"
#include "interp/text_canon.hpp"

namespace {

using namespace kerf::
    interp;  // NOLINT(google-build-using-namespace): the whole program is about it

/// Bytes of text that are written at once.
constexpr std::size_t kOutputBuffer = std::size_t{128} * 1024;

constexpr const char* kUsage =
    "Usage: rs274 [-p interp.so] [-t tool.tbl] [-v var-file.var] [-n 0|1|2]\n"
    "          [-b] [-s] [-g] [input file [output file]]\n"
    "\n"
    "    -p: accepted for old scripts and ignored\n"
    "    -t: Specify the .tbl (tool table) file to use\n"
    "    -v: Specify the .var (parameter) file to use\n"
    "    -n: Specify the continue mode:\n"
    "           0: continue\n"
    "           1: enter MDI mode\n"
    "           2: stop (default)\n"
    "    -b: Toggle the 'block delete' flag (default: OFF)\n"
    "    -s: Toggle the 'print stack' flag (default: OFF)\n"
    "    -g: Toggle the 'go (batch mode)' flag (default: OFF)\n"
    "    -i: specify the INI file (default: no INI file)\n"
    "    -T: call task_init()\n"
    "    -l: specify the log_level (default: -1)\n"
    "    -h, --help: print this and end\n";

std::optional<Rs274Options> read_options(int argc, char** argv) {
  Rs274Options o;
  opterr = 0;
  const option long_options[] = {{"help", no_argument, nullptr, 'h'}, {}};
  for (int c = 0;
       (c = getopt_long(argc, argv, "p:t:v:n:bsgi:Tl:h", long_options, nullptr)) != -1;) {
    switch (c) {
      case 'h': std::fputs(kUsage, stdout); std::exit(0);
      case 't': o.tools = optarg; break;
      case 'v': o.parameters = optarg; break;
      case 'n':
        o.on_error = std::strcmp(optarg, "0") == 0   ? OnError::go_on
                     : std::strcmp(optarg, "1") == 0 ? OnError::mdi
                                                     : OnError::stop;
        break;
      case 'b': o.block_delete = !o.block_delete; break;
      case 's': o.stack = !o.stack; break;
      case 'g': o.batch = !o.batch; break;
      case 'i': o.ini = optarg; break;
      case 'p':
      case 'T': break;
      case 'l': o.log_level = static_cast<int>(std::strtol(optarg, nullptr, 10)); break;
      default:
        std::fprintf(stderr, "rs274: invalid option -- '%c'\n%s", optopt, kUsage);
        return std::nullopt;
    }
  }
  if (optind < argc) o.input = argv[optind];
  if (optind + 1 < argc) o.output = argv[optind + 1];
  return o;
}

/// What -i says.
class IniSession {
 public:
  /// False: the file cannot be used; it has been said why.
  [[nodiscard]] bool load(const std::string& path) {
    auto loaded = kerf::ini::IniFile::load(path);
    for (const auto& d : loaded.diagnostics) std::fprintf(stderr, "%s\n", d.message().c_str());
    if (!loaded.ok) return false;
    file_ = std::move(loaded.file);
    kerf::ini::Reader reader(*file_);
    setup_ = read_interp_setup(reader, bench_settings().machine_unit_mm);
    setup_.settings.spindles = static_cast<int>(reader.integer("TRAJ", "SPINDLES"));
    for (const auto& d : reader.complaints()) std::fprintf(stderr, "%s\n", d.message().c_str());
    if (reader.failed()) return false;
    auto scripts = open_scripts(setup_.python, {});
    if (!scripts.ok()) std::fprintf(stderr, "%s\n", scripts.error().message().c_str());
    if (scripts.ok()) scripts_ = std::move(*scripts);
    return scripts.ok();
  }
  /// Units and axes are those of rs274 whatever the file says, as at the peer.
  [[nodiscard]] Settings settings(const Rs274Options& options) const {
    const Settings bench = bench_settings();
    Settings s = file_ ? setup_.settings : bench;
    if (options.log_level) s.log_level = static_cast<LogLevel>(*options.log_level);
    s.machine_unit_mm = bench.machine_unit_mm;
    s.start_units = bench.start_units;
    s.axis_mask = bench.axis_mask;
    return s;
  }
  [[nodiscard]] BenchEnvironment environment() const {
    BenchEnvironment environment;
    if (!file_) return environment;
    environment.set_scripts(scripts_.get());
    environment.add_directory(setup_.paths.program_prefix);
    for (const std::string& path : setup_.paths.subroutine_path) environment.add_directory(path);
    if (!setup_.paths.wizard_root.empty()) environment.add_directory(setup_.paths.wizard_root);
    environment.set_ini([this](std::string_view section, std::string_view key) {
      const auto value = kerf::ini::get_real(*file_, section, key);
      return value.found && value.ok() ? std::optional<double>(value.value) : std::nullopt;
    });
    return environment;
  }

 private:
  std::optional<kerf::ini::IniFile> file_;
  InterpSetup setup_;
  std::unique_ptr<ScriptHost> scripts_;
};

class Session {
 public:
  Session(const Rs274Options& options, const IniSession& ini, std::FILE* out)
      : options_(options),
        out_(out),
        env_(ini.environment()),
        canon_(out, ini.settings(options).machine_unit_mm),
        interp_(env_, canon_, ini.settings(options)) {
    env_.set_log(ini.settings(options));
  }

  int run() {
    env_.add_directory("");
    const std::size_t slash = options_.input.rfind('/');
    if (slash != std::string::npos) env_.add_directory(options_.input.substr(0, slash));
    if (!options_.tools.empty()) {
      if (const auto s = env_.load_tools(options_.tools, bench_settings().machine_unit_mm); !s.ok())
        return problem(s.error().message());
    }
    if (!options_.parameters.empty()) {
      const auto s = ParameterFile(options_.parameters).load(interp_.parameters());
      if (!s.ok() && s.error().code != kerf::rtapi::Errc::not_found)
        return problem(s.error().message());
      if (!s.ok())
        std::fprintf(stderr, "%s is not there yet; it is written at the end\n",
                     options_.parameters.c_str());
    }
    interp_.set_block_delete(options_.block_delete);
    std::fputs("executing\n", stderr);
    interp_.init();
    if (options_.input.empty()) return finish(mdi());
    if (const auto s = interp_.open(options_.input); !s.ok()) {
      std::fflush(out_);
      return problem(std::string(s.error().what.view()));
    }
    canon_.on_reset();
    return finish(program());
  }

 private:
  static int problem(const std::string& text) {
    std::fprintf(stderr, "%s\n", text.c_str());
    return 1;
  }

  int finish(int result) {
    // As the peer: once for the interpreter's end, and once for the file's.
    if (!options_.input.empty() && options_.ini.empty()) canon_.on_reset();
    canon_.on_reset();
    if (!options_.parameters.empty()) {
      if (const auto s = ParameterFile(options_.parameters).save(interp_.parameters()); !s.ok())
        return problem(s.error().message());
    }
    return result;
  }

  void show_error() {
    std::fflush(out_);
    const InterpError& e = interp_.error();
    std::fprintf(stderr, "%s\n%s\n", e.text.c_str(), e.source.c_str());
    if (const std::string caret = e.caret(); !caret.empty())
      std::fprintf(stderr, "%s\n", caret.c_str());
    if (e.line > 0) {
      std::fprintf(stderr, "%s:%d", e.file.empty() ? "MDI" : e.file.c_str(), e.line);
      if (e.column > 0) std::fprintf(stderr, ":%d", e.column);
      std::fprintf(stderr, ": %s\n", e.help.empty() ? "this line has no effect" : e.help.c_str());
    }
    if (options_.stack) std::fprintf(stderr, "call level %d\n", e.call_level);
  }

  void synchronize(const Pose& before) {
    interp_.synchronize(bench_answer(interp_, before, canon_));
  }

  int program() {
    // Whoever reads the calls gets the first at once, and waits for none for longer than so many lines take.
    constexpr unsigned kBlocksPerFlush = 16384;
    for (unsigned blocks = 0;; ++blocks) {
      if (blocks % kBlocksPerFlush == 0) std::fflush(out_);
      const Pose before = interp_.modal().position;
      switch (interp_.execute_next()) {
        case Outcome::ok: break;
        case Outcome::needs_sync: synchronize(before); break;
        case Outcome::program_end:
        case Outcome::needs_line:
        case Outcome::idle: return 0;
        case Outcome::error:
          show_error();
          if (interp_.error().source.empty()) return 1;  // no line to go on behind
          if (options_.on_error == OnError::stop) return 1;
          if (options_.on_error == OnError::mdi) {
            std::fputs("starting MDI\n", stderr);
            mdi();
            std::fputs("continue program? y/n =>", stderr);
            const int answer = std::getchar();
            if (answer != 'y' && answer != 'Y') return 1;
          }
          break;
      }
    }
  }

  int mdi() {
    std::string line;
    const bool terminal = isatty(STDIN_FILENO) != 0;
    for (;;) {
      if (terminal) std::fputs("READ => ", stderr);
      if (!std::getline(std::cin, line)) return 0;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line == "quit") return 0;
      Pose before = interp_.modal().position;
      Outcome o = interp_.execute_mdi(line);
      while (o == Outcome::ok || o == Outcome::needs_sync) {
        if (o == Outcome::needs_sync) synchronize(before);
        before = interp_.modal().position;
        o = interp_.execute_next();
        if (!interp_.mdi_active()) break;
      }
      if (o == Outcome::error) show_error();
      std::fflush(out_);
    }
  }

  const Rs274Options& options_;
  std::FILE* out_;
  BenchEnvironment env_;
  TextCanon canon_;
  Interpreter interp_;
};

}  // namespace

int main(int argc, char** argv) {
  auto options = read_options(argc, argv);
  if (!options) return 1;
  if (!options->batch && !run_menu(*options, stdin, stderr)) return 1;
  IniSession ini;
  if (!options->ini.empty() && !ini.load(options->ini)) return 1;
  std::FILE* out = stdout;
  if (!options->output.empty()) {
    out = std::fopen(options->output.c_str(), "we");
    if (out == nullptr) {
      std::fprintf(stderr, "Unable to open file <%s>\n", options->output.c_str());
      return 1;
    }
  }
  // Calls come by the million; a terminal sees each line, a file or a pipe whole batches. What is written so far goes out before
  // an error is shown.
  std::vector<char> buffer(kOutputBuffer);
  if (isatty(fileno(out)) == 0) std::setvbuf(out, buffer.data(), _IOFBF, buffer.size());
  int result = 0;
  {
    Session session(*options, ini, out);
    result = session.run();
  }
  if (std::fflush(out) != 0) result = 1;
  if (out == stdout)
    std::setvbuf(out, nullptr, _IONBF, 0);  // the buffer ends before the program does
  else if (std::fclose(out) != 0)
    result = 1;
  return result;
}
