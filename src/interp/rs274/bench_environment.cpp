#include "interp/rs274/bench_environment.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace kerf::interp {

namespace {

/// One word of a tool line into the tool; false when it is none.
bool tool_word(char letter, double value, double unit_mm, Tool& t) {
  const char upper = letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 32) : letter;
  switch (upper) {
    case 'T': t.number = static_cast<int>(value); return true;
    case 'P': t.pocket = static_cast<int>(value); return true;
    case 'D': t.diameter_mm = value * unit_mm; return true;
    case 'I': t.front_angle_deg = value; return true;
    case 'J': t.back_angle_deg = value; return true;
    case 'Q': t.orientation = static_cast<int>(value); return true;
    default: break;
  }
  const int axis = rtapi::axis_index(upper);
  if (axis < 0) return false;
  const auto i = static_cast<std::size_t>(axis);
  t.offset[i] = rtapi::is_rotary(i) ? value : value * unit_mm;
  return true;
}

}  // namespace

Settings bench_settings() {
  Settings s;
  s.machine_unit_mm = 25.4;
  s.start_units = Units::mm;
  s.axis_mask = 0x3F;
  return s;
}

ExternalState bench_answer(const Interpreter& interpreter, const Pose& start, TextCanon& canon) {
  ExternalState state;
  if (interpreter.sync_reason() == SyncReason::tool_change) {
    if (const auto offset = canon.take_offset_of_last_motion(); offset) {
      const CanonFrame& now = interpreter.modal().frame;
      CanonFrame then = now;
      then.use_tool_length_offset(*offset);
      const Pose seen = then.to_program(now.to_machine(interpreter.modal().position));
      state.machine_position = now.to_machine(seen);
    }
  }
  if (interpreter.sync_reason() != SyncReason::probe) return state;
  constexpr double kShortMm = 0.254;
  const ModalState& modal = interpreter.modal();
  const Pose end = modal.position, way = end - start;
  const double length = std::hypot(way.x, way.y, way.z);
  Pose stop = end;
  if (length > 0) {
    for (std::size_t i = 0; i < 3; ++i) stop[i] -= way[i] / length * kShortMm;
  }
  state.probe = ExternalState::Probe{modal.frame.to_machine(end), false};
  state.machine_position = modal.frame.to_machine(stop);
  return state;
}

rtapi::Status BenchEnvironment::load_tools(const std::string& path, double unit_mm) {
  std::FILE* file = std::fopen(path.c_str(), "re");
  if (file == nullptr)
    return rtapi::fail(rtapi::Errc::not_found,
                       "Unable to open file <" + path + ">: " + std::strerror(errno));
  char line[1024];
  std::int32_t number = 0;
  rtapi::Status status;
  while (status.ok() && std::fgets(line, sizeof line, file) != nullptr) {
    ++number;
    if (char* comment = std::strchr(line, ';'); comment != nullptr) *comment = '\0';
    Tool t;
    for (char* at = line; *at != '\0' && status.ok();) {
      if (std::isspace(static_cast<unsigned char>(*at)) != 0) {
        ++at;
        continue;
      }
      char* end = nullptr;
      const double value = std::strtod(at + 1, &end);
      if (end == at + 1 || !tool_word(*at, value, unit_mm, t)) {
        status = rtapi::fail(
            rtapi::Errc::syntax, std::string("unknown word in the tool table: ") + *at,
            {rtapi::FixedString<160>(path), number, static_cast<std::int32_t>(at - line) + 1});
        break;
      }
      at = end;
    }
    if (t.number >= 0) tools_[t.number] = t;
  }
  std::fclose(file);
  return status;
}

std::optional<Tool> BenchEnvironment::find_tool(int number) {
  const auto hit = tools_.find(number);
  return hit == tools_.end() ? std::nullopt : std::optional<Tool>(hit->second);
}

std::optional<Tool> BenchEnvironment::find_pocket(int pocket) {
  for (const auto& [number, tool] : tools_) {
    if (tool.pocket == pocket) return tool;
  }
  return std::nullopt;
}

void BenchEnvironment::warning(std::string_view text) {
  std::fprintf(stderr, "%.*s\n", static_cast<int>(text.size()), text.data());
}

std::string BenchEnvironment::find_sub(std::string_view name) {
  for (const std::string& directory : directories_) {
    for (const char* suffix : {".ngc", ""}) {
      std::string path =
          (directory.empty() ? std::string() : directory + "/") + std::string(name) + suffix;
      struct stat st {};
      if (::stat(path.c_str(), &st) == 0 && S_ISREG(st.st_mode)) return path;
    }
  }
  return {};
}

}  // namespace kerf::interp
