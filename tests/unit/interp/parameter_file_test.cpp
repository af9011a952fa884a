#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "rig.hpp"

namespace kerf::interp {
namespace {

class ParameterFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    dir_ = std::filesystem::temp_directory_path() / ("kerf_var_" + std::to_string(::getpid()));
    std::filesystem::create_directories(dir_);
    path_ = (dir_ / "machine.var").string();
  }
  void TearDown() override { std::filesystem::remove_all(dir_); }
  void write(const std::string& text) const { std::ofstream(path_) << text; }
  [[nodiscard]] std::string read(const std::string& suffix = "") const {
    std::ostringstream s;
    s << std::ifstream(path_ + suffix).rdbuf();
    return s.str();
  }
  std::filesystem::path dir_;
  std::string path_;
};

TEST_F(ParameterFiles, KeepTheDocumentedNumbersAndTheUsersOwn) {
  write("31\t7.5\nnonsense\n5161 1.0\n5220\t2\n5241\t25.4\n5250\t30\n1 2 3\n");
  ParameterTable table;
  ASSERT_TRUE(ParameterFile(path_).load(table).ok());
  EXPECT_EQ(table.get(31), 7.5);
  EXPECT_EQ(table.get(5161), 1);
  EXPECT_EQ(table.get(5241), 25.4);
  table.set(31, 8);
  table.set(32, 9);
  table.set(5162, -2.25);
  ASSERT_TRUE(ParameterFile(path_).save(table).ok());
  const std::string text = read();
  EXPECT_EQ(text.substr(0, 41), "31\t8.000000\n5161\t1.000000\n5162\t-2.250000\n");
  EXPECT_EQ(text.find("32\t"), std::string::npos)
      << "only numbers that the file had, or that are persistent";
  EXPECT_NE(text.find("\n5390\t0.000000\n"), std::string::npos);
  EXPECT_EQ(read(".bak").substr(0, 7), "31\t7.5\n");
  EXPECT_FALSE(std::filesystem::exists(path_ + ".new"));
}

/// The file and its backup stay as they are; anything else that stands there is replaced.
TEST_F(ParameterFiles, WhatIsThereIsNotWrittenAgain) {
  const auto inode = [&] {
    struct stat s {};
    EXPECT_EQ(::stat(path_.c_str(), &s), 0);
    return s.st_ino;
  };
  write("5161\t1\n");
  ParameterTable table;
  ASSERT_TRUE(ParameterFile(path_).load(table).ok());
  ASSERT_TRUE(ParameterFile(path_).save(table).ok());
  EXPECT_EQ(read(".bak"), "5161\t1\n");
  const std::string text = read();
  const auto first = inode();
  ASSERT_TRUE(ParameterFile(path_).save(table).ok());
  EXPECT_EQ(inode(), first);
  EXPECT_EQ(read(".bak"), "5161\t1\n");
  for (const std::string& other :
       {text + "1\t2\n", text.substr(0, text.size() - 2), std::string(), "4" + text.substr(1)}) {
    write(other);
    ASSERT_TRUE(ParameterFile(path_).save(table).ok());
    EXPECT_EQ(read(), text);
    EXPECT_EQ(read(".bak"), other);
  }
  std::filesystem::remove(path_);
  ASSERT_TRUE(ParameterFile(path_).save(table).ok());
  EXPECT_EQ(read(), text);
}

TEST_F(ParameterFiles, RefuseDisorder) {
  write("5162\t1\n5161\t1\n");
  ParameterTable table;
  const auto s = ParameterFile(path_).load(table);
  ASSERT_FALSE(s.ok());
  EXPECT_NE(s.error().message().find("machine.var:2: Parameter file out of order"),
            std::string::npos);
  write("5161\t1\n9999\t1\n");
  EXPECT_NE(ParameterFile(path_).load(table).error().message().find("out of range"),
            std::string::npos);
  EXPECT_EQ(ParameterFile((dir_ / "none.var").string()).load(table).error().code,
            rtapi::Errc::not_found);
}

TEST_F(ParameterFiles, OnlyAMissingFileIsANewMachine) {
  ParameterTable table;
  std::filesystem::create_directory(path_);
  const auto directory = ParameterFile(path_).load(table);
  ASSERT_FALSE(directory.ok());
  EXPECT_EQ(directory.error().code, rtapi::Errc::system);
  std::filesystem::remove(path_);
  std::filesystem::create_symlink(path_, path_);
  EXPECT_EQ(ParameterFile(path_).load(table).error().code, rtapi::Errc::system);
  std::filesystem::remove(path_);
  for (const char* value : {"nan", "inf", "-inf"}) {
    write(std::string("5161\t1\n5221\t") + value + "\n");
    const auto loaded = ParameterFile(path_).load(table);
    ASSERT_FALSE(loaded.ok()) << value;
    EXPECT_NE(loaded.error().message().find("machine.var:2"), std::string::npos);
  }
}

TEST_F(ParameterFiles, AFailedSaveLeavesTheOldFile) {
  if (::geteuid() == 0) {
    // root writes anywhere: a directory in the way does the same
    std::filesystem::create_directory(path_ + ".new");
  } else {
    write("5161\t1\n");
    ::chmod(dir_.c_str(), 0555);
  }
  ParameterTable table;
  EXPECT_FALSE(ParameterFile(path_).save(table).ok());
  ::chmod(dir_.c_str(), 0755);
}

TEST_F(ParameterFiles, OffsetsApplyAtStart) {
  Settings s;
  s.machine_unit_mm = 25.4;
  Rig rig(s);
  write("5210\t1\n5211\t1\n5220\t3\n5261\t2\n5270\t90\n");
  ASSERT_TRUE(ParameterFile(path_).load(rig.interp.parameters()).ok());
  rig.interp.init();
  EXPECT_EQ(rig.interp.modal().coord_system, 3);
  EXPECT_DOUBLE_EQ(rig.interp.modal().frame.g5x().x, 50.8);
  EXPECT_DOUBLE_EQ(rig.interp.modal().frame.g92().x, 25.4);
  EXPECT_DOUBLE_EQ(rig.interp.modal().frame.rotation_deg(), 90);
  EXPECT_NE(rig.calls().find("SET_G5X_OFFSET(3, 2.0000,"), std::string::npos);
}

/// Also when what was copied is gone.
TEST(ParameterTables, ACopyKnowsItsOwnNames) {
  ParameterTable copy;
  {
    auto first = std::make_unique<ParameterTable>();
    first->set_named(first->intern("_short"), Value{7, nullptr});
    first->set_named(first->intern("_a_name_that_fits_into_no_string_object"), Value{8, nullptr});
    copy = *first;
    for (const std::uint32_t id : {0U, 1U}) first->set_named(id, Value{-1, nullptr});
  }
  const ParameterTable moved = [&] {
    ParameterTable second(copy);
    return second;
  }();
  for (ParameterTable table : {copy, moved}) {
    const Value* short_one = table.find(table.intern("_short"));
    const Value* long_one = table.find(table.intern("_a_name_that_fits_into_no_string_object"));
    ASSERT_TRUE(short_one != nullptr && long_one != nullptr);
    EXPECT_EQ(short_one->number, 7);
    EXPECT_EQ(long_one->number, 8);
  }
}

}  // namespace
}  // namespace kerf::interp
