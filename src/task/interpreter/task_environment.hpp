// TaskEnvironment: what the interpreter asks of the real machine.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "ini/ini_file.hpp"
#include "interp/environment.hpp"
#include "interp/program_log.hpp"
#include "io/tool_store.hpp"
#include "task/machine_config.hpp"

namespace kerf::task {

/// Reads a HAL pin, signal or parameter as a number; nullopt: no such name.
using HalReader = std::function<std::optional<double>(std::string_view)>;

class TaskEnvironment final : public interp::Environment {
 public:
  TaskEnvironment(const MachineSetup& setup, const ini::IniFile& ini, io::ToolStore& tools,
                  HalReader hal)
      : setup_(setup), ini_(ini), tools_(tools), hal_(std::move(hal)), log_(setup.interp) {}

  void set_scripts(interp::ScriptHost* scripts) { scripts_ = scripts; }
  /// Sets *seen at each read of a HAL value from now on; null: no more.
  void note_hal_reads(bool* seen) { hal_read_ = seen; }
  interp::ScriptHost* scripts() override { return scripts_; }
  std::optional<interp::Tool> find_tool(int number) override;
  std::optional<interp::Tool> find_pocket(int pocket) override;
  std::string find_sub(std::string_view name) override;
  interp::UserMcode find_user_mcode(int number) override;
  void warning(std::string_view text) override;
  void log(std::string_view line) override { log_.write(line); }
  std::optional<double> hal_value(std::string_view name) override;
  std::optional<double> ini_value(std::string_view section, std::string_view key) override;

  /// Full path of a program as the operator named it: as it is, then in PROGRAM_PREFIX.
  [[nodiscard]] std::string find_program(const std::string& name) const;

 private:
  const MachineSetup& setup_;
  const ini::IniFile& ini_;
  io::ToolStore& tools_;
  HalReader hal_;
  interp::ProgramLog log_;
  interp::ScriptHost* scripts_{nullptr};
  bool* hal_read_{nullptr};
};

/// User M-codes, as run by task: P and Q are their two arguments ("%f", -1.000000 when absent). Their environment has besides
/// ours: KERF_INSTANCE, KERF_FILE and KERF_LINE of the block, KERF_STATE ("auto" or "mdi"), and KERF_X ... KERF_W, the position in
/// the work coordinate system in machine units. Exit status 0 goes on, any other stops the program.
///
/// Looks for the program of a user M-code: PROGRAM_PREFIX, USER_M_PATH, SUBROUTINE_PATH, each time anew, so that a program
/// that is added while the machine runs is found. `cause` names which of the documented causes it is.
[[nodiscard]] interp::UserMcode find_user_mcode(const ProgramPaths& paths, int number);

}  // namespace kerf::task
