// Cases that are folders: each holds what is run and, in the file `expected`, what it printed. KERF_GOLDEN_UPDATE=1 writes that file
// anew; look at the difference before you commit it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace kerf::hal::test {

/// Folder of this file.
inline std::filesystem::path hal_tests() {
  return std::filesystem::path(KERF_SOURCE_DIR) / "tests/hal";
}

/// "" when there is no such file.
inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Names of the folders in `folder`, those that have the file `holding` only.
inline std::vector<std::string> folders_of_cases(const std::filesystem::path& folder,
                                                 const std::string& holding = {}) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_directory() && std::filesystem::exists(entry.path() / holding))
      out.push_back(entry.path().filename().string());
  std::sort(out.begin(), out.end());
  return out;
}

/// Name of a test in a suite whose parameters are folders.
inline std::string case_name(const testing::TestParamInfo<std::string>& tested) {
  std::string name = tested.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// Compares, or writes anew and skips the test.
inline void expect_file(const std::filesystem::path& path, const std::string& got) {
  if (std::getenv("KERF_GOLDEN_UPDATE") != nullptr) {
    std::ofstream(path, std::ios::binary) << got;
    GTEST_SKIP() << "written anew";
  }
  EXPECT_EQ(got, read_file(path)) << path;
}

/// Goes to a folder and back: scripts name their files relative to themselves.
class InFolder {
 public:
  explicit InFolder(const std::filesystem::path& folder) : old_(std::filesystem::current_path()) {
    std::filesystem::current_path(folder);
  }
  ~InFolder() { std::filesystem::current_path(old_); }
  InFolder(const InFolder&) = delete;
  InFolder& operator=(const InFolder&) = delete;

 private:
  std::filesystem::path old_;
};

}  // namespace kerf::hal::test
