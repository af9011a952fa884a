// The fault table of homing: layout x joint x state x fault. Whatever breaks at whatever moment: all joints come to rest within
// their limits and in time, they say why, and none is taken as homed that does not stand where it says.
//
// KERF_COUNT=N looks at about N branches; 3000, the default, is all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "motion/core/homing.hpp"
#include "unit/motion/homing_rig.hpp"

namespace kerf::motion {
namespace {

using test::Drive;
using test::HomingRig;

constexpr double kLatchVel = 5;

enum class Breaks {
  nothing,
  dead_switch,   ///< never closes again
  stuck_switch,  ///< closed for ever
  bounce,        ///< for 5 ms at each edge from now on
  no_index,
  hard_limit,
  other_limit,  ///< of a joint that stands
  amplifier,
  stall,  ///< the motor stands: following error
  abort,
  off,
  estop,  ///< motion.enable
  task_dead,
  misc_error,
  second_request,
  unhome,
  stale_feedback,  ///< the driver reads nothing for 3 cycles, within the budget
};
constexpr Breaks kBreaks[] = {Breaks::nothing,     Breaks::dead_switch,   Breaks::stuck_switch,
                              Breaks::bounce,      Breaks::no_index,      Breaks::hard_limit,
                              Breaks::other_limit, Breaks::amplifier,     Breaks::stall,
                              Breaks::abort,       Breaks::off,           Breaks::estop,
                              Breaks::task_dead,   Breaks::misc_error,    Breaks::second_request,
                              Breaks::unhome,      Breaks::stale_feedback};

struct Layout {
  const char* name;
  std::vector<int> axes;
  int sequence[4];
  std::int32_t flags;  ///< of all joints
  double latch;
  bool locks;
};
const std::vector<Layout>& layouts() {
  static const std::vector<Layout> all = {
      {"together", {0, 1, 2}, {0, 0, 0}, 0, -kLatchVel, false},
      {"one by one", {0, 1, 2}, {2, 0, 1}, 0, kLatchVel, false},
      {"gantry", {0, 1, 1, 2}, {1, -2, -2, 0}, 0, -kLatchVel, false},
      {"gantry, other edge", {0, 1, 1, 2}, {1, -2, 2, 0}, 0, kLatchVel, false},
      {"index", {0, 1, 1, 2}, {0, -1, -1, 0}, home_use_index, -kLatchVel, false},
      {"locks", {0, 1, 2}, {0, 0, -1}, home_unlock_first, -kLatchVel, true},
      {"limit switches", {0, 1, 2}, {0, 1, 1}, home_ignore_limits, -kLatchVel, false},
  };
  return all;
}

class TableRig : public HomingRig {
 public:
  explicit TableRig(const Layout& layout) : HomingRig(layout.axes), layout_(layout) {
    for (std::size_t j = 0; j < count(); ++j) {
      JointConfig& c = config.joint[j];
      c.home_sequence = layout.sequence[j];
      c.home_flags = layout.flags;
      c.home_latch_vel = layout.latch;
      c.home_search_dist = 12;
      c.home_latch_dist = 6;
      Drive& d = drive[j];
      d.edge = 2.5 + 0.4 * static_cast<double>(j);
      d.index_every = 1;
      d.locks = layout.locks;
      d.place = j == 0 && layout.axes.size() == 3 ? 4 : 0;  // one begins on its switch
    }
    apply_config();
    disturb = [this] { spoil(); };
  }

  void break_it(Breaks what, std::size_t j) {
    broken_ = what;
    victim_ = j;
    at_ = drive[j].place;
    closed_ = drive[j].closed();
    switch (what) {
      case Breaks::abort: return abort();
      case Breaks::off: orders.enable = false; return;
      case Breaks::task_dead: heart = false; return;
      case Breaks::no_index: drive[j].index_every = 0; return;
      case Breaks::second_request: return home(0);
      case Breaks::unhome:
        ++intent.unhome_seq;
        intent.unhome_joint = -1;
        return;
      default: return;
    }
  }

  /// Joints whose flag says homed stand where they say.
  void check_homed(const std::string& where) {
    for (std::size_t j = 0; j < count(); ++j) {
      const JointStatus& s = status().joint[j];
      if (!s.homed) continue;
      EXPECT_FALSE(s.homing) << where << j;
      const bool index = (layout_.flags & home_use_index) != 0;
      // Of the pulse next to the edge; or of the edge, seen within a cycle or its bounces. A switch that begins to lie while its
      // edge is awaited looks like one: then by no more than the way from where the latch began.
      const bool lies =
          j == victim_ && (broken_ == Breaks::dead_switch || broken_ == Breaks::stuck_switch);
      const double off = (lies && index ? 1.0
                          : lies        ? 0.25
                                        : 0.0) +
                         (broken_ == Breaks::bounce ? 0.04 : 0.0101);
      const double truth = index ? std::floor(drive[j].edge) : drive[j].edge;
      const double says = drive[j].place - s.pos_cmd + config.joint[j].home_offset;
      EXPECT_NEAR(says, truth, off) << where << j;
    }
  }

 private:
  void spoil() {
    JointInputs& at = in.joint[victim_];
    const bool closed = at.home_switch;
    switch (broken_) {
      case Breaks::dead_switch: at.home_switch = false; break;
      case Breaks::stuck_switch: at.home_switch = true; break;
      case Breaks::bounce:
        if (closed != closed_) bouncing_ = 5;
        if (bouncing_ > 0) at.home_switch = (--bouncing_ % 2 == 0) == closed;
        break;
      case Breaks::hard_limit: at.neg_limit = true; break;
      case Breaks::other_limit: in.joint[(victim_ + 1) % count()].pos_limit = true; break;
      case Breaks::amplifier: at.amp_fault = true; break;
      case Breaks::stall: at.motor_pos_fb = at_ - drive[victim_].zero; break;
      case Breaks::estop: in.enable = false; break;
      case Breaks::misc_error: in.misc_errors = 4; break;
      case Breaks::stale_feedback:
        at.fb_stale = unread_ > 0;
        if (unread_ > 0) {
          --unread_;
          at.motor_pos_fb = last_.motor_pos_fb;
          at.home_switch = last_.home_switch;
          at.index_enable = last_.index_enable;
        }
        break;
      default: break;
    }
    closed_ = closed;
    last_ = at;
  }

  const Layout& layout_;
  Breaks broken_{Breaks::nothing};
  std::size_t victim_{0};
  double at_{0};
  int bouncing_{0};
  bool closed_{false};
  int unread_{3};
  JointInputs last_;  ///< what was read last
};

struct Course {
  double skew{0};
  double low[4]{}, high[4]{}, start[4]{};
};

void look(TableRig& rig, Course& course) {
  for (std::size_t j = 0; j < rig.count(); ++j) {
    course.low[j] = std::min(course.low[j], rig.drive[j].place);
    course.high[j] = std::max(course.high[j], rig.drive[j].place);
  }
  if (rig.count() == 4)
    course.skew = std::max(course.skew, std::abs(rig.drive[1].place - rig.drive[2].place));
}

double worst_skew = 0;  ///< of a gantry whose switches tell the truth

bool stands(const TableRig& rig) { return !rig.status().homing_active && rig.status().in_position; }

/// Fails of the machine itself, which switch it off.
bool stops_at_once(Breaks what, const Layout& layout) {
  switch (what) {
    case Breaks::hard_limit:
    case Breaks::other_limit: return (layout.flags & home_ignore_limits) == 0;
    case Breaks::amplifier:
    case Breaks::abort:
    case Breaks::off:
    case Breaks::estop:
    case Breaks::task_dead:
    case Breaks::misc_error: return true;
    default: return false;
  }
}

/// One branch. False: the joint never is in that state in this layout.
bool branch(const Layout& layout, std::size_t j, std::int32_t state, int cycles, Breaks what) {
  TableRig rig(layout);
  rig.enable();
  rig.steps(2);
  rig.home(-1);
  Course course;
  for (std::size_t n = 0; n < rig.count(); ++n) course.start[n] = rig.drive[n].place;
  if (!rig.step_until(
          [&] {
            look(rig, course);
            return rig.status().joint[j].home_state == state || rig.all_home();
          },
          8000) ||
      rig.status().joint[j].home_state != state)
    return false;
  const std::string where = std::string(layout.name) + ", joint " + std::to_string(j) + ", state " +
                            std::to_string(state) + " + " + std::to_string(cycles) + ", fault " +
                            std::to_string(static_cast<int>(what)) + ": ";
  rig.steps(cycles);
  double fastest = 0;  // mm/s, and with 1000 mm/s2 the ms that a stop takes
  for (std::size_t n = 0; n < rig.count(); ++n)
    fastest = std::max(fastest, std::abs(rig.status().joint[n].vel_cmd));
  rig.break_it(what, j);
  int took = 0;
  const bool rests = rig.step_until(
      [&] {
        look(rig, course);
        return ++took > 2 && stands(rig);
      },
      20000);
  EXPECT_TRUE(rests) << where << "it never ends";
  // Each brakes at 1000 mm/s2; task's silence is noticed after 100 ms, in which the fastest move may begin.
  if (stops_at_once(what, layout)) {
    const double braking_ms = fastest + 5;
    EXPECT_LE(took, what == Breaks::task_dead ? 100 + 105 : braking_ms) << where;
  }
  rig.check_homed(where);
  for (std::size_t n = 0; n < rig.count(); ++n) {
    // The search goes on by 12 at most, a way back too.
    EXPECT_GE(course.low[n], -12.3) << where << n;
    EXPECT_LE(course.high[n], course.start[n] + 12.3) << where << n;
  }
  if (rig.count() == 4 && what != Breaks::stall) {
    // Misalignment 0.4; a switch that lies to one leg is worth what that leg may search.
    const bool lies = what == Breaks::dead_switch || what == Breaks::stuck_switch;
    const bool index = (layout.flags & home_use_index) != 0;
    const double most = 0.4 + 0.04 + (what == Breaks::bounce ? 0.1 : 0.0) + (index ? 1.0 : 0.0);
    EXPECT_LE(course.skew, lies || what == Breaks::no_index ? 12.3 : most) << where;
    if (!lies && what != Breaks::bounce && !index) worst_skew = std::max(worst_skew, course.skew);
  }
  for (const FaultRecord& f : rig.faults)
    EXPECT_FALSE(f.fault >= Fault::limit_velocity && f.fault <= Fault::limit_continuity)
        << where << static_cast<int>(f.fault) << ' ' << f.index << ' ' << f.value << ' ' << f.limit;
  const bool by_order = what == Breaks::abort || what == Breaks::off;
  EXPECT_TRUE(rig.all_home() || by_order || !rig.faults.empty()) << where << "it says nothing";
  double rest[4];
  for (std::size_t n = 0; n < rig.count(); ++n) rest[n] = rig.drive[n].place;
  rig.steps(50);
  for (std::size_t n = 0; n < rig.count(); ++n) {
    EXPECT_EQ(rig.drive[n].place, rest[n]) << where << n << " moves again";
    EXPECT_FALSE(rig.drive[n].index_enable) << where << n;
  }
  EXPECT_EQ(rig.turned_locked, 0) << where;
  return true;
}

TEST(HomingTable, EveryFaultInEveryState) {
  constexpr int kAll = 3000;
#ifdef __SANITIZE_ADDRESS__
  constexpr int kDefault = 600;
#else
  constexpr int kDefault = kAll;
#endif
  const char* wanted = std::getenv("KERF_COUNT");
  const int count = std::clamp(wanted != nullptr ? std::atoi(wanted) : kDefault, 1, kAll);
  constexpr int kLast = Homing::wait_lock;
  int total = 0;
  for (const Layout& layout : layouts())
    total += static_cast<int>(layout.axes.size()) * kLast * static_cast<int>(std::size(kBreaks));
  int number = 0, done = 0;
  double credit = 0;
  // States that a layout does not have cost little and count for nothing.
  for (const Layout& layout : layouts()) {
    for (std::size_t j = 0; j < layout.axes.size(); ++j) {
      for (std::int32_t state = 1; state <= kLast; ++state) {
        for (const Breaks what : kBreaks) {
          ++number;
          credit += static_cast<double>(count) / kAll;
          if (credit < 1) continue;
          credit -= 1;
          if (branch(layout, j, state, number % 7, what)) ++done;
        }
      }
    }
  }
  EXPECT_GT(done, count / 4);
  std::printf(
      "result: homing fault table: %d branches of %d (%zu layouts, each joint and state, %zu "
      "faults), "
      "%d of them in states that the layout has; legs of a gantry whose switches are %.2f mm "
      "apart, a "
      "machine fault at any time: at most %.3f mm askew\n",
      std::min(count, total), total, layouts().size(), std::size(kBreaks), done, 0.4, worst_skew);
  RecordProperty("branches", done);
}

}  // namespace
}  // namespace kerf::motion
