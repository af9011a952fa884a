// Runs the sessions of this folder (README.md has their form) against the programs' own functions.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "ini/inivalue.hpp"

namespace kerf::ini {
namespace {

namespace fs = std::filesystem;

const fs::path kCases = fs::path(KERF_SOURCE_DIR) / "tests/golden/ini";

std::string decoded(std::string text) {
  const std::pair<const char*, std::string> marks[] = {
      {"<CR>", "\r"},   {"<TAB>", "\t"},           {"<NUL>", std::string(1, '\0')},
      {"<FF>", "\xFF"}, {"<BOM>", "\xEF\xBB\xBF"}, {"<EOF>\n", ""}};
  for (const auto& [mark, bytes] : marks) {
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += bytes.size())
      text.replace(at, std::string(mark).size(), bytes);
  }
  return text;
}

/// Words of a command line; 'quotes' keep blanks.
std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  bool inside = false, open = false;
  std::string word;
  for (const char c : line + ' ') {
    if (c == '\'') {
      inside = !inside;
      open = true;
    } else if (c == ' ' && !inside) {
      if (open) words.push_back(std::exchange(word, {}));
      open = false;
    } else {
      word += c;
      open = true;
    }
  }
  return words;
}

std::string with_mark(const std::string& text, const std::string& mark) {
  std::string out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out += mark + line + '\n';
  return out;
}

std::string run(const std::string& line) {
  std::vector<std::string> words = words_of(line);
  const std::string program = words.front();
  words.erase(words.begin());
  EXPECT_TRUE(program == "inivalue" || program == "inivar") << line;
  const CommandOutput got = program == "inivar" ? run_inivar(words) : run_inivalue(words);
  return "$ " + line + '\n' + got.out + with_mark(got.err, "! ") +
         (got.exit_code == 0 ? "" : "= " + std::to_string(got.exit_code) + '\n');
}

/// The case as it should read: everything but what commands print is kept.
std::string play(const std::string& text) {
  std::istringstream in(text);
  std::string out, file, name;
  bool in_file = false, in_output = false;
  for (std::string line; std::getline(in, line);) {
    if (in_file || line.rfind("---", 0) == 0) {
      out += line + '\n';
      if (in_file && line == "---") {
        fs::create_directories(fs::path(name).parent_path().empty() ? "."
                                                                    : fs::path(name).parent_path());
        std::ofstream(name, std::ios::binary) << decoded(file);
        in_file = false;
      } else if (in_file) {
        file += line + '\n';
      } else {
        name = line.substr(4);
        file.clear();
        in_file = true;
        in_output = false;
      }
    } else if (line.rfind("$ ", 0) == 0) {
      out += run(line.substr(2));
      in_output = true;
    } else if (!in_output || line.rfind("## ", 0) == 0) {
      out += line + '\n';  // prose; what a command printed is written by run()
    }
  }
  return out;
}

class Golden : public testing::TestWithParam<std::string> {};

TEST_P(Golden, session) {
  const fs::path path = kCases / (GetParam() + ".session");
  std::ifstream in(path);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const fs::path folder = fs::path(testing::TempDir()) / ("ini_golden_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const fs::path before = fs::current_path();
  fs::current_path(folder);
  setenv("HOME", "/home/operator", 1);
  const std::string got = play(text);
  fs::current_path(before);
  fs::remove_all(folder);
  EXPECT_NE(got.find("$ "), std::string::npos) << "a case without a command";
  if (std::getenv("KERF_GOLDEN_UPDATE") != nullptr) std::ofstream(path) << got;
  EXPECT_EQ(got, text);
}

std::vector<std::string> cases() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(kCases))
    if (entry.path().extension() == ".session") out.push_back(entry.path().stem().string());
  std::sort(out.begin(), out.end());
  return out;
}

std::string test_name(const testing::TestParamInfo<std::string>& one) {
  std::string name = one.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Ini, Golden, testing::ValuesIn(cases()), test_name);

}  // namespace
}  // namespace kerf::ini
