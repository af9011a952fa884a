#include "clients/common/machine_view.hpp"

#include <algorithm>
#include <cmath>

#include "hal/core/view.hpp"
#include "rtapi/sync/patient_read.hpp"

namespace kerf::clients {

using rtapi::Errc;
using rtapi::fail;

namespace {

/// From here on a limit means "none".
constexpr double kNoLimit = 1e98;

double scaled(double value, double unit) noexcept {
  return std::fabs(value) >= kNoLimit ? value : value / unit;
}

}  // namespace

rtapi::Result<std::unique_ptr<MachineView>> MachineView::attach(const std::string& instance) {
  KERF_TRY(std::unique_ptr<rtapi::Segment> segment, rtapi::Segment::attach(instance));
  std::unique_ptr<MachineView> view(new MachineView());
  KERF_CHECK(view->open(*segment));
  view->own_ = std::move(segment);
  return view;
}

rtapi::Result<std::unique_ptr<MachineView>> MachineView::over(rtapi::Segment& segment) {
  std::unique_ptr<MachineView> view(new MachineView());
  KERF_CHECK(view->open(segment));
  return view;
}

rtapi::Status MachineView::open(rtapi::Segment& segment) {
  segment_ = &segment;
  auto task = segment.find<task::TaskShared>(task::kTaskBlock, task::kTaskAbi);
  if (!task.ok()) return rtapi::Failure{task.error()};
  task_shared_ = *task;
  if (task_shared_->ready.observe() == 0)
    return fail(Errc::not_found,
                "milltask of instance '" + segment.instance() + "' is not ready yet");
  auto motion =
      hal::View(segment).block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  if (!motion.ok()) return rtapi::Failure{motion.error()};
  motion_shared_ = *motion;
  if (!poll())
    return fail(Errc::not_found, "the status of instance '" + segment.instance() +
                                     "' cannot be read: it is being written, or its writer died");
  return {};
}

double MachineView::from_axis(std::size_t axis, double value) const noexcept {
  return scaled(value, rtapi::is_rotary(axis) ? facts_.angular_unit_deg : facts_.linear_unit_mm);
}

double MachineView::from_joint(std::size_t joint, double value) const noexcept {
  const double unit = facts_.joint_unit[joint];
  return unit > 0 ? scaled(value, unit) : value;
}

rtapi::Pose MachineView::from_pose(const rtapi::Pose& pose) const noexcept {
  rtapi::Pose out;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) out[i] = from_axis(i, pose[i]);
  return out;
}

bool MachineView::poll() {
  // Task first: it describes what motion has done, so motion may be ahead of it, never behind.
  task::TaskStatus task;
  motion::MotionStatus motion;
  motion::MachineConfig config;
  task::MachineFacts facts;
  if (!rtapi::read_patiently(task_shared_->status, task) ||
      !rtapi::read_patiently(task_shared_->facts, facts) ||
      !rtapi::read_patiently(motion_shared_->status, motion) ||
      !rtapi::read_patiently(motion_shared_->config, config))
    return false;
  task_ = task;
  motion_ = motion;
  config_ = config;
  facts_ = facts;
  fill_task();
  fill_machine();
  fill_motion();
  fill_io();
  read_tools();
  return true;
}

void MachineView::fill_task() {
  Stat& s = stat_;
  const task::TaskStatus& t = task_;
  s.task_state = static_cast<int>(t.task_state);
  s.task_mode = static_cast<int>(t.mode);
  s.exec_state = static_cast<int>(t.exec_state);
  s.interp_state = static_cast<int>(t.interp_state);
  s.interpreter_errcode = t.interpreter_error;
  s.state = !t.idle ? RcsState::exec : t.last_failed ? RcsState::error : RcsState::done;
  s.estop = t.task_state == task::TaskState::estop;
  s.task_paused = s.paused = t.paused;
  s.single_stepping = t.single_step != 0;
  s.optional_stop = t.optional_stop;
  s.block_delete = t.block_delete;
  s.input_timeout = t.input_timeout;
  s.prompt = t.prompt;
  s.waiting_for = t.waiting_for;
  s.call_level = t.call_level;
  // An MDI line has no number.
  const bool in_file = !t.source.empty();
  s.current_line = in_file ? t.current_line : 0;
  s.read_line = t.idle ? 0 : t.read_line;
  s.debug = t.debug;
  s.queued_mdi_commands = t.queued_mdi;
  s.program_units = t.program_units;
  s.g5x_index = t.g5x_index;
  s.echo_serial_number = t.echo_serial;
  s.taskbeat = motion_shared_->intent.heartbeat.get();
  s.command = t.idle ? std::string() : std::string(t.command.view());
  s.file = std::string(t.file.view());
  s.ini_filename = std::string(facts_.ini_file.view());
  for (std::size_t i = 0; i < s.gcodes.size(); ++i) s.gcodes[i] = t.g_codes[i];
  for (std::size_t i = 0; i < s.mcodes.size(); ++i) s.mcodes[i] = t.m_codes[i];
  for (std::size_t i = 0; i < s.settings.size(); ++i) s.settings[i] = t.settings[i];
  if (!in_file) s.gcodes[0] = s.mcodes[0] = 0, s.settings[0] = 0;
  s.g5x_offset = from_pose(t.g5x_offset);
  s.g92_offset = from_pose(t.g92_offset);
  s.tool_offset = from_pose(t.tool_offset);
  s.rotation_xy = t.rotation_deg;
}

void MachineView::fill_machine() {
  Stat& s = stat_;
  s.linear_units = 1 / facts_.linear_unit_mm;
  s.angular_units = 1 / facts_.angular_unit_deg;
  s.joints = config_.joints;
  s.spindles = config_.spindles;
  s.num_extrajoints = motion_.extra_joints;
  s.kinematics_type = motion_.kinematics_type;
  s.axis_mask = config_.axis_mask;
  s.acceleration = from_mm(facts_.default_acc_mm_s2);
  s.max_velocity = from_mm(task_.max_vel_mm_s);
  s.max_acceleration = from_mm(facts_.max_acc_mm_s2);
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    const bool used = (config_.axis_mask >> i & 1U) != 0;
    s.axis[i].velocity = from_axis(i, motion_.axis_vel[i]);
    s.axis[i].min_position_limit = used ? from_axis(i, config_.axis[i].min_limit) : 0;
    s.axis[i].max_position_limit = used ? from_axis(i, config_.axis[i].max_limit) : 0;
  }
}

void MachineView::fill_joint(std::size_t j) {
  const motion::JointStatus& from = motion_.joint[j];
  const motion::JointConfig& c = config_.joint[j];
  JointStat& to = stat_.joint[j];
  to = JointStat{};
  stat_.joint_position[j] = stat_.joint_actual_position[j] = 0;
  stat_.limit[j] = stat_.homed[j] = 0;
  if (j >= static_cast<std::size_t>(stat_.joints)) return;
  to.joint_type = c.rotary ? 2 : 1;
  to.units = facts_.joint_unit[j] > 0 ? 1 / facts_.joint_unit[j] : 1;
  to.backlash = from_joint(j, c.backlash);
  to.min_position_limit = from_joint(j, c.min_limit);
  to.max_position_limit = from_joint(j, c.max_limit);
  to.max_ferror = from_joint(j, c.ferror);
  to.min_ferror = from_joint(j, c.min_ferror);
  to.ferror_current = from_joint(j, from.ferror);
  to.ferror_highmark = from_joint(j, from.ferror_high);
  to.output = stat_.joint_position[j] = from_joint(j, from.pos_cmd);
  to.input = stat_.joint_actual_position[j] = from_joint(j, from.pos_fb);
  to.velocity = from_joint(j, from.vel_cmd);
  to.inpos = from.in_position;
  to.homing = from.homing;
  to.homed = from.homed;
  to.fault = from.faulted || from.error;
  to.enabled = from.enabled;
  to.min_soft_limit = from.min_soft_limit;
  to.max_soft_limit = from.max_soft_limit;
  to.min_hard_limit = from.min_hard_limit;
  to.max_hard_limit = from.max_hard_limit;
  to.override_limits = from.on_limit_override;
  stat_.homed[j] = from.homed ? 1 : 0;
  stat_.limit[j] = (from.min_hard_limit ? 1 : 0) | (from.max_hard_limit ? 2 : 0) |
                   (from.min_soft_limit ? 4 : 0) | (from.max_soft_limit ? 8 : 0);
}

void MachineView::fill_motion() {
  Stat& s = stat_;
  const motion::MotionStatus& m = motion_;
  s.heartbeat = m.cycle;
  s.cycle_time = static_cast<double>(m.servo_period_ns) * 1e-9;
  s.enabled = m.enabled;
  s.inpos = m.in_position;
  s.all_homed = m.all_homed;
  s.probing = m.probing;
  s.probe_tripped = m.probe_tripped;
  s.probe_val = m.probe_input ? 1 : 0;
  s.feed_override_enabled = m.enables.feed;
  s.adaptive_feed_enabled = m.enables.adaptive;
  s.feed_hold_enabled = m.enables.feed_hold;
  s.motion_mode = static_cast<int>(m.mode);
  s.motion_type = m.path_empty ? 0 : static_cast<int>(m.kind);
  s.motion_line = task_.source.empty() ? 0 : m.current.line;
  s.motion_id = m.path_empty ? 0 : s.motion_line;
  const std::uint64_t waiting = motion_shared_->path.size();
  s.queue = static_cast<int>(m.planned_items + waiting);
  s.queue_full = waiting == motion::PathRing::capacity();
  s.active_queue = m.path_empty ? 0 : 1;
  s.feedrate = task_.feed_override;
  s.rapidrate = task_.rapid_override;
  s.current_vel = from_mm(m.vel_mm_s);
  s.distance_to_go = from_mm(m.distance_to_go);
  s.delay_left = m.dwell_left_s;
  s.position = from_pose(m.pos_cmd + m.external_offset);
  s.actual_position = from_pose(m.pos_fb);
  s.probed_position = from_pose(m.probed);
  s.dtg = from_pose(m.distance_to_go_axes);
  for (std::size_t j = 0; j < motion::kMaxJoints; ++j) fill_joint(j);
  for (std::size_t i = 0; i < motion::kMaxAnalog; ++i) {
    s.ain[i] = m.analog_in[i];
    s.aout[i] = m.analog_out[i];
  }
  for (std::size_t i = 0; i < motion::kMaxDigital; ++i) {
    s.din[i] = static_cast<int>(m.digital_in >> i & 1U);
    s.dout[i] = static_cast<int>(m.digital_out >> i & 1U);
    s.misc_error[i] = static_cast<int>(m.misc_error >> i & 1U);
  }
  for (std::size_t n = 0; n < motion::kMaxSpindles; ++n) {
    const motion::SpindleStatus& from = m.spindle[n];
    SpindleStat& to = s.spindle[n];
    to = SpindleStat{};
    if (n >= static_cast<std::size_t>(s.spindles)) continue;
    to.brake = from.brake ? 1 : 0;
    to.direction = from.direction;
    to.enabled = from.on ? 1 : 0;
    to.orient_state = from.orient_state;
    to.orient_fault = from.orient_fault;
    to.override_ = task_.spindle_override[n];
    to.speed = from.speed_rpm;
    to.override_enabled = m.enables.spindle[n];
  }
}

void MachineView::fill_io() {
  stat_.flood = task_.flood;
  stat_.mist = task_.mist;
  stat_.tool_in_spindle = task_.tool_in_spindle;
  stat_.tool_from_pocket = task_.tool_from_pocket;
  stat_.pocket_prepped = task_.pocket_prepped;
}

ToolStat MachineView::tool(const task::ToolRecord& record) const {
  ToolStat t;
  t.id = record.number;
  t.pocket = record.pocket;
  t.offset = from_pose(record.offset);
  t.diameter = from_mm(record.diameter_mm);
  t.frontangle = record.front_angle_deg;
  t.backangle = record.back_angle_deg;
  t.orientation = record.orientation;
  t.comment = std::string(record.comment.view());
  return t;
}

void MachineView::read_tools() {
  const task::ToolSlots& slots = task_shared_->tools;
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    const std::uint64_t version = slots.version.observe();
    if (version == tools_version_) return;
    if ((version & 1U) != 0) continue;
    std::vector<ToolStat> table;
    const std::size_t used = std::min<std::size_t>(slots.used.get(), task::ToolSlots::kSlots);
    table.reserve(used);
    for (std::size_t n = 0; n < used; ++n) {
      task::ToolRecord record;
      if (slots.slot[n].read(record)) table.push_back(tool(record));
    }
    // The table changed meanwhile: it is read again, so that old and new rows never stand beside each other.
    rtapi::full_fence();
    if (slots.version.observe() != version) continue;
    stat_.tool_table = std::move(table);
    tools_version_ = version;
    return;
  }
}

}  // namespace kerf::clients
