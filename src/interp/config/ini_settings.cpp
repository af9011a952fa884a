#include "interp/config/ini_settings.hpp"

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "ini/ini_file.hpp"
#include "interp/dialect.hpp"
#include "interp/remap.hpp"

namespace kerf::interp {

namespace {

namespace fs = std::filesystem;
using ini::Reader;

constexpr const char* kSection = "RS274NGC";

struct FlagRow {
  const char* key;
  bool Settings::*field;
  std::uint32_t feature;  ///< bit of the old key FEATURES, 0: none
};
constexpr FlagRow kFlags[] = {
    {"RETAIN_G43", &Settings::retain_g43, 0x1},
    {"OWORD_NARGS", &Settings::oword_nargs, 0x2},
    {"INI_VARS", &Settings::ini_vars, 0x4},
    {"HAL_PIN_VARS", &Settings::hal_pin_vars, 0x8},
    {"NO_DOWNCASE_OWORD", &Settings::no_downcase_oword, 0x10},
    {"OWORD_WARNONLY", &Settings::oword_warnonly, 0x20},
    {"DISABLE_FANUC_STYLE_SUB", &Settings::disable_fanuc_style_sub, 0},
    {"DISABLE_G92_PERSISTENCE", &Settings::disable_g92_persistence, 0},
    {"DISABLE_AUTO_G54", &Settings::disable_auto_g54, 0},
};

struct LengthRow {
  const char* key;
  double Settings::*field;
  bool machine_units;  ///< else as its name says
};
constexpr LengthRow kLengths[] = {
    {"CENTER_ARC_RADIUS_TOLERANCE_MM", &Settings::arc_error_mm, false},
    {"CENTER_ARC_RADIUS_TOLERANCE_INCH", &Settings::arc_error_inch, false},
    {"G64_DEFAULT_TOLERANCE", &Settings::g64_default_tolerance_mm, true},
    {"G64_DEFAULT_NAIVETOLERANCE", &Settings::g64_default_naivecam_mm, true},
    {"G73_PECK_CLEARANCE", &Settings::g73_clearance_mm, true},
    {"G83_PECK_CLEARANCE", &Settings::g83_clearance_mm, true},
};

/// FEATURES is the way before LinuxCNC 2.8: a set bit means the key of its own, which rules when both are there.
void read_flags(Reader& r, Settings& s) {
  std::uint32_t features = 0;
  if (r.has(kSection, "FEATURES")) {
    features = static_cast<std::uint32_t>(r.integer(kSection, "FEATURES"));
    std::string keys;
    for (const FlagRow& row : kFlags)
      if ((features & row.feature) != 0) keys += std::string(" ") + row.key + " = 1";
    r.complain(kSection, "FEATURES",
               "FEATURES is from LinuxCNC 2.7" +
                   (keys.empty() ? ": delete it" : "; write instead:" + keys),
               false);
  }
  for (const FlagRow& row : kFlags) {
    const bool feature = (features & row.feature) != 0;
    s.*row.field = r.boolean(kSection, row.key, feature || s.*row.field);
  }
}

void read_lengths(Reader& r, Settings& s, double unit_mm) {
  for (const LengthRow& row : kLengths) {
    const double scale = row.machine_units ? unit_mm : 1.0;
    s.*row.field = scale * r.real(kSection, row.key, s.*row.field / scale);
  }
  s.orient_offset_deg = r.real(kSection, "ORIENT_OFFSET");
  s.compensation_look_ahead = static_cast<int>(r.integer(kSection, "COMPENSATION_LOOK_AHEAD"));
}

std::vector<std::string> path_list(Reader& r, const std::string& ini_dir, const char* key) {
  std::vector<std::string> out;
  std::istringstream in(r.string(kSection, key));
  for (std::string item; std::getline(in, item, ':');)
    if (!item.empty()) out.push_back(resolve_path(ini_dir, item));
  return out;
}

void read_paths(Reader& r, ProgramPaths& p) {
  std::error_code ec;
  const auto absolute = fs::absolute(fs::path(r.file().name()), ec);
  p.ini_dir = ec ? std::string(".") : absolute.parent_path().string();
  p.program_prefix = resolve_path(p.ini_dir, r.string("DISPLAY", "PROGRAM_PREFIX"));
  p.user_m_path = path_list(r, p.ini_dir, "USER_M_PATH");
  p.subroutine_path = path_list(r, p.ini_dir, "SUBROUTINE_PATH");
  const auto one = [&](const char* section, const char* key) {
    const std::string path = r.string(section, key);
    return path.empty() ? path : resolve_path(p.ini_dir, path);
  };
  p.wizard_root = one("WIZARD", "WIZARD_ROOT");
  p.parameter_file = one(kSection, "PARAMETER_FILE");
}

void read_dialect(Reader& r, Settings& s) {
  const std::size_t n = r.choice(kSection, "COMPAT");  // 2.7 2.8 2.9 2.10
  s.compat = n == 0 ? Compat::v2_7 : n == 1 ? Compat::v2_8 : Compat::newest;
  s.dialect = dialect_names()[r.choice(kSection, "DIALECT")];  // the same names; a test
}

void read_python(Reader& r, const std::string& ini_dir, PythonSettings& p) {
  const std::string toplevel = r.string("PYTHON", "TOPLEVEL");
  if (!toplevel.empty()) p.toplevel = resolve_path(ini_dir, toplevel);
  for (const std::string& path : r.strings("PYTHON", "PATH_PREPEND"))
    p.path_prepend.push_back(resolve_path(ini_dir, path));
  for (const std::string& path : r.strings("PYTHON", "PATH_APPEND"))
    p.path_append.push_back(resolve_path(ini_dir, path));
  p.log_level = static_cast<int>(r.integer("PYTHON", "LOG_LEVEL"));
  p.reload_on_change = r.boolean("PYTHON", "RELOAD_ON_CHANGE");
}

/// What a REMAP line cannot know alone: other lines, files, Python.
std::string remap_problem(const InterpSetup& s, const Remap& remap) {
  for (const Remap& other : s.settings.remaps)
    if (other.letter == remap.letter && other.code == remap.code)
      return "code '" + remap.name + "' already remapped";
  for (const std::string* function : {&remap.python, &remap.prolog, &remap.epilog})
    if (!function->empty() && s.python.toplevel.empty() && !is_native_glue(*function))
      return "'" + *function +
             "' is not a Python callable function: [PYTHON]TOPLEVEL must name the script that "
             "defines it";
  if (!remap.ngc.empty() && find_sub_file(s.paths, remap.ngc).empty())
    return "NGC file not found: ngc=" + remap.ngc + ": put " + remap.ngc +
           ".ngc into [DISPLAY]PROGRAM_PREFIX or a folder of [RS274NGC]SUBROUTINE_PATH";
  return {};
}

void read_remaps(Reader& r, InterpSetup& s) {
  for (const std::string& line : r.strings(kSection, "REMAP")) {
    if (line.empty()) continue;
    RemapParse parsed = parse_remap(line);
    for (const std::string& warning : parsed.warnings)
      r.complain(kSection, "REMAP", std::string(warning).append(": REMAP = ").append(line), false);
    if (parsed.remap && parsed.error.empty()) parsed.error = remap_problem(s, *parsed.remap);
    if (!parsed.error.empty())
      r.complain(kSection, "REMAP", parsed.error + ": REMAP = " + line);
    else if (parsed.remap)
      s.settings.remaps.push_back(std::move(*parsed.remap));
  }
}

}  // namespace

InterpSetup read_interp_setup(Reader& reader, double unit_mm) {
  InterpSetup s;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a)
    if (rtapi::is_rotary(a) &&
        reader.has(std::string("AXIS_") + rtapi::kAxisLetters[a], "LOCKING_INDEXER_JOINT"))
      s.settings.indexer_mask |= 1U << a;
  read_paths(reader, s.paths);
  read_flags(reader, s.settings);
  read_lengths(reader, s.settings, unit_mm);
  read_dialect(reader, s.settings);
  s.settings.log_level = static_cast<LogLevel>(reader.integer(kSection, "LOG_LEVEL"));
  s.settings.smooth_planner = static_cast<int>(reader.integer("TRAJ", "SMOOTH_PLANNER"));
  s.settings.debug_mask = static_cast<int>(
      std::strtoul(reader.string("EMC", "DEBUG").c_str(), nullptr, 0) & 0x7FFFFFFFU);
  const std::string log = reader.string(kSection, "LOG_FILE");
  if (!log.empty()) s.settings.log_file = resolve_path(s.paths.ini_dir, log);
  s.startup_code = reader.string(kSection, "RS274NGC_STARTUP_CODE");
  s.on_abort_command = reader.string(kSection, "ON_ABORT_COMMAND");
  read_python(reader, s.paths.ini_dir, s.python);
  read_remaps(reader, s);
  return s;
}

std::string find_sub_file(const ProgramPaths& paths, std::string_view name) {
  const std::string file = std::string(name) + ".ngc";
  std::vector<std::string> folders{paths.program_prefix};
  folders.insert(folders.end(), paths.subroutine_path.begin(), paths.subroutine_path.end());
  if (!paths.wizard_root.empty()) folders.push_back(paths.wizard_root);
  for (const std::string& folder : folders) {
    std::error_code ec;
    std::string path = folder;
    path.append("/").append(file);
    if (fs::is_regular_file(path, ec)) return path;
  }
  return {};
}

std::string resolve_path(const std::string& ini_dir, const std::string& path) {
  const std::string expanded = ini::expand_tilde(path);
  fs::path p(expanded);
  if (p.is_relative()) p = fs::path(ini_dir) / p;
  std::string out = p.lexically_normal().string();
  while (out.size() > 1 && out.back() == '/') out.pop_back();
  return out;
}

}  // namespace kerf::interp
