// Any bytes are read without a crash and in bounded time, and what is said of them is consistent: files of random bytes, of
// random pieces of the language, real files with random damage, and files that include each other in any way.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "ini/check.hpp"
#include "ini/escape.hpp"
#include "ini/inivalue.hpp"
#include "ini/reader.hpp"

namespace kerf::ini {
namespace {

namespace fs = std::filesystem;

unsigned count = 2000;
unsigned only_seed = 0;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  std::size_t below(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(engine_);
  }
  bool chance(double p) { return std::uniform_real_distribution<double>(0, 1)(engine_) < p; }
  template <class T>
  const T& of(const std::vector<T>& all) {
    return all[below(all.size())];
  }

 private:
  std::mt19937 engine_;
};

std::string bytes(Random& random) {
  std::string out(random.below(400), ' ');
  for (char& c : out) c = static_cast<char>(random.below(256));
  return out;
}

std::string pieces(Random& random) {
  static const std::vector<std::string> kPieces{"[JOINT_0]\n",
                                                "[AXIS_X]\n",
                                                "[TRAJ]\n",
                                                "[DISPLAY]\n",
                                                "[HAL]\n",
                                                "[A]\n",
                                                "MAX_VELOCITY",
                                                "SPINDLES",
                                                "HALFILE",
                                                "TYPE",
                                                "HOME",
                                                " = ",
                                                "=",
                                                "\n",
                                                "\\\n",
                                                "\\x41",
                                                "\\u00e9",
                                                "\\ud83d",
                                                "\\ude00",
                                                "\\0",
                                                "\\q",
                                                "#INCLUDE ",
                                                "\n#INCLUDE x",
                                                "1.5",
                                                "-3",
                                                "0x1F",
                                                "1e999",
                                                "nan",
                                                "TRUE",
                                                "no",
                                                "LINEAR",
                                                "mm inch",
                                                " # c",
                                                "; c\n",
                                                "[",
                                                "]",
                                                "\xC3",
                                                "\xC3\xA9",
                                                "\r\n",
                                                "\t",
                                                "[JOINT_999999999999]\n",
                                                "99999999999999999999"};
  std::string out;
  for (std::size_t n = random.below(60); n > 0; --n) out += random.of(kPieces);
  return out;
}

std::string damaged(Random& random, const std::string& good) {
  std::string out = good;
  for (std::size_t n = 1 + random.below(6); n > 0 && !out.empty(); --n) {
    const std::size_t at = random.below(out.size());
    switch (random.below(4)) {
      case 0: out[at] = static_cast<char>(random.below(256)); break;
      case 1: out.erase(at, random.below(40)); break;
      case 2: out.insert(at, out.substr(random.below(out.size()), random.below(60))); break;
      default: out.resize(at); break;
    }
  }
  return out;
}

/// What must hold of every result, good or bad.
void check_result(const LoadResult& result) {
  bool has_error = false;
  for (const Diagnostic& d : result.diagnostics) {
    EXPECT_FALSE(d.text.empty());
    EXPECT_GE(d.at.line, 0);
    has_error = has_error || d.is_error;
  }
  EXPECT_EQ(result.ok, !has_error);
  std::size_t entries = 0;
  for (const std::string& section : result.file.sections()) {
    EXPECT_TRUE(result.file.has_section(section));
    entries += result.file.variables(section).size();
  }
  EXPECT_EQ(result.file.variables("").size(), entries) << "each entry is in one section";
  for (const Entry* entry : result.file.variables("")) {
    EXPECT_TRUE(is_valid_utf8(entry->value));
    EXPECT_GT(entry->at.line, 0);
    const auto all = result.file.find_all(entry->section, entry->key);
    EXPECT_NE(std::find(all.begin(), all.end(), entry), all.end());
    EXPECT_EQ(result.file.find(entry->section, entry->key), all.front());
  }
}

/// Typed readers and the check of keys take what the file has, and agree on errors.
void check_keys_of(const IniFile& file) {
  const std::vector<Diagnostic> found = check_keys(file, {});
  Reader reader(file);
  for (const KeySection& section : machine_keys().sections()) {
    for (const Key& key : section.keys) {
      if (key.verdict == Verdict::no)
        continue;  // nobody reads them, so their values are not checked
      std::string name(section.name), of(key.name);
      if (name == "AXIS_L") name = "AXIS_X";
      if (name.back() == 'n') name.back() = '0';
      if (of.find('n') != std::string::npos) of[of.find('n')] = '0';
      switch (key.kind) {
        case Kind::text: (void)reader.string(name, of); break;
        case Kind::real: (void)reader.real(name, of); break;
        case Kind::integer: (void)reader.integer(name, of); break;
        case Kind::boolean: (void)reader.boolean(name, of); break;
        case Kind::choice: (void)reader.choice(name, of); break;
        case Kind::reals: (void)reader.reals(name, of); break;
        case Kind::linear_unit: (void)reader.linear_unit(name, of); break;
        case Kind::angular_unit: (void)reader.angular_unit(name, of); break;
      }
    }
  }
  // An error of the typed reader about a value that is there is one of the check, too.
  for (const Diagnostic& d : reader.complaints()) {
    if (!d.is_error || d.text.find(" is missing: ") != std::string::npos) continue;
    const bool told = std::any_of(found.begin(), found.end(), [&](const Diagnostic& other) {
      return other.text == d.text || other.at.line == d.at.line;
    });
    EXPECT_TRUE(told) << d.message();
  }
}

template <class Make>
void for_seeds(Make make) {
  const unsigned first = only_seed != 0 ? only_seed : 1;
  const unsigned last = only_seed != 0 ? only_seed : count;
  for (unsigned seed = first; seed <= last && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("--seed " + std::to_string(seed));
    Random random(seed);
    const std::string text = make(random);
    const LoadResult result = IniFile::parse(text, "r.ini");
    check_result(result);
    check_keys_of(result.file);
  }
}

TEST(IniProperty, random_bytes) { for_seeds(bytes); }

TEST(IniProperty, random_pieces) { for_seeds(pieces); }

TEST(IniProperty, real_files_with_damage) {
  std::vector<std::string> files;
  for (const char* name : {"mill/mill.ini", "tcl-mill/mill.inc"}) {
    std::ifstream in(fs::path(KERF_SOURCE_DIR) / "configs/sim" / name);
    files.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    ASSERT_FALSE(files.back().empty()) << name;
  }
  for_seeds([&](Random& random) { return damaged(random, random.of(files)); });
}

class IniFolder : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = fs::path(testing::TempDir()) / ("ini_property_" + std::to_string(getpid()));
    fs::create_directories(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }
  fs::path dir_;
};

TEST_F(IniFolder, files_that_include_each_other) {
  for (unsigned seed = 1; seed <= count / 40; ++seed) {
    SCOPED_TRACE("--seed " + std::to_string(seed));
    Random random(only_seed != 0 ? only_seed : seed);
    const std::size_t files = 2 + random.below(18);
    for (std::size_t i = 0; i < files; ++i) {
      std::ofstream out(dir_ / (std::to_string(i) + ".ini"), std::ios::binary);
      out << "[S" << i << "]\nX = " << i << '\n';
      for (std::size_t n = random.below(5); n > 0; --n)
        out << "#INCLUDE " << random.below(files + 1) << ".ini\n";
    }
    const LoadResult result = IniFile::load((dir_ / "0.ini").string());
    check_result(result);
    EXPECT_LE(result.file.variables("").size(), 1000U);
  }
}

// Two includes of the next file on each of sixteen levels would be 65536 files.
TEST_F(IniFolder, the_number_of_files_is_bounded) {
  for (int i = 0; i < 20; ++i)
    std::ofstream(dir_ / ("f" + std::to_string(i)))
        << "[A]\nX=1\n#INCLUDE f" << i + 1 << "\n#INCLUDE f" << i + 1 << "\n";
  const LoadResult result = IniFile::load((dir_ / "f0").string());
  EXPECT_FALSE(result.ok);
  EXPECT_LE(result.file.variables("").size(), 1000U);
  const auto told = std::count_if(
      result.diagnostics.begin(), result.diagnostics.end(),
      [](const Diagnostic& d) { return d.text.find("More than 1000 files") != std::string::npos; });
  EXPECT_EQ(told, 1);
}

TEST_F(IniFolder, so_is_the_size) {
  std::ofstream(dir_ / "zero") << "[A]\n#INCLUDE /dev/zero\n";
  const LoadResult result = IniFile::load((dir_ / "zero").string());
  ASSERT_FALSE(result.ok);
  EXPECT_NE(result.diagnostics[0].text.find("File too large"), std::string::npos)
      << result.diagnostics[0].text;
}

TEST_F(IniFolder, programs_end_with_their_exit_codes) {
  const fs::path before = fs::current_path();
  fs::current_path(dir_);
  const std::vector<std::string> words{"-V",     "X",      "-S", "A",  "-N",  "-1",    "2",   "-a",
                                       "-y",     "i",      "r",  "b",  "z",   "-m",    "1e9", "-M",
                                       "--sec=", "--type", "-o", "-c", "-op", "--all", "-q",  "-b",
                                       "--",     "c.ini",  "",   "-",  "-B",  "-T",    "-e",  "-h"};
  for (unsigned seed = 1; seed <= count / 10; ++seed) {
    Random random(only_seed != 0 ? only_seed : seed);
    std::ofstream("c.ini", std::ios::binary)
        << (random.chance(0.5) ? pieces(random) : "[A]\nX=1\nX=yes\n");
    std::vector<std::string> args;
    for (std::size_t n = random.below(7); n > 0; --n) args.push_back(random.of(words));
    if (random.chance(0.7)) args.emplace_back("c.ini");
    const CommandOutput got = run_inivalue(args);
    EXPECT_GE(got.exit_code, 0);
    EXPECT_LE(got.exit_code, 3);
    (void)run_inivar(args);
  }
  fs::current_path(before);
}

}  // namespace
}  // namespace kerf::ini

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  for (int i = 1; i + 1 < argc; i += 2) {
    const auto value = static_cast<unsigned>(std::strtoul(argv[i + 1], nullptr, 10));
    if (std::string(argv[i]) == "--count") kerf::ini::count = value;
    if (std::string(argv[i]) == "--seed") kerf::ini::only_seed = value;
  }
  return RUN_ALL_TESTS();
}
