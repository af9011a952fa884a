// `halcmd check`: options, and findings as text or JSON.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "hal/cmd/apart.hpp"
#include "hal/cmd/check.hpp"
#include "hal/cmd/front_doors.hpp"

namespace kerf::hal {

namespace {

using Json = nlohmann::ordered_json;

std::size_t count(const std::vector<Finding>& findings, Finding::Level level) {
  return static_cast<std::size_t>(std::count_if(
      findings.begin(), findings.end(), [level](const Finding& f) { return f.level == level; }));
}

std::string counted(std::size_t n, const char* one) {
  return std::to_string(n) + " " + one + (n == 1 ? "" : "s");
}

std::string text_of(const std::vector<Finding>& findings, bool quiet) {
  std::string text;
  for (const auto& f : findings) {
    if (quiet && f.level == Finding::Level::note) continue;
    text += f.text_line() + "\n";
  }
  return text + counted(count(findings, Finding::Level::error), "error") + ", " +
         counted(count(findings, Finding::Level::warning), "warning") + ", " +
         counted(count(findings, Finding::Level::note), "note") + "\n";
}

}  // namespace

std::string check_json(const ScriptCheck& check, const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const auto& f : findings) {
    Json one;
    one["level"] = level_name(f.level);
    one["kind"] = f.kind;
    one["file"] = f.at.file;
    one["line"] = f.at.line;
    one["text"] = f.text;
    list.push_back(std::move(one));
  }
  Json unchecked = Json::array();
  for (const auto& pin : check.trace().unchecked) unchecked.push_back(pin.name);
  Json out;
  out["files"] = check.files();
  out["errors"] = count(findings, Finding::Level::error);
  out["warnings"] = count(findings, Finding::Level::warning);
  out["notes"] = count(findings, Finding::Level::note);
  out["findings"] = std::move(list);
  out["unchecked"] = std::move(unchecked);
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

bool load_machine_ini(const std::string& path, bool enter_folder, ini::LoadResult& ini) {
  const auto whole = std::filesystem::absolute(path);
  ini = ini::IniFile::load(path);
  for (const auto& d : ini.diagnostics) std::fprintf(stderr, "%s\n", d.message().c_str());
  if (!ini.ok) return false;
  // As on the machine, where everything starts in the INI's folder.
  ::setenv("CONFIG_DIR", whole.parent_path().c_str(), 1);
  ::setenv("INI_FILE_NAME", whole.c_str(), 1);
  std::error_code error;
  if (enter_folder) std::filesystem::current_path(whole.parent_path(), error);
  return true;
}

int check_main(std::span<const std::string> words) {
  CLI::App app{
      "Checks HAL files without a running HAL: unknown names, types, writers, what never runs.",
      "halcmd check"};
  std::vector<std::string> files;
  std::string ini_path;
  bool json = false, quiet = false;
  app.add_option("FILE", files, "HAL files, carried out one after the other");
  app.add_option("-i", ini_path,
                 "INI file with the values of [SECTION]KEY; without FILE, the HAL files it names");
  app.add_flag("--json", json, "print the findings as JSON");
  app.add_flag("-q", quiet, "print no notes");
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1));
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  // An INI file is no HAL file, so there is no doubt what is meant.
  if (ini_path.empty() && files.size() == 1 && files[0].ends_with(".ini")) {
    ini_path = files[0];
    files.clear();
  }
  if (files.empty() && ini_path.empty()) {
    std::fputs("halcmd check: name a HAL file, or an INI file with -i\n", stderr);
    return 2;
  }
  ini::LoadResult ini;
  if (!ini_path.empty()) {
    if (!load_machine_ini(ini_path, files.empty(), ini)) return 1;
  }
  // The exit status, and what is to be printed.
  const std::string done = do_apart_without_broken([&](ModuleSource& modules) {
    ScriptCheck check(modules, ini_path.empty() ? nullptr : &ini.file);
    if (files.empty()) check.run_ini_files();
    for (const auto& file : files) check.run_file(file);
    const auto findings = check.finish();
    return (count(findings, Finding::Level::error) == 0 ? "0" : "1") +
           (json ? check_json(check, findings) : text_of(findings, quiet));
  });
  if (done.empty()) return 1;
  std::fputs(done.c_str() + 1, stdout);
  return done[0] - '0';
}

}  // namespace kerf::hal
