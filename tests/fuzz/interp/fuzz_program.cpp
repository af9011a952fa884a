#include "fuzz/interp/fuzz_program.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "interp/interpreter.hpp"
#include "interp/null_canon.hpp"
#include "interp/text_canon.hpp"
#include "unit/interp/shop_dialect.hpp"

namespace kerf::interp {
namespace {

/// Blocks of one program, and errors after which it goes on.
constexpr int kMostBlocks = 400;
constexpr int kMostErrors = 40;
/// Lines of an MDI session or a stream.
constexpr int kMostLines = 100;

void expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

class World final : public Environment {
 public:
  std::optional<Tool> find_tool(int number) override {
    if (number < 1 || number > 3) return std::nullopt;
    Tool t;
    t.number = t.pocket = number;
    t.offset.z = 10.0 * number;
    t.diameter_mm = 3.0 * number;
    t.orientation = number;
    return t;
  }
  UserMcode find_user_mcode(int number) override {
    return number == 101 ? UserMcode{"/M101", ""} : UserMcode{"", "no such file"};
  }
  std::optional<double> hal_value(std::string_view name) override {
    return name == "a" ? std::optional<double>(1.5) : std::nullopt;
  }
};

/// Counts blocks and looks at the numbers of moves.
class CheckedCanon final : public NullCanon {
 public:
  int blocks{0};
  void next_block(const SourceLine& source) override {
    ++blocks;
    expect(source.line >= 0 && source.call_level >= 0, "a block stands somewhere");
  }
  void straight_traverse(const Pose& end) override { finite(end); }
  void straight_feed(const Pose& end) override { finite(end); }
  void arc_feed(const Arc& arc) override {
    finite(arc.end);
    expect(arc.turns != 0, "an arc turns");
    for (const double c : arc.center) expect(std::isfinite(c), "the centre of an arc is a point");
  }
  void set_feed_rate(double linear, double angular) override {
    expect(std::isfinite(linear) && std::isfinite(angular), "a feed is a number");
  }

 private:
  static void finite(const Pose& p) {
    for (std::size_t i = 0; i < rtapi::kAxes; ++i)
      expect(std::isfinite(p[i]), "the end of a move is a point");
  }
};

ExternalState answer(const Interpreter& interp) {
  ExternalState state;
  switch (interp.sync_reason()) {
    case SyncReason::probe:
      state.probe =
          ExternalState::Probe{interp.modal().frame.to_machine(interp.modal().position), true};
      break;
    case SyncReason::tool_change:
      state.tool_in_spindle = interp.modal().selected_tool;
      state.pocket_in_spindle = interp.modal().selected_pocket;
      break;
    case SyncReason::wait_input: state.input_value = 1; break;
    default: break;
  }
  return state;
}

/// Runs what is open; true when it may go on with more MDI lines.
void run(Interpreter& interp, const CheckedCanon* checked, Outcome o, bool mdi) {
  int errors = 0, seen = checked != nullptr ? checked->blocks : 0;
  for (int i = 0; i < kMostBlocks; ++i) {
    if (o == Outcome::error) {
      expect(checked == nullptr || checked->blocks == seen, "a block in error makes no call");
      expect(!interp.error().text.empty(), "an error says what it is");
      if (mdi || ++errors == kMostErrors) return;
    }
    if (o == Outcome::needs_sync) interp.synchronize(answer(interp));
    if (o == Outcome::idle || o == Outcome::program_end) return;
    if (mdi && !interp.mdi_active()) return;
    if (checked != nullptr) seen = checked->blocks;
    o = interp.execute_next();
  }
}

/// Cuts the next line off.
std::string next_line(std::string_view& data) {
  const std::size_t end = data.find('\n');
  std::string line(data.substr(0, end));
  data.remove_prefix(end == std::string_view::npos ? data.size() : end + 1);
  return line;
}

/// A line `!` is an abort as task does it: back to the state of the item at which motion stopped, here that of the last `?`.
bool stopped(Interpreter& interp, const std::string& line, ModalState& then) {
  if (line == "?") then = interp.modal();
  if (line != "!") return line == "?";
  interp.abort();
  interp.restore(then);
  interp.synchronize({.machine_position = then.frame.to_machine(then.position)});
  expect(!interp.waiting() && !interp.beside_path(), "nothing waits after an abort");
  return true;
}

void run_mdi(Interpreter& interp, const CheckedCanon* checked, std::string_view data) {
  ModalState then = interp.modal();
  for (int lines = 0; !data.empty() && lines < kMostLines; ++lines) {
    const std::string line = next_line(data);
    if (stopped(interp, line, then)) continue;
    const int before = checked != nullptr ? checked->blocks : 0;
    const Outcome o = interp.execute_mdi(line);
    expect(o != Outcome::error || checked == nullptr || checked->blocks == before,
           "an MDI line in error makes no call");
    run(interp, checked, o, true);
    interp.abort();
    expect(!interp.mdi_active(), "no MDI line runs after an abort");
  }
}

/// Each line is answered before the next, but for those that end with a \x01: these wait for the one behind.
void run_stream(Interpreter& interp, const CheckedCanon* checked, std::string_view data) {
  ModalState then = interp.modal();
  interp.open_stream("fuzz");
  for (int lines = 0; lines < kMostLines; ++lines) {
    const bool ends = data.empty();
    const std::string line = next_line(data);
    if (ends) {
      interp.end_stream();
    } else if (stopped(interp, line, then)) {
      continue;
    } else {
      expect(interp.push_line(line).ok(), "a short stream takes every line");
      if (line.ends_with('\x01')) continue;
    }
    Outcome o = Outcome::ok;
    for (int i = 0; i < kMostBlocks; ++i) {
      const int before = checked != nullptr ? checked->blocks : 0;
      o = interp.execute_next();
      if (o == Outcome::needs_line || o == Outcome::program_end || o == Outcome::idle) break;
      if (o == Outcome::needs_sync) interp.synchronize(answer(interp));
      if (o != Outcome::error) continue;
      expect(checked == nullptr || checked->blocks == before, "a line in error makes no call");
      expect(!interp.error().text.empty(), "an error says what it is");
    }
    expect(!ends || o != Outcome::needs_line, "a stream that ended wants no line");
    if (ends) return;
  }
}

}  // namespace

void run_fuzzed(std::string_view data) {
  if (data.empty()) return;
  constexpr unsigned kText = 1, kMdi = 2, kDelete = 4, kMetric = 8, kTask = 16, kStream = 32,
                     kShop = 64, kLookAhead = 128;
  const auto how = static_cast<unsigned char>(data.front());
  data.remove_prefix(1);
  World world;
  Settings settings;
  settings.machine_unit_mm = (how & kMetric) != 0 ? 1.0 : 25.4;
  settings.is_task = (how & kTask) != 0;
  settings.spindles = 2;
  settings.compensation_look_ahead = (how & kLookAhead) != 0 ? 3 : 0;
  static std::FILE* const nowhere = std::fopen("/dev/null", "we");
  TextCanon text(nowhere);
  CheckedCanon checked;
  const bool printing = (how & kText) != 0;
  Interpreter interp(world, printing ? static_cast<Canon&>(text) : checked, settings,
                     (how & kShop) != 0 ? shop_dialect() : linuxcnc_dialect());
  interp.init();
  interp.set_block_delete((how & kDelete) != 0);
  const CheckedCanon* const check = printing ? nullptr : &checked;
  if ((how & kStream) != 0) return run_stream(interp, check, data);
  if ((how & kMdi) != 0) return run_mdi(interp, check, data);
  if (!interp.open_text("fuzz.ngc", std::string(data)).ok()) return;
  run(interp, check, Outcome::ok, false);
  interp.abort();
  expect(interp.call_level() == 0, "nothing runs after an abort");
}

}  // namespace kerf::interp
