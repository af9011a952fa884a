// [RS274NGC] and what belongs to it, as task and rs274 -i read it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "interp/config/ini_settings.hpp"
#include "interp/dialect.hpp"

namespace kerf::interp {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class IniSettings : public ::testing::Test {
 protected:
  void SetUp() override {
    dir_ =
        (fs::temp_directory_path() / ("kerf_ini_settings_" + std::to_string(::getpid()))).string();
    for (const char* sub : {"/nc_files", "/one", "/two", "/wizard"})
      fs::create_directories(dir_ + sub);
  }
  void TearDown() override { fs::remove_all(dir_); }

  InterpSetup read(const std::string& keys, double unit_mm = 1) {
    const auto loaded = ini::IniFile::parse("[RS274NGC]\n" + keys, dir_ + "/m.ini");
    EXPECT_TRUE(loaded.ok);
    ini::Reader reader(loaded.file);
    InterpSetup s = read_interp_setup(reader, unit_mm);
    failed_ = reader.failed();
    complaints_.clear();
    for (const auto& c : reader.complaints()) complaints_ += c.message() + "\n";
    return s;
  }
  void file(const std::string& name) const { std::ofstream(dir_ + "/" + name) << "M2\n"; }

  std::string dir_, complaints_;
  bool failed_{false};
};

TEST_F(IniSettings, Defaults) {
  const InterpSetup s = read("");
  EXPECT_EQ(complaints_, "");
  EXPECT_TRUE(s.settings.ini_vars && s.settings.hal_pin_vars);
  EXPECT_FALSE(s.settings.retain_g43 || s.settings.oword_nargs || s.settings.no_downcase_oword ||
               s.settings.oword_warnonly || s.settings.disable_fanuc_style_sub ||
               s.settings.disable_g92_persistence || s.settings.disable_auto_g54);
  EXPECT_DOUBLE_EQ(s.settings.arc_error_mm, 0.0127);
  EXPECT_DOUBLE_EQ(s.settings.arc_error_inch, 0.0005);
  EXPECT_EQ(s.settings.compat, Compat::newest);
  EXPECT_EQ(s.settings.dialect, "linuxcnc");
  EXPECT_EQ(s.settings.log_level, LogLevel::nothing);
  EXPECT_EQ(s.paths.program_prefix, dir_ + "/nc_files");
  EXPECT_EQ(s.paths.parameter_file, "");
  EXPECT_EQ(s.python.toplevel, "");
}

TEST_F(IniSettings, EachDialectCanBeChosen) {
  for (const std::string_view name : dialect_names()) {
    EXPECT_EQ(read("DIALECT = " + std::string(name) + "\n").settings.dialect, name);
    EXPECT_EQ(complaints_, "");
  }
}

TEST_F(IniSettings, EveryFlagHasItsKey) {
  const std::pair<const char*, bool Settings::*> rows[] = {
      {"RETAIN_G43", &Settings::retain_g43},
      {"OWORD_NARGS", &Settings::oword_nargs},
      {"NO_DOWNCASE_OWORD", &Settings::no_downcase_oword},
      {"OWORD_WARNONLY", &Settings::oword_warnonly},
      {"DISABLE_FANUC_STYLE_SUB", &Settings::disable_fanuc_style_sub},
      {"DISABLE_G92_PERSISTENCE", &Settings::disable_g92_persistence},
      {"DISABLE_AUTO_G54", &Settings::disable_auto_g54},
      {"INI_VARS", &Settings::ini_vars},
      {"HAL_PIN_VARS", &Settings::hal_pin_vars},
  };
  for (const auto& [key, field] : rows) {
    EXPECT_TRUE(read(std::string(key) + " = 1\n").settings.*field) << key;
    EXPECT_FALSE(read(std::string(key) + " = 0\n").settings.*field) << key;
    EXPECT_EQ(complaints_, "") << key;
    (void)read(std::string(key) + " = maybe\n");
    EXPECT_TRUE(failed_) << key;
    EXPECT_THAT(complaints_, HasSubstr(key));
  }
}

TEST_F(IniSettings, BitsOfTheOldFeatures) {
  const std::pair<int, bool Settings::*> rows[] = {
      {0x1, &Settings::retain_g43},
      {0x2, &Settings::oword_nargs},
      {0x10, &Settings::no_downcase_oword},
      {0x20, &Settings::oword_warnonly},
  };
  for (const auto& [bit, field] : rows) {
    const InterpSetup s = read("FEATURES = " + std::to_string(bit) + "\n");
    for (const auto& [other, other_field] : rows)
      EXPECT_EQ(s.settings.*other_field, other == bit) << bit;
    EXPECT_TRUE(s.settings.ini_vars && s.settings.hal_pin_vars);
    EXPECT_FALSE(failed_);
    EXPECT_THAT(complaints_, HasSubstr("FEATURES is from LinuxCNC 2.7; write instead:"));
  }
  EXPECT_FALSE(read("FEATURES = 3\nRETAIN_G43 = 0\n").settings.retain_g43) << "the key rules";
  EXPECT_THAT(complaints_, HasSubstr("RETAIN_G43 = 1 OWORD_NARGS = 1"));
}

TEST_F(IniSettings, LengthsAreInMachineUnits) {
  const InterpSetup s = read(
      "G64_DEFAULT_TOLERANCE = 0.1\nG64_DEFAULT_NAIVETOLERANCE = 0.2\nG73_PECK_CLEARANCE = 0.3\n"
      "G83_PECK_CLEARANCE = 0.4\nCENTER_ARC_RADIUS_TOLERANCE_MM = 0.01\n"
      "CENTER_ARC_RADIUS_TOLERANCE_INCH = 0.002\nORIENT_OFFSET = 90\n",
      25.4);
  EXPECT_DOUBLE_EQ(s.settings.g64_default_tolerance_mm, 2.54);
  EXPECT_DOUBLE_EQ(s.settings.g64_default_naivecam_mm, 5.08);
  EXPECT_DOUBLE_EQ(s.settings.g73_clearance_mm, 7.62);
  EXPECT_DOUBLE_EQ(s.settings.g83_clearance_mm, 10.16);
  EXPECT_DOUBLE_EQ(s.settings.arc_error_mm, 0.01);
  EXPECT_DOUBLE_EQ(s.settings.arc_error_inch, 0.002);
  EXPECT_DOUBLE_EQ(s.settings.orient_offset_deg, 90);
  EXPECT_EQ(complaints_, "");
}

TEST_F(IniSettings, CompensationLooksAheadOnlyWhenAsked) {
  EXPECT_EQ(read("").settings.compensation_look_ahead, 0);
  EXPECT_EQ(read("COMPENSATION_LOOK_AHEAD = 12\n").settings.compensation_look_ahead, 12);
  (void)read("COMPENSATION_LOOK_AHEAD = -1\n");
  EXPECT_THAT(complaints_, HasSubstr("COMPENSATION_LOOK_AHEAD"));
}

TEST_F(IniSettings, UnknownNamesAreErrorsThatListTheKnown) {
  EXPECT_EQ(read("COMPAT = 2.7\n").settings.compat, Compat::v2_7);
  EXPECT_EQ(read("COMPAT = 2.8\n").settings.compat, Compat::v2_8);
  EXPECT_EQ(read("COMPAT = 2.9\n").settings.compat, Compat::newest);
  (void)read("COMPAT = 2.6\n");
  EXPECT_TRUE(failed_);
  EXPECT_THAT(complaints_, HasSubstr("2.7"));
  (void)read("DIALECT = fanuc\n");
  EXPECT_TRUE(failed_);
  EXPECT_THAT(complaints_, HasSubstr("linuxcnc"));
}

TEST_F(IniSettings, SubsAreFoundInTheDocumentedOrder) {
  const auto loaded = ini::IniFile::parse(
      "[DISPLAY]\nPROGRAM_PREFIX = nc_files\n[RS274NGC]\nSUBROUTINE_PATH = one:" + dir_ +
          "/two\n[WIZARD]\nWIZARD_ROOT = wizard\n",
      dir_ + "/m.ini");
  ini::Reader reader(loaded.file);
  const InterpSetup s = read_interp_setup(reader, 1);
  EXPECT_THAT(s.paths.subroutine_path, ElementsAre(dir_ + "/one", dir_ + "/two"));
  EXPECT_EQ(find_sub_file(s.paths, "a"), "");
  for (const char* folder : {"wizard", "two", "one", "nc_files"}) {
    file(std::string(folder) + "/a.ngc");
    EXPECT_EQ(find_sub_file(s.paths, "a"), dir_ + "/" + folder + "/a.ngc");
  }
}

TEST_F(IniSettings, TextsAndPaths) {
  const InterpSetup s = read(
      "PARAMETER_FILE = my.var\nRS274NGC_STARTUP_CODE = G21 G90\nUSER_M_PATH = one:two\n"
      "LOG_LEVEL = 3\nLOG_FILE = interp.log\nON_ABORT_COMMAND = O <on_abort> call\n"
      "[PYTHON]\nTOPLEVEL = python/top.py\nPATH_PREPEND = python\nPATH_PREPEND = /x\n"
      "PATH_APPEND = ~/y\nLOG_LEVEL = 2\nRELOAD_ON_CHANGE = 1\n");
  EXPECT_EQ(complaints_, "");
  EXPECT_EQ(s.paths.parameter_file, dir_ + "/my.var");
  EXPECT_THAT(s.paths.user_m_path, ElementsAre(dir_ + "/one", dir_ + "/two"));
  EXPECT_EQ(s.startup_code, "G21 G90");
  EXPECT_EQ(s.settings.log_level, LogLevel{3});
  EXPECT_EQ(s.settings.log_file, dir_ + "/interp.log");
  EXPECT_EQ(s.on_abort_command, "O <on_abort> call");
  EXPECT_EQ(s.python.toplevel, dir_ + "/python/top.py");
  EXPECT_THAT(s.python.path_prepend, ElementsAre(dir_ + "/python", "/x"));
  EXPECT_EQ(s.python.path_append.size(), 1U);
  EXPECT_EQ(s.python.log_level, 2);
  EXPECT_TRUE(s.python.reload_on_change);
}

TEST_F(IniSettings, RemapLines) {
  file("nc_files/body.ngc");
  const InterpSetup s = read(
      "REMAP = M400 modalgroup=10 argspec=Pq ngc=body\nREMAP = T prolog=prepare_prolog ngc=body "
      "epilog=prepare_epilog\nREMAP = M3 ngc=body\n");
  EXPECT_EQ(s.settings.remaps.size(), 2U);
  EXPECT_FALSE(failed_) << complaints_;
  EXPECT_THAT(complaints_, HasSubstr("M3 is built in and stays so"));

  const std::pair<const char*, const char*> bad[] = {
      {"M400 ngc=nofile", "NGC file not found: ngc=nofile"},
      {"M400 python=mine", "[PYTHON]TOPLEVEL must name the script"},
      {"M400 prolog=mine ngc=body", "[PYTHON]TOPLEVEL must name the script"},
      {"M400 ngc=body\nREMAP = M400 ngc=body", "code 'M400' already remapped"},
      {"M400", "no remap function given"},
      {"Q1 ngc=body", "is no code that can be remapped"},
  };
  for (const auto& [line, complaint] : bad) {
    (void)read(std::string("REMAP = ") + line + "\n");
    EXPECT_TRUE(failed_) << line;
    EXPECT_THAT(complaints_, HasSubstr(complaint)) << line;
    EXPECT_THAT(complaints_, HasSubstr("m.ini:"));
  }
  EXPECT_EQ(read("REMAP = M400 python=mine\n[PYTHON]\nTOPLEVEL = top.py\n").settings.remaps.size(),
            1U);
}

}  // namespace
}  // namespace kerf::interp
