#include "clients/rsh/live_machine.hpp"

#include <cstdlib>
#include <filesystem>

#include "rtapi/clock/real_clock.hpp"

namespace kerf::rsh {

namespace fs = std::filesystem;

rtapi::Result<IniAnswers> IniAnswers::load(const std::string& path) {
  auto loaded = ini::IniFile::load(path);
  if (!loaded.ok) {
    std::string text;
    for (const auto& d : loaded.diagnostics)
      if (d.is_error) text += (text.empty() ? "" : "\n") + d.message();
    return rtapi::fail(rtapi::Errc::bad_argument, text.empty() ? path + ": not read" : text);
  }
  IniAnswers answers;
  answers.name_ = path;
  answers.file_ = std::move(loaded.file);
  return answers;
}

std::optional<std::string> IniAnswers::value(const std::string& section,
                                             const std::string& key) const {
  const ini::Entry* entry = file_.find(section, key);
  if (entry == nullptr) return std::nullopt;
  return entry->value;
}

std::optional<std::string> IniAnswers::find_program(const std::string& program,
                                                    const std::string& folder) const {
  std::error_code ignored;
  const auto absolute = [&ignored](const fs::path& path) {
    return fs::absolute(path, ignored).lexically_normal();
  };
  const fs::path ini_folder =
      absolute(name_.empty() ? fs::path(".") : fs::path(name_).parent_path());
  std::vector<fs::path> folders{fs::current_path(ignored), ini_folder};
  if (!folder.empty()) folders.push_back(absolute(folder));
  std::string prefix = value("DISPLAY", "PROGRAM_PREFIX").value_or("nc_files");
  if (const char* home = std::getenv("HOME"); home != nullptr && prefix.rfind("~/", 0) == 0)
    prefix = home + prefix.substr(1);
  folders.push_back(ini_folder / prefix);
  for (const fs::path& one : folders) {
    const fs::path path = one / program;  // an absolute program stands for itself
    if (fs::is_regular_file(path, ignored)) return path.lexically_normal().string();
  }
  return std::nullopt;
}

std::optional<task::Reply> LiveMachine::outcome(std::uint64_t id) {
  (void)client_->poll();
  return client_->outcome(id);
}

double LiveMachine::wall_time_s() const { return rtapi::wall_time_s(); }

}  // namespace kerf::rsh
