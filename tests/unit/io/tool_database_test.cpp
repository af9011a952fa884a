// [EMCIO]DB_PROGRAM: the conversation with a program that keeps the tools. Manual: "Tool Database Interface".
#include "io/tool_database.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "io/tool_store.hpp"

namespace kerf::io {
namespace {

class ToolDatabaseTest : public testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/kerf-db-XXXXXX";
    folder = ::mkdtemp(name);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  /// A shell script; the options to run it.
  ToolDatabase::Options script(const std::string& body, int timeout_ms = 2000) {
    std::ofstream(folder + "/db") << "#!/bin/sh\n" << body;
    ::chmod((folder + "/db").c_str(), 0755);
    return {"db", folder, "", timeout_ms};
  }
  static std::string error_of(const ToolDatabase::Options& options) {
    auto db = ToolDatabase::start(options);
    return db.ok() ? "" : db.error().message();
  }
  std::string log() {
    std::ifstream in(folder + "/log");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// Pumps until something is said.
  static std::string news(ToolDatabase& db) {
    for (int i = 0; i < 50; ++i) {
      const auto said = db.pump();
      if (!said.empty()) return said.front();
      pollfd p[2] = {{db.answer_fd(), POLLIN, 0}, {db.timer_fd(), POLLIN, 0}};
      (void)::poll(p, 2, 100);
    }
    return "";
  }
  static constexpr const char* kGood =
      "echo v2.1\nwhile read -r cmd; do echo \"$cmd\" >>log\ncase $cmd in\n"
      "g) echo 'T1 P3 Z10 D6 ;mill'; echo T2 P4; echo FINI;;\n*) echo ok;;\nesac; done\n";
  std::string folder;
};

TEST_F(ToolDatabaseTest, GivesAllToolsAndIsToldOfChanges) {
  auto db = ToolDatabase::start(script(kGood));
  ASSERT_TRUE(db.ok()) << db.error().message();
  for (int i = 0; i < 3; ++i) {
    const auto tools = (*db)->get();
    ASSERT_TRUE(tools.ok()) << tools.error().message();
    EXPECT_EQ(*tools, "T1 P3 Z10 D6 ;mill\nT2 P4\n");
    (*db)->tell("l T1 P0");
    (*db)->tell("u T0 P0");
  }
  EXPECT_TRUE((*db)->get().ok());
  EXPECT_EQ(log(), "g\nl T1 P0\nu T0 P0\ng\nl T1 P0\nu T0 P0\ng\nl T1 P0\nu T0 P0\ng\n");
  EXPECT_TRUE((*db)->pump().empty());
}

TEST_F(ToolDatabaseTest, WhatIsNoToolDatabaseIsNamed) {
  EXPECT_NE(error_of({"nothing-here", folder, "", 500}).find("cannot run"), std::string::npos);
  EXPECT_NE(error_of({"nothing-here", folder, "", 500}).find("nothing-here"), std::string::npos);
  EXPECT_NE(error_of(script("echo v1.0\nsleep 5\n")).find("'v1.0'"), std::string::npos);
  EXPECT_NE(error_of(script("exit 3\n")).find("exit status 3"), std::string::npos);
  EXPECT_NE(error_of(script("kill -9 $$\n")).find("signal 9"), std::string::npos);
  EXPECT_NE(error_of(script("sleep 60\n", 300)).find("no answer"), std::string::npos);
  EXPECT_NE(error_of(script("head -c 100000 /dev/zero | tr '\\0' x\nsleep 5\n")).find("4096"),
            std::string::npos);
  auto options = script("echo v2.1\n");
  ::chmod((folder + "/db").c_str(), 0644);
  EXPECT_NE(error_of(options).find("chmod +x"), std::string::npos);
}

TEST_F(ToolDatabaseTest, AQuestionWithoutAnEndIsAnError) {
  auto hangs = ToolDatabase::start(script("echo v2.1\nread x\necho T1 P1\nsleep 60\n", 300));
  ASSERT_TRUE(hangs.ok());
  auto tools = (*hangs)->get();
  ASSERT_FALSE(tools.ok());
  EXPECT_NE(tools.error().message().find("no answer"), std::string::npos);
  auto dies = ToolDatabase::start(script("echo v2.1\nread x\necho T1 P1\nexit 4\n"));
  ASSERT_TRUE(dies.ok());
  tools = (*dies)->get();
  ASSERT_FALSE(tools.ok());
  EXPECT_NE(tools.error().message().find("exit status 4"), std::string::npos);
  EXPECT_FALSE((*dies)->running());
}

TEST_F(ToolDatabaseTest, NobodyWaitsForAProgramThatHangsOrDies) {
  auto nak = ToolDatabase::start(script("echo v2.1\nread x\necho NAK no tool 1\nread x\nexit 0\n"));
  ASSERT_TRUE(nak.ok());
  (*nak)->tell("l T1 P0");
  EXPECT_NE(news(**nak).find("NAK no tool 1"), std::string::npos);
  (*nak)->tell("u T0 P0");
  EXPECT_NE(news(**nak).find("exit status 0"), std::string::npos);
  for (int i = 0; i < 1000; ++i) (*nak)->tell("l T1 P0");
  EXPECT_TRUE((*nak)->pump().empty()) << "said once";

  auto hangs = ToolDatabase::start(script("echo v2.1\nexec sleep 60\n", 300));
  ASSERT_TRUE(hangs.ok());
  // More than a pipe holds.
  for (int i = 0; i < 100000; ++i) (*hangs)->tell("p T1 P1 Z1.25 D6");
  EXPECT_NE(news(**hangs).find("does not confirm"), std::string::npos);
  EXPECT_FALSE((*hangs)->get().ok());
}

TEST_F(ToolDatabaseTest, TheStoreStartsItAgainAndKeepsItsTableMeanwhile) {
  ToolStore store("never.tbl", 1.0);
  store.use_database(
      script("echo v2.1\nread x\necho T1 P1; echo FINI\nread x; echo $x >>log\nexit 1\n"), "");
  ASSERT_TRUE(store.load().ok());
  EXPECT_NE(store.table()->find(1), nullptr);
  ToolEntry entry = *store.table()->find(1);
  entry.offset.z = 12.5;
  EXPECT_TRUE(store.put(entry).ok());
  std::vector<std::string> news;
  for (int i = 0; i < 50 && news.empty(); ++i) {
    ::usleep(20000);
    news = store.database_news();
  }
  ASSERT_FALSE(news.empty());
  EXPECT_EQ(log(), "p T1 P1 Z12.5 D0\n");
  EXPECT_EQ(store.table()->find(1)->offset.z, 12.5);
  EXPECT_TRUE(store.database_fds().empty());
  EXPECT_TRUE(store.load().ok()) << "started anew";
  EXPECT_EQ(store.table()->find(1)->offset.z, 0);
  std::filesystem::remove(folder + "/db");
  EXPECT_TRUE(store.put(entry).ok());
  for (int i = 0; i < 50 && store.database_fds().size() > 0; ++i) {
    ::usleep(20000);
    (void)store.database_news();
  }
  EXPECT_FALSE(store.load().ok());
  EXPECT_EQ(store.table()->find(1)->offset.z, 12.5) << "the present table stays";
}

TEST_F(ToolDatabaseTest, ThePythonModuleSpeaksIt) {
  if (std::system("python3 -c 'pass' >/dev/null 2>&1") != 0) GTEST_SKIP() << "no python3";
  std::ofstream(folder + "/db") << "#!/usr/bin/env python3\nimport sys\nsys.path.insert(0, '"
                                << KERF_SOURCE_DIR << "/src/python')\n"
                                << R"(
from tooldb import tooldb_tools, tooldb_callbacks, tooldb_loop
tools = {10: 'T10 P110 D6', 11: ['T11', 'P111']}
def get(toolno):
    return tools[toolno]
def note(toolno, params):
    with open('log', 'a') as log:
        print(toolno, params, file=log)
def unload(toolno, params):
    raise RuntimeError('nothing to unload')
tooldb_tools([11, 10])
tooldb_callbacks(get, note, note, unload)
tooldb_loop()
)";
  ::chmod((folder + "/db").c_str(), 0755);
  auto db = ToolDatabase::start({"db", folder, "", 20000});
  ASSERT_TRUE(db.ok()) << db.error().message();
  (*db)->tell("p T10 P110 z1.5 ;remark");
  (*db)->tell("l T11 P0");
  const auto tools = (*db)->get();
  ASSERT_TRUE(tools.ok()) << tools.error().message();
  EXPECT_EQ(*tools, "T10 P110 D6\nT11 P111\n");
  EXPECT_EQ(log(), "10 T10 P110 Z1.5\n11 T11 P0\n");
  (*db)->tell("u T0 P0");
  EXPECT_EQ(news(**db), "tool database: NAK nothing to unload");
}

TEST_F(ToolDatabaseTest, ARandomChangerRemembersItsSpindle) {
  const auto options = script(kGood);
  for (int round = 0; round < 2; ++round) {
    ToolStore store("", 1.0, true);
    store.use_database(options, folder + "/db_spindle.tbl");
    ASSERT_TRUE(store.load().ok());
    if (round == 0) {
      EXPECT_EQ(store.table()->find_pocket(0), nullptr);
      EXPECT_TRUE(store.move({{2, 0}}).ok());
      EXPECT_TRUE(store.in_spindle(2, -1, 4).ok());
      ASSERT_TRUE(store.load().ok());  // all is said
      EXPECT_EQ(log(), "g\nu T0 P4\nl T2 P0\ng\n");
    }
    ASSERT_NE(store.table()->find_pocket(0), nullptr);
    EXPECT_EQ(store.table()->find_pocket(0)->number, 2);
  }
}

}  // namespace
}  // namespace kerf::io
