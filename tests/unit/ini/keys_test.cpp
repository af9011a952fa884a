// The table of keys, and files held against it.
#include "ini/keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "ini/check.hpp"
#include "ini/convert.hpp"
#include "ini/ini_file.hpp"

namespace kerf::ini {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Lines = std::vector<std::string>;

Lines check(const std::string& text, const std::string& hal = "", const std::string& tcl = "") {
  const auto loaded = IniFile::parse(text, "m.ini");
  EXPECT_TRUE(loaded.ok);
  HalUse use;
  use.add_text(hal);
  use.add_script(tcl);
  Lines out;
  for (const auto& d : check_keys(loaded.file, use)) out.push_back(d.message());
  return out;
}

TEST(KeyTable, FindsSectionsAndKeysByPattern) {
  const KeyTable& table = machine_keys();
  EXPECT_EQ(table.section("JOINT_12")->name, "JOINT_n");
  EXPECT_EQ(table.section("AXIS_W")->name, "AXIS_L");
  EXPECT_EQ(table.section("TRAJ")->name, "TRAJ");
  EXPECT_EQ(table.section("HAL")->name, "HAL");
  for (const char* none : {"JOINT_", "JOINT_X", "JOINT", "AXIS_D", "AXIS_XY", "AXIS_0", "traj", ""})
    EXPECT_EQ(table.section(none), nullptr) << none;
  EXPECT_EQ(table.find("DISPLAY", "MIN_SPINDLE_0_SPEED").key->name, "MIN_SPINDLE_n_SPEED");
  EXPECT_EQ(table.find("DISPLAY", "MIN_SPINDLE_SPEED").key->name, "MIN_SPINDLE_SPEED");
  EXPECT_EQ(table.find("DISPLAY", "MIN_SPINDLE_X_SPEED").key, nullptr);
  EXPECT_EQ(table.find("JOINT_0", "home").key, nullptr);
  EXPECT_EQ(table.find("JOINT_0", "HOME").by(), By::motion);
  EXPECT_EQ(table.find("JOINT_0", "P").by(), By::hal);
}

// Each row makes sense by itself, so that its readers need not ask.
TEST(KeyTable, RowsAreSound) {
  std::set<std::string> seen;
  for (const KeySection& section : machine_keys().sections()) {
    for (const Key& key : section.keys) {
      const std::string name = '[' + std::string(section.name) + ']' + std::string(key.name);
      SCOPED_TRACE(name);
      EXPECT_TRUE(seen.insert(name).second) << "twice in the table";
      EXPECT_LE(key.min, key.max);
      const bool needs_note = key.verdict == Verdict::no || key.verdict == Verdict::differs;
      EXPECT_EQ(key.note.empty(), !needs_note) << "say why";
      const bool read = key.verdict != Verdict::no && key.by != By::nobody;
      EXPECT_FALSE(read && key.meaning.empty()) << "say what it is for";
      EXPECT_FALSE(key.is_required && !key.fallback.empty()) << "nobody would see the default";
      for (const std::string_view text : {key.meaning, key.note, key.fallback, key.units})
        EXPECT_EQ(text.find('\t'), std::string_view::npos);
      if (key.fallback.empty()) continue;
      IniFile file = IniFile::parse("[" + std::string(section.name) + "]\n" +
                                        std::string(key.name) + "=" + std::string(key.fallback),
                                    "t")
                         .file;
      EXPECT_THAT(check_keys(file, {}), IsEmpty()) << "the default is no good value";
    }
  }
  EXPECT_GT(seen.size(), 250U);
}

TEST(KeyCheck, UnknownKeysGetTheNearestName) {
  EXPECT_THAT(check("[JOINT_0]\nHOEM_OFFSET=2\nMY_OWN=1\nHOEM_OFFSET=3\n[MY_PROBE]\nX=1\n"),
              ElementsAre("m.ini:2: warning: unknown key [JOINT_0]HOEM_OFFSET; did you mean "
                          "'HOME_OFFSET'?",
                          "m.ini:3: warning: unknown key [JOINT_0]MY_OWN"));
}

TEST(KeyCheck, WhatHalFilesUseIsKnown) {
  const std::string text = "[JOINT_0]\nMY_SCALE=2\n[TRAJ]\nOWN=x\n[EMC]\nTHIRD=1\n[JOINT_1]\nA=1\n";
  EXPECT_THAT(check(text, "setp a.b [JOINT_0]MY_SCALE\nsetp c.[TRAJ](OWN) 1\n",
                    "set x $::EMC(THIRD)\nset y [set ::JOINT_${n}(A)]\n"),
              IsEmpty());
  EXPECT_EQ(check(text, "# [JOINT_0] MY_SCALE").size(), 4U);
}

TEST(KeyCheck, WrongValuesAreErrorsWhereKerfReadsThem) {
  EXPECT_THAT(
      check("[JOINT_0]\nMAX_VELOCITY=0\nP=big\n[TRAJ]\nLINEAR_UNITS=mile\nSPINDLES=9\n"
            "[DISPLAY]\nMIN_LINEAR_VELOCITY=slow\nMAX_FEED_OVERRIDE=lots\n"),
      ElementsAre(
          "m.ini:2: error: [JOINT_0]MAX_VELOCITY = '0': expected a number above 0 [units/s]",
          "m.ini:3: warning: [JOINT_0]P = 'big': expected a number",
          "m.ini:5: error: [TRAJ]LINEAR_UNITS = 'mile': expected one of mm cm inch in metric "
          "imperial",
          "m.ini:6: error: [TRAJ]SPINDLES = '9': expected an integer from 1 to 8",
          "m.ini:8: warning: [DISPLAY]MIN_LINEAR_VELOCITY = 'slow': expected a number of at least "
          "0 "
          "[units/s]",
          "m.ini:9: error: [DISPLAY]MAX_FEED_OVERRIDE = 'lots': expected a number above 0 and at "
          "most 100"));
}

TEST(KeyCheck, UnsupportedKeysSayWhy) {
  const Lines lines =
      check("[TRAJ]\nMAX_VELOCITY = 5\n[AXIS_A]\nWRAPPED_ROTARY = 0\n[EMC]\nVERSION=1.0\n");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0],
            "m.ini:2: warning: [TRAJ]MAX_VELOCITY is not supported: from before LinuxCNC 2.8: its "
            "name is MAX_LINEAR_VELOCITY");
  EXPECT_THAT(lines[1], HasSubstr("[EMC]VERSION = 1.0"));
  EXPECT_THAT(check("[TRAJ]\nMAX_VELOCITY = 5\n", "setp a [TRAJ]MAX_VELOCITY\n"), IsEmpty());
}

TEST(KeyCheck, ASecondLineOfAKeyThatCountsOnce) {
  EXPECT_THAT(
      check("[EMC]\nMACHINE=a\nMACHINE=b\n[HAL]\nHALFILE=a\nHALFILE=b\n"),
      ElementsAre("m.ini:3: warning: [EMC]MACHINE again: the first one counts, in m.ini:2"));
}

TEST(KeyCheck, MistypedSections) {
  EXPECT_THAT(
      check("[JOINT0]\nHOME=1\n[DISPLY]\nX=1\n[AXIS_0]\nHOME=0\n[PROBE]\nA=1\n"),
      ElementsAre("m.ini:1: warning: nothing reads section [JOINT0]; did you mean [JOINT_0]?",
                  "m.ini:3: warning: nothing reads section [DISPLY]; did you mean [DISPLAY]?",
                  "m.ini:5: warning: section [AXIS_0] is from before LinuxCNC 2.8: joints are "
                  "in [JOINT_n], axes in [AXIS_X] and so on"));
  EXPECT_THAT(check("[JOINT0]\nHOME=1\n", "setp a [JOINT0]HOME"), IsEmpty());
}

TEST(KeyCheck, FiltersAreTheUsersOwn) {
  EXPECT_THAT(check("[FILTER]\nPROGRAM_EXTENSION=.py x\nPROGRAM_EXTENSION=.png y\npy=python3\n"),
              IsEmpty());
}

TEST(KeyTable, Texts) {
  const std::string all = keys_as_text(machine_keys(), {});
  EXPECT_THAT(all, HasSubstr("[JOINT_n]MAX_VELOCITY: number above 0 [units/s], default 1.0"));
  const std::string some = keys_as_text(machine_keys(), {"joint", "latch_vel"});
  EXPECT_EQ(some.substr(0, some.find('\n')),
            "[JOINT_n]HOME_LATCH_VEL: number [units/s], default 0");
  EXPECT_EQ(keys_as_text(machine_keys(), {"no such words"}), "");
}

}  // namespace
}  // namespace kerf::ini
