#include "motion/replay/replay.hpp"

#include <algorithm>
#include <cinttypes>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <thread>

#include "hal/core/value_text.hpp"
#include "motion/api/faults.hpp"
#include "motion/motmod/flight_recorder.hpp"
#include "motion/motmod/planner_participant.hpp"

namespace kerf::motion {
namespace {

using Head = rtapi::OverwriteRing::Head;

struct Entry {
  Head head;
  const std::uint64_t* words;
  [[nodiscard]] FlightKind kind() const { return static_cast<FlightKind>(head.kind); }
};

std::vector<Entry> entries(const std::vector<std::uint64_t>& words) {
  std::vector<Entry> out;
  rtapi::OverwriteRing::for_each(words, [&](const Head& head, const std::uint64_t* w) {
    out.push_back({head, w});
  });
  return out;
}

template <class T>
bool read(const Entry& entry, T& out) {
  if (entry.head.words != sizeof(T) / 8) return false;
  std::memcpy(static_cast<void*>(&out), entry.words, sizeof(T));
  return true;
}

class HeapMemory final : public path::Memory {
 public:
  void* allocate(std::size_t bytes, std::size_t align) noexcept override {
    // Blocks of new are aligned for all that has no wish of its own.
    blocks_.push_back(std::make_unique<std::byte[]>(bytes + align));
    void* p = blocks_.back().get();
    std::size_t room = bytes + align;
    return std::align(align, bytes, p, room);
  }

 private:
  std::vector<std::unique_ptr<std::byte[]>> blocks_;
};

struct Turn {
  TurnRecord begin;
  std::vector<PathItem> items;
};

/// The planner in a thread of its own, which is let go on between servo cycles, as far as the recorded one had come by then.
class PlannerThread final : public PlanGate::Hold {
 public:
  PlannerThread(PlannerParticipant& planner, MotionShared& shared, PlannerLink& link)
      : planner_(planner), shared_(shared), link_(link) {}
  ~PlannerThread() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    moved_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  PlannerThread(const PlannerThread&) = delete;
  PlannerThread& operator=(const PlannerThread&) = delete;

  void start(std::vector<Turn> turns) {
    turns_ = std::move(turns);
    thread_ = std::thread([this] { run(); });
  }
  /// Behind a cycle: lets it make all passes up to `number`, and look at `view`; comes back when it has.
  void allow(std::uint64_t number, const ServoView& view) {
    std::unique_lock lock(mutex_);
    allowed_ = number;
    newest_ = view.cycle;
    view_[view.cycle % kViews] = view;
    moved_.notify_all();
    moved_.wait(lock, [this] { return done_ || (stands_ && !may_go()); });
  }
  void wait(std::uint64_t number) noexcept override {
    std::unique_lock lock(mutex_);
    wants_ = number;
    stands_ = true;
    moved_.notify_all();
    moved_.wait(lock, [this] { return ends_ || may_go(); });
    stands_ = false;
    if (wants_ == begin_->passes + 1) link_.view.write(view_[begin_->view_cycle % kViews]);
  }

 private:
  /// A turn begins with a look at what the servo says, and while the servo is at work that is what the cycle before has said.
  [[nodiscard]] bool may_go() const {
    return wants_ == begin_->passes + 1 ? begin_->view_cycle <= newest_ : wants_ <= allowed_;
  }
  void run() {
    for (const Turn& turn : turns_) {
      {
        const std::lock_guard lock(mutex_);
        begin_ = &turn.begin;
      }
      // Whatever it did more or less than the recorded one, the next turn begins as that one's.
      link_.slots.gate.resume_at(turn.begin.passes, this);
      // What does not fit is lost, and the difference is seen: motion had room for all of them.
      for (const PathItem& item : turn.items) (void)shared_.path.push(item);
      shared_.intent.abort_epoch.set(static_cast<std::uint32_t>(turn.begin.abort_epoch));
      rtapi::WaitSpec spec;
      planner_.step(turn.begin.time_ns, spec);
      const std::lock_guard lock(mutex_);
      if (ends_) break;
    }
    const std::lock_guard lock(mutex_);
    done_ = true;
    moved_.notify_all();
  }

  PlannerParticipant& planner_;
  MotionShared& shared_;
  PlannerLink& link_;
  std::vector<Turn> turns_;
  const TurnRecord* begin_{nullptr};
  static constexpr std::size_t kViews = 256;
  ServoView view_[kViews];  ///< by cycle
  std::uint64_t newest_{0};
  std::mutex mutex_;
  std::condition_variable moved_;
  std::uint64_t wants_{0}, allowed_{0};
  bool stands_{false}, ends_{false}, done_{false};
  std::thread thread_;
};

/// Motion without HAL.
class Machine {
 public:
  Machine(const FlightFile& file, Kinematics& kinematics, const RestRecord& rest)
      : kinematics_(kinematics),
        link_(std::make_unique<PlannerLink>()),
        shared_(std::make_unique<MotionShared>()),
        planner_(std::make_unique<PlannerParticipant>(kinematics, *shared_, *link_)),
        controller_(
            std::make_unique<Controller>(kinematics, link_->spans, link_->slots, link_->faults,
                                         static_cast<std::int32_t>(file.number("joints")),
                                         static_cast<std::int32_t>(file.number("spindles")))),
        period_ns_(file.number("period-ns")),
        now_ns_(rest.time_ns),
        intent_(rest.intent) {
    (void)planner_->planner().create(memory_);
    planner_->planner().set_counts(static_cast<std::int32_t>(file.number("digital")),
                                   static_cast<std::int32_t>(file.number("analog")),
                                   static_cast<std::int32_t>(file.number("spindles")));
    controller_->status().extra_joints = static_cast<std::int32_t>(file.number("extra-joints"));
    if (kinematics_.kinds() > 1) (void)kinematics_.switch_to(rest.state.kind);
    describe(rest.state.config);
    if (!file.screws.empty()) controller_->use_screws(file.screws.data());
    controller_->restore(rest.state);
    inputs_.set(rest.inputs);
    image_.set(rest.intent);
    link_->config.write(rest.state.config);
    orders_.values = &intent_;
    planner_thread_ = std::make_unique<PlannerThread>(*planner_, *shared_, *link_);
    tell();
  }

  void config(const ConfigRecord& change) {
    if (!change.all) {
      controller_->adopt(change.config);
      return;
    }
    if (change.switches) (void)controller_->switch_kinematics(kinematics_, change.kind);
    controller_->configure(change.config);
    describe(change.config);
    link_->config.write(change.config);
    ++version_;
  }
  bool intent(const Entry& e) {
    const bool good = image_.apply(e.words, e.head.words);
    image_.get(intent_);
    return good;
  }
  bool cycle(const Entry& e) {
    if (!inputs_.apply(e.words, e.head.words)) return false;
    CycleInputs in;
    inputs_.get(in);
    orders_.abort_epoch = in.abort_epoch;
    orders_.enable = in.enable;
    orders_.hold = in.hold;
    orders_.enable_request = in.enable_request;
    orders_.path_ring_empty = in.path_ring_empty;
    orders_.heartbeat = in.heartbeat;
    now_ns_ += period_ns_;
    planner_thread_->allow(in.in.plan_passes, last_);
    controller_->step(in.in, orders_, static_cast<double>(period_ns_) * 1e-9, now_ns_);
    tell();
    return true;
  }
  void plan(const Planner::Modal* modal, std::vector<Turn> turns) {
    if (modal != nullptr) planner_->planner().set_modal(*modal);
    planner_thread_->start(std::move(turns));
  }
  [[nodiscard]] const Controller& controller() const { return *controller_; }

 private:
  void describe(const MachineConfig& config) {
    kinematics_.use_unit(config.linear_units_per_mm > 0 ? 1.0 / config.linear_units_per_mm : 1.0);
    std::uint32_t rotary = 0;
    for (std::size_t j = 0; j < kMaxJoints; ++j) rotary |= config.joint[j].rotary ? 1U << j : 0U;
    kinematics_.use_machine(rotary, config.axis_mask);
  }
  void tell() {
    ServoView view = controller_->view();
    view.config_version = version_;
    const rtapi::WordPart all = rtapi::words_of(0, sizeof view);
    tell_planner(*link_, view, {&all, 1}, last_);
    last_ = view;
  }
  Kinematics& kinematics_;
  HeapMemory memory_;
  std::unique_ptr<PlannerLink> link_;
  std::unique_ptr<MotionShared> shared_;
  std::unique_ptr<PlannerParticipant> planner_;
  std::unique_ptr<Controller> controller_;
  std::int64_t period_ns_, now_ns_;
  std::uint64_t version_{1};
  WordImage<CycleInputs> inputs_;
  WordImage<Intent> image_;
  Intent intent_;
  Orders orders_;
  ServoView last_;
  std::unique_ptr<PlannerThread> planner_thread_;  ///< ends before what it works on
};

/// The first standstill behind which all is there; nullptr: none.
const Entry* first_rest(const std::vector<Entry>& servo, const std::vector<Entry>& path,
                        bool path_lost) {
  const auto whole = [&](std::uint64_t cycle) {
    if (path_lost && (path.empty() || path.front().head.number > cycle)) return false;
    const auto next = std::find_if(path.begin(), path.end(), [&](const Entry& e) {
      return e.head.number >= cycle && e.kind() != FlightKind::turn;
    });
    return next == path.end() || next->kind() == FlightKind::modal;
  };
  for (const Entry& e : servo)
    if (e.kind() == FlightKind::rest && e.head.words == sizeof(RestRecord) / 8 &&
        whole(e.head.number))
      return &e;
  return nullptr;
}

std::vector<Turn> turns_since(const std::vector<Entry>& path, std::uint64_t cycle) {
  std::vector<Turn> turns;
  std::uint32_t number = 0;
  for (const Entry& e : path) {
    if (e.head.number < cycle) continue;
    TurnRecord begin;
    PathItem item;
    if (e.kind() == FlightKind::turn && read(e, begin)) {
      turns.push_back({begin, {}});
      number = e.head.extra;
    } else if (e.kind() == FlightKind::item && !turns.empty() && e.head.extra == number &&
               read(e, item)) {
      turns.back().items.push_back(item);
    }
  }
  return turns;
}

std::string line_of(const ReplayResult::Met& met) {
  char text[160];
  std::snprintf(text, sizeof text, "%s of %d in cycle %" PRIu64 ", line %d (%.6g, limit %.6g)",
                fault_name(met.fault.fault), met.fault.index, met.cycle, met.fault.tag.line,
                met.fault.value, met.fault.limit);
  return text;
}

}  // namespace

bool ReplayResult::same_faults() const {
  return recorded.size() == replayed.size() &&
         std::equal(recorded.begin(), recorded.end(), replayed.begin(),
                    [](const Met& a, const Met& b) {
                      return a.cycle == b.cycle && a.fault.fault == b.fault.fault &&
                             a.fault.index == b.fault.index;
                    });
}

ReplayResult replay(const FlightFile& file, Kinematics& kinematics) {
  ReplayResult result;
  if (file.text("state-abi") != std::to_string(kFlightStateAbi)) {
    result.error =
        "another build of Kerf has written it, whose standstills look otherwise; `kerf record "
        "show` "
        "prints it";
    return result;
  }
  const std::vector<Entry> servo = entries(file.servo), path = entries(file.path);
  const Entry* start = first_rest(servo, path, file.number("path-lost") != 0);
  if (start == nullptr) {
    result.error =
        "the machine did not stand still in this record, so it has no beginning that could be run; "
        "`kerf record show` prints it";
    return result;
  }
  auto rest = std::make_unique<RestRecord>();
  (void)read(*start, *rest);
  if (file.number("joints") > static_cast<long long>(kMaxJoints) || file.number("period-ns") <= 0) {
    result.error = "its head is damaged";
    return result;
  }
  Machine machine(file, kinematics, *rest);
  result.from_cycle = start->head.number;
  result.from_ns = rest->time_ns;
  ModalRecord modal;
  const auto first_modal = std::find_if(path.begin(), path.end(), [&](const Entry& e) {
    return e.head.number >= start->head.number && e.kind() == FlightKind::modal && read(e, modal);
  });
  machine.plan(first_modal != path.end() ? &modal.modal : nullptr,
               turns_since(path, start->head.number));
  for (const Entry* e = start + 1; e < servo.data() + servo.size(); ++e) {
    bool good = true;
    switch (e->kind()) {
      case FlightKind::config: {
        ConfigRecord change;
        good = read(*e, change);
        if (good) machine.config(change);
        break;
      }
      case FlightKind::intent: good = machine.intent(*e); break;
      case FlightKind::cycle: {
        good = machine.cycle(*e);
        ++result.cycles;
        for (const FaultRecord& fault : machine.controller().faults())
          result.replayed.push_back({e->head.number, fault});
        if (result.differs_at == 0 && check_sum(machine.controller()) != e->head.extra)
          result.differs_at = e->head.number;
        break;
      }
      case FlightKind::fault: {
        FaultRecord fault;
        good = read(*e, fault);
        if (good) result.recorded.push_back({e->head.number, fault});
        break;
      }
      default: break;
    }
    if (!good) {
      result.error = "it is damaged at cycle " + std::to_string(e->head.number);
      return result;
    }
  }
  return result;
}

std::string report(const ReplayResult& r) {
  if (!r.error.empty()) return r.error + "\n";
  char text[200];
  std::snprintf(text, sizeof text,
                "ran %" PRIu64 " cycles from the standstill of cycle %" PRIu64 " (%.3f s)\n",
                r.cycles, r.from_cycle, static_cast<double>(r.from_ns) * 1e-9);
  std::string out = text;
  for (const auto& met : r.recorded) out += "recorded: " + line_of(met) + "\n";
  for (const auto& met : r.replayed) out += "replayed: " + line_of(met) + "\n";
  if (r.recorded.empty() && r.replayed.empty())
    out += "no fault, as recorded\n";
  else
    out += r.same_faults() ? "the same faults in the same cycles\n" : "NOT the same faults\n";
  out += r.differs_at == 0
             ? "all positions are those recorded, to the last bit\n"
             : "positions differ from cycle " + std::to_string(r.differs_at) + " on\n";
  return out;
}

namespace {

/// Of the pins that a record has, as HAL writes them.
class Pins {
 public:
  explicit Pins(const FlightFile& file) {
    const auto [begin, end] = file.head.equal_range("pin");
    for (auto at = begin; at != end && names_.size() < kMaxRecordedPins; ++at) {
      const std::size_t blank = at->second.find(' ');
      if (blank == std::string::npos) continue;
      types_.push_back(static_cast<hal::Type>(std::atoi(at->second.c_str())));
      names_.push_back(at->second.substr(blank + 1));
    }
  }
  void take(const Entry& e) {
    PinValues all;
    if (e.head.extra == 1 && read(e, all))
      image_.set(all);
    else if (e.head.extra == 0)
      (void)image_.apply(e.words, e.head.words);
  }
  [[nodiscard]] std::string names() const {
    std::string out;
    for (const std::string& name : names_) out.append(" ").append(name);
    return out;
  }
  [[nodiscard]] std::string values() const {
    std::string out;
    for (std::size_t i = 0; i < names_.size(); ++i)
      out.append(" ").append(hal::plain_value_text(types_[i], image_.words()[i]));
    return out;
  }

 private:
  std::vector<std::string> names_;
  std::vector<hal::Type> types_;
  WordImage<PinValues> image_;
};

const char* name_of(MotionMode mode) {
  switch (mode) {
    case MotionMode::free: return "joint";
    case MotionMode::teleop: return "teleop";
    default: return "path";
  }
}

}  // namespace

std::string show(const FlightFile& file, double seconds) {
  Pins pins(file);
  const std::vector<Entry> servo = entries(file.servo);
  const auto joints =
      std::clamp<long long>(file.number("joints"), 0, static_cast<long long>(kMaxJoints));
  std::int64_t last = 0;
  StatusRecord s;
  for (const Entry& e : servo)
    if (e.kind() == FlightKind::status && read(e, s)) last = s.time_ns;
  std::string out;
  for (const auto& [key, value] : file.head)
    out.append("# ").append(key).append(": ").append(value).append("\n");
  out += "# time cycle line vel feed-override spindle mode flags";
  for (long long j = 0; j < joints; ++j)
    out += " joint." + std::to_string(j) + " ferror." + std::to_string(j);
  out += pins.names() + "\n";
  char text[160];
  for (const Entry& e : servo) {
    if (e.kind() == FlightKind::pins) pins.take(e);
    if (e.kind() == FlightKind::fault) {
      FaultRecord fault;
      if (read(e, fault)) out += "# fault: " + line_of({e.head.number, fault}) + "\n";
    }
    if (e.kind() != FlightKind::status || !read(e, s) ||
        s.time_ns < last - static_cast<std::int64_t>(seconds * 1e9))
      continue;
    std::snprintf(text, sizeof text, "%.3f %" PRIu64 " %d %.4f %.2f %.0f %s %s%s",
                  static_cast<double>(s.time_ns) * 1e-9, e.head.number, s.line, s.vel_mm_s,
                  s.feed_override, s.spindle_rpm, name_of(s.mode), s.enabled != 0 ? "on" : "off",
                  s.held != 0 ? ",held" : "");
    out += text;
    for (long long j = 0; j < joints; ++j) {
      std::snprintf(text, sizeof text, " %.6f %.6f", s.joint[j], s.ferror[j]);
      out += text;
    }
    out += pins.values() + "\n";
  }
  return out;
}

}  // namespace kerf::motion
