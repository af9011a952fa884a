// Golden canon output. A case is a directory FAMILY/NAME beside this file:
//   test.ngc        the program; run as `rs274 -g` does
//   expected        the canonical calls, and the error that ends it, if any
//   README          one line: what the case shows
//   tools.tbl, parameters.var, NAME.ngc   optional: tool table, parameters at the start, subs in files
// KERF_GOLDEN_WRITE=1 writes `expected` anew: read the difference before keeping it. compare_with_peer runs the same
// programs with LinuxCNC.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "interp/config/ini_settings.hpp"
#include "interp/interpreter.hpp"
#include "interp/parameters.hpp"
#include "interp/rs274/bench_environment.hpp"
#include "interp/text_canon.hpp"

namespace kerf::interp {
namespace {

namespace fs = std::filesystem;

const fs::path cases_folder = fs::path(KERF_SOURCE_DIR) / "tests/golden/interp";

std::string read(const fs::path& path) {
  std::ostringstream s;
  s << std::ifstream(path).rdbuf();
  return s.str();
}

/// config.ini, read as rs274 -i reads it.
Settings settings_of(const fs::path& dir, BenchEnvironment& world) {
  const Settings bench = bench_settings();
  const fs::path path = dir / "config.ini";
  if (!fs::exists(path)) return bench_settings();
  const auto loaded = ini::IniFile::load(path.string());
  EXPECT_TRUE(loaded.ok) << path;
  ini::Reader reader(loaded.file);
  InterpSetup setup = read_interp_setup(reader, bench.machine_unit_mm);
  for (const auto& c : reader.complaints()) EXPECT_FALSE(c.is_error) << c.message();
  world.add_directory(setup.paths.program_prefix);
  for (const std::string& folder : setup.paths.subroutine_path) world.add_directory(folder);
  setup.settings.machine_unit_mm = bench.machine_unit_mm;
  setup.settings.start_units = bench.start_units;
  setup.settings.axis_mask = bench.axis_mask;
  return setup.settings;
}

std::string interpret(const fs::path& dir) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* out = open_memstream(&text, &size);
  {
    BenchEnvironment world;
    world.add_directory(dir.string());
    const Settings settings = settings_of(dir, world);
    if (fs::exists(dir / "tools.tbl")) {
      EXPECT_TRUE(world.load_tools((dir / "tools.tbl").string(), settings.machine_unit_mm).ok());
    }
    TextCanon canon(out, settings.machine_unit_mm);
    Interpreter interp(world, canon, settings);
    if (fs::exists(dir / "parameters.var")) {
      EXPECT_TRUE(ParameterFile((dir / "parameters.var").string()).load(interp.parameters()).ok());
    }
    interp.init();
    EXPECT_TRUE(interp.open((dir / "test.ngc").string()).ok());
    canon.on_reset();
    for (int i = 0; i < 100000; ++i) {
      const Pose before = interp.modal().position;
      const Outcome o = interp.execute_next();
      if (o == Outcome::needs_sync) interp.synchronize(bench_answer(interp, before, canon));
      if (o == Outcome::error) {
        const InterpError& e = interp.error();
        std::fprintf(out, "error in line %d, column %d: %s\nhelp: %s\n", e.line, e.column,
                     e.text.c_str(), e.help.c_str());
      }
      if (o == Outcome::error || o == Outcome::program_end || o == Outcome::idle) break;
    }
  }
  std::fclose(out);
  std::string result(text, size);
  std::free(text);
  // Messages name files as they were opened; the folder of this checkout is nobody's business.
  const std::string here = dir.string() + "/";
  for (std::size_t at = 0; (at = result.find(here, at)) != std::string::npos;)
    result.erase(at, here.size());
  return result;
}

std::vector<std::string> cases() {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(cases_folder)) {
    if (entry.path().filename() == "test.ngc")
      names.push_back(fs::relative(entry.path().parent_path(), cases_folder).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class Golden : public ::testing::TestWithParam<std::string> {};

TEST_P(Golden, PrintsWhatWasReviewed) {
  const fs::path dir = cases_folder / GetParam();
  const std::string got = interpret(dir);
  if (std::getenv("KERF_GOLDEN_WRITE") != nullptr) std::ofstream(dir / "expected") << got;
  EXPECT_TRUE(fs::exists(dir / "README"));
  EXPECT_EQ(got, read(dir / "expected"));
}

INSTANTIATE_TEST_SUITE_P(Interp, Golden, ::testing::ValuesIn(cases()), [](const auto& row) {
  std::string name = row.param;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

}  // namespace
}  // namespace kerf::interp
