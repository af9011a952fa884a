// Functions in Python as parts of the interpreter: the library kerf_interp_python.so over an embedded CPython.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "interp/config/script_library.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// One Python per process: the functions of all tests stand in one folder, and one host serves them.
class PythonTest : public ::testing::Test {
 protected:
  static constexpr const char* kRemap = R"PY(
from interpreter import *
import interpreter
import emccanon
from stdglue import *

def words(self, **words):
    emccanon.MESSAGE("%s %d %d" % (sorted(words.items()), self.call_level, self.remap_level))
    return INTERP_OK
def text(self, **words):
    return "failing miserably"
def raises(self, **words):
    raise ValueError("boom")
def generator(self, **words):
    emccanon.MESSAGE("a")
    yield INTERP_EXECUTE_FINISH
    emccanon.MESSAGE("b %d" % self.params[5399])
    yield INTERP_EXECUTE_FINISH
    emccanon.MESSAGE("c")
def waits(self, **words):
    emccanon.WAIT(0, 1, 2, 5.0)
    yield INTERP_EXECUTE_FINISH
    self.execute("G0 X%f" % self.params[5399])
def executes(self, **words):
    self.execute("G0 X1")
    self.execute("G0 X2\nG0 X3", 42)
    self.execute("M400")
    emccanon.MESSAGE("at %g" % self.current_x)
    return INTERP_OK
def executes_wait(self, **words):
    self.execute("M66 P0 L0")
    emccanon.MESSAGE("input %d" % self.params[5399])
def catches(self, **words):
    try:
        self.execute("G3456", 7)
    except InterpreterException as e:
        return "%d %s %s" % (e.line_number, e.line_text, e.error_message)
def catches_not(self, **words):
    self.execute("G0 X1\nG1 X2")
def returns_status(self, **words):
    interpreter.throw_exceptions = 0
    try:
        code = self.execute("G1 X2")
    finally:
        interpreter.throw_exceptions = 1
    return "status %d: %s" % (code, self.get_errormsg())
def finish(self, **words):
    return INTERP_EXECUTE_FINISH
def error(self, **words):
    self.set_errormsg("my message")
    return INTERP_ERROR
def bare_error(self, **words):
    return INTERP_ERROR
def number(self, **words):
    return 1.5
def prolog(self, **words):
    self.params["myname"] = 123
    self.params[1] = 345
    self.params["_glob"] = 7
    return INTERP_OK
def epilog(self, **words):
    return "%g %g %g %d" % (self.params[1], self.params["result"], self.return_value, self.value_returned)
def waiting_prolog(self, **words):
    self.params["a"] = 1
    yield INTERP_EXECUTE_FINISH
    self.params["b"] = 2
def good_epilog(self, **words):
    emccanon.MESSAGE("epilog %g" % self.return_value)
    yield INTERP_EXECUTE_FINISH
    emccanon.MESSAGE("done")
def canon(self, **words):
    emccanon.STRAIGHT_TRAVERSE(3, 1, 2, 3, 0, 0, 0, 0, 0, 0)
    emccanon.SET_FEED_RATE(5)
    emccanon.STRAIGHT_FEED(3, 4, 2, 3, 0, 0, 0, 0, 0, 0)
    emccanon.enqueue_SET_SPINDLE_SPEED(0, 100.0)
    return INTERP_OK
def block(self, **words):
    c = self.blocks[self.remap_level]
    return "%s %g %s %g %s %d %d %d" % (c.x_flag, c.x_number, c.p_flag, c.p_number, c.comment, c.line_number,
                                        c.n_number, c.motion_to_be)
def attributes(self, **words):
    self.own = getattr(self, "own", 0) + 1
    self.selected_tool = 5
    return "%d %d %d %g %s %d" % (self.own, self.selected_tool, self.task, self.speed[0], self.motion_mode,
                                  self.find_tool_pocket(99)[0])
def enums(self, **words):
    emccanon.SELECT_PLANE(emccanon.CANON_PLANE_XZ)
    emccanon.DISABLE_SPEED_OVERRIDE(0)
    return "%s %d %s %r %s %s" % (emccanon.GET_EXTERNAL_PLANE().name, emccanon.CANON_AXIS_W,
                               interpreter.FEED_MODE(self.feed_mode).name, self.blocks[0].o_name,
                               [s for _, s in self.stack()], emccanon.GET_EXTERNAL_SPINDLE_OVERRIDE_ENABLE(0))
def misspelt(self, **words):
    return self.curent_x
def readonly(self, **words):
    self.call_level = 3
def missing(self, **words):
    try:
        return self.params["nothing"]
    except KeyError:
        return "no such parameter"
def forever(self, **words):
    while True:
        pass
def sleeps(self, **words):
    import time
    time.sleep(3)
)PY";
  static constexpr const char* kOword = R"PY(
def five(self, *args):
    return len(args) + sum(args)
def none(self, *args):
    pass
def text(self, *args):
    return "error text"
def wrong(self, *args):
    return [1]
def mover(self, *args):
    self.execute("G0 X%f" % args[0])
    return 2
)PY";
  static constexpr const char* kToplevel = "import remap\nimport oword\nimport namedparams\n";
  static constexpr const char* kNamed = "def _pi(self):\n    return 3.1415926535\n";

  static void SetUpTestSuite() {
    dir = new fs::path(fs::temp_directory_path() / ("kerf_python_" + std::to_string(::getpid())));
    fs::create_directories(*dir);
    write("remap.py", kRemap);
    write("oword.py", kOword);
    write("namedparams.py", kNamed);
    write("toplevel.py", kToplevel);
    write("pp.ngc",
          "o<pp> sub\n(debug,myname #<myname> #1 glob #<_glob>)\n#<result> = [#<myname> * "
          "2]\n#1 = 9\no<pp> endsub [4]\n");
    write("ab.ngc", "o<ab> sub\n(debug,#<a> #<b>)\no<ab> endsub [1]\n");
    write("body.ngc", "o<body> sub\n(debug,body)\no<body> endsub [1]\n");
  }
  static void TearDownTestSuite() {
    fs::remove_all(*dir);
    delete dir;
  }
  static void write(const std::string& name, const std::string& text) {
    std::ofstream(*dir / name) << text;
  }

  class World final : public Environment {
   public:
    BenchEnvironment files;
    ScriptHost* host{nullptr};
    std::string warnings;
    ScriptHost* scripts() override { return host; }
    std::string find_sub(std::string_view name) override { return files.find_sub(name); }
    std::optional<Tool> find_tool(int number) override { return files.find_tool(number); }
    void warning(std::string_view text) override { warnings += std::string(text) + "\n"; }
  };

  void SetUp() override { start(); }
  void TearDown() override { interp_.reset(); }
  void start(const std::string& toplevel = "toplevel.py", bool reload = false) {
    PythonSettings settings;
    settings.reload_on_change = reload;
    settings.toplevel = (*dir / toplevel).string();
    settings.path_prepend = {dir->string()};
    auto host = open_scripts(settings, [this] { return stop_ && ++asked_ > 3; });
    if (!host.ok()) GTEST_SKIP() << host.error().message();
    host_ = std::move(*host);
    world_.host = host_.get();
    world_.files.add_directory(dir->string());
    printed_ = std::make_unique<PrintedCalls>();
    Settings s;
    for (const char* line : {"M400 argspec=p ngc=body",
                             "M401 argspec=Pqx python=words",
                             "M402 python=text",
                             "M403 python=raises",
                             "M404 python=generator",
                             "M405 python=executes",
                             "M406 python=catches",
                             "M407 python=catches_not",
                             "M408 python=waits",
                             "M409 python=finish",
                             "M410 python=error",
                             "M411 python=bare_error",
                             "M412 prolog=prolog ngc=pp epilog=epilog",
                             "M413 python=canon",
                             "G88.6 modalgroup=1 python=block",
                             "M414 python=attributes",
                             "M415 python=misspelt",
                             "M432 python=enums",
                             "M416 prolog=waiting_prolog ngc=ab epilog=good_epilog",
                             "M417 python=number",
                             "M418 python=returns_status",
                             "M419 python=readonly",
                             "M420 python=missing",
                             "M421 python=nofunction",
                             "M422 prolog=text ngc=body",
                             "M423 python=forever",
                             "M424 python=sleeps",
                             "M425 python=executes_wait",
                             "M426 python=changing",
                             "M427 python=added",
                             "T prolog=prepare_prolog ngc=body epilog=prepare_epilog"})
      s.remaps.push_back(parse_remap(line).remap.value());
    interp_ = std::make_unique<Interpreter>(world_, printed_->canon(), s);
    interp_->init();
    (void)calls();
  }
  std::string calls() { return printed_->take(); }
  /// Calls of a line; "error: TEXT" at the end. Waits are answered with the input 5; `waits_` counts them.
  std::string mdi(const std::string& line) {
    waits_ = 0;
    Outcome o = interp_->execute_mdi(line);
    for (;;) {
      if (o == Outcome::needs_sync) {
        ++waits_;
        interp_->synchronize({.input_value = 5});
      } else if (o != Outcome::ok) {
        break;
      }
      if (!interp_->mdi_active()) break;
      o = interp_->execute_next();
    }
    std::string c = calls();
    if (o != Outcome::error) return c;
    if (interp_->mdi_active()) interp_->abort();
    return c + "error: " + interp_->error().text;
  }
  static std::string message(const std::string& text) { return "MESSAGE(\"" + text + "\")\n"; }
  static std::string traverse(const std::string& x) {
    return "STRAIGHT_TRAVERSE(" + x + ", 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n";
  }

  static fs::path* dir;
  std::unique_ptr<ScriptHost> host_;
  World world_;
  std::unique_ptr<PrintedCalls> printed_;
  std::unique_ptr<Interpreter> interp_;
  int waits_{0}, asked_{0};
  bool stop_{false};
};
fs::path* PythonTest::dir = nullptr;

TEST_F(PythonTest, BodiesGetTheirWords) {
  EXPECT_EQ(mdi("M401 P1 Q2"), message("[('p', 1.0), ('q', 2.0)] 1 1"));
  EXPECT_EQ(mdi("M401"), "error: user-defined M401: missing: P");
  EXPECT_EQ(mdi("M421"), "error: 'nofunction' is not a Python callable function");
}

TEST_F(PythonTest, WhatTheyReturnDecides) {
  EXPECT_EQ(mdi("M402"), "error: failing miserably");
  EXPECT_EQ(interp_->error().line, 1);
  EXPECT_EQ(mdi("M403"), "error: pycall(remap.raises) failed: ValueError: boom");
  EXPECT_THAT(interp_->error().help, HasSubstr("remap.py(13): raises"));
  EXPECT_EQ(mdi("M410"), "error: my message");
  EXPECT_EQ(mdi("M411"), "error: remap.bare_error returned INTERP_ERROR");
  EXPECT_THAT(mdi("M417"), HasSubstr("remap.number must return INTERP_OK"));
  EXPECT_EQ(mdi("M409 G0 X1"), traverse("1.0000"));
  EXPECT_EQ(waits_, 1) << "returning INTERP_EXECUTE_FINISH waits";
}

TEST_F(PythonTest, GeneratorsWaitAtEachYield) {
  EXPECT_EQ(mdi("M404 G0 X9"), message("a") + message("b 5") + message("c") + traverse("9.0000"));
  EXPECT_EQ(waits_, 2);
  EXPECT_EQ(mdi("M408"), traverse("5.0000"));
  EXPECT_EQ(waits_, 1);
}

TEST_F(PythonTest, ExecuteRunsLinesSubsAndRemaps) {
  EXPECT_EQ(mdi("M405 G0 X4"), traverse("1.0000") + traverse("2.0000") + traverse("3.0000") +
                                   message("body") + message("at 3") + traverse("4.0000"));
  EXPECT_EQ(mdi("M425"), message("input 5"));
  EXPECT_EQ(waits_, 1);
  EXPECT_EQ(interp_->call_level(), 0);
}

TEST_F(PythonTest, ErrorsOfExecuteAreExceptions) {
  EXPECT_EQ(mdi("M406"), "error: 7 G3456 G-code out of range");
  EXPECT_EQ(mdi("M407"), traverse("1.0000") +
                             "error: pycall(remap.catches_not) failed: InterpreterException: "
                             "Cannot do g1 with zero feed rate");
  EXPECT_EQ(mdi("M418"), "error: status 5: Cannot do g1 with zero feed rate");
  EXPECT_EQ(mdi("G0 X2"), traverse("2.0000")) << "nothing is left behind";
}

TEST_F(PythonTest, PrologAndEpilogShareTheScopeOfTheSub) {
  EXPECT_EQ(mdi("M412"),
            message("myname 123.000000 345.000000 glob 7.000000") + "error: 9 246 4 1");
  EXPECT_EQ(mdi("(debug,#<myname>)"), message("######"));
  EXPECT_EQ(mdi("M416"), message("1.000000 2.000000") + message("epilog 1") + message("done"));
  EXPECT_EQ(waits_, 2);
  EXPECT_EQ(mdi("M422"), "error: failing miserably");
}

TEST_F(PythonTest, GlueThatScriptsImportIsOurs) {
  world_.files.set_tool({3, 7, {}, 0, 0, 0, 0});
  EXPECT_EQ(mdi("T3"), message("body") + "SELECT_TOOL(3)\n");
  EXPECT_EQ(mdi("T4"), "error: T4: pocket not found");
}

TEST_F(PythonTest, CanonicalCalls) {
  EXPECT_EQ(mdi("M413"),
            "STRAIGHT_TRAVERSE(1.0000, 2.0000, 3.0000, 0.0000, 0.0000, 0.0000)\n"
            "SET_FEED_RATE(5.0000)\n"
            "STRAIGHT_FEED(4.0000, 2.0000, 3.0000, 0.0000, 0.0000, 0.0000)\n"
            "SET_SPINDLE_SPEED(0, 100.0000)\n");
  EXPECT_EQ(mdi("G1 X5"), "STRAIGHT_FEED(5.0000, 2.0000, 3.0000, 0.0000, 0.0000, 0.0000)\n")
      << "the interpreter knows feed and position";
}

TEST_F(PythonTest, BlockAndAttributes) {
  EXPECT_EQ(mdi("N5 G88.6 X1 P2 (note)"), "COMMENT(\"note\")\nerror: True 1 True 2 note 1 5 886");
  EXPECT_EQ(mdi("M414"), "error: 1 5 0 0 800 5");
  EXPECT_EQ(mdi("M414"), "error: 2 5 0 0 800 5") << "a function's own attributes stay";
  EXPECT_THAT(mdi("M415"), HasSubstr("did you mean current_x?"));
  EXPECT_THAT(mdi("M419"), HasSubstr("call_level is read-only"));
  EXPECT_EQ(mdi("M420"), "error: no such parameter");
}

TEST_F(PythonTest, EnumsAndBlocksWithoutALabel) {
  EXPECT_EQ(mdi("M432"), "error: CANON_PLANE_XZ 9 UNITS_PER_MINUTE '' ['', 'enums'] 0");
}

TEST_F(PythonTest, OwordSubs) {
  EXPECT_EQ(mdi("o<five> call [1][2.5]"), "");
  EXPECT_EQ(mdi("(debug,#<_value> #<_value_returned>)"), message("5.500000 1.000000"));
  EXPECT_EQ(mdi("o<none> call"), "");
  EXPECT_EQ(mdi("(debug,#<_value> #<_value_returned>)"), message("0.000000 0.000000"));
  EXPECT_EQ(mdi("o<text> call"), "error: error text");
  EXPECT_THAT(mdi("o<wrong> call"), HasSubstr("oword.wrong must return a number"));
  EXPECT_EQ(mdi("o<mover> call [3]"), traverse("3.0000"));
}

TEST_F(PythonTest, CommentsAndNamedParameters) {
  EXPECT_EQ(mdi(";py,import emccanon; emccanon.MESSAGE('Hi %d' % self.call_level)"),
            message("Hi 0"));
  EXPECT_EQ(mdi("G0 X1 ;py,x = 1"), traverse("1.0000"));
  EXPECT_THAT(mdi(";py,nonsense"), HasSubstr("NameError"));
  EXPECT_EQ(mdi("(debug,#<_pi>)"), message("3.141593"));
  EXPECT_EQ(mdi("G0 X[2 * #<_pi>]"), traverse("6.2832"));
}

TEST_F(PythonTest, HungFunctionsAreAbandonedWhenTheProgramStops) {
  stop_ = true;
  EXPECT_THAT(mdi("M423"), HasSubstr("was stopped"));
  asked_ = 0;
  EXPECT_THAT(mdi("M424"), HasSubstr("abandoned"));
  stop_ = false;
  EXPECT_EQ(mdi("M401 P1"), message("[('p', 1.0)] 1 1")) << "Python goes on working";
}

TEST_F(PythonTest, AbortEndsAFunctionThatWaits) {
  EXPECT_EQ(interp_->execute_mdi("M404"), Outcome::ok);
  EXPECT_EQ(interp_->execute_next(), Outcome::needs_sync);
  interp_->abort();
  (void)calls();
  EXPECT_EQ(mdi("M401 P1"), message("[('p', 1.0)] 1 1"));
  EXPECT_EQ(interp_->call_level(), 0);
}

TEST_F(PythonTest, ABrokenToplevelIsSaid) {
  write("broken.py", "import remap\nimport nothing_of_this_name\n");
  TearDown();
  start("broken.py");
  EXPECT_THAT(interp_->script_problem(), HasSubstr("nothing_of_this_name"));
  EXPECT_THAT(world_.warnings, HasSubstr("broken.py"));
}

/// Other functions for the running machine: remap.py ends with `changing`, for which others follow.
class PythonReload : public PythonTest {
 protected:
  void SetUp() override {
    change("remap.py", kRemap + changing("one"));
    start("toplevel.py", true);
  }
  void TearDown() override {
    PythonTest::TearDown();
    change("remap.py", kRemap);
    change("toplevel.py", kToplevel);
  }
  static std::string changing(const std::string& says) {
    return "def changing(self, **words):\n    emccanon.MESSAGE(\"" + says + "\")\n";
  }
  /// Each change has a time of its own, however fast the test is.
  static void change(const std::string& name, const std::string& text) {
    static int changes = 0;
    write(name, text);
    fs::last_write_time(*dir / name,
                        fs::last_write_time(*dir / name) + std::chrono::milliseconds(++changes));
  }
};

TEST_F(PythonReload, AChangedModuleCountsFromTheNextCall) {
  // The module is that of the process; other tests imported it before this one wrote its function.
  change("remap.py", kRemap + changing("one"));
  EXPECT_EQ(mdi("M426"), message("one"));
  change("remap.py", kRemap + changing("two"));  // as long as before, within the same second
  EXPECT_EQ(mdi("M426"), message("two"));
  EXPECT_EQ(mdi("M426"), message("two"));
  EXPECT_EQ(mdi("M401 P1"), message("[('p', 1.0)] 1 1")) << "the others are there too";
}

TEST_F(PythonReload, AnAddedFunctionIsFound) {
  change("toplevel.py", kToplevel + std::string("remap.__dict__.pop('added', None)\n"));
  EXPECT_EQ(mdi("M427"), "error: 'added' is not a Python callable function");
  change("toplevel.py", kToplevel);
  change("remap.py", kRemap + std::string("added = number\n"));
  EXPECT_THAT(mdi("M427"), HasSubstr("remap.added must return INTERP_OK"));
}

TEST_F(PythonReload, AChangedToplevelRunsAgain) {
  change("toplevel.py", std::string(kToplevel) + "remap.changing = remap.finish\n");
  EXPECT_EQ(mdi("M426 G0 X1"), traverse("1.0000"));
  EXPECT_EQ(waits_, 1);
}

TEST_F(PythonReload, AWrongChangeLeavesTheFunctionsAndIsSaidOnce) {
  change("remap.py", kRemap + changing("good"));
  EXPECT_EQ(mdi("M426"), message("good"));
  change("remap.py", "def changing(self, **words:\n");
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(mdi("M426"), message("good"));
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("SyntaxError"));
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(mdi("M426"), message("good"));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  change("remap.py", kRemap + changing("mended"));
  EXPECT_EQ(mdi("M426"), message("mended"));
}

TEST_F(PythonReload, WithoutTheKeyNothingIsReadAgain) {
  change("remap.py", kRemap + changing("read"));
  EXPECT_EQ(mdi("M426"), message("read"));
  interp_.reset();
  start();
  change("remap.py", kRemap + changing("unread"));
  EXPECT_EQ(mdi("M426"), message("read"));
}

TEST(PythonAbsent, CommentsSayThatThereIsNone) {
  Rig rig;
  EXPECT_EQ(rig.mdi(";py,print(1)"), "");
  EXPECT_EQ(rig.mdi("(py, print)"), "");
}

}  // namespace
}  // namespace kerf::interp
