// Rig: planner and controller without HAL, driven cycle by cycle, with a perfect machine behind them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "motion/core/controller.hpp"
#include "motion/core/planner/asked_kinematics.hpp"
#include "motion/core/planner/planner.hpp"

namespace kerf::motion::test {

/// Joint j moves axis `axes[j]`; or a module of kinematics does, which tells everything itself.
class RigKinematics final : public Kinematics {
 public:
  explicit RigKinematics(std::vector<int> axes) : axes_(std::move(axes)) {}
  explicit RigKinematics(const Kinematics& all) : kind(all.type()), module(&all) {}
  [[nodiscard]] KinematicsType type() const noexcept override { return kind; }
  [[nodiscard]] std::int32_t joints() const noexcept override {
    if (module != nullptr) return module->joints();
    return static_cast<std::int32_t>(axes_.size());
  }
  [[nodiscard]] bool forward(const JointVector& q, Pose& p) const noexcept override {
    if (module != nullptr) return module->forward(q, p);
    for (std::size_t j = axes_.size(); j > 0; --j)
      p[static_cast<std::size_t>(axes_[j - 1])] = q[j - 1];
    if (core_xy) {
      p.x = 0.5 * (q[0] + q[1]);
      p.y = 0.5 * (q[0] - q[1]);
    }
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& p, JointVector& q) const noexcept override {
    if (module != nullptr) return module->inverse(p, q);
    for (std::size_t j = 0; j < axes_.size(); ++j) q[j] = p[static_cast<std::size_t>(axes_[j])];
    if (core_xy) {
      q[0] = p.x + p.y;
      q[1] = p.x - p.y;
    }
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t j) const noexcept override {
    if (module != nullptr) return module->axis_of_joint(j);
    return core_xy && j < 2 ? -1 : axes_[static_cast<std::size_t>(j)];
  }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override {
    if (module != nullptr) return module->axis_mask();
    std::uint32_t mask = 0;
    for (const int a : axes_) mask |= 1U << static_cast<unsigned>(a);
    return mask;
  }
  KinematicsType kind{KinematicsType::identity};
  const Kinematics* module{nullptr};
  bool core_xy{false};  ///< joints 0 and 1 move X+Y and X-Y
  bool later{
      false};  ///< the planner's questions are answered in servo cycles, as those to modules in C are

 private:
  std::vector<int> axes_;
};

/// The planner's memory, for the life of the rig; then kept for the next one. The planner writes to all of its tens of MB when it is
/// made, tests make thousands of rigs, and pages new from the kernel took most of their time.
class HeapMemory final : public path::Memory {
 public:
  HeapMemory() = default;
  HeapMemory(const HeapMemory&) = delete;
  HeapMemory& operator=(const HeapMemory&) = delete;
  ~HeapMemory() {
    for (auto& [bytes, block] : blocks_) kept().emplace(bytes, std::move(block));
  }
  void* allocate(std::size_t bytes, std::size_t align) noexcept override {
    if (align > alignof(std::max_align_t)) return nullptr;
    if (const auto at = kept().find(bytes); at != kept().end()) {
      blocks_.emplace_back(bytes, std::move(at->second));
      kept().erase(at);
    } else {
      blocks_.emplace_back(bytes, std::make_unique_for_overwrite<std::byte[]>(bytes));
    }
    return blocks_.back().second.get();
  }

 private:
  using Block = std::unique_ptr<std::byte[]>;
  /// By size.
  static std::unordered_multimap<std::size_t, Block>& kept() {
    static std::unordered_multimap<std::size_t, Block> blocks;
    return blocks;
  }
  std::vector<std::pair<std::size_t, Block>> blocks_;
};

struct Rig {
  static constexpr double kPeriod = 0.001;

  explicit Rig(std::vector<int> axes = {0, 1, 2}) : Rig(RigKinematics(std::move(axes))) {}
  explicit Rig(const RigKinematics& moved_by)
      : kinematics(moved_by),
        path(std::make_unique<PathRing>()),
        spans(std::make_unique<SpanRing>()),
        faults_in(std::make_unique<FaultRing>()),
        slots(std::make_unique<PlanSlots>()),
        asked(moved_by.later ? std::make_unique<AskedKinematics>(kinematics) : nullptr),
        planner(asked != nullptr ? static_cast<const Kinematics&>(*asked) : kinematics, *spans,
                *slots, *faults_in),
        controller(std::make_unique<Controller>(kinematics, *spans, *slots, *faults_in,
                                                kinematics.joints(), 2)) {
    if (!planner.create(memory)) std::abort();
    config.joints = kinematics.joints();
    config.axis_mask = kinematics.axis_mask();
    config.traj_max_vel_mm_s = 1e6;
    config.traj_max_ang_vel_deg_s = 1e6;
    config.max_feed_override = 1.5;
    config.path_check = true;
    for (auto& j : config.joint) {
      j.min_limit = -1000;
      j.max_limit = 1000;
      j.max_vel = 100;
      j.max_acc = 1000;
      j.ferror = 1;
      j.min_ferror = 0.5;
    }
    for (auto& a : config.axis) {
      a.min_limit = -1000;
      a.max_limit = 1000;
      a.max_vel = 100;
      a.max_acc = 1000;
    }
    orders.values = &intent;
    apply_config();
  }

  void apply_config() {
    planner.configure(config);
    controller->configure(config);
  }

  /// One servo cycle, planner first.
  void cycle() {
    if (heart) ++orders.heartbeat;
    while (plan && planner.run(*path, controller->view(), orders.abort_epoch, now_ns) ==
                       Planner::Waits::turn) {
    }
    orders.path_ring_empty = path->empty();
    controller->step(in, orders, kPeriod, now_ns);
    if (asked != nullptr) (void)asked->serve();
    now_ns += 1'000'000;
    for (const auto& f : controller->faults()) faults.push_back(f);
    for (std::size_t j = 0; j < controller->joints(); ++j) {
      const auto& s = status().joint[j];
      if (follow)
        in.joint[j].motor_pos_fb =
            s.pos_cmd + s.motor_offset + controller->joint(j).backlash.position();
    }
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) cycle();
  }
  /// Cycles until `done()` holds, or `limit`; gives how many it took, -1 when it never did.
  template <class F>
  int run_until(F&& done, int limit = 100000) {
    for (int i = 0; i < limit; ++i) {
      cycle();
      if (done()) return i + 1;
    }
    return -1;
  }

  void enable() {
    orders.enable = true;
    run(2);
  }
  /// Homes without moving and goes to coordinated mode.
  void ready() {
    enable();
    for (int j = 0; j < kinematics.joints(); ++j) config.joint[j].home_sequence = 0;
    apply_config();
    ++intent.home_seq;
    intent.home_joint = -1;
    run_until([&] { return status().all_homed && !status().homing_active; }, 100);
    intent.mode = MotionMode::coordinated;
    run(2);
  }
  bool push(PathItems::Variant body, int line = 0) {
    PathItem item;
    item.epoch = orders.abort_epoch;
    item.seq = ++seq;
    item.tag.id = seq;
    item.tag.line = line == 0 ? static_cast<int>(seq) : line;
    item.body = body;
    const bool pushed = path->push(item);
    if (!pushed) --seq;
    return pushed;
  }
  bool line(const Pose& end, double vel, MotionKind kind = MotionKind::feed) {
    LinearMove m;
    m.end = end;
    m.vel_mm_s = vel;
    m.kind = kind;
    return push(m);
  }
  /// Until all that was pushed is done.
  int finish(int limit = 200000) {
    return run_until([&] { return status().executed_seq >= seq && status().path_empty; }, limit);
  }
  void abort() { ++orders.abort_epoch; }
  [[nodiscard]] const MotionStatus& status() const { return std::as_const(*controller).status(); }
  [[nodiscard]] bool saw(Fault f) const {
    for (const auto& r : faults) {
      if (r.fault == f) return true;
    }
    return false;
  }

  RigKinematics kinematics;
  MachineConfig config;
  std::unique_ptr<PathRing> path;
  std::unique_ptr<SpanRing> spans;
  std::unique_ptr<FaultRing> faults_in;
  std::unique_ptr<PlanSlots> slots;
  HeapMemory memory;
  std::unique_ptr<AskedKinematics> asked;
  Planner planner;
  std::unique_ptr<Controller> controller;
  Inputs in;
  Orders orders;
  Intent intent;
  std::vector<FaultRecord> faults;
  std::uint64_t seq{0};
  std::int64_t now_ns{0};
  bool heart{true}, plan{true}, follow{true};
};

}  // namespace kerf::motion::test
