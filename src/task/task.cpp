#include "task/task.hpp"

#include "hal/core/view.hpp"
#include "interp/config/script_library.hpp"
#include "io/iocontrol.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/sync/patient_read.hpp"
#include "task/api/message_reader.hpp"
#include "task/command/command_participant.hpp"
#include "task/exchange.hpp"
#include "task/hal_ini_pins.hpp"
#include "task/hal_io_pins.hpp"
#include "task/interpreter/interpreter_participant.hpp"
#include "task/journal_writer.hpp"
#include "task/machine_config.hpp"
#include "task/older_pin_names.hpp"
#include "task/position_file.hpp"

namespace kerf::task {

using rtapi::Errc;
using rtapi::fail;

struct Task::Parts {
  const ini::IniFile& ini;
  rtapi::Segment& segment;
  hal::Session* session;
  TaskOptions options;
  MachineSetup setup;
  std::string warnings;
  TaskShared* shared{nullptr};
  motion::MotionShared* motion{nullptr};
  std::unique_ptr<HalIoPins> hal_pins;
  std::unique_ptr<LiveConfig> live;
  std::unique_ptr<HalIniPins> ini_pins;
  std::unique_ptr<io::ToolStore> tools;
  std::unique_ptr<io::IoLink> link;
  std::unique_ptr<io::IoControl> iocontrol;
  std::unique_ptr<JournalWriter> journal;
  std::unique_ptr<Exchange> exchange;
  std::unique_ptr<rtapi::LogReader> realtime_log;
  std::unique_ptr<interp::ScriptHost> scripts;  // outlives the interpreter
  std::unique_ptr<TaskEnvironment> environment;
  std::unique_ptr<InterpreterParticipant> interpreter;
  std::unique_ptr<CommandParticipant> command;
  rtapi::Word<std::uint32_t> ending{0};  ///< 1: whatever a script does is to end
};

namespace {

rtapi::Result<TaskShared*> find_or_make(rtapi::Segment& segment) {
  auto found = segment.find<TaskShared>(kTaskBlock, kTaskAbi);
  if (found.ok() || found.error().code != Errc::not_found) return found;
  return segment.make<TaskShared>(kTaskBlock, kTaskAbi);
}

std::optional<double> to_number(hal::Type type, std::uint64_t raw) {
  switch (type) {
    case hal::Type::bit: return hal::from_raw<bool>(raw) ? 1.0 : 0.0;
    case hal::Type::floating: return hal::from_raw<double>(raw);
    case hal::Type::s32: return hal::from_raw<std::int32_t>(raw);
    case hal::Type::u32: return hal::from_raw<std::uint32_t>(raw);
    case hal::Type::s64: return static_cast<double>(hal::from_raw<std::int64_t>(raw));
    case hal::Type::u64: return static_cast<double>(hal::from_raw<std::uint64_t>(raw));
    default: return std::nullopt;
  }
}

HalReader hal_reader(rtapi::Segment& segment) {
  return [&segment](std::string_view name) -> std::optional<double> {
    const hal::View view(segment);
    if (!view.attached()) return std::nullopt;
    if (const auto pin = view.find_pin(name)) return to_number(pin->type, pin->raw);
    if (const auto param = view.find_param(name)) return to_number(param->type, param->raw);
    if (const auto signal = view.find_signal(name)) return to_number(signal->type, signal->raw);
    return std::nullopt;
  };
}

std::function<std::string(std::string_view)> net_reader(rtapi::Segment& segment) {
  return [&segment](std::string_view name) {
    const hal::View view(segment);
    const auto pin = view.attached() ? view.find_pin(name) : std::nullopt;
    return pin ? pin->signal : std::string();
  };
}

MachineFacts facts_of(const MachineSetup& setup, const ini::IniFile& ini) {
  MachineFacts f;
  f.ini_file = rtapi::FixedString<511>(ini.name());
  f.machine_name = rtapi::FixedString<127>(setup.machine_name);
  f.linear_unit_mm = setup.linear_unit_mm;
  f.angular_unit_deg = setup.angular_unit_deg;
  for (std::size_t j = 0; j < motion::kMaxJoints; ++j) f.joint_unit[j] = setup.joint_unit[j];
  f.default_vel_mm_s = setup.default_vel_mm_s;
  f.default_acc_mm_s2 = setup.default_acc_mm_s2;
  f.max_acc_mm_s2 = setup.motion.traj_max_acc_mm_s2;
  f.cycle_time_s = setup.task_cycle_s;
  f.max_feed_override = setup.limits.max_feed_override;
  f.min_spindle_override = setup.limits.min_spindle_override;
  f.max_spindle_override = setup.limits.max_spindle_override;
  for (std::size_t n = 0; n < kMaxSpindles; ++n)
    f.spindle_increment_rpm[n] = setup.motion.spindle[n].increment_rpm;
  f.random_toolchanger = setup.tools.random_changer;
  f.no_force_homing = setup.motion.no_force_homing;
  return f;
}

}  // namespace

rtapi::Status make_task_block(rtapi::Segment& segment) {
  auto block = find_or_make(segment);
  if (!block.ok()) return rtapi::Failure{block.error()};
  return {};
}

Task::Task(const ini::IniFile& ini, rtapi::Segment& segment, hal::Session* session,
           TaskOptions options)
    : parts_(new Parts{ini, segment, session, options, {}, {}, nullptr, nullptr, {}, {}, {},
                       {},  {},      {},      {},      {}, {}, {},      {},      {}, {}}) {}

Task::~Task() = default;

rtapi::Status Task::start() {
  KERF_CHECK(prepare());
  return connect();
}

rtapi::Status Task::prepare() {
  Parts& p = *parts_;
  SetupResult setup = read_machine_setup(p.ini);
  if (!setup.ok) {
    std::string text = setup.text();
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return fail(Errc::bad_argument, text);
  }
  p.warnings = setup.text();
  p.setup = std::move(setup.setup);

  if (!p.setup.position_file.empty()) {
    if (const auto loaded = load_positions(p.setup.position_file, p.setup); !loaded.ok())
      p.warnings += "warning: " + loaded.error().message() + '\n';
  }

  auto shared = find_or_make(p.segment);
  if (!shared.ok()) return rtapi::Failure{shared.error()};
  p.shared = *shared;
  p.shared->ready.publish(0);

  p.tools = std::make_unique<io::ToolStore>(p.setup.tools.table_file, p.setup.linear_unit_mm,
                                            p.setup.tools.random_changer);
  if (!p.setup.tools.database.empty())
    p.tools->use_database({p.setup.tools.database, p.setup.paths.ini_dir, p.segment.instance()},
                          interp::resolve_path(p.setup.paths.ini_dir, "db_spindle.tbl"));
  if (const rtapi::Status loaded = p.tools->load(); !loaded.ok()) {
    // A database that does not answer can be seen to while the machine runs; one that is not there is a mistake of the INI file.
    const bool is_database = !p.setup.tools.database.empty();
    if (is_database && loaded.error().code == Errc::not_found) return loaded;
    // A machine without its table has no tools; a table with mistakes would have wrong ones.
    if (!is_database && loaded.error().code != Errc::not_found) return loaded;
    p.warnings += "warning: no tools: " + loaded.error().message() + '\n';
  }
  for (const std::string& warning : p.tools->table()->warnings())
    p.warnings += "warning: " + warning + '\n';
  p.link =
      std::make_unique<io::IoLink>(p.shared->to_io, p.shared->to_command, p.shared->to_interpreter);
  p.live = std::make_unique<LiveConfig>(p.setup, p.ini);
  if (p.session != nullptr) {
    KERF_CHECK(ask_for_older_pin_names(*p.session, p.setup.interp.compat));
    p.ini_pins = std::make_unique<HalIniPins>(*p.session, p.live->pins());
    KERF_CHECK(p.ini_pins->status());
  }
  io::IoPins* pins = p.options.pins;
  if (pins == nullptr) {
    if (p.session == nullptr) return fail(Errc::bad_argument, "task needs a HAL session or pins");
    p.hal_pins = std::make_unique<HalIoPins>(*p.session, p.setup.tools.v2_pins);
    KERF_CHECK(p.hal_pins->status());
    pins = p.hal_pins.get();
  }
  const ToolConfig& tools = p.setup.tools;
  p.iocontrol = std::make_unique<io::IoControl>(
      *p.link, p.shared->to_io, *pins, *p.tools,
      io::IoOptions{tools.random_changer, tools.v2, tools.start_change, tools.fault_text,
                    rtapi::Nanos{tools.servo_period_ns}});
  return {};
}

rtapi::Status Task::connect() {
  Parts& p = *parts_;
  auto motion =
      hal::View(p.segment).block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  if (!motion.ok() && motion.error().code == Errc::not_found)
    return fail(Errc::not_found, "no motion in instance '" + p.segment.instance() +
                                     "': motmod is not loaded; a HAL file must say: loadrt motmod "
                                     "servo_period_nsec=1000000 num_joints=" +
                                     std::to_string(p.setup.motion.joints));
  if (!motion.ok()) return rtapi::Failure{motion.error()};
  p.motion = *motion;
  p.exchange = std::make_unique<Exchange>(p.shared->to_command, p.shared->to_interpreter);
  p.environment = std::make_unique<TaskEnvironment>(
      p.setup, p.ini, *p.tools, p.session != nullptr ? hal_reader(p.segment) : HalReader{});
  auto scripts = interp::open_scripts(p.setup.python, [&p] {
    return p.ending.get() != 0 || (p.interpreter && p.interpreter->abort_came());
  });
  if (!scripts.ok()) return rtapi::Failure{scripts.error()};
  p.scripts = std::move(*scripts);
  p.environment->set_scripts(p.scripts.get());
  p.interpreter = std::make_unique<InterpreterParticipant>(
      InterpreterParticipant::Parts{*p.motion, *p.shared, *p.exchange, *p.link, *p.tools, p.setup,
                                    *p.environment, p.segment.instance(), p.segment});
  if (auto begun = p.interpreter->init(); !begun.ok()) {
    rtapi::Error error = begun.error();
    const ini::Entry* code = p.ini.find("RS274NGC", "RS274NGC_STARTUP_CODE");
    if (error.code == Errc::syntax && code != nullptr && error.at.file.empty())
      error.at = {rtapi::FixedString<160>(code->at.file), code->at.line, 0};
    return rtapi::Failure<rtapi::Error>{error};
  }
  open_journal();
  KERF_TRY(const rtapi::LogRing* realtime_log, rtapi::open_log(p.segment));
  p.realtime_log = std::make_unique<rtapi::LogReader>(*realtime_log);
  p.command = std::make_unique<CommandParticipant>(
      CommandParticipant::Parts{*p.motion, *p.shared, *p.exchange, *p.link, p.setup, p.options.pid,
                                p.tools.get(), p.live.get(), p.ini_pins.get(),
                                net_reader(p.segment), p.journal.get(), p.realtime_log.get()});
  p.shared->facts.write(facts_of(p.setup, p.ini));
  if (p.options.listen)
    KERF_CHECK(p.command->listen(rtapi::socket_name(p.segment.instance(), kTaskService)));
  return {};
}

void Task::open_journal() {
  Parts& p = *parts_;
  const std::string& wish = p.setup.journal;
  const std::string path = wish.empty() && !p.options.journal_thread
                               ? std::string()
                               : journal_path(p.setup.ini_file, wish);
  if (path.empty()) return;
  const bool is_virtual = rtapi::clock_mode(p.segment) == rtapi::ClockMode::virtual_time;
  p.journal = std::make_unique<JournalWriter>(
      path, JournalWriter::Options{p.options.journal_thread, !is_virtual});
  // A machine without its journal is one that cannot be resumed, but it runs.
  if (auto opened = p.journal->open(); !opened.ok()) {
    rtapi::log_error(opened.error());
    p.journal.reset();
  }
}

const std::string& Task::warnings() const { return parts_->warnings; }

std::vector<rtapi::Participant*> Task::participants() {
  return {parts_->command.get(), parts_->interpreter.get(), parts_->iocontrol.get()};
}

std::uint64_t Task::submit(const std::vector<std::string>& words) {
  return parts_->command->submit(words);
}
void Task::submit_json(const std::string& json) { parts_->command->submit_json(json); }
std::optional<Reply> Task::outcome(std::uint64_t id) const { return parts_->command->outcome(id); }

TaskStatus Task::status() const {
  TaskStatus status;
  (void)rtapi::read_patiently(parts_->shared->status, status);
  return status;
}

TaskShared& Task::shared() { return *parts_->shared; }

std::vector<OperatorMessage> Task::messages(std::uint64_t& cursor) const {
  return read_messages(parts_->shared->messages, cursor);
}

void Task::end_scripts() { parts_->ending.set(1); }

void Task::shut_down() {
  if (!parts_->command) return;
  parts_->command->shut_down();
  parts_->interpreter->shut_down();
  if (auto saved = parts_->interpreter->save_parameters(); !saved.ok())
    rtapi::log_error(saved.error());
  motion::MotionStatus status;
  // Without a single cycle of motion nobody knows where the joints are.
  if (parts_->setup.position_file.empty() ||
      !rtapi::read_patiently(parts_->motion->status, status) || status.cycle == 0)
    return;
  if (auto saved = save_positions(parts_->setup.position_file, parts_->setup, status); !saved.ok())
    rtapi::log_error(saved.error());
}

}  // namespace kerf::task
