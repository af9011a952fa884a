// The Python module gcode: programs as calls of a Python object, for previews. Needs no machine.
#include <pybind11/stl.h>

#include <cstdlib>
#include <filesystem>

#include "ini/ini_file.hpp"
#include "ini/reader.hpp"
#include "interp/config/ini_settings.hpp"
#include "interp/parameters.hpp"
#include "python/gcode/canon.hpp"

namespace kerf::python {
namespace {

namespace fs = std::filesystem;

// Results of parse().
constexpr int kStopped = 0, kProgramEnd = 1, kFileEnd = 3, kNotOpen = 4, kError = 5;
constexpr int kMinError = 3, kMaxError = -1;
/// How often check_abort() is asked.
constexpr int kBlocksPerQuestion = 50;

/// Of the last error in this process; under the GIL.
std::string& last_error() {
  static auto* const text = new std::string();
  return *text;
}

/// Tools by the canon's get_tool(), files by the folder of the program and by the INI file of the environment.
class PreviewEnvironment final : public interp::Environment {
 public:
  PreviewEnvironment(std::vector<std::string> folders, std::optional<interp::ProgramPaths> paths)
      : folders_(std::move(folders)), paths_(std::move(paths)) {}

  /// Slots as get_tool() counts them: 0 is the spindle.
  void add_tool(int slot, const interp::Tool& tool) { tools_.emplace_back(slot, tool); }
  [[nodiscard]] int slot_of(int number) const {
    for (const auto& [slot, tool] : tools_)
      if (slot > 0 && tool.number == number) return slot;
    return 0;
  }
  std::optional<interp::Tool> find_tool(int number) override {
    for (const auto& [slot, tool] : tools_)
      if (slot > 0 && tool.number == number) return tool;
    return std::nullopt;
  }
  std::optional<interp::Tool> find_pocket(int pocket) override {
    for (const auto& [slot, tool] : tools_)
      if (tool.pocket == pocket) return tool;
    return std::nullopt;
  }
  std::string find_sub(std::string_view name) override {
    for (const std::string& folder : folders_) {
      const fs::path file = fs::path(folder) / (std::string(name) + ".ngc");
      std::error_code ignored;
      if (fs::is_regular_file(file, ignored)) return file.string();
    }
    return paths_ ? interp::find_sub_file(*paths_, name) : std::string();
  }
  /// All of them: nothing is run.
  interp::UserMcode find_user_mcode(int number) override {
    return {"M" + std::to_string(number), ""};
  }

 private:
  std::vector<std::string> folders_;
  std::optional<interp::ProgramPaths> paths_;
  std::vector<std::pair<int, interp::Tool>> tools_;
};

class Parse {
 public:
  Parse(std::string file, const py::object& target) : file_(std::move(file)), canon_(target) {
    read_settings(target);
  }

  /// `codes`: blocks executed before the file.
  py::tuple run(const std::vector<std::string>& codes) {
    last_error().clear();
    std::vector<std::string> folders{fs::path(file_).parent_path().string()};
    if (folders[0].empty()) folders[0] = ".";
    PreviewEnvironment environment(folders, paths_);
    read_tools(environment);
    interp::Interpreter interpreter(environment, canon_, settings_);
    environment_ = &environment;
    if (!parameter_file_.empty())
      (void)interp::ParameterFile(parameter_file_).load(interpreter.parameters());
    interpreter.set_block_delete(block_delete_);
    canon_.begin_line(0);
    interpreter.init();
    // A preview of a program that leaves its feed to the operator is no error.
    interp::ModalState modal = interpreter.modal();
    modal.feed = modal.feed_word = 1;
    interpreter.restore(modal);
    canon_.use(interpreter);
    for (const std::string& code : codes) {
      if (code.empty()) continue;
      interp::Outcome outcome = interpreter.execute_mdi(code);
      const int result = go(interpreter, outcome, true);
      if (result > kMinError) return answer(interpreter, result);
    }
    if (auto opened = interpreter.open(file_); !opened.ok()) {
      last_error() = "File not open";
      rethrow();
      return py::make_tuple(kNotOpen, 1);
    }
    return answer(interpreter, go(interpreter, interp::Outcome::ok, false));
  }

 private:
  void rethrow() {
    if (canon_.failed()) std::rethrow_exception(canon_.failed());
  }

  py::tuple answer(const interp::Interpreter& interpreter, int result) {
    rethrow();
    int line = interpreter.next_line();
    if (result == kError) {
      const interp::InterpError& error = interpreter.error();
      last_error() = error.text;
      // At the end of the file nothing is wrong with its last line; the one behind it is missing.
      const bool at_end = error.text.rfind("File ended", 0) == 0;
      if (error.line > 0) line = at_end ? error.line + 1 : error.line;
    }
    return py::make_tuple(result, line);
  }

  /// Executes until the end; result of parse().
  int go(interp::Interpreter& interpreter, interp::Outcome outcome, bool mdi) {
    for (int blocks = 0;; ++blocks) {
      if (canon_.failed()) return kStopped;
      switch (outcome) {
        case interp::Outcome::ok: break;
        case interp::Outcome::needs_sync: synchronize(interpreter); break;
        case interp::Outcome::program_end:
          return canon_.ended_by_percent() ? kFileEnd : kProgramEnd;
        case interp::Outcome::needs_line:  // only senders of lines are asked for more
        case interp::Outcome::idle: return mdi ? kStopped : kFileEnd;
        case interp::Outcome::error: return kError;
      }
      if (blocks % kBlocksPerQuestion == kBlocksPerQuestion - 1) {
        if (const auto stop = canon_.ask("check_abort"); stop && stop->cast<bool>())
          return kStopped;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      }
      outcome = interpreter.execute_next();
    }
  }

  /// What was asked for has happened; probes touch at the end of their moves.
  void synchronize(interp::Interpreter& interpreter) {
    interp::ExternalState state;
    switch (interpreter.sync_reason()) {
      case interp::SyncReason::tool_change: {
        const int slot = environment_->slot_of(canon_.selected_tool());
        canon_.tool_changed(slot);
        state.tool_in_spindle = canon_.selected_tool();
        const auto tool = environment_->find_tool(canon_.selected_tool());
        state.pocket_in_spindle = tool ? tool->pocket : 0;
        break;
      }
      case interp::SyncReason::wait_input: state.input_value = 0; break;
      case interp::SyncReason::probe: {
        const rtapi::Pose at = interpreter.modal().frame.to_machine(canon_.end());
        state.machine_position = at;
        state.probe = interp::ExternalState::Probe{at, true};
        break;
      }
      default: break;
    }
    interpreter.synchronize(state);
  }

  void read_settings(const py::object& target) {
    if (const char* ini = std::getenv("INI_FILE_NAME"); ini != nullptr && *ini != '\0') {
      if (auto loaded = ini::IniFile::load(ini); loaded.ok) {
        ini::Reader reader(loaded.file);
        auto setup =
            interp::read_interp_setup(reader, reader.linear_unit("TRAJ", "LINEAR_UNITS", 1.0));
        settings_ = std::move(setup.settings);
        paths_ = std::move(setup.paths);
        // Remapped codes in Python belong to the machine's own interpreter.
      }
    }
    double unit_mm = 25.4;
    if (const auto units = canon_.ask("get_external_length_units"))
      if (const double n = units->cast<double>(); n > 0) unit_mm = 1 / n;
    settings_.machine_unit_mm = unit_mm;
    // Whoever wants mm says so with `unitcode`.
    settings_.start_units = interp::Units::inch;
    if (const auto mask = canon_.ask("get_axis_mask"))
      settings_.axis_mask = mask->cast<std::uint32_t>();
    if (const auto skip = canon_.ask("get_block_delete")) block_delete_ = py::bool_(*skip);
    const py::object file = py::getattr(target, "parameter_file", py::none());
    if (!file.is_none()) parameter_file_ = py::str(file);
  }

  void read_tools(PreviewEnvironment& environment) {
    constexpr int kSlots = 1001;
    for (int slot = 0; slot < kSlots; ++slot) {
      const auto answer = canon_.ask("get_tool", slot);
      if (!answer) return;
      const auto row = answer->cast<py::sequence>();
      if (row.size() < 14) throw py::value_error("get_tool must give 14 values");
      interp::Tool tool;
      tool.number = row[0].cast<int>();
      if (tool.number < 0) continue;
      tool.pocket = slot;
      for (std::size_t i = 0; i < rtapi::kAxes; ++i)
        tool.offset[i] =
            row[i + 1].cast<double>() * (rtapi::is_rotary(i) ? 1.0 : settings_.machine_unit_mm);
      tool.diameter_mm = row[10].cast<double>() * settings_.machine_unit_mm;
      tool.front_angle_deg = row[11].cast<double>();
      tool.back_angle_deg = row[12].cast<double>();
      tool.orientation = row[13].cast<int>();
      environment.add_tool(slot, tool);
    }
  }

  std::string file_;
  PythonCanon canon_;
  interp::Settings settings_;
  std::optional<interp::ProgramPaths> paths_;
  PreviewEnvironment* environment_{nullptr};
  std::string parameter_file_;
  bool block_delete_{false};
};

py::tuple parse(const std::string& file, const py::object& canon, const std::string& unit_code,
                const std::string& init_code, const std::string& /*interpreter*/) {
  return Parse(file, canon).run({unit_code, init_code});
}

/// As AXIS asks: any number of blocks before the file.
py::tuple parse_after(const std::string& file, const py::object& canon, const py::list& codes,
                      const std::string& /*interpreter*/) {
  return Parse(file, canon).run(codes.cast<std::vector<std::string>>());
}

/// The text of the last error for its own number.
std::string strerror(int code) {
  if (code == kNotOpen) return "File not open";
  return code == kError ? last_error() : std::string();
}

template <class Array>
py::tuple numbers(const Array& values) {
  py::tuple out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[i] = values[i];
  return out;
}

void add_linecode(py::module_& m) {
  py::class_<LineCode> c(m, "linecode", "The modal state that a line found.");
  c.def(py::init<>())
      .def_readonly("sequence_number", &LineCode::sequence_number)
      .def_readonly("feed_rate", &LineCode::feed_rate)
      .def_readonly("speed", &LineCode::speed)
      .def_property_readonly("gcodes", [](const LineCode& l) { return numbers(l.gcodes); })
      .def_property_readonly("mcodes", [](const LineCode& l) { return numbers(l.mcodes); });
  const auto g = [&c](const char* name, std::size_t at) {
    c.def_property_readonly(name, [at](const LineCode& l) { return l.gcodes[at]; });
  };
  const auto mc = [&c](const char* name, std::size_t at) {
    c.def_property_readonly(name, [at](const LineCode& l) { return l.mcodes[at]; });
  };
  g("motion_mode", 1), g("block", 2), g("plane", 3), g("cutter_side", 4), g("units", 5);
  g("distance_mode", 6), g("feed_mode", 7), g("origin", 8), g("tool_length_offset", 9);
  g("retract_mode", 10), g("path_mode", 11);
  mc("stopping", 1), mc("spindle", 2), mc("toolchange", 3), mc("mist", 4), mc("flood", 5);
  mc("overrides", 6);
}

}  // namespace

PYBIND11_MODULE(gcode, m) {
  m.doc() = "Programs as calls of a Python object, for previews.";
  m.def("parse", parse, py::arg("file"), py::arg("canon"), py::arg("unitcode") = "",
        py::arg("initcode") = "", py::arg("interpname") = "",
        "parse(file, canon, unitcode='', initcode='') -> (result, line). Results above MIN_ERROR "
        "are errors.");
  m.def("parse", parse_after, py::arg("file"), py::arg("canon"), py::arg("initcodes"),
        py::arg("interpname") = "",
        "The same after a list of blocks, which set the preview to the machine's state.");
  m.def("strerror", strerror, py::arg("result"), "The text of a result of parse().");
  m.attr("MIN_ERROR") = kMinError;
  m.attr("MAX_ERROR") = kMaxError;
  add_linecode(m);
  add_extents(m);
}

}  // namespace kerf::python
