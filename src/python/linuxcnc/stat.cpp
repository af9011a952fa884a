// linuxcnc.stat: the machine at the last poll(), attribute by attribute.
#include "python/linuxcnc/module.hpp"

namespace kerf::python {
namespace {

using clients::Stat;

void poll(StatObject& self) {
  if (auto polled = self.live.poll(); !polled.ok())
    throw_error("emcStatusBuffer invalid: " + polled.error().message());
}

template <class Array>
py::tuple numbers(const Array& values) {
  py::tuple out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[i] = values[i];
  return out;
}

py::tuple pose(const rtapi::Pose& p) {
  py::tuple out(rtapi::kAxes);
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) out[i] = p[i];
  return out;
}

py::dict joint(const clients::JointStat& j) {
  py::dict d;
  d["jointType"] = j.joint_type;
  d["units"] = j.units;
  d["backlash"] = j.backlash;
  d["min_position_limit"] = j.min_position_limit;
  d["max_position_limit"] = j.max_position_limit;
  d["max_ferror"] = j.max_ferror;
  d["min_ferror"] = j.min_ferror;
  d["ferror_current"] = j.ferror_current;
  d["ferror_highmark"] = j.ferror_highmark;
  d["output"] = j.output;
  d["input"] = j.input;
  d["velocity"] = j.velocity;
  d["inpos"] = j.inpos ? 1 : 0;
  d["homing"] = j.homing ? 1 : 0;
  d["homed"] = j.homed ? 1 : 0;
  d["fault"] = j.fault ? 1 : 0;
  d["enabled"] = j.enabled ? 1 : 0;
  d["min_soft_limit"] = j.min_soft_limit ? 1 : 0;
  d["max_soft_limit"] = j.max_soft_limit ? 1 : 0;
  d["min_hard_limit"] = j.min_hard_limit ? 1 : 0;
  d["max_hard_limit"] = j.max_hard_limit ? 1 : 0;
  d["override_limits"] = j.override_limits ? 1 : 0;
  return d;
}

py::dict axis(const clients::AxisStat& a) {
  py::dict d;
  d["velocity"] = a.velocity;
  d["min_position_limit"] = a.min_position_limit;
  d["max_position_limit"] = a.max_position_limit;
  return d;
}

py::dict spindle(const clients::SpindleStat& s) {
  py::dict d;
  d["brake"] = s.brake;
  d["direction"] = s.direction;
  d["enabled"] = s.enabled;
  d["override_enabled"] = s.override_enabled;
  d["speed"] = s.speed;
  d["override"] = s.override_;
  d["homed"] = s.homed;
  d["orient_state"] = s.orient_state;
  d["orient_fault"] = s.orient_fault;
  return d;
}

template <class Array, class Make>
py::tuple each(const Array& values, Make make) {
  py::tuple out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[i] = make(values[i]);
  return out;
}

/// The class linuxcnc.tool, which linuxcnc/__init__.py makes.
py::object tool_class() { return py::module_::import("linuxcnc").attr("tool"); }

py::tuple tool_table(const Stat& s) {
  const py::object make = tool_class();
  py::tuple out(s.tool_table.size());
  for (std::size_t n = 0; n < s.tool_table.size(); ++n) {
    const clients::ToolStat& t = s.tool_table[n];
    const rtapi::Pose& o = t.offset;
    out[n] = make(py::make_tuple(t.id, o.x, o.y, o.z, o.a, o.b, o.c, o.u, o.v, o.w, t.diameter,
                                 t.frontangle, t.backangle, t.orientation));
  }
  return out;
}

/// One tool by its number, with what the tuple has no place for.
py::dict toolinfo(const StatObject& self, int number) {
  const Stat& s = self.stat();
  for (std::size_t n = 1; n < s.tool_table.size(); ++n) {
    const clients::ToolStat& t = s.tool_table[n];
    if (t.id != number) continue;
    py::dict d;
    d["toolno"] = t.id;
    d["pocketno"] = t.pocket;
    d["diameter"] = t.diameter;
    d["frontangle"] = t.frontangle;
    d["backangle"] = t.backangle;
    d["orientation"] = t.orientation;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      std::string name("?offset");
      name[0] = static_cast<char>(rtapi::kAxisLetters[i] + ('a' - 'A'));
      d[py::str(name)] = t.offset[i];
    }
    d["comment"] = t.comment;
    return d;
  }
  throw_error("toolinfo: there is no tool " + std::to_string(number) + " in the tool table");
}

class StatClass {
 public:
  explicit StatClass(py::module_& m) : class_(m, "stat", "The machine at the last poll().") {
    class_.attr("__module__") = "linuxcnc";
  }
  /// `get` makes the value from a Stat.
  template <class Get>
  StatClass& add(const char* name, Get get) {
    class_.def_property_readonly(name, [get](const StatObject& o) { return get(o.stat()); });
    return *this;
  }
  py::class_<StatObject>& object() { return class_; }

 private:
  py::class_<StatObject> class_;
};

#define KERF_STAT(name) add(#name, [](const Stat& s) { return s.name; })
#define KERF_STAT_INT(name) add(#name, [](const Stat& s) { return static_cast<int>(s.name); })
#define KERF_STAT_POSE(name) add(#name, [](const Stat& s) { return pose(s.name); })
#define KERF_STAT_TUPLE(name) add(#name, [](const Stat& s) { return numbers(s.name); })

void add_task(StatClass& c) {
  c.KERF_STAT(task_state)
      .KERF_STAT(task_mode)
      .KERF_STAT(exec_state)
      .KERF_STAT(interp_state)
      .KERF_STAT(interpreter_errcode)
      .KERF_STAT_INT(state)
      .KERF_STAT_INT(estop)
      .KERF_STAT_INT(task_paused)
      .KERF_STAT(paused)
      .KERF_STAT(single_stepping)
      .KERF_STAT(optional_stop)
      .KERF_STAT(block_delete)
      .KERF_STAT(input_timeout)
      .KERF_STAT(call_level)
      .KERF_STAT(current_line)
      .KERF_STAT(motion_line)
      .KERF_STAT(motion_id)
      .KERF_STAT(read_line)
      .KERF_STAT(debug)
      .KERF_STAT(queued_mdi_commands)
      .KERF_STAT(program_units)
      .KERF_STAT(g5x_index)
      .KERF_STAT(echo_serial_number)
      .KERF_STAT(heartbeat)
      .KERF_STAT(taskbeat)
      .add("prompt",
           [](const Stat& s) -> py::object {
             if (s.prompt.kind == task::PromptKind::none) return py::none();
             py::dict d;
             d["number"] = s.prompt.number;
             d["kind"] = task::to_string(s.prompt.kind);
             d["tool"] = s.prompt.tool;
             d["text"] = std::string(s.prompt.text.view());
             return d;
           })
      .add("waiting_for",
           [](const Stat& s) -> py::object {
             if (s.waiting_for.object.empty()) return py::none();
             py::dict d;
             d["text"] = task::wait_text(s.waiting_for);
             d["object"] = std::string(s.waiting_for.object.view());
             d["pin"] = std::string(s.waiting_for.pin.view());
             d["net"] = std::string(s.waiting_for.net.view());
             return d;
           })
      .KERF_STAT(command)
      .KERF_STAT(file)
      .KERF_STAT(ini_filename)
      .KERF_STAT_TUPLE(gcodes)
      .KERF_STAT_TUPLE(mcodes)
      .KERF_STAT_TUPLE(settings)
      .KERF_STAT_POSE(g5x_offset)
      .KERF_STAT_POSE(g92_offset)
      .KERF_STAT_POSE(tool_offset)
      .KERF_STAT(rotation_xy)
      .KERF_STAT(delay_left)
      .KERF_STAT(cycle_time)
      .KERF_STAT_INT(flood)
      .KERF_STAT_INT(mist)
      .KERF_STAT(tool_in_spindle)
      .KERF_STAT(tool_from_pocket)
      .KERF_STAT(pocket_prepped)
      .add("tool_table", [](const Stat& s) { return tool_table(s); });
}

void add_motion(StatClass& c) {
  c.KERF_STAT(linear_units)
      .KERF_STAT(angular_units)
      .KERF_STAT(joints)
      .KERF_STAT(num_extrajoints)
      .KERF_STAT(spindles)
      .KERF_STAT(kinematics_type)
      .KERF_STAT(axis_mask)
      .KERF_STAT(velocity)
      .KERF_STAT(acceleration)
      .KERF_STAT(max_velocity)
      .KERF_STAT(max_acceleration)
      .KERF_STAT(enabled)
      .KERF_STAT(inpos)
      .KERF_STAT(queue_full)
      .KERF_STAT(probing)
      .KERF_STAT(probe_tripped)
      .KERF_STAT(probe_val)
      .KERF_STAT(feed_override_enabled)
      .KERF_STAT(adaptive_feed_enabled)
      .KERF_STAT(feed_hold_enabled)
      .KERF_STAT(motion_mode)
      .KERF_STAT(motion_type)
      .KERF_STAT(queue)
      .KERF_STAT(active_queue)
      .KERF_STAT(feedrate)
      .KERF_STAT(rapidrate)
      .KERF_STAT(current_vel)
      .KERF_STAT(distance_to_go)
      .KERF_STAT_POSE(position)
      .KERF_STAT_POSE(actual_position)
      .KERF_STAT_POSE(probed_position)
      .KERF_STAT_POSE(dtg)
      .KERF_STAT_TUPLE(joint_position)
      .KERF_STAT_TUPLE(joint_actual_position)
      .KERF_STAT_TUPLE(limit)
      .KERF_STAT_TUPLE(homed)
      .KERF_STAT_TUPLE(ain)
      .KERF_STAT_TUPLE(aout)
      .KERF_STAT_TUPLE(din)
      .KERF_STAT_TUPLE(dout)
      .KERF_STAT_TUPLE(misc_error)
      .add("joint", [](const Stat& s) { return each(s.joint, joint); })
      .add("axis", [](const Stat& s) { return each(s.axis, axis); })
      .add("spindle", [](const Stat& s) { return each(s.spindle, spindle); });
}

}  // namespace

void add_stat(py::module_& m) {
  StatClass c(m);
  c.object()
      .def(py::init([](const py::args&) { return std::make_unique<StatObject>(); }),
           "stat(): nothing is read before the first poll(). The name of an NML file may be given; "
           "there is none.")
      .def("poll", poll, "Takes a new copy of the machine's state.")
      .def("toolinfo", toolinfo, py::arg("toolno"),
           "A tool's row of the tool table as a dictionary.");
  add_task(c);
  add_motion(c);
}

}  // namespace kerf::python
