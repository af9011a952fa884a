#include "task/interpreter/task_environment.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "ini/convert.hpp"

namespace kerf::task {
namespace {

namespace fs = std::filesystem;

interp::Tool to_tool(const io::ToolEntry& entry) {
  interp::Tool tool;
  tool.number = entry.number;
  tool.pocket = entry.pocket;
  tool.offset = entry.offset;
  tool.diameter_mm = entry.diameter_mm;
  tool.front_angle_deg = entry.front_angle_deg;
  tool.back_angle_deg = entry.back_angle_deg;
  tool.orientation = entry.orientation;
  return tool;
}

bool is_file(const std::string& path) {
  struct stat s {};
  return ::stat(path.c_str(), &s) == 0 && S_ISREG(s.st_mode);
}

std::vector<std::string> mcode_folders(const ProgramPaths& paths) {
  std::vector<std::string> out{paths.program_prefix};
  out.insert(out.end(), paths.user_m_path.begin(), paths.user_m_path.end());
  out.insert(out.end(), paths.subroutine_path.begin(), paths.subroutine_path.end());
  return out;
}

/// Why a folder has no usable program of that name, or "".
std::string near_miss(const std::string& folder, const std::string& name) {
  std::string lower = name;
  lower[0] = 'm';
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(folder, ec)) {
    const std::string file = entry.path().filename().string();
    if (file == name && entry.is_directory(ec)) return entry.path().string() + " is a directory";
    if (file == name && !fs::exists(entry.path(), ec))
      return entry.path().string() + " is a link that leads nowhere";
    if (file == lower)
      return entry.path().string() + " begins with a lower case m: it must be named " + name;
    if (file.size() > name.size() && file.compare(0, name.size(), name) == 0 &&
        file[name.size()] == '.')
      return entry.path().string() + " has an extension: it must be named " + name;
  }
  return {};
}

}  // namespace

interp::UserMcode find_user_mcode(const ProgramPaths& paths, int number) {
  const std::string name = "M" + std::to_string(number);
  if (number < 100 || number > 199) return {{}, name + " is not M100 to M199"};
  const auto folders = mcode_folders(paths);
  std::string cause;
  for (const auto& folder : folders) {
    const std::string path = folder + "/" + name;
    if (!is_file(path)) {
      if (cause.empty()) cause = near_miss(folder, name);
      continue;
    }
    if (::access(path.c_str(), X_OK) == 0) return {path, {}};
    if (cause.empty()) cause = path + " is not an executable file (chmod +x)";
  }
  if (cause.empty()) {
    cause = name + " does not exist in";
    for (const auto& folder : folders) cause += " " + folder;
  }
  return {{}, cause};
}

std::optional<interp::Tool> TaskEnvironment::find_tool(int number) {
  const auto table = tools_.table();
  const io::ToolEntry* entry = table->find(number);
  if (entry == nullptr) return std::nullopt;
  return to_tool(*entry);
}

std::optional<interp::Tool> TaskEnvironment::find_pocket(int pocket) {
  const auto table = tools_.table();
  const io::ToolEntry* entry = table->find_pocket(pocket);
  if (entry == nullptr) return std::nullopt;
  return to_tool(*entry);
}

std::string TaskEnvironment::find_sub(std::string_view name) {
  return interp::find_sub_file(setup_.paths, name);
}

interp::UserMcode TaskEnvironment::find_user_mcode(int number) {
  return task::find_user_mcode(setup_.paths, number);
}

// Standard error is what LinuxCNC's terminal shows.
void TaskEnvironment::warning(std::string_view text) {
  std::fprintf(stderr, "%.*s\n", static_cast<int>(text.size()), text.data());
}

std::optional<double> TaskEnvironment::hal_value(std::string_view name) {
  if (hal_read_ != nullptr) *hal_read_ = true;
  return hal_ ? hal_(name) : std::nullopt;
}

std::optional<double> TaskEnvironment::ini_value(std::string_view section, std::string_view key) {
  const ini::Entry* entry = ini_.find(section, key);
  if (entry == nullptr) return std::nullopt;
  const auto number = ini::to_real(entry->value);
  if (!number.valid) return std::nullopt;
  return number.value;
}

std::string TaskEnvironment::find_program(const std::string& name) const {
  if (name.empty() || name[0] == '/') return name;
  const std::string in_prefix = setup_.paths.program_prefix + "/" + name;
  if (is_file(in_prefix)) return in_prefix;
  std::error_code ec;
  const auto here = fs::absolute(name, ec);
  return ec ? name : here.string();
}

}  // namespace kerf::task
