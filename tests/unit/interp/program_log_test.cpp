// [RS274NGC]LOG_LEVEL and LOG_FILE.
#include "interp/program_log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "interp/interpreter.hpp"
#include "interp/null_canon.hpp"

namespace kerf::interp {
namespace {

class Listening final : public Environment {
 public:
  std::string lines;
  void log(std::string_view line) override { lines.append(line).append("\n"); }
};

std::string logged(LogLevel level) {
  Listening world;
  NullCanon canon;
  Settings settings;
  settings.log_level = level;
  Interpreter interp(world, canon, settings);
  interp.init();
  EXPECT_TRUE(interp.open_text("a.ngc", "o1 sub\nG0 X1\no1 endsub\no1 call\nG1 X2\nM2\n").ok());
  Outcome o = Outcome::ok;
  while (o == Outcome::ok || o == Outcome::error) o = interp.execute_next();
  (void)interp.execute_mdi("G0 X3");
  return world.lines;
}

TEST(ProgramLog, EachLevelHasThoseBefore) {
  EXPECT_EQ(logged(LogLevel::nothing), "");
  const std::string errors = logged(LogLevel::errors);
  EXPECT_EQ(errors.substr(0, 13), "error: a.ngc:") << errors;
  EXPECT_NE(errors.find("Cannot do g1 with zero feed rate"), std::string::npos);
  const std::string calls = logged(LogLevel::calls);
  EXPECT_EQ(calls, "a.ngc: program begins\na.ngc:4: call of o1\n" + errors +
                       "a.ngc:6: program end\nMDI: G0 X3\n");
  const std::string blocks = logged(LogLevel::blocks);
  EXPECT_NE(blocks.find("\na.ngc:2: G0 X1\n"), std::string::npos) << blocks;
  EXPECT_NE(blocks.find("\na.ngc:6: M2\n"), std::string::npos) << blocks;
}

TEST(ProgramLog, IsAppendedToItsFile) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("kerf_log_" + std::to_string(::getpid()) + ".log"))
          .string();
  Settings settings;
  settings.log_file = path;
  for (const char* const line : {"one", "two"}) ProgramLog(settings).write(line);
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(), "one\ntwo\n");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace kerf::interp
