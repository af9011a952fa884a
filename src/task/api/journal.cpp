#include "task/api/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "task/api/number_text.hpp"

namespace kerf::task {

using rtapi::Errc;
using rtapi::fail;
using Json = nlohmann::json;

namespace {

constexpr std::uint64_t kFnvStart = 0xcbf29ce484222325ULL, kFnvFactor = 0x100000001b3ULL;
constexpr const char* kHead = "kerf-journal 1 ";
constexpr std::size_t kHeadBytes = 64;  ///< of a slot, before the record

std::uint64_t fnv(std::string_view bytes, std::uint64_t hash = kFnvStart) noexcept {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * kFnvFactor;
  return hash;
}

struct File {
  int fd{-1};
  ~File() {
    if (fd >= 0) ::close(fd);
  }
};

rtapi::Failure<rtapi::Error> errno_failure(const std::string& what, const std::string& path) {
  const int e = errno;
  return fail(e == ENOENT   ? Errc::not_found
              : e == EACCES ? Errc::permission
                            : Errc::system,
              what + " " + path + ": " + std::strerror(e));
}

constexpr const char* kStates[] = {"running", "paused", "stopped", "ended"};

Json pose_json(const rtapi::Pose& pose) {
  Json out = Json::array();
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) out.push_back(pose[a]);
  return out;
}

rtapi::Pose pose_from(const Json& json) {
  rtapi::Pose pose;
  for (std::size_t a = 0; a < rtapi::kAxes && a < json.size(); ++a) pose[a] = json[a].get<double>();
  return pose;
}

Json json_of(const JournalRecord& r) {
  return {{"number", r.number},
          {"time_ns", r.time_ns},
          {"state", to_string(r.state)},
          {"ini", r.ini_file},
          {"program", r.program},
          {"size", r.mark.size},
          {"hash", r.mark.hash},
          {"marked", r.marked},
          {"line", r.line},
          {"from_line", r.from_line},
          {"source", r.source},
          {"source_line", r.source_line},
          {"executed", r.executed},
          {"why", r.why},
          {"position", pose_json(r.position)},
          {"joints", r.joints},
          {"homed", r.homed},
          {"tool", r.tool},
          {"tool_offset", pose_json(r.tool_offset)},
          {"g5x_offset", pose_json(r.g5x_offset)},
          {"g92_offset", pose_json(r.g92_offset)},
          {"g5x_index", r.g5x_index},
          {"rotation_deg", r.rotation_deg},
          {"g_codes", r.g_codes},
          {"m_codes", r.m_codes},
          {"feed", r.feed},
          {"speed", r.speed},
          {"spindle_rpm", r.spindle_rpm},
          {"flood", r.flood},
          {"mist", r.mist},
          {"digital_out", r.digital_out}};
}

JournalRecord record_of(const Json& j) {
  JournalRecord r;
  r.number = j.at("number");
  r.time_ns = j.at("time_ns");
  const std::string state = j.at("state");
  for (std::size_t i = 0; i < std::size(kStates); ++i)
    if (state == kStates[i]) r.state = static_cast<RunState>(i);
  r.ini_file = j.at("ini");
  r.program = j.at("program");
  r.mark = {j.at("size"), j.at("hash")};
  r.marked = j.at("marked");
  r.line = j.at("line");
  r.from_line = j.at("from_line");
  r.source = j.at("source");
  r.source_line = j.at("source_line");
  r.executed = j.at("executed");
  r.why = j.at("why");
  r.position = pose_from(j.at("position"));
  r.joints = j.at("joints").get<std::vector<double>>();
  r.homed = j.at("homed");
  r.tool = j.at("tool");
  r.tool_offset = pose_from(j.at("tool_offset"));
  r.g5x_offset = pose_from(j.at("g5x_offset"));
  r.g92_offset = pose_from(j.at("g92_offset"));
  r.g5x_index = j.at("g5x_index");
  r.rotation_deg = j.at("rotation_deg");
  r.g_codes = j.at("g_codes");
  r.m_codes = j.at("m_codes");
  r.feed = j.at("feed");
  r.speed = j.at("speed");
  r.spindle_rpm = j.at("spindle_rpm").get<std::vector<double>>();
  r.flood = j.at("flood");
  r.mist = j.at("mist");
  r.digital_out = j.at("digital_out");
  return r;
}

std::string pose_text(const rtapi::Pose& pose) {
  std::string text;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a)
    if (a < 3 || pose[a] != 0)
      text += (text.empty() ? "" : " ") + std::string(1, rtapi::kAxisLetters[a]) + number(pose[a]);
  return text;
}

template <std::size_t N>
std::string codes_text(char letter, const std::array<std::int32_t, N>& codes, int tenths) {
  std::string text;
  for (std::size_t i = 1; i < N; ++i) {
    if (codes[i] < 0) continue;
    text += (text.empty() ? "" : " ") + std::string(1, letter) + std::to_string(codes[i] / tenths);
    if (codes[i] % tenths != 0) text += '.' + std::to_string(codes[i] % tenths);
  }
  return text;
}

}  // namespace

const char* to_string(RunState state) noexcept { return kStates[static_cast<std::size_t>(state)]; }

rtapi::Result<FileMark> mark_file(const std::string& path) {
  const File in{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (in.fd < 0) return errno_failure("cannot read", path);
  FileMark mark{0, kFnvStart};
  char buffer[65536];
  for (;;) {
    const ssize_t n = ::read(in.fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno_failure("cannot read", path);
    if (n == 0) return mark;
    mark.size += static_cast<std::uint64_t>(n);
    mark.hash = fnv({buffer, static_cast<std::size_t>(n)}, mark.hash);
  }
}

std::string journal_path(const std::string& ini_file, const std::string& wish) {
  namespace fs = std::filesystem;
  if (wish == "off") return {};
  const fs::path ini = fs::absolute(ini_file).lexically_normal();
  if (!wish.empty()) return (ini.parent_path() / wish).lexically_normal().string();
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  fs::path folder = state != nullptr && *state == '/'
                        ? fs::path(state)
                        : fs::path(home == nullptr ? "/" : home) / ".local/state";
  // Machines of the same name in different folders have journals of their own.
  char digits[24];
  std::snprintf(digits, sizeof digits, "-%016llx",
                static_cast<unsigned long long>(fnv(ini.string())));
  return (folder / "kerf" / (ini.stem().string() + digits + ".journal")).string();
}

std::string format_slot(const JournalRecord& record) {
  constexpr std::size_t kRoom = kJournalSlotBytes - kHeadBytes;
  const auto dump = [](const JournalRecord& r) {
    return json_of(r).dump(-1, ' ', false, Json::error_handler_t::replace);
  };
  std::string body = dump(record);
  if (body.size() > kRoom) {
    JournalRecord shorter = record;
    shorter.why.clear();
    body = dump(shorter);
  }
  if (body.size() > kRoom) return {};  // names of thousands of letters
  char head[kHeadBytes + 1];
  std::snprintf(head, sizeof head, "%s%zu %016llx", kHead, body.size(),
                static_cast<unsigned long long>(fnv(body)));
  std::string slot(head);
  slot.resize(kHeadBytes - 1, ' ');
  slot += '\n';
  slot += body;
  slot.resize(kJournalSlotBytes - 1, ' ');
  slot += '\n';
  return slot;
}

rtapi::Result<JournalRecord> parse_slot(std::string_view bytes) {
  const auto torn = [] { return fail(Errc::syntax, "no whole record"); };
  if (bytes.size() < kJournalSlotBytes || bytes.substr(0, std::strlen(kHead)) != kHead)
    return torn();
  unsigned long long hash = 0;
  std::size_t length = 0;
  const std::string head(bytes.substr(std::strlen(kHead), kHeadBytes - std::strlen(kHead)));
  if (std::sscanf(head.c_str(), "%zu %llx", &length, &hash) != 2 ||
      length > kJournalSlotBytes - kHeadBytes)
    return torn();
  const std::string_view body = bytes.substr(kHeadBytes, length);
  if (fnv(body) != hash) return torn();
  try {
    return record_of(Json::parse(body));
  } catch (const Json::exception&) {
    return torn();
  }
}

rtapi::Result<JournalRecord> read_journal(const std::string& path) {
  const File in{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (in.fd < 0) return errno_failure("cannot read the journal", path);
  std::string bytes(kJournalSlots * kJournalSlotBytes, '\0');
  const ssize_t n = ::pread(in.fd, bytes.data(), bytes.size(), 0);
  if (n < 0) return errno_failure("cannot read the journal", path);
  bytes.resize(static_cast<std::size_t>(n));
  std::optional<JournalRecord> newest;
  for (std::size_t i = 0; i < kJournalSlots && (i + 1) * kJournalSlotBytes <= bytes.size(); ++i) {
    auto record =
        parse_slot(std::string_view(bytes).substr(i * kJournalSlotBytes, kJournalSlotBytes));
    if (record.ok() && (!newest || record->number > newest->number)) newest = std::move(*record);
  }
  if (!newest) return fail(Errc::not_found, path + ": no whole record in this journal");
  return std::move(*newest);
}

std::string describe(const JournalRecord& r) {
  std::string text = "program     " + r.program + "\n";
  const char* how = r.state == RunState::running  ? "was running when the record ends"
                    : r.state == RunState::paused ? "was paused when the record ends"
                    : r.state == RunState::ended  ? "ran to its end"
                                                  : "was stopped";
  text += std::string("state       ") + how + (r.why.empty() ? "" : ": " + r.why) + "\n";
  text += "line        " + std::to_string(r.line);
  if (!r.source.empty()) text += ", in " + r.source + " line " + std::to_string(r.source_line);
  if (r.from_line > 0) text += " (it was begun at line " + std::to_string(r.from_line) + ")";
  text += "\nposition    " + pose_text(r.position) + " (machine, mm and degrees)\n";
  text += "tool        " + std::to_string(r.tool) + ", offset " + pose_text(r.tool_offset) + "\n";
  constexpr const char* kSystems[] = {"?",   "G54", "G55",   "G56",   "G57",
                                      "G58", "G59", "G59.1", "G59.2", "G59.3"};
  const auto system = static_cast<std::size_t>(r.g5x_index);
  text += std::string("offsets     ") + (system < std::size(kSystems) ? kSystems[system] : "?") +
          " " + pose_text(r.g5x_offset) + ", G92 " + pose_text(r.g92_offset);
  if (r.rotation_deg != 0) text += ", turned by " + number(r.rotation_deg);
  text += "\ncodes       " + codes_text('G', r.g_codes, 10) + " " + codes_text('M', r.m_codes, 1) +
          " F" + number(r.feed) + " S" + number(r.speed) + "\n";
  for (std::size_t n = 0; n < r.spindle_rpm.size(); ++n) {
    const double rpm = r.spindle_rpm[n];
    text += "spindle " + std::to_string(n) + "   " +
            (rpm == 0 ? std::string("stood")
                      : std::string(rpm > 0 ? "forward " : "reverse ") +
                            number(rpm > 0 ? rpm : -rpm) + " rpm") +
            "\n";
  }
  text += std::string("coolant     flood ") + (r.flood ? "on" : "off") + ", mist " +
          (r.mist ? "on" : "off") + "\n";
  return text;
}

}  // namespace kerf::task
