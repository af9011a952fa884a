// linuxcnc.command: a connection to task. Each method sends one command and returns when task has it; wait_complete() tells
// how the last one ended.
#include <pybind11/stl.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "python/linuxcnc/module.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "task/api/client.hpp"

namespace kerf::python {
namespace {

using nlohmann::json;

constexpr double kDefaultWait = 5.0;
/// So long task may take to say that it has a command.
constexpr rtapi::Nanos kReceiveTime = 5 * rtapi::kSecond;
/// Servo cycles after which motion shows what a command has started.
constexpr std::uint64_t kCyclesToStart = 3;
constexpr int kRcsDone = 1, kRcsError = 3, kTimedOut = -1;

/// What a command has done when task says `done`.
enum class Ends {
  with_reply,    ///< all of it
  with_motion,   ///< only begun: a jog
  with_program,  ///< only begun: resume, step
};

class CommandObject {
 public:
  CommandObject() : clock_(rtapi::make_real_clock()) { (void)connect(); }

  [[nodiscard]] std::uint64_t serial() const { return serial_; }

  /// Sends {"cmd": ...}; returns when task has taken it, whatever comes of it.
  void send(json request, Ends ends = Ends::with_reply) {
    rtapi::Status status;
    {
      const py::gil_scoped_release no_gil;
      const std::lock_guard turn(mutex_);
      status = send_unlocked(std::move(request), ends);
    }
    if (!status.ok()) throw_error(status.error().message());
  }

  int wait_complete(double seconds) {
    if (!(seconds >= 0)) throw_error("wait_complete: the time must be 0 or more seconds");
    int result = kTimedOut;
    {
      const py::gil_scoped_release no_gil;
      const std::lock_guard turn(mutex_);
      const rtapi::Nanos end = clock_->now() + rtapi::seconds(seconds);
      while (!ended(result)) {
        if (clock_->now() >= end) return kTimedOut;
        const py::gil_scoped_acquire gil;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        const py::gil_scoped_release again;
        wait_a_little(end);
      }
    }
    return result;
  }

 private:
  rtapi::Status connect() {
    client_.reset();
    view_.reset();
    auto segment = rtapi::Segment::attach(rtapi::default_instance());
    if (!segment.ok()) return rtapi::Failure{segment.error()};
    KERF_TRY(client_, task::Client::connect(**segment));
    KERF_TRY(view_, clients::MachineView::over(**segment));
    // The old mapping is given up last: nothing points there any more.
    segment_ = std::move(*segment);
    return {};
  }

  rtapi::Status send_unlocked(json request, Ends ends) {
    if (client_) (void)client_->poll();
    if (!client_ || !client_->connected()) KERF_CHECK(connect());
    const std::uint64_t id = client_->next_id();
    request["id"] = id;
    // A script that never asks how its commands ended must not gather them for ever.
    if (serial_ != 0) client_->forget(serial_);
    KERF_CHECK(client_->send_json(request.dump()));
    serial_ = id;
    ends_ = ends;
    began_at_.reset();
    const rtapi::Nanos end = clock_->now() + kReceiveTime;
    while (!client_->outcome(id)) {
      if (!client_->connected()) return rtapi::fail(rtapi::Errc::dead, "milltask has ended");
      if (clock_->now() >= end)
        return rtapi::fail(rtapi::Errc::busy, "milltask does not take commands");
      wait_a_little(end);
      (void)client_->poll();
    }
    return {};
  }

  void wait_a_little(rtapi::Nanos end) {
    rtapi::WaitSpec spec;
    if (client_) client_->add_to(spec);
    spec.wake_at(std::min(end, clock_->now() + 10 * rtapi::kMillisecond));
    if (client_) (void)client_->poll();
    if (client_ && serial_ != 0 && client_->finished(serial_))
      spec.wake_at(clock_->now() + rtapi::kMillisecond);
    clock_->wait(spec);
  }

  /// True with the result when the last command has ended.
  bool ended(int& result) {
    result = kRcsDone;
    if (serial_ == 0) return true;
    if (!client_) {
      result = kRcsError;
      return true;
    }
    (void)client_->poll();
    const auto reply = client_->outcome(serial_);
    if (!reply) {  // the connection ended before task took it
      result = kRcsError;
      return !client_->connected();
    }
    if (!task::is_terminal(reply->state)) return false;
    if (reply->state != task::CommandState::done) {
      result = kRcsError;
      return true;
    }
    return ends_ == Ends::with_reply || came_to_rest();
  }

  /// What a jog, a step or a resumed program has begun is over.
  bool came_to_rest() {
    if (!view_->poll()) return false;
    if (!began_at_) began_at_ = view_->motion().cycle;
    if (view_->motion().cycle < *began_at_ + kCyclesToStart) return false;
    if (ends_ == Ends::with_motion) {
      // In the cycle in which a joint arrives it still has a speed.
      const motion::MotionStatus& m = view_->motion();
      return !m.jogging && m.in_position &&
             std::all_of(m.joint, m.joint + m.joints,
                         [](const motion::JointStatus& j) { return j.in_position; });
    }
    return view_->task().idle || view_->task().paused;
  }

  std::mutex mutex_;
  std::unique_ptr<rtapi::WaitClock> clock_;
  std::unique_ptr<rtapi::Segment> segment_;
  std::unique_ptr<task::Client> client_;
  std::unique_ptr<clients::MachineView> view_;
  std::uint64_t serial_{0};
  Ends ends_{Ends::with_reply};
  std::optional<std::uint64_t> began_at_;
};

/// The word of a number, or ValueError with `complaint`.
const char* word(int value, std::initializer_list<std::pair<int, const char*>> words,
                 const char* complaint) {
  for (const auto& [number, text] : words)
    if (number == value) return text;
  throw py::value_error(complaint);
}

bool on_off(int value, const char* name) {
  if (value == 0 || value == 1) return value == 1;
  throw py::value_error(std::string(name) + " should be " + name + "_ON or " + name + "_OFF");
}

void state(CommandObject& c, int value) {
  c.send({{"cmd", "state"},
          {"state", word(value, {{1, "estop"}, {2, "estop-reset"}, {3, "off"}, {4, "on"}},
                         "Machine state should be STATE_ESTOP, STATE_ESTOP_RESET, STATE_ON, or "
                         "STATE_OFF")}});
}

void mode(CommandObject& c, int value) {
  c.send({{"cmd", "mode"},
          {"mode", word(value, {{1, "manual"}, {2, "auto"}, {3, "mdi"}},
                        "Mode should be MODE_MDI, MODE_MANUAL, or MODE_AUTO")}});
}

void traj_mode(CommandObject& c, int value) {
  c.send({{"cmd", "motion-mode"},
          {"mode", word(value, {{1, "free"}, {2, "coordinated"}, {3, "teleop"}},
                        "Mode should be TRAJ_MODE_FREE, TRAJ_MODE_COORD, or TRAJ_MODE_TELEOP")}});
}

void automatic(CommandObject& c, int what, std::optional<int> line) {
  const auto unexpected = [what] {
    throw_error("Unexpected argument '" + std::to_string(what) + "' to command.auto");
  };
  if (line.has_value() != (what == 0)) unexpected();
  switch (what) {
    case 0: return c.send({{"cmd", "run"}, {"line", *line}});
    case 1: return c.send({{"cmd", "pause"}});
    case 2: return c.send({{"cmd", "resume"}}, Ends::with_program);
    case 3: return c.send({{"cmd", "step"}}, Ends::with_program);
    case 4: return c.send({{"cmd", "direction"}, {"way", "reverse"}});
    case 5: return c.send({{"cmd", "direction"}, {"way", "forward"}});
    default: unexpected();
  }
}

/// "0" for a joint, "x" for an axis; a number out of range is task's to refuse.
std::string jogged(bool joint, int index) {
  if (joint || index < 0 || index >= static_cast<int>(rtapi::kAxes)) return std::to_string(index);
  return {static_cast<char>(rtapi::kAxisLetters[static_cast<std::size_t>(index)] + ('a' - 'A'))};
}

void jog(CommandObject& c, int kind, int joint_flag, int index, std::optional<double> speed,
         std::optional<double> increment) {
  const auto wrong = [](const std::string& text) { throw py::type_error(text); };
  const int given = 3 + (speed ? 1 : 0) + (increment ? 1 : 0);
  const auto takes = [&](const char* name, int wanted) {
    if (given != wanted)
      wrong(std::string("jog(") + name + ", ...) takes " + std::to_string(wanted) + " arguments (" +
            std::to_string(given) + " given)");
  };
  const std::string what = jogged(joint_flag != 0, index);
  switch (kind) {
    case 0:
      takes("JOG_STOP", 3);
      return c.send({{"cmd", "jog-stop"}, {"what", what}}, Ends::with_motion);
    case 1:
      takes("JOG_CONTINUOUS", 4);
      return c.send({{"cmd", "jog"}, {"what", what}, {"speed", *speed}, {"in-mode", true}},
                    Ends::with_motion);
    case 2:
      takes("JOG_INCREMENT", 5);
      return c.send({{"cmd", "jog"},
                     {"what", what},
                     {"speed", *speed},
                     {"distance", *increment},
                     {"in-mode", true}},
                    Ends::with_motion);
    default: wrong("jog() first argument must be JOG_xxx");
  }
}

void spindle(CommandObject& c, int direction, double speed, int number, int wait, int given) {
  // With increase, decrease, constant and off the second argument is the spindle.
  const bool turns = direction == 1 || direction == -1;
  json request{
      {"cmd", "spindle"},
      {"action", word(direction,
                      {{0, "off"},
                       {1, "forward"},
                       {-1, "reverse"},
                       {10, "increase"},
                       {11, "decrease"},
                       {12, "constant"}},
                      "Spindle direction should be SPINDLE_FORWARD, SPINDLE_REVERSE, SPINDLE_OFF, "
                      "SPINDLE_INCREASE, SPINDLE_DECREASE, or SPINDLE_CONSTANT")}};
  if (turns) {
    if (given > 1) request["speed"] = speed;
    request["spindle"] = number;
    (void)wait;  // the next feed move waits for spindle.N.at-speed in any case
  } else {
    request["spindle"] = given > 1 ? static_cast<int>(speed) : 0;
  }
  c.send(std::move(request));
}

void brake(CommandObject& c, int on, int number) {
  if (on != 0 && on != 1) throw py::value_error("BRAKE should be BRAKE_ENGAGE or BRAKE_RELEASE");
  c.send({{"cmd", "brake"}, {"on", on == 1}, {"spindle", number}});
}

/// The program as this process sees it; a name that is no file here is searched by task.
void program_open(CommandObject& c, const std::string& file) {
  std::error_code ignored;
  const auto full = std::filesystem::absolute(file, ignored);
  const bool here = !ignored && std::filesystem::is_regular_file(full, ignored);
  c.send({{"cmd", "open"}, {"file", here ? full.string() : file}});
}

void limit(CommandObject& c, int joint, const char* which, double value) {
  c.send({{"cmd", "joint-limit"}, {"joint", joint}, {which, value}});
}

void tool_offset(CommandObject& c, int tool, double z, double x, double diameter, double front,
                 double back, int orientation) {
  c.send({{"cmd", "tool-offset"},
          {"tool", tool},
          {"z", z},
          {"x", x},
          {"diameter", diameter},
          {"front", front},
          {"back", back},
          {"orientation", orientation}});
}

void message(CommandObject& c, const char* kind, const std::string& text) {
  c.send({{"cmd", "message"}, {"text", text}, {"kind", kind}});
}

using Class = py::class_<CommandObject>;

void add_machine(Class& c) {
  c.def("state", state, py::arg("state"), "state(STATE_*)")
      .def("mode", mode, py::arg("mode"), "mode(MODE_*)")
      .def("traj_mode", traj_mode, py::arg("mode"), "traj_mode(TRAJ_MODE_*)")
      .def(
          "teleop_enable",
          [](CommandObject& o, int on) {
            o.send({{"cmd", "teleop"}, {"on", on != 0}});
          },
          py::arg("on"), "Jogs move axes (1) or joints (0).")
      .def(
          "home",
          [](CommandObject& o, int j) {
            o.send({{"cmd", "home"}, {"joint", j}});
          },
          py::arg("joint"), "Homes a joint, or all (-1).")
      .def(
          "unhome",
          [](CommandObject& o, int j) {
            o.send({{"cmd", "unhome"}, {"joint", j}});
          },
          py::arg("joint"), "Unhomes a joint, all (-1), or the volatile ones (-2).")
      .def("jog", jog, py::arg("kind"), py::arg("joint_flag"), py::arg("index"),
           py::arg("speed") = py::none(), py::arg("increment") = py::none(),
           "jog(JOG_STOP, joint_flag, n), jog(JOG_CONTINUOUS, joint_flag, n, speed), "
           "jog(JOG_INCREMENT, joint_flag, n, speed, distance). A continuous jog ends with this "
           "object.")
      .def("override_limits",
           [](CommandObject& o) {
             o.send({{"cmd", "override-limits"}, {"on", true}});
           })
      .def(
          "set_min_limit", [](CommandObject& o, int j, double v) { limit(o, j, "min", v); },
          py::arg("joint"), py::arg("limit"))
      .def(
          "set_max_limit", [](CommandObject& o, int j, double v) { limit(o, j, "max", v); },
          py::arg("joint"), py::arg("limit"))
      .def(
          "debug",
          [](CommandObject& o, int v) {
            o.send({{"cmd", "debug"}, {"level", v}});
          },
          py::arg("level"));
}

void add_program(Class& c) {
  c.def("auto", automatic, py::arg("what"), py::arg("line") = py::none(),
        "auto(AUTO_RUN, line), auto(AUTO_PAUSE), auto(AUTO_RESUME), auto(AUTO_STEP); while it "
        "is paused auto(AUTO_REVERSE), auto(AUTO_FORWARD): which way it goes on")
      .def("abort",
           [](CommandObject& o) {
             o.send({{"cmd", "abort"}});
           })
      .def(
          "mdi",
          [](CommandObject& o, const std::string& text) {
            o.send({{"cmd", "mdi"}, {"text", text}, {"in-mode", true}});
          },
          py::arg("line"))
      .def("program_open", program_open, py::arg("file"))
      .def("reset_interpreter",
           [](CommandObject& o) {
             o.send({{"cmd", "reset-interpreter"}});
           })
      .def("task_plan_synch",
           [](CommandObject& o) {
             o.send({{"cmd", "synch"}});
           })
      .def(
          "set_optional_stop",
          [](CommandObject& o, int on) {
            o.send({{"cmd", "optional-stop"}, {"on", on != 0}});
          },
          py::arg("on"))
      .def(
          "set_block_delete",
          [](CommandObject& o, int on) {
            o.send({{"cmd", "block-delete"}, {"on", on != 0}});
          },
          py::arg("on"))
      .def(
          "error_msg", [](CommandObject& o, const std::string& t) { message(o, "error", t); },
          py::arg("text"))
      .def(
          "text_msg", [](CommandObject& o, const std::string& t) { message(o, "text", t); },
          py::arg("text"))
      .def(
          "display_msg", [](CommandObject& o, const std::string& t) { message(o, "display", t); },
          py::arg("text"));
}

/// A method `name(value)` that sends {"cmd": command, key: value}.
template <class T>
void add_value(Class& c, const char* name, const char* command, const char* key) {
  c.def(
      name,
      [command, key](CommandObject& o, T value) {
        o.send({{"cmd", command}, {key, value}});
      },
      py::arg("value"));
}

void add_switch(Class& c, const char* name, const char* command) {
  c.def(
      name,
      [command](CommandObject& o, int on) {
        o.send({{"cmd", command}, {"on", on != 0}});
      },
      py::arg("on"));
}

void add_overrides(Class& c) {
  add_value<double>(c, "feedrate", "feed-override", "value");
  add_value<double>(c, "rapidrate", "rapid-override", "value");
  add_value<double>(c, "maxvel", "max-velocity", "value");
  c.def(
      "spindleoverride",
      [](CommandObject& o, double value, int n) {
        o.send({{"cmd", "spindle-override"}, {"value", value}, {"spindle", n}});
      },
      py::arg("value"), py::arg("spindle") = 0);
  add_switch(c, "set_feed_override", "feed-override-enable");
  add_switch(c, "set_adaptive_feed", "adaptive-feed");
  add_switch(c, "set_feed_hold", "feed-hold");
  c.def(
      "set_spindle_override",
      [](CommandObject& o, int on, int n) {
        o.send({{"cmd", "spindle-override-enable"}, {"on", on != 0}, {"spindle", n}});
      },
      py::arg("on"), py::arg("spindle") = 0);
}

void add_io(Class& c) {
  c.def(
       "spindle",
       [](CommandObject& o, int direction, const py::args& rest) {
         if (rest.size() > 3)
           throw py::type_error("function takes at most 4 arguments (" +
                                std::to_string(rest.size() + 1) + " given)");
         spindle(o, direction, rest.size() > 0 ? rest[0].cast<double>() : 0,
                 rest.size() > 1 ? rest[1].cast<int>() : 0,
                 rest.size() > 2 ? rest[2].cast<int>() : 0, static_cast<int>(rest.size()) + 1);
       },
       "spindle(SPINDLE_FORWARD or _REVERSE, speed, spindle=0, wait=0), spindle(SPINDLE_OFF, "
       "_INCREASE, "
       "_DECREASE or _CONSTANT, spindle=0)")
      .def("brake", brake, py::arg("on"), py::arg("spindle") = 0)
      .def(
          "flood",
          [](CommandObject& o, int on) {
            o.send({{"cmd", "flood"}, {"on", on_off(on, "FLOOD")}});
          },
          py::arg("on"))
      .def(
          "mist",
          [](CommandObject& o, int on) {
            o.send({{"cmd", "mist"}, {"on", on_off(on, "MIST")}});
          },
          py::arg("on"))
      .def(
          "set_digital_output",
          [](CommandObject& o, int index, int on) {
            o.send({{"cmd", "digital-out"}, {"index", index}, {"on", on != 0}});
          },
          py::arg("index"), py::arg("on"))
      .def(
          "set_analog_output",
          [](CommandObject& o, int index, double value) {
            o.send({{"cmd", "analog-out"}, {"index", index}, {"value", value}});
          },
          py::arg("index"), py::arg("value"))
      .def(
          "answer",
          [](CommandObject& o, std::uint64_t prompt) {
            if (prompt == 0)
              o.send({{"cmd", "answer"}});
            else
              o.send({{"cmd", "answer"}, {"prompt", prompt}});
          },
          py::arg("prompt") = 0, "answer(stat.prompt['number']): yes to what the program asks")
      .def("load_tool_table",
           [](CommandObject& o) {
             o.send({{"cmd", "tool-table"}});
           })
      .def("tool_offset", tool_offset, py::arg("tool"), py::arg("z"), py::arg("x"),
           py::arg("diameter"), py::arg("frontangle"), py::arg("backangle"),
           py::arg("orientation"));
}

}  // namespace

void add_command(py::module_& m) {
  Class c(m, "command", "Commands to the machine; a connection of its own.");
  c.attr("__module__") = "linuxcnc";
  c.def(py::init([](const py::args&) { return std::make_unique<CommandObject>(); }))
      .def(
          "wait_complete", &CommandObject::wait_complete, py::arg("timeout") = kDefaultWait,
          "Waits for the end of the last command: RCS_DONE, RCS_ERROR, or -1 when it takes longer.")
      .def_property_readonly("serial", &CommandObject::serial);
  add_machine(c);
  add_program(c);
  add_overrides(c);
  add_io(c);
}

}  // namespace kerf::python
