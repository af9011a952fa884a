#include "interp/interpreter.hpp"

#include <algorithm>

#include "interp/core.hpp"

namespace kerf::interp {

std::string InterpError::message() const {
  std::string m;
  if (line > 0 || !file.empty()) {
    m = file.empty() ? "MDI" : file;
    if (line > 0) m += ':' + std::to_string(line);
    if (column > 0) m += ':' + std::to_string(column);
    m += ": ";
  }
  m += text;
  if (!help.empty()) m += '\n' + help;
  return m;
}

std::string InterpError::caret() const {
  const auto before = static_cast<std::size_t>(std::max(column, 1) - 1);
  if (column <= 0 || before >= source.size() || before > 200) return {};
  std::string s;
  for (const char c : std::string_view(source).substr(0, before)) s += c == '\t' ? '\t' : ' ';
  return s + '^';
}

Interpreter::Interpreter(Environment& environment, Canon& canon, const Settings& settings)
    : Interpreter(environment, canon, settings, dialect_of(settings.dialect)) {}
Interpreter::Interpreter(Environment& environment, Canon& canon, const Settings& settings,
                         const Dialect& dialect)
    : core_(std::make_unique<Core>(environment, canon, settings, dialect)) {}
Interpreter::~Interpreter() = default;

void Interpreter::init() { core_->init(); }

rtapi::Status Interpreter::open(const std::string& path) {
  auto source = open_file_source(path, core_->dialect.longest_line);
  if (!source) return rtapi::Failure<rtapi::Error>{source.error()};
  core_->open_main(path, std::move(*source));
  return {};
}

rtapi::Status Interpreter::open_text(const std::string& name, std::string text) {
  core_->open_main(name, make_text_source(std::move(text), core_->dialect.longest_line));
  return {};
}

void Interpreter::open_stream(const std::string& name) { core_->open_stream(name); }

rtapi::Status Interpreter::push_line(std::string_view line) {
  LineStream* const stream = core_->stream();
  if (stream == nullptr)
    return rtapi::fail(rtapi::Errc::busy, "No stream is open\nopen_stream() first");
  return stream->push(line);
}

void Interpreter::end_stream() {
  if (LineStream* const stream = core_->stream(); stream != nullptr) stream->end();
}

void Interpreter::close() { core_->close_main(); }

bool Interpreter::is_open() const {
  return !core_->flows.frames.empty() && (!core_->flows.mdi || !core_->flows.parked.empty());
}

Outcome Interpreter::execute_next() { return core_->execute_next(); }
Outcome Interpreter::execute_mdi(std::string_view text) { return core_->execute_mdi(text); }
bool Interpreter::mdi_active() const { return core_->flows.mdi; }
SyncReason Interpreter::sync_reason() const { return core_->sync; }
void Interpreter::synchronize(const ExternalState& state) { core_->synchronize(state); }
void Interpreter::abort() { core_->abort(); }
bool Interpreter::waiting() const { return core_->compensation.waits(); }
void Interpreter::replace_tool_offset(const Pose& offset) { core_->replace_tool_offset(offset); }
bool Interpreter::used_machine_place() const { return core_->machine_place; }
bool Interpreter::beside_path() const { return core_->compensation.beside(); }
const ModalState& Interpreter::modal() const {
  return core_->shown != nullptr ? *core_->shown : core_->state;
}
void Interpreter::restore(const ModalState& state) { core_->restore(state); }
const InterpError& Interpreter::error() const { return core_->error; }
const std::string& Interpreter::script_problem() const { return core_->script_problem_; }
ParameterTable& Interpreter::parameters() { return core_->params; }
void Interpreter::set_block_delete(bool on) { core_->block_delete = on; }

void Interpreter::set_tool_in_spindle(int number, int pocket) {
  core_->synchronize({.tool_in_spindle = number, .pocket_in_spindle = pocket});
}

bool Interpreter::at_line_start() const {
  return core_->repeats.left == 0 && core_->flows.resume == nullptr && !core_->flows.skip.active &&
         core_->flows.profile == nullptr;
}

int Interpreter::call_level() const {
  const auto n = core_->flows.frames.size();
  return n == 0 ? 0 : static_cast<int>(n) - 1;
}

int Interpreter::next_line() const {
  const auto& frames = core_->flows.frames;
  return frames.empty() ? 0 : frames.back().place.line + 1;
}

std::uint32_t Interpreter::current_file() const {
  const auto& frames = core_->flows.frames;
  return frames.empty() ? 0 : frames.back().program;
}

const std::string& Interpreter::file_name(std::uint32_t file_id) const {
  const auto& programs = core_->flows.programs;
  return programs[file_id < programs.size() ? file_id : 0].path;
}

}  // namespace kerf::interp
