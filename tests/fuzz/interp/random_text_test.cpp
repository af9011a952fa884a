// Random text never crashes, never hangs a step, and an error never makes a call or changes the state.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "rig.hpp"

namespace kerf::interp {
namespace {

/// KERF_FUZZ_SEED and KERF_FUZZ_LINES turn the dial; a failing seed becomes a named case.
unsigned from_environment(const char* name, unsigned otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}
const unsigned kSeed = from_environment("KERF_FUZZ_SEED", 20240607);
const int kLines = static_cast<int>(from_environment("KERF_FUZZ_LINES", 30000));

const char* const kPieces[] = {"G0 ",      "G1 ",        "G2 ",
                               "G81 ",     "G10 L2 P1 ", "G53 ",
                               "X",        "Y1",         "Z-1",
                               "R2",       "I1",         "J",
                               "F10 ",     "S",          "T1 ",
                               "M3 ",      "M6 ",        "M66 P0 ",
                               "#1=",      "#<a>=",      "#<_b>",
                               "#[",       "[",          "]",
                               "1",        ".5",         "-",
                               "+",        "**",         "/",
                               "sin[",     "atan[1]/[",  "o1 ",
                               "o<s> ",    "sub",        "call",
                               "endsub",   "if [1]",     "while [0]",
                               "endwhile", "do",         "repeat [2]",
                               "break",    "return",     "(",
                               ")",        "(msg,",      "(debug,#1",
                               ";",        "%",          "$",
                               "@1",       "^9",         " ",
                               "\t",       "N5 ",        "G92 ",
                               "G28 ",     "G43 ",       "L3 ",
                               "P1 ",      "Q.1 ",       "G20 ",
                               "G91 ",     "M2",         "exists[#<a>]",
                               "mod",      "eq",         "9999999999999999999",
                               "\x80",     "e5"};

std::string random_line(std::mt19937& rng) {
  std::string line;
  const auto n = rng() % 9;
  for (unsigned i = 0; i < n; ++i) {
    if (rng() % 12 == 0)
      line += static_cast<char>(rng() % 255 + 1);
    else
      line += kPieces[rng() % (sizeof kPieces / sizeof kPieces[0])];
  }
  for (char& c : line) {
    if (c == '\n') c = ' ';
  }
  return line;
}

TEST(RandomText, MdiLinesNeverBreakTheInterpreter) {
  std::mt19937 rng(kSeed);
  Rig rig;
  rig.world.files.set_tool({1, 1, {}, 6, 0, 0, 0});
  int errors = 0;
  for (int i = 0; i < kLines; ++i) {
    const std::string line = random_line(rng);
    const ModalState before = rig.interp.modal();
    Outcome o = rig.interp.execute_mdi(line);
    if (o == Outcome::error) {
      ++errors;
      ASSERT_EQ(rig.calls(), "") << "seed " << kSeed << " line " << i << ": " << line;
      ASSERT_EQ(rig.interp.modal().position, before.position) << line;
      ASSERT_EQ(rig.interp.modal().frame, before.frame) << line;
      ASSERT_FALSE(rig.interp.error().text.empty()) << line;
    }
    for (int k = 0; k < 50 && o != Outcome::error && rig.interp.mdi_active(); ++k) {
      if (o == Outcome::needs_sync) rig.interp.synchronize({});
      o = rig.interp.execute_next();
    }
    rig.interp.abort();
    (void)rig.calls();
  }
  EXPECT_GT(errors, kLines / 10);
  EXPECT_LT(errors, kLines);
}

TEST(RandomText, ProgramsNeverBreakTheInterpreter) {
  std::mt19937 rng(kSeed + 1);
  Rig rig;
  for (int i = 0; i < kLines / 50; ++i) {
    std::string program;
    for (int k = 0; k < 30; ++k) program += random_line(rng) + "\n";
    ASSERT_TRUE(rig.interp.open_text("random.ngc", program).ok());
    for (int k = 0; k < 300; ++k) {
      const Outcome o = rig.interp.execute_next();
      if (o == Outcome::needs_sync) rig.interp.synchronize({});
      if (o == Outcome::program_end || o == Outcome::idle) break;
    }
    (void)rig.calls();
  }
  rig.interp.close();
  EXPECT_EQ(rig.interp.execute_next(), Outcome::idle);
}

}  // namespace
}  // namespace kerf::interp
