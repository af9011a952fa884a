#include "launcher/resume.hpp"

#include <sys/stat.h>

#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "ini/ini_file.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/stop_signals.hpp"
#include "rtapi/shm/segment.hpp"
#include "task/api/client.hpp"
#include "task/api/journal.hpp"

namespace kerf::launcher {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Status;
using task::JournalRecord;
using task::RunState;

namespace {

/// When the record was written: a clock of ours does not outlive the power, that of the file system does.
std::string time_of(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return "?";
  std::tm local{};
  char text[64];
  if (::localtime_r(&file.st_mtime, &local) == nullptr ||
      std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S %Z", &local) == 0)
    return "?";
  return text;
}

/// "" when the program is still what it was; else why not.
std::string why_changed(const JournalRecord& record) {
  if (!record.marked) return "it is not known what the program was: it could not be read then";
  auto mark = task::mark_file(record.program);
  if (!mark.ok()) return mark.error().message();
  if (*mark == record.mark) return {};
  return record.program + " has changed since: line " + std::to_string(record.line) +
         " may be another one now. Run it by hand from a line of your choice "
         "(docs/run-from-line.md)";
}

/// One command to its outcome, or until it runs.
rtapi::Result<task::Reply> ask(task::Client& client, rtapi::WaitClock& clock,
                               const std::vector<std::string>& words, bool until_it_runs = false) {
  KERF_TRY(const std::uint64_t id, client.send(words));
  for (;;) {
    rtapi::WaitSpec spec;
    client.add_to(spec);
    KERF_CHECK(client.poll());
    if (const auto reply = client.outcome(id)) {
      const bool runs = until_it_runs && reply->state == task::CommandState::running;
      if (reply->state == task::CommandState::done || runs) return *reply;
      if (task::is_terminal(reply->state)) return fail(Errc::bad_argument, reply->text);
    }
    if (clock.stopped()) return fail(Errc::cancelled, "interrupted");
    clock.wait(spec);
  }
}

Status go_on(const Options& options, const JournalRecord& record, Console& console) {
  const std::string instance =
      options.instance.empty() ? rtapi::default_instance() : options.instance;
  KERF_TRY(auto segment, rtapi::Segment::attach(instance));
  KERF_TRY(auto client, task::Client::connect(*segment));
  task::MachineFacts facts;
  if (client->shared().facts.read(facts) && facts.ini_file.view() != record.ini_file)
    return fail(Errc::bad_argument, "instance '" + instance + "' runs " +
                                        std::string(facts.ini_file.view()) +
                                        ", and the journal is of " + record.ini_file);
  KERF_TRY(auto clock, rtapi::join_clock(*segment, rtapi::Role::user_component, "resume"));
  const rtapi::StopOnSignal stop(*clock);
  const std::string line = std::to_string(record.line);
  KERF_CHECK(ask(*client, *clock, {"open", record.program}));
  KERF_TRY(const task::Reply differs, ask(*client, *clock, {"run", line, "check"}));
  console.print("\nTo reach line " + line + ":\n" + differs.text + "\n");
  KERF_CHECK(ask(*client, *clock, {"run", line}, true));
  console.print("The program runs from line " + line + ".\n");
  return {};
}

}  // namespace

int resume(const Options& options, Console& console) {
  const ini::LoadResult loaded = ini::IniFile::load(options.ini);
  for (const ini::Diagnostic& d : loaded.diagnostics) console.diagnostic(d);
  if (!loaded.ok) {
    console.error("the INI file cannot be used");
    return kExitFailure;
  }
  const ini::Entry* wish = loaded.file.find("KERF", "JOURNAL");
  const std::string path =
      task::journal_path(loaded.file.name(), wish != nullptr ? wish->value : std::string());
  if (path.empty()) {
    console.error("[KERF]JOURNAL = off: this machine keeps no journal");
    return kExitFailure;
  }
  auto record = task::read_journal(path);
  if (!record.ok()) {
    console.error(record.error().code == Errc::not_found
                      ? "no program has run on this machine (" + path + ")"
                      : record.error().message());
    return kExitFailure;
  }
  console.print("recorded    " + time_of(path) + ", in " + path + "\n" + task::describe(*record));
  if (record->state == RunState::ended) {
    console.print("\nThe program ran to its end: there is nothing to go on with.\n");
    return options.resume_run ? kExitFailure : kExitOk;
  }
  const std::string changed = why_changed(*record);
  if (record->line < 1) {
    console.print("\nNothing of the program itself was executed: run it from its start.\n");
    return options.resume_run ? kExitFailure : kExitOk;
  }
  if (!changed.empty()) {
    console.error(changed);
    return kExitFailure;
  }
  if (!options.resume_run) {
    console.print(
        "\nThe program file is unchanged. Start the machine, home it, look at the work and at the "
        "tool; then\n"
        "  kerf resume --run " +
        options.ini + "\ngoes on from the beginning of line " + std::to_string(record->line) +
        ", with the approach of docs/run-from-line.md.\n");
    return kExitOk;
  }
  if (Status went = go_on(options, *record, console); !went.ok()) {
    console.error(went.error().message());
    return kExitFailure;
  }
  return kExitOk;
}

}  // namespace kerf::launcher
