// The file format: every row of the newest reader's behaviour.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "ini/ini_file.hpp"

namespace kerf::ini {
namespace {

std::vector<std::string> messages(const LoadResult& result) {
  std::vector<std::string> out;
  for (const auto& d : result.diagnostics) out.push_back(d.message());
  return out;
}

using Lines = std::vector<std::string>;

/// A file beside nothing, deleted after the test.
class IniFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto base = std::filesystem::temp_directory_path() / "kerf_ini_XXXXXX";
    std::string name = base.string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    dir_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(dir_); }

  std::string write(const std::string& name, std::string_view text) {
    const std::string path = (dir_ / name).string();
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    std::FILE* file = std::fopen(path.c_str(), "wb");
    EXPECT_NE(file, nullptr);
    EXPECT_EQ(std::fwrite(text.data(), 1, text.size(), file), text.size());
    std::fclose(file);
    return path;
  }

  std::filesystem::path dir_;
};

struct ValueCase {
  const char* name;
  std::string_view text;  ///< below [A]
  const char* value;      ///< of X
  Lines diagnostics{};
};

class IniValue : public ::testing::TestWithParam<ValueCase> {};

TEST_P(IniValue, ReadsAs) {
  const auto result = IniFile::parse("[A]\n" + std::string(GetParam().text) + "\n", "c.ini");
  ASSERT_TRUE(result.ok) << ::testing::PrintToString(messages(result));
  const Entry* entry = result.file.find("A", "X");
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->value, GetParam().value);
  EXPECT_EQ(messages(result), GetParam().diagnostics);
}

INSTANTIATE_TEST_SUITE_P(
    Format, IniValue,
    ::testing::Values(
        ValueCase{"HashAfterValue", "X = 1 # c", "1 # c"},
        ValueCase{"SemicolonAfterValue", "X=1 ; 2", "1 ; 2"},
        ValueCase{"BlanksAround", "  X   =   a  b   ", "a  b"},
        ValueCase{"Tabs", "\tX\t=\t1\t", "1"}, ValueCase{"DoubleQuotes", "X=\"q\"", "\"q\""},
        ValueCase{"SingleQuotes", "X='it'", "'it'"}, ValueCase{"Empty", "X=", ""},
        ValueCase{"EqualsInValue", "X=1=2", "1=2"}, ValueCase{"LeadingEquals", "X==2", "=2"},
        ValueCase{"CommentsBefore", "# a\n; b\n  # c\n\t; d\nX=1", "1"},
        ValueCase{"CommentIsNotContinued", "# a \\\nX=1", "1"},
        ValueCase{"SemicolonCommentIsNotContinued", "  ; a \\\nX=1", "1"},
        ValueCase{"ContinuationKeepsLeadingBlanks", "X=a \\\n  b\\\nc", "a   bc"},
        ValueCase{"ContinuedByEmptyLine", "X=a\\\n", "a"},
        ValueCase{"BlankAfterBackslash", "X=a\\ \n  b", "a  b"},
        ValueCase{"CommentSignInContinuation", "X=a\\\n# b", "a# b"},
        ValueCase{"HeaderInContinuation", "X=a\\\n[B]", "a[B]"},
        ValueCase{"ContinuedBeforeEquals", "X \\\n = 1", "1"},
        ValueCase{"EscapedBackslashAtEnd", "X=a\\\\", "a\\"},
        ValueCase{"Escapes", "X=a\\tb\\x41\\101\\u00e9", "a\tbAA\xC3\xA9"},
        ValueCase{"AllLetters", "X=\\a\\b\\f\\n\\r\\t\\v\\\\.", "\a\b\f\n\r\t\v\\."},
        ValueCase{"OctalLengths", "X=\\1-\\12-\\1234", "\001-\012-S4"},
        ValueCase{"SurrogatePair", "X=\\uD83D\\uDE00", "\xF0\x9F\x98\x80"},
        ValueCase{"Utf32", "X=\\U0001F600", "\xF0\x9F\x98\x80"},
        ValueCase{"EscapedBlanksStay", "X=\\x20a\\x20", " a "},
        ValueCase{"UnknownEscape",
                  "X=\\qz",
                  "\\qz",
                  {"c.ini:2: warning: Improper escape of 'q', ignored"}},
        ValueCase{"QuoteEscape",
                  "X=\\\"",
                  "\\\"",
                  {"c.ini:2: warning: Improper escape of '\"', ignored"}},
        ValueCase{
            "OctalAboveTwo", "X=\\4", "\\4", {"c.ini:2: warning: Improper escape of '4', ignored"}},
        ValueCase{"NoExpansion", "X=$HOME/~", "$HOME/~"},
        ValueCase{"TildeIsLiteral", "X=~/a", "~/a"}, ValueCase{"CrLf", "X=1\r", "1"},
        ValueCase{"LoneCr", "X=a\rb", "a\rb"}, ValueCase{"Utf8", "X=\xC3\xA9", "\xC3\xA9"},
        ValueCase{"FirstOfTwo", "X=1\nX=2", "1"},
        ValueCase{"KeysAreCaseSensitive", "x=0\nX=1", "1"}),
    [](const auto& test) { return std::string(test.param.name); });

struct ErrorCase {
  const char* name;
  std::string text;
  Lines diagnostics;
};

class IniError : public ::testing::TestWithParam<ErrorCase> {};

TEST_P(IniError, IsReported) {
  const auto result = IniFile::parse(GetParam().text, "c.ini");
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(messages(result), GetParam().diagnostics);
}

ErrorCase in_value(const char* name, const char* value, const std::string& error) {
  return {name, std::string("[A]\nX=") + value + "\n", {"c.ini:2: error: " + error}};
}

INSTANTIATE_TEST_SUITE_P(
    Format, IniError,
    ::testing::Values(
        ErrorCase{"NoEquals",
                  "[A]\nX\n",
                  {"c.ini:2: error: Invalid tag 'X'. Expected '=' after tag identifier"}},
        ErrorCase{"ByteOrderMark",
                  "\xEF\xBB\xBF[A]\nX=1\n",
                  {"c.ini:1: error: Invalid tag '\xEF\xBB\xBF[A]'. Expected '=' after tag "
                   "identifier",
                   "c.ini:2: error: Tag 'X' found without prior section definition",
                   "c.ini:1: warning: The file begins with a UTF-8 byte order mark; save it "
                   "without one"}},
        ErrorCase{"BlankInKey",
                  "[A]\nX Y = 1\n",
                  {"c.ini:2: error: Invalid tag name 'X Y'. Identifier contains invalid "
                   "character(s)"}},
        ErrorCase{"KeyStartsWithDigit",
                  "[A]\n1X=1\n",
                  {"c.ini:2: error: Invalid tag '1X'. Tag identifiers cannot start with a digit"}},
        ErrorCase{
            "NoKey", "[A]\n=1\n", {"c.ini:2: error: Invalid tag. Missing identifier before '='"}},
        ErrorCase{"NoSection",
                  "X=1\n",
                  {"c.ini:1: error: Tag 'X' found without prior section definition"}},
        ErrorCase{"OpenHeader", "[A\nX=1\n", {"c.ini:1: error: Invalid section. Missing ']'"}},
        ErrorCase{"EmptyHeader",
                  "[ ]\n",
                  {"c.ini:1: error: Invalid section. No content between '[' and ']'"}},
        ErrorCase{"HeaderCharacters",
                  "[A-B]\n",
                  {"c.ini:1: error: Invalid section 'A-B'. Identifier contains invalid "
                   "character(s)"}},
        ErrorCase{"HeaderDigit",
                  "[1A]\n",
                  {"c.ini:1: error: Invalid section '1A'. Cannot start with a digit"}},
        ErrorCase{
            "LastContinuation", "[A]\nX=1\\\n", {"c.ini:2: error: Last line has a continuation"}},
        ErrorCase{"LiteralNul",
                  std::string("[A]\nX=a\0b\n", 10),
                  {"c.ini:2: error: Embedded literal NUL character not supported"}},
        in_value("BadUtf8", "\xFF", "Value contains invalid UTF-8 sequence"),
        in_value("BadUtf8FromEscape", "\\xff", "Value contains invalid UTF-8 sequence"),
        in_value("OverlongUtf8", "\xC0\x80", "Value contains invalid UTF-8 sequence"),
        in_value("OctalNul", "\\0", "Embedded octal NUL character not supported"),
        in_value("HexNul", "\\x00", "Embedded hex NUL character not supported"),
        in_value("Utf16Nul", "\\u0000", "Embedded UTF-16 NUL character not supported"),
        in_value("Utf32Nul", "\\U00000000", "Embedded UTF-32 NUL character not supported"),
        in_value("ShortHex", "\\x4", "Improper hex escape"),
        in_value("BadHex", "\\xZZ", "Invalid hex 'ZZ' in hex escape"),
        in_value("ShortUtf16", "\\u12", "Improper UTF-16 escape"),
        in_value("LoneHighSurrogate", "\\uD83Dx", "Missing low surrogate in UTF-16"),
        in_value("BadUtf32", "\\U0000ZZZZ", "Invalid hex value '0000ZZZZ' in UTF-32 escape"),
        in_value("TooLargeCodePoint", "\\U00110000",
                 "Invalid code point U00110000 in UTF-32 escape"),
        ErrorCase{"IncludeWithoutName",
                  "#INCLUDE  \n",
                  {"c.ini:1: error: Missing filename after #INCLUDE"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(IniParse, EveryErrorIsReportedAtOnce) {
  const auto result = IniFile::parse("[A]\nX\n1Y=2\nZ=3\n", "c.ini");
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.diagnostics.size(), 2U);
}

TEST(IniParse, SectionNamesAreTrimmedAndCaseSensitive) {
  const auto result = IniFile::parse("[ A ] ; c\nX=1\n[B] # c\n[a]\nX=2\n", "c.ini");
  ASSERT_TRUE(result.ok);
  EXPECT_TRUE(result.diagnostics.empty());
  EXPECT_EQ(result.file.sections(), (Lines{"A", "B", "a"}));
  EXPECT_EQ(result.file.find("a", "X")->value, "2");
  EXPECT_EQ(result.file.find("b", "X"), nullptr);
}

TEST(IniParse, TrailingTextAfterHeaderIsAWarning) {
  const auto result = IniFile::parse("[A] junk\nX=1\n", "c.ini");
  EXPECT_TRUE(result.ok);
  EXPECT_EQ(messages(result),
            Lines{"c.ini:1: warning: Section header has trailing content, ignored"});
}

TEST(IniParse, RepeatedSectionIsMerged) {
  const auto result = IniFile::parse("[A]\nX=1\n[B]\nX=9\n[A]\nX=2\n", "c.ini");
  ASSERT_TRUE(result.ok);
  EXPECT_EQ(messages(result), Lines{"c.ini:5: warning: Section 'A' already exists. Merging..."});
  EXPECT_EQ(result.file.find("A", "X", 2)->value, "2");
  EXPECT_EQ(result.file.find("A", "X", 3), nullptr);
  EXPECT_EQ(result.file.find_all("A", "X").size(), 2U);
  EXPECT_EQ(result.file.find("", "X", 2)->section, "B");
  EXPECT_EQ(result.file.sections(), (Lines{"A", "B"}));
}

TEST(IniParse, EntriesKnowTheirPlace) {
  const auto result = IniFile::parse("\n[A]\nX=1\\\n2\nY=3\n", "c.ini");
  EXPECT_EQ(result.file.find("A", "X")->at.text(), "c.ini:3");
  EXPECT_EQ(result.file.find("A", "Y")->at.text(), "c.ini:5");
  EXPECT_EQ(result.file.section_position("A").text(), "c.ini:2");
}

TEST(IniParse, EmptyNamesMeanAny) {
  const auto result = IniFile::parse("[A]\nX=1\n[B]\nY=2\nX=3\n", "c.ini");
  EXPECT_EQ(result.file.find("", "")->value, "1");
  EXPECT_EQ(result.file.find("B", "")->value, "2");
  EXPECT_EQ(result.file.find("", "X", 2)->value, "3");
  EXPECT_EQ(result.file.variables("B").size(), 2U);
  EXPECT_EQ(result.file.variables("").size(), 3U);
  EXPECT_EQ(result.file.find("A", "X", 0), nullptr);
}

TEST(IniParse, OnlyTheExactIncludeWordIncludes) {
  const auto result =
      IniFile::parse("[A]\n#include no.ini\n# INCLUDE no.ini\n  #INCLUDE no.ini\nX=1\n", "c.ini");
  EXPECT_TRUE(result.ok);
  EXPECT_TRUE(result.diagnostics.empty());
}

TEST_F(IniFiles, MissingFileHasNoLine) {
  const auto result = IniFile::load("nofile.ini");
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(messages(result), Lines{"nofile.ini: error: Cannot open ini-file (errno=2 (No such "
                                    "file or directory))"});
}

TEST_F(IniFiles, FolderInsteadOfFileIsAnError) { EXPECT_FALSE(IniFile::load(dir_.string()).ok); }

TEST_F(IniFiles, IncludeIsReadInPlaceRelativeToItsFile) {
  write("sub/inner.ini", "X=inner\n#INCLUDE deeper.ini\n");
  write("sub/deeper.ini", "[B]\nY=deep\n");
  const std::string top = write("top.ini", "[A]\n#INCLUDE   sub/inner.ini  \nZ=after\n");
  const auto result = IniFile::load(top);
  ASSERT_TRUE(result.ok) << ::testing::PrintToString(messages(result));
  EXPECT_EQ(result.file.find("A", "X")->at.text(), (dir_ / "sub/inner.ini").string() + ":1");
  EXPECT_EQ(result.file.find("B", "Y")->value, "deep");
  // A section that an included file opened stays open behind the #INCLUDE line.
  EXPECT_EQ(result.file.find("B", "Z")->value, "after");
}

TEST_F(IniFiles, IncludeTakesAbsoluteAndHomeNames) {
  write("home.ini", "X=1\n");
  const std::string absolute = write("abs.ini", "Y=2\n");
  const char* old = std::getenv("HOME");
  const std::string saved = old != nullptr ? old : "";
  setenv("HOME", dir_.c_str(), 1);
  const auto result =
      IniFile::load(write("top.ini", "[A]\n#INCLUDE ~/home.ini\n#INCLUDE " + absolute + "\n"));
  setenv("HOME", saved.c_str(), 1);
  ASSERT_TRUE(result.ok) << ::testing::PrintToString(messages(result));
  EXPECT_NE(result.file.find("A", "X"), nullptr);
  EXPECT_NE(result.file.find("A", "Y"), nullptr);
}

TEST_F(IniFiles, MissingIncludeNamesTheLineThatAsks) {
  const std::string top = write("top.ini", "[A]\n#INCLUDE gone.ini\n");
  const auto result = IniFile::load(top);
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(messages(result),
            Lines{top + ":2: error: Cannot open ini-file '" + (dir_ / "gone.ini").string() +
                  "' (errno=2 (No such file or directory))"});
}

TEST_F(IniFiles, RecursionIsFoundAlsoAroundTheCorner) {
  const std::string self = write("self.ini", "[A]\n#INCLUDE self.ini\n");
  EXPECT_EQ(messages(IniFile::load(self)),
            Lines{self + ":2: error: Include file recursion on loading '" + self + "'"});
  const std::string one = write("one.ini", "[A]\n#INCLUDE two.ini\n");
  const std::string two = write("two.ini", "#INCLUDE ./one.ini\n");
  const auto result = IniFile::load(one);
  ASSERT_EQ(result.diagnostics.size(), 1U);
  EXPECT_EQ(result.diagnostics[0].at.text(), two + ":1");
}

TEST_F(IniFiles, SameFileTwiceInARowIsNoRecursion) {
  write("part.ini", "X=1\n");
  const auto result =
      IniFile::load(write("top.ini", "[A]\n#INCLUDE part.ini\n#INCLUDE part.ini\n"));
  EXPECT_TRUE(result.ok);
  EXPECT_EQ(result.file.find_all("A", "X").size(), 2U);
}

TEST_F(IniFiles, DepthIsLimited) {
  for (int i = 1; i < 20; ++i) {
    write("f" + std::to_string(i) + ".ini", "#INCLUDE f" + std::to_string(i + 1) + ".ini\n");
  }
  const auto result = IniFile::load((dir_ / "f1.ini").string());
  ASSERT_EQ(result.diagnostics.size(), 1U);
  EXPECT_EQ(result.diagnostics[0].message(),
            (dir_ / "f16.ini").string() +
                ":1: error: Maximum include depth (16) reached on loading '" +
                (dir_ / "f17.ini").string() + "'");
}

// Any text gives a result and no crash, and what loads can be looked up again.
TEST(IniParse, RandomTextNeverBreaks) {
  constexpr std::string_view kAlphabet = "[]A=1\\\n #;xu0\t\r\"\xC3";
  unsigned seed = 42;
  for (int round = 0; round < 2000; ++round) {
    std::string text = round % 2 == 0 ? "[A]\n" : "";
    for (int i = 0; i < 60; ++i) {
      seed = seed * 1664525U + 1013904223U;
      text += kAlphabet[(seed >> 16) % kAlphabet.size()];
    }
    const auto result = IniFile::parse(text, "r.ini");
    for (const Entry* entry : result.file.variables("")) {
      EXPECT_FALSE(result.file.find_all(entry->section, entry->key).empty());
      EXPECT_GT(entry->at.line, 0);
    }
    bool errors = false;
    for (const auto& d : result.diagnostics) errors = errors || d.is_error;
    EXPECT_NE(result.ok, errors) << text;
  }
}

}  // namespace
}  // namespace kerf::ini
