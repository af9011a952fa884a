// What the fuzzer has found worth keeping runs without a fault, whatever built it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "fuzz/interp/fuzz_program.hpp"

namespace kerf::interp {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ostringstream s;
  s << std::ifstream(path, std::ios::binary).rdbuf();
  return s.str();
}

TEST(Corpus, RunsWithoutFault) {
  int files = 0;
  for (const auto& entry :
       fs::directory_iterator(fs::path(KERF_SOURCE_DIR) / "tests/fuzz/interp/corpus")) {
    run_fuzzed(content(entry.path()));
    ++files;
  }
  EXPECT_GT(files, 100);
}

TEST(Corpus, GoldenProgramsRunInEachWay) {
  int files = 0;
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(KERF_SOURCE_DIR) / "tests/golden/interp")) {
    if (entry.path().extension() != ".ngc") continue;
    const std::string program = content(entry.path());
    for (int how = 0; how < 256; how += how < 32 ? 1 : 13)
      run_fuzzed(static_cast<char>(how) + program);
    ++files;
  }
  EXPECT_GT(files, 50);
}

}  // namespace
}  // namespace kerf::interp
