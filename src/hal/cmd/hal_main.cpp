// hal: what can be asked of HAL without running it.
#include <cstdio>
#include <string>
#include <vector>

#include "hal/cmd/front_doors.hpp"
#include "rtapi/base/suggest.hpp"
#include "rtapi/log/log.hpp"

namespace {

using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file

struct Row {
  const char* name;
  int (*run)(std::span<const std::string> words);
  const char* help;
};
constexpr Row kRows[] = {
    {"check", &hal::check_main, "find what is wrong with HAL files"},
    {"describe", &hal::describe_main, "print the manual page of a component"},
    {"graph", &hal::graph_main, "draw the running HAL, or HAL files"},
};

void print_help() {
  std::puts("Usage: hal COMMAND [OPTIONS] [ARGUMENT ...]\n");
  for (const Row& row : kRows) std::printf("  %-10s %s\n", row.name, row.help);
  std::puts(
      "\n  -h, --help  this text; after a command, that command's\n"
      "  hal describe takes --text, --man, --markdown or --json, and --all\n\n"
      "halcmd commands the HAL of a running machine.");
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::set_program_name("hal");
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty() || words[0] == "-h" || words[0] == "--help") {
    print_help();
    return words.empty() ? 2 : 0;
  }
  std::vector<std::string> known;
  for (const Row& row : kRows) {
    if (words[0] == row.name) return row.run(words);
    known.emplace_back(row.name);
  }
  std::fprintf(stderr, "hal: unknown command '%s'%s\n", words[0].c_str(),
               rtapi::did_you_mean(words[0], known).c_str());
  return 2;
}
