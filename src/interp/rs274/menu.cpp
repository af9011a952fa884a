#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "interp/rs274/options.hpp"

namespace kerf::interp {

namespace {

class Menu {
 public:
  Menu(Rs274Options& options, std::FILE* in, std::FILE* ask)
      : options_(options), in_(in), ask_(ask) {}

  bool run() {
    for (;;) {
      std::fprintf(ask_,
                   "enter a number:\n1 = start interpreting\n2 = choose parameter file ...\n"
                   "3 = read tool file ...\n4 = turn block delete switch %s\n"
                   "5 = adjust error handling...\nenter choice => ",
                   options_.block_delete ? "OFF" : "ON");
      const auto choice = answer();
      if (!choice || *choice == "1") return true;
      if (*choice == "2" && !choose_file("parameter", options_.parameters)) return false;
      if (*choice == "3" && !choose_file("tool", options_.tools)) return false;
      if (*choice == "4") options_.block_delete = !options_.block_delete;
      if (*choice == "5" && !error_handling()) return true;
    }
  }

 private:
  /// Nothing when the input has ended.
  std::optional<std::string> answer() {
    std::array<char, 1024> line{};
    std::fflush(ask_);
    if (std::fgets(line.data(), line.size(), in_) == nullptr) return std::nullopt;
    line[std::strcspn(line.data(), "\r\n")] = '\0';
    return std::string(line.data());
  }

  bool choose_file(const char* kind, std::string& path) {
    std::fprintf(ask_, "name of %s file => ", kind);
    path = answer().value_or("");
    if (::access(path.c_str(), R_OK) == 0) return true;
    std::fprintf(ask_, "Cannot open %s\n", path.c_str());
    return false;
  }

  /// False when the input has ended.
  bool error_handling() {
    for (;;) {
      std::fprintf(ask_,
                   "enter a number:\n1 = done with error handling\n2 = %sprint stack on error\n",
                   options_.stack ? "do not " : "");
      if (!options_.input.empty()) {
        std::fprintf(ask_, "3 = %s\n",
                     options_.on_error == OnError::stop ? "continue on error (do not stop or mdi)"
                     : options_.on_error == OnError::go_on
                         ? "mdi on error (do not continue or stop)"
                         : "stop on error (do not continue or mdi)");
      }
      std::fputs("enter choice => ", ask_);
      const auto choice = answer();
      if (!choice) return false;
      if (*choice == "1") return true;
      if (*choice == "2") options_.stack = !options_.stack;
      if (*choice == "3" && !options_.input.empty()) {
        options_.on_error = options_.on_error == OnError::stop    ? OnError::go_on
                            : options_.on_error == OnError::go_on ? OnError::mdi
                                                                  : OnError::stop;
      }
    }
  }

  Rs274Options& options_;
  std::FILE *in_, *ask_;
};

}  // namespace

bool run_menu(Rs274Options& options, std::FILE* in, std::FILE* ask) {
  return Menu(options, in, ask).run();
}

}  // namespace kerf::interp
